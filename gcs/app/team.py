"""A team that is flown from Python: :class:`gcs.Team`."""

from __future__ import annotations

import math
import tempfile
import threading
from collections.abc import Callable, Mapping
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import Any, Self

from gcs.app.call import as_flown
from gcs.app.flown import Flight, flown
from gcs.app.fly import FlightResult
from gcs.app.fly_options import FlyOptions
from gcs.app.in_process import open_world
from gcs.app.served_flight import Flights, take_truth
from gcs.app.team_drive import Drive, LockstepDrive, RealTimeDrive, YieldingConnection
from gcs.drivers.in_process import InProcessLockstep
from gcs.errors import OrderRefused
from gcs.mavlink import px4
from gcs.mavlink.address import Address, parse_url
from gcs.mavlink.services.aircraft import Reposition
from gcs.mavlink.services.answer import ACCEPTED, Answer
from gcs.mission.model import Mission
from gcs.record.run_folder import NewRunFolder
from gcs.record.setpoints import SentSetpoints
from gcs.serve.report import PayloadMotion
from gcs.serve.server import TeamServer

WORLD = "hover"
"""Of the package's missions, that whose system the team has where none is named: a world without obstacles."""
_SENDER = ("", 0), 0
_NAN = math.nan
_READY_TIME = 30.0
"""s; for the checks before take-off."""


class Team:
    """UAVs and their load, flown as one aircraft; a context manager that lands and closes.

    Made by :meth:`simulate` or :meth:`connect`. Positions are the payload's, north, east and up (m) from home on the
    ground. Time goes on only in :meth:`run`, :meth:`wait`, :meth:`finish` and :meth:`close` where it is simulated, and
    always where it is not.

    An order that cannot be carried out raises :class:`OrderRefused` with the reason.
    """

    def __init__(self, drive: Drive, flights: Flights, setpoints: SentSetpoints, opened: ExitStack) -> None:
        self._drive, self._flights, self._setpoints, self._opened = drive, flights, setpoints, opened
        self._server = drive.server
        self._session, self._aircraft = drive.server.session, drive.server.aircraft

    @classmethod
    def simulate(
        cls,
        world: Path | str | Mission = WORLD,
        *,
        seed: int | None = None,
        config: Path | str | None = None,
        settings: Mapping[str, Any] | None = None,
        run_dir: Path | str | None = None,
    ) -> Self:
        """Simulate a team in this process, in lockstep: the same orders at the same times give the same bytes.

        Args:
            world: a mission, whose system, home, obstacles and faults the world has; it is not flown.
            seed: of every random number, in place of the world's own.
            config: a system file in place of the world's own.
            settings: of the system file, by dotted path (docs/settings.md).
            run_dir: a folder for the records, made if it is absent; each flight has a folder in it. None: none is kept.

        Raises :class:`gcs.errors.UnusableInput` for what cannot be simulated.
        """
        mission = as_flown(world, seed, config, settings or {}, None)
        with ExitStack() as opening:
            wanted = run_dir
            if wanted is None:
                wanted = Path(opening.enter_context(tempfile.TemporaryDirectory(prefix="cooplift-"))) / "run"
            folder = opening.enter_context(NewRunFolder("team", wanted))
            simulated = opening.enter_context(closing(open_world(mission, folder.path)))
            sent = SentSetpoints()

            flights = Flights(simulated.addresses, folder.path, partial(take_truth, folder.path))
            server = TeamServer(mission, flights.open)
            drive = LockstepDrive(InProcessLockstep(simulated, server), sent.add)
            folder.keep()
            return cls(drive, flights, sent, opening.pop_all())

    @classmethod
    def connect(cls, *urls: str, world: Path | str | Mission = WORLD, run_dir: Path | str | None = None) -> Self:
        """Connect to a swarm that runs in real time, as ``gcs fly --connect`` does: ``vehicle-sim``, or autopilots.

        Args:
            urls: ``udp://HOST:PORT`` of every vehicle, in the order of their system ids; none: the ports of this
                machine where vehicle-sim listens.
            world: a mission, whose system, home and known obstacles the ground assumes; it is not flown.
            run_dir: a folder for the records, made if it is absent; None: ``runs/team-<number>``.

        Raises :class:`gcs.errors.UnusableInput` for an address that cannot be used.
        """
        mission = as_flown(world, None, None, {}, None)
        options = FlyOptions(Path(WORLD), connect=tuple(parse_url(url) for url in urls))
        with ExitStack() as opening:
            folder = opening.enter_context(NewRunFolder("team", run_dir))
            connection = opening.enter_context(closing(YieldingConnection(_local(options), threading.Condition())))
            flights = Flights(options.addresses(mission.system.team.vehicles), folder.path)
            server = TeamServer(mission, flights.open)
            folder.keep()
            return cls(RealTimeDrive(server, connection), flights, SentSetpoints(), opening.pop_all())

    # State

    @property
    def time(self) -> float:
        """Time since the ground began (s)."""
        return self._drive.now

    @property
    def position(self) -> tuple[float, float, float]:
        """Where the payload's centre is, by the ground's estimate: north, east and up (m); nan before it is known."""
        motion = self._motion()
        return (_NAN, _NAN, _NAN) if motion is None else (motion.position[0], motion.position[1], -motion.position[2])

    @property
    def speed(self) -> float:
        """Speed of the payload (m/s)."""
        motion = self._motion()
        return _NAN if motion is None else math.hypot(*motion.velocity)

    @property
    def phase(self) -> str:
        """Phase of the flight: connect, check, arm, spool up, climb, fly, hold, land, spool down, disarm."""
        return self._session.flight.phase.value

    @property
    def in_air(self) -> bool:
        """True from spool-up until the rotors have stopped."""
        return self._session.in_air

    @property
    def flights(self) -> list[Flight]:
        """The flights that are over, each from arming to disarming."""
        return [self._flown(result) for result in self._flights.results]

    # Orders

    def upload(self, mission: Path | str | Mission) -> None:
        """Have a mission, a file or one that was built in Python; only what it flies, its fence included, counts."""
        self._order(lambda: self._aircraft.load(as_flown(mission, None, None, {}, None)))

    def start(self) -> None:
        """Fly the mission: take off for it, or begin it in the air."""
        self._ready()
        self._order(lambda: self._aircraft.start_mission(0, self.time))

    def take_off(self, height: float = 3.0) -> None:
        """Arm, take off to ``height`` above home (m), and hold there."""
        self._ready()
        with self._drive.lock:  # armed, it is disarmed again where the take-off is late
            self._order(lambda: self._aircraft.arm(self.time))
            self._order(lambda: self._aircraft.take_off(height + self._aircraft.base.home.altitude, self.time))

    def pause(self) -> None:
        """Come to rest on the way, and hold."""
        self._order(lambda: self._aircraft.pause(self.time))

    def resume(self) -> None:
        """Go on with the mission."""
        self._order(lambda: self._aircraft.resume(self.time))

    def go_to(self, north: float, east: float, up: float, speed: float | None = None) -> None:
        """Fly to a place round what is known, at ``speed`` (m/s; None: the system's), and hold there."""
        frame, home = self._server.report.frame, self._aircraft.base.home
        latitude, longitude, _ = frame.geodetic(north, east, 0.0)
        goal = Reposition(latitude, longitude, home.altitude + up, _NAN, _NAN if speed is None else speed)
        self._order(lambda: self._aircraft.reposition(goal, self.time))

    def change_speed(self, speed: float) -> None:
        """Fly with another ``speed`` (m/s) from now on."""
        self._order(lambda: self._aircraft.change_speed(speed, self.time))

    def return_home(self) -> None:
        """Fly to above home, or to a rally point that is nearer, and land there."""
        self._order(lambda: self._aircraft.enter_mode(px4.MODE_RETURN, _SENDER, self.time))

    def land(self) -> None:
        """Land where the payload is."""
        self._order(lambda: self._aircraft.enter_mode(px4.MODE_LAND, _SENDER, self.time))

    # Time

    def run(self, seconds: float) -> None:
        """Let time go on."""
        self._drive.run(lambda: False, seconds)

    def wait(self, timeout: float = 600.0) -> bool:
        """Let time go on until the payload holds at rest, or is on the ground; return False after ``timeout`` (s)."""
        flight = self._session.flight
        begin = self.time

        def is_at_rest() -> bool:
            if self.time <= begin:
                return False
            return self._session.orders.is_settled or self._session.flight is not flight

        return self._drive.run(is_at_rest, timeout)

    def finish(self, timeout: float = 3600.0) -> Flight | None:
        """Let time go on until the flight is over, and return it; None: none flies, or longer than ``timeout`` (s)."""
        before = len(self._flights.results)
        if not self._session.is_armed:
            return None
        if not self._drive.run(lambda: len(self._flights.results) > before, timeout):
            return None
        return self._flown(self._flights.results[-1])

    def close(self) -> None:
        """Land what is in the air, and close the records; harmless when that is done."""
        with self._opened:
            if not self._server.ended:
                self._drive.close()
            self._session.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ready(self) -> None:
        """Wait for the checks before take-off."""
        self._drive.run(lambda: self._aircraft.arming_problem(self.time) is None, _READY_TIME)

    def _motion(self) -> PayloadMotion | None:
        with self._drive.lock:
            return self._server.report.own_position

    def _order(self, carry_out: Callable[[], Answer]) -> None:
        self._drive.run(lambda: True, 0.0)  # raises if the ground has ended
        with self._drive.lock:
            answer = carry_out()
        if answer != ACCEPTED:
            raise OrderRefused(answer.text)

    def _flown(self, result: FlightResult) -> Flight:
        return flown(result, self._setpoints, "", keep=True)


def _local(options: FlyOptions) -> Address:
    remote = [url for url in options.urls if not url.host.startswith("127.")]
    return ("0.0.0.0" if remote else "127.0.0.1", 0)
