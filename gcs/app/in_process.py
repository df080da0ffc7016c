"""A flight in lockstep within this process, step by step: the world of an entry point, and the ground station."""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol, Self

from gcs.app.fly import FlightResult, cpu_time, flight_result, ground_station
from gcs.app.imports import importing
from gcs.drivers.in_process import InProcessLockstep, World
from gcs.extras import simulator
from gcs.flight.flight import Flight
from gcs.flight.ground_station import GroundStation
from gcs.mavlink.address import Address
from gcs.mission.model import Mission
from gcs.record.incomplete import Incomplete
from gcs.record.recorder import FlightRecorder
from gcs.record.setpoints import SentSetpoints

WORLDS = "cooplift.world"
"""Group of entry points, each a function of mission and run folder that opens a :class:`RecordedWorld`."""


class RecordedWorld(World, Protocol):
    """A world that writes its records (``truth.csv`` and others) to a run folder."""

    @property
    def incomplete(self) -> Sequence[Incomplete]:
        """Records that could not be written in full; known when it is closed."""

    def close(self) -> None:
        """End the world and its records; harmless when that is done."""


def open_world(mission: Mission, run_dir: Path) -> RecordedWorld:
    """Open the world of ``mission`` that is installed, as :func:`gcs.extras.simulator` chooses.

    Raises :class:`GcsError` if there is none, and :class:`UnusableInput` if it cannot simulate the mission.
    """
    entry = simulator(WORLDS, "world is")
    with importing():
        open_one = entry.load()
    world: RecordedWorld = open_one(mission, run_dir)
    return world


class FlightInProcess:
    """One flight, its records in a run folder; a context manager that closes them.

    Public state, to be read only: ``mission``, ``run_dir``, ``world``, ``recorder``, ``lockstep``, and ``setpoints``,
    those that were sent.
    """

    def __init__(
        self,
        mission: Mission,
        run_dir: Path,
        *,
        controller: str = "idc",
        world: RecordedWorld | None = None,
        addresses: Sequence[Address | None] | None = None,
        start_epoch: float = 0.0,
    ) -> None:
        """Open the world, unless one is given, and the records in ``run_dir``, which must exist.

        ``addresses``: of the vehicles, as the ground station is given them; None: the true ones. ``start_epoch``:
        seconds since 1970 at time 0, for the telemetry log.
        """
        self.mission, self.run_dir = mission, run_dir
        self.setpoints = SentSetpoints()
        self._takeoff: float | None = None
        """Wall time of take-off (s)."""
        self._cpu = cpu_time()
        self._closed = False
        gc.collect()  # of flights before: their cycles hold large arrays
        with ExitStack() as opened:
            self.world = open_world(mission, run_dir) if world is None else world
            opened.callback(self.world.close)
            self.recorder = FlightRecorder(run_dir, start_epoch)
            opened.callback(self.recorder.close)
            station = ground_station(mission, addresses or self.world.addresses, self.recorder, controller)
            self.lockstep = InProcessLockstep(self.world, station)
            self._closing = opened.pop_all()

    @property
    def station(self) -> GroundStation:
        """The ground station."""
        return self.lockstep.station

    @property
    def flight(self) -> Flight:
        """The flight as the ground station knows it."""
        return self.station.flight

    @property
    def now(self) -> float:
        """Time of the next exchange (s)."""
        return self.lockstep.now

    @property
    def ended(self) -> bool:
        """True if the flight is over."""
        return self.lockstep.ended

    def step(self, exchanged: Callable[[], None] = lambda: None) -> None:
        """Make one exchange between world and ground station, and go on to the time of the next.

        ``exchanged`` is called in between. After the last exchange the vehicles are still to come to rest: see
        :meth:`result`.
        """

        def record(sent: Sequence[tuple[bytes, Address]]) -> None:
            if self._takeoff is None and not math.isnan(self.flight.takeoff_time):
                self._takeoff = time.monotonic()
            self.setpoints.add(self.now, sent)
            exchanged()

        self.lockstep.step(record)

    def fly(
        self,
        exchanged: Callable[[], None] = lambda: None,
        *,
        until: float = math.inf,
        stop: Callable[[], bool] = lambda: False,
    ) -> None:
        """Fly to the end, to ``until`` (s), or until ``stop`` returns true; ``exchanged`` as in :meth:`step`."""
        while not self.ended and self.now <= until and not stop():
            self.step(exchanged)

    def result(self) -> FlightResult:
        """Let the vehicles come to rest, close the records, write the summary, and return how the flight ended.

        Of a flight that is closed already, the records end there.
        """
        if not self._closed:
            self.lockstep.let_land()
        wall = 0.0 if self._takeoff is None else time.monotonic() - self._takeoff
        self.close()
        incomplete = (*self.recorder.incomplete.found, *self.world.incomplete)
        cpu = cpu_time() - self._cpu
        return flight_result(self.run_dir, self.mission, self.station, self.recorder.last_time, wall, incomplete, cpu)

    def close(self) -> None:
        """Close world and records; harmless when they are closed."""
        self._closed = True
        self._closing.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
