"""The flights of a team that is served: each with a ground station and, from arming on, a run folder of its own."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from gcs.app.fly import FlightResult, flight_result, ground_station
from gcs.app.logs import LOG
from gcs.mavlink.address import Address
from gcs.mission.model import Mission
from gcs.record.excerpt import take_excerpt
from gcs.record.no_records import NoRecords
from gcs.record.recorder import FlightRecorder
from gcs.record.run_folder import NewRunFolder, write_manifest

if TYPE_CHECKING:
    from gcs.flight.ground_station import GroundStation


class Waiting:
    """A ground station between flights, without records."""

    def __init__(self, world: Mission, addresses: Sequence[Address | None]) -> None:
        self.station = ground_station(world, addresses, NoRecords())

    def close(self) -> str:
        """Return nothing: there are no records."""
        return ""


class ServedFlight:
    """A flight with its records in a run folder."""

    def __init__(
        self,
        world: Mission,
        addresses: Sequence[Address | None],
        run_dir: Path,
        begin: datetime,
        keep_truth: Callable[[Path, GroundStation], None],
        closed: Callable[[FlightResult], None],
    ) -> None:
        """``begin``: when the ground's time was 0. ``keep_truth`` puts the true motion into the folder at the end."""
        self._opened = ExitStack()
        folder = self._opened.enter_context(NewRunFolder(world.name, run_dir))
        write_manifest(
            folder.path, command=sys.argv, seed=world.seed, mission=world, system=world.system, start=datetime.now(UTC)
        )
        recorder: FlightRecorder = self._opened.enter_context(FlightRecorder(folder.path, begin.timestamp()))
        folder.keep()
        self._run_dir, self._recorder, self._wall = folder.path, recorder, time.monotonic()
        self._keep_truth, self._closed = keep_truth, closed
        self.station = ground_station(world, addresses, recorder)
        self.result: FlightResult | None = None

    def close(self) -> str:
        """Close the records, write the summary, and return how the flight ended."""
        if self.result is None:
            self._opened.close()
            self._keep_truth(self._run_dir, self.station)
            mission, recorder = self.station.flight.mission, self._recorder
            wall = time.monotonic() - self._wall
            incomplete = tuple(recorder.incomplete.found)
            self.result = flight_result(self._run_dir, mission, self.station, recorder.last_time, wall, incomplete)
            self._closed(self.result)
        return f"Flight {self.result.summary['outcome']}{f': {self.result.reason}' if self.result.reason else ''}"


def take_truth(world: Path, flight: Path, station: GroundStation) -> None:
    """Copy the true motion since a flight began from the folder of its ``world`` into that of the ``flight``."""
    take_excerpt(world, flight, station.flight.started, math.inf)


@dataclass
class Flights:
    """Opens the flights of a session, whose records go to ``folder``/flight-1 and on."""

    addresses: Sequence[Address | None]
    folder: Path
    keep_truth: Callable[[Path, GroundStation], None] = lambda folder, station: None
    begin: datetime = field(default_factory=lambda: datetime.now(UTC))
    results: list[FlightResult] = field(default_factory=list)
    """Of the flights that have ended."""
    _number: int = 0

    def open(self, world: Mission, recorded: bool) -> Waiting | ServedFlight:
        """Open a flight in ``world``, or the ground station that waits for one."""
        if not recorded:
            return Waiting(world, self.addresses)
        self._number += 1
        run_dir = self.folder / f"flight-{self._number}"
        LOG.info("flight %d: records in %s", self._number, run_dir)
        return ServedFlight(world, self.addresses, run_dir, self.begin, self.keep_truth, self.results.append)
