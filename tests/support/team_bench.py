"""The team in a simulated world within this process, and clients that know only what comes over the wire, for tests."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterable
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import Any, Self

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as m
from mission_ground import Downloader, Uploader
from service_client import Asking, text_of
from vehicle_bench import GROUND, command

from gcs.app.in_process import open_world
from gcs.app.served_flight import Flights, take_truth
from gcs.drivers.in_process import InProcessLockstep
from gcs.flight.failsafe import Failsafe
from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mission.model import DEFAULT_HOME, Mission
from gcs.record.reader import read_table
from gcs.serve.server import TEAM_SYSTEM, TeamServer

FRAME = LocalFrame(DEFAULT_HOME)
TEAM = TEAM_SYSTEM, px4.AUTOPILOT_COMPONENT
LATE = 120.0
"""s; after which what was waited for does not come."""
PREARM = m.MAV_SYS_STATUS_PREARM_CHECK


def team_command(number: int, *parameters: float) -> Any:
    return command(number, *parameters, system=TEAM_SYSTEM)


def set_mode(custom_mode: int) -> Any:
    return team_command(m.MAV_CMD_DO_SET_MODE, 1, custom_mode >> 16 & 0xFF, custom_mode >> 24)


def reposition(north: float, east: float, up: float, speed: float = -1.0) -> Any:
    latitude, longitude, _ = FRAME.place((north, east, 0.0))
    return m.MAVLink_command_int_message(
        *TEAM, m.MAV_FRAME_GLOBAL_RELATIVE_ALT, m.MAV_CMD_DO_REPOSITION, 0, 0, speed, 1, 0, math.nan, latitude,
        longitude, up,
    )  # fmt: skip


class TeamBench(Asking):
    """A team without socket and clock; a context manager that closes its records.

    ``inbox`` holds what the team has sent to an address, ``sent`` with its times a digest of all of that.
    """

    target = TEAM

    def __init__(self, world: Mission, folder: Path) -> None:
        self.folder = folder
        self._opened = ExitStack()
        simulated = self._opened.enter_context(closing(open_world(world, folder)))
        self._flights = Flights(simulated.addresses, folder, partial(take_truth, folder))
        self.server = TeamServer(world, self._flights.open, [GROUND])
        self._opened.callback(self.server.session.close)
        self._lockstep = InProcessLockstep(simulated, self.server)
        self._codecs: dict[Any, Codec] = {}
        self._reader = Codec(254, 1)
        self._pending: list[tuple[bytes, Any]] = []
        self.inbox: dict[Any, list[Any]] = {}
        self.sent = hashlib.sha256()
        self.disturb: Callable[[float], Iterable[tuple[bytes, Any]]] = lambda now: ()
        """Returns what others send at a time, each with its sender."""
        self.silenced: Any = None
        """Address of a vehicle whose telemetry is lost."""
        self._receive, self.server.receive_all = self.server.receive_all, self._take  # type: ignore[method-assign]
        self._beat = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    @property
    def now(self) -> float:
        return self._lockstep.now

    @property
    def results(self) -> list[Any]:
        """The flights that are over."""
        return self._flights.results

    def land_and_close(self) -> None:
        self.server.raise_failsafe(self.now, Failsafe.INTERRUPTED, "closed")
        while not self.server.ended:
            self._step()
        self._lockstep.let_land()

    # The wire

    def send(self, message: Any, sender: Any = GROUND, system: int = 255, component: int = 190) -> None:
        codec = self._codecs.setdefault((sender, system, component), Codec(system, component))
        self._pending.append((codec.encode(message), sender))

    def collect(self) -> None:
        """Let what was sent arrive."""
        if self._pending:
            self._step()

    def _take(self, datagrams: Any, now: float) -> None:
        self._receive([one for one in datagrams if one[1] != self.silenced], now)

    def _step(self) -> None:
        if self.now >= self._beat:
            self._beat = self.now + 1.0
            self.send(m.MAVLink_heartbeat_message(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3))
        pending, self._pending = [*self._pending, *self.disturb(self.now)], []
        self._lockstep.step(self._keep, pending)

    def _keep(self, sent: list[tuple[bytes, Any]]) -> None:
        vehicles = self._lockstep.world.addresses
        for datagram, address in sent:
            if address in vehicles:
                continue
            if address == GROUND:
                self.sent.update(b"%.6f %s" % (self.now, datagram))
            self.inbox.setdefault(address, []).extend(got.message for got in self._reader.decode(datagram))

    def run(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            self._step()

    def until(self, kind: str, wanted: Callable[[Any], bool] = lambda _: True, *, new: bool = True) -> Any:
        """Let time pass until a message of a kind comes that is wanted; ``new``: later than now."""
        inbox = self.inbox.setdefault(GROUND, [])
        looked, end = len(inbox) if new else 0, self.now + LATE
        while self.now < end:
            for message in inbox[looked:]:
                if message.get_type() == kind and wanted(message):
                    return message
            looked = len(inbox)
            self._step()
        raise AssertionError(f"no such {kind} in {LATE:g} s, last: {self.last(kind)}")

    def got(self, kind: str) -> list[Any]:
        return [found for found in self.inbox.get(GROUND, []) if found.get_type() == kind]

    def last(self, kind: str) -> Any:
        return next((found for found in reversed(self.inbox[GROUND]) if found.get_type() == kind), None)

    def answer(self, message: Any) -> tuple[int, str]:
        """Send a command; return the result of its acknowledgement, and what texts say."""
        answers = self.ask(message)
        [ack] = [found for found in answers if found.get_type() == "COMMAND_ACK"]
        assert (ack.command, ack.target_system) == (message.command, 255)
        return ack.result, text_of(answers)

    def order(self, message: Any) -> None:
        """Send a command that is accepted."""
        assert self.answer(message) == (m.MAV_RESULT_ACCEPTED, "")

    def set_parameter(self, name: str, value: float) -> tuple[float, str]:
        """Set a parameter; return the value that it has then, and what texts say."""
        message = m.MAVLink_param_set_message(*TEAM, name.encode(), value, m.MAV_PARAM_TYPE_REAL32)
        answers = self.ask(message)
        [kept] = [found for found in answers if found.get_type() == "PARAM_VALUE"]
        return kept.param_value, text_of(answers)

    def upload(self, items: Any, plan_type: int) -> tuple[int, str]:
        """Upload a plan; return the result, and what texts say."""
        before = len(self.inbox.setdefault(GROUND, []))
        uploader = self._exchange(Uploader(items, plan_type, TEAM_SYSTEM))
        self.run(0.1)
        return uploader.result, text_of(self.inbox[GROUND][before:])

    def download(self, plan_type: int) -> list[Any]:
        items: list[Any] = self._exchange(Downloader(plan_type, TEAM_SYSTEM)).items
        return items

    def _exchange(self, client: Any) -> Any:
        waiting, end = client.start(self.now), self.now + LATE
        while not client.is_done and self.now < end:
            answers = self.ask(waiting.pop(0)) if waiting else self.ask(m.MAVLink_ping_message(0, 0, 0, 0))
            waiting += [new for found in answers for new in client.take(found, self.now)]
        assert client.is_done
        for message in waiting:
            self.send(message)
        self.collect()
        return client

    # What it waits for

    def ready(self) -> None:
        self.until("SYS_STATUS", lambda found: found.onboard_control_sensors_health & PREARM)

    def settled(self, north: float, east: float, up: float, within: float = 0.1) -> None:
        """Wait until the payload is at a place, at rest."""

        def is_there(found: Any) -> bool:
            away = math.dist((found.x, found.y, found.z), (north, east, -up))
            return away < within and math.hypot(found.vx, found.vy, found.vz) < 0.05

        self.until("LOCAL_POSITION_NED", is_there)

    def at_rest(self) -> None:
        """Wait until the payload has been at rest for a second."""
        moved = [self.now]

        def rests(found: Any) -> bool:
            if math.hypot(found.vx, found.vy, found.vz) > 0.05:
                moved[0] = self.now
            return self.now - moved[0] > 1.0

        self.until("LOCAL_POSITION_NED", rests)

    def disarmed(self) -> None:
        """Wait until the team is disarmed, and the records of its flight are closed."""
        self.until("HEARTBEAT", lambda found: not found.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)
        self.run(2.5)


class Truth:
    """What a payload truly did from one time to another (s)."""

    def __init__(self, folder: Path, since: float = 0.0, until: float = math.inf) -> None:
        table = read_table(folder / "truth.csv")
        table = table[(table["time_s"] >= since) & (table["time_s"] <= until)]
        self.time, self.contacts = table["time_s"], table["contacts"]
        self.position = np.stack([table[f"payload_{axis}_m"] for axis in "xyz"], axis=1)
        self.velocity = np.stack([table[f"payload_v{axis}_mps"] for axis in "xyz"], axis=1)
        x, y = table["payload_qx"], table["payload_qy"]
        self.tilt = np.degrees(np.arccos(np.clip(1.0 - 2.0 * (x**2 + y**2), -1.0, 1.0)))

    @property
    def speed(self) -> Any:
        return np.linalg.norm(self.velocity, axis=1)

    @property
    def acceleration(self) -> Any:
        """Magnitude of the mean accelerations over 0.2 s (m/s2)."""
        return np.linalg.norm(self.velocity[10:] - self.velocity[:-10], axis=1) / (self.time[10:] - self.time[:-10])

    def nearest(self, north: float, east: float, up: float) -> float:
        """Return the least distance from a place (m)."""
        return float(np.linalg.norm(self.position - (north, east, -up), axis=1).min())
