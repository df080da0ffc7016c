"""A fault of a flight: its parameters, its schedule, its random numbers, and what it has done."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from gcs.faults import KINDS, Direction, Kind, read_settings
from gcs.mission.model import Fault
from vehicle_sim.faults.schedule import Schedule

_STREAM = 2_000_003  # separates these generators from the sensors'
WORLD = 0  # in place of a vehicle, of faults that disturb none


@dataclass
class ActiveFault:
    """``number`` counts the faults of the mission from 1; ``seen`` and ``disturbed`` are datagrams or samples."""

    number: int
    fault: Fault
    kind: Kind
    settings: Any
    schedule: Schedule
    seed: int
    vehicles: tuple[int, ...]
    seen: int = 0
    disturbed: int = 0

    @classmethod
    def of(cls, number: int, fault: Fault, seed: int, team: int) -> Self:
        """Return a mission's fault, ready to fly. Raises :class:`gcs.errors.UnusableInput`."""
        settings = read_settings(fault.kind, fault.settings)
        vehicles = tuple(range(1, team + 1)) if fault.vehicles is None else fault.vehicles
        schedule = Schedule(fault.start, fault.duration, fault.every, fault.times)
        return cls(number, fault, KINDS[fault.kind], settings, schedule, seed, vehicles)

    @property
    def direction(self) -> Direction | None:
        """Return the mission's direction, or the kind's default."""
        return self.fault.direction or self.kind.direction

    def generator(self, vehicle: int, *which: int) -> np.random.Generator:
        """Return random numbers that follow from the mission's seed, the fault's number and the vehicle alone."""
        return np.random.default_rng([self.seed, _STREAM, self.number, vehicle, *which])
