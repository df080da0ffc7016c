"""A fault of a flight: its parameters, its schedule, its random numbers, and what it has done."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from gcs.faults import KINDS, Direction, Kind, read_settings

if TYPE_CHECKING:
    from gcs.mission.model import Fault  # takes long to import, with the kernels of the geometry

TOLERANCE = 1e-6  # s: sums of steps are not exact, and drivers round to microseconds


class Moment(NamedTuple):
    """A time at which a fault is active: since when (s), and in which of its occurrences, from 0."""

    elapsed: float
    occurrence: int


class Schedule:
    """Start (s after its origin), duration (s; None: no end), period (s; None: once) and how often (None: no end)."""

    def __init__(
        self, start: float, duration: float | None = None, every: float | None = None, times: int | None = None
    ) -> None:
        self.start = start
        self._duration = math.inf if duration is None else duration
        self._every = every
        self._last = 0 if every is None else math.inf if times is None else times - 1
        self.origin: float | None = None
        """Time from which the start counts (s): take-off, or the entry into a phase; None: not yet."""

    def at(self, now: float) -> Moment | None:
        """Return where ``now`` (s) is in the fault; None: the fault is not active."""
        if self.origin is None:
            return None
        elapsed = now - self.origin - self.start + TOLERANCE
        if elapsed < 0.0:
            return None
        occurrence = 0
        if self._every is not None:
            occurrence = int(min(elapsed // self._every, self._last))
            elapsed -= occurrence * self._every
        if elapsed >= self._duration:
            return None
        return Moment(max(elapsed - TOLERANCE, 0.0), occurrence)

    def end_after(self, now: float) -> float:
        """Return when the occurrence that is active ``now`` ends (s; infinity: never)."""
        moment = self.at(now)
        return math.inf if moment is None else now - moment.elapsed + self._duration

    def active_time(self, now: float) -> float:
        """Return for how long in all the fault has been active until ``now`` (s)."""
        if self.origin is None:
            return 0.0
        elapsed = now - self.origin - self.start
        if elapsed <= 0.0:
            return 0.0
        if self._every is None:
            return min(elapsed, self._duration)
        whole = min(elapsed // self._every, self._last)
        return whole * self._duration + min(elapsed - whole * self._every, self._duration)

    def occurrences(self, now: float, limit: int) -> tuple[int, list[tuple[float, float | None]]]:
        """Return the number of occurrences until ``now``, and begin and end of the first ``limit``.

        In s after the origin; an end is None while the occurrence is not over.
        """
        if self.origin is None or now - self.origin + TOLERANCE < self.start:
            return 0, []
        flown = now - self.origin + TOLERANCE
        count = 1
        if self._every is not None:
            count = int(min((flown - self.start) // self._every, self._last)) + 1
        begins = [self.start + k * (self._every or 0.0) for k in range(min(count, limit))]
        return count, [(b, b + self._duration if b + self._duration <= flown else None) for b in begins]


_STREAM = 2_000_003  # separates these generators from the sensors'
WORLD = 0  # in place of a vehicle, of faults that disturb none


@dataclass(kw_only=True)
class Activity:
    """Parameters of a kind of fault, when they act, and on how many datagrams or samples they have."""

    settings: Any
    schedule: Schedule
    seen: int = 0
    disturbed: int = 0


@dataclass(kw_only=True)
class ActiveFault(Activity):
    """A fault of a mission, which counts its faults from 1."""

    number: int
    fault: Fault
    kind: Kind
    seed: int
    vehicles: tuple[int, ...]

    @classmethod
    def of(cls, number: int, fault: Fault, seed: int, team: int) -> Self:
        """Return a mission's fault, ready to fly. Raises :class:`gcs.errors.UnusableInput`."""
        settings = read_settings(fault.kind, fault.settings)
        vehicles = tuple(range(1, team + 1)) if fault.vehicles is None else fault.vehicles
        start = (fault.start_offset if fault.start is None else fault.start) or 0.0
        schedule = Schedule(start, fault.duration, fault.every, fault.times)
        return cls(
            number=number, fault=fault, kind=KINDS[fault.kind], settings=settings, schedule=schedule, seed=seed,
            vehicles=vehicles,
        )  # fmt: skip

    @property
    def direction(self) -> Direction | None:
        """Return the mission's direction, or the kind's default."""
        return self.fault.direction or self.kind.direction

    def generator(self, vehicle: int, *which: int) -> np.random.Generator:
        """Return random numbers that follow from the mission's seed, the fault's number and the vehicle alone."""
        return np.random.default_rng([self.seed, _STREAM, self.number, vehicle, *which])
