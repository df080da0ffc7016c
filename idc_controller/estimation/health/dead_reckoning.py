"""Whether poses go where their own motion takes them: positions by velocities, attitudes by rates.

The outlier gate goes by what most sources say. Positions that are wrong for one common reason (a base station that
drifts, say) agree with each other, and would drag the estimate along. So would the payload's only unit, which is right
when it insists on a blow that nobody foresaw. Yet each of them contradicts itself, whatever the others say.
"""

from __future__ import annotations

from collections import deque
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position
from idc_controller.rotations import quaternion_product

Array = NDArray[np.float64]

WINDOW = 2.0
"""Over which a position is compared with its velocity (s)."""
GAP = 0.3
"""Longer (s) without a sample nobody knows where the velocity has led."""
SAMPLES = 9
"""At either end of the window, whose median counts: single samples may be anything."""
SMOOTHED = 5
"""Velocities whose median counts, for the same reason."""
ROUNDING = {Position: 0.03, Attitude: 0.02}
"""What sums of sampled velocities may be off by over the window (m), and of sampled rates (rad)."""
SIGMAS = 5.0
"""Of the difference of two such medians, beside that."""
DOUBTED = 0.5
"""Of what makes a contradiction, at which a source is no witness against others any more."""
ALONE = 3
"""Times in a row that a source must contradict itself to count without others: spikes may bend a median."""
_MEDIAN = 1.2533 / SAMPLES**0.5 * 2.0**0.5  # standard deviation of that difference over that of one sample
_FROM_STEPS = 1.4826 / 2.0**0.5  # standard deviation of a sample over the median step from one to the next


class Group(NamedTuple):
    """One kind of measurement, of the payload unit or of all vehicles."""

    of_payload: bool
    kind: type[Measurement]


class DeadReckoning:
    """Of ``vehicles`` UAVs and the payload unit."""

    def __init__(self, vehicles: int) -> None:
        self._vehicles = vehicles
        self._tracks: dict[tuple[int, type], _Track] = {}

    def add(self, measurement: Measurement) -> None:
        """A pose with its motion; what comes late is passed over, what lacks either, and vehicles' attitudes."""
        if isinstance(measurement, Attitude) and measurement.source != PAYLOAD:
            return
        if measurement.has_pose and measurement.has_motion:
            key = measurement.source, type(measurement)
            track = self._tracks.get(key)
            if track is None:
                track = self._tracks[key] = _Track(_Way() if isinstance(measurement, Position) else _Turn(measurement))
            track.add(measurement)

    def contradicts_itself(self, uav: int) -> bool:
        """Whether the position of a UAV does not go where its velocity takes it."""
        track = self._tracks.get((uav, Position))
        return track is not None and track.off > 1.0

    @property
    def astray(self) -> tuple[Group, ...]:
        """What contradicts itself: most vehicles' positions, while the payload unit's do not; or the other way round;
        or the payload unit's attitude."""
        vehicles = [
            track.off for (source, kind), track in self._tracks.items() if source != PAYLOAD and kind is Position
        ]
        place, attitude = (self._tracks.get((PAYLOAD, kind)) for kind in (Position, Attitude))
        found = []
        if place is not None and place.off <= DOUBTED and 2 * sum(off > 1.0 for off in vehicles) > self._vehicles:
            found.append(Group(False, Position))
        if place is not None and place.is_astray and 2 * sum(off <= DOUBTED for off in vehicles) > self._vehicles:
            found.append(Group(True, Position))
        if attitude is not None and attitude.is_astray:
            found.append(Group(True, Attitude))
        return tuple(found)


class _Way:
    """Where velocities have led."""

    def __init__(self) -> None:
        self._path = np.zeros(3)

    def go(self, duration: float, velocity: Array) -> None:
        """For a ``duration`` (s)."""
        self._path = self._path + duration * velocity

    def rest(self, measurement: Position) -> Array:
        """What is left of the position (m), which is constant but for noise."""
        return measurement.position - self._path


class _Turn:
    """Where body rates have led from the attitude ``begin``."""

    def __init__(self, begin: Attitude) -> None:
        self._path = begin.quaternion

    def go(self, duration: float, rates: Array) -> None:
        """For a ``duration`` (s)."""
        turned = quaternion_product(self._path, np.append(1.0, 0.5 * duration * rates))
        self._path = turned / np.linalg.norm(turned)

    def rest(self, measurement: Attitude) -> Array:
        """What is left of the attitude: a rotation vector in the world (rad), as long as it is small."""
        rest = quaternion_product(measurement.quaternion, self._path * [1.0, -1.0, -1.0, -1.0])
        return 2.0 * rest[1:] * (1.0 if rest[0] >= 0.0 else -1.0)


class _Track:
    """Of one source: its pose less the path by its motion."""

    def __init__(self, path: _Way | _Turn) -> None:
        self.off = 0.0
        """What pose and motion differ by, over what they may."""
        self._astray = 0
        self._recent: deque[Any] = deque(maxlen=SMOOTHED)
        self._path: Any = path
        self._rounding = ROUNDING[Position if isinstance(path, _Way) else Attitude]
        self._motion: Array | None = None
        self._rest: deque[tuple[float, Array]] = deque()
        self._unjudged = 0

    def add(self, measurement: Measurement) -> None:
        recent = self._recent
        if recent and (measurement.time <= recent[-1].time or measurement.agrees(recent[-1])):
            return  # a relay of the same sample by a vehicle whose clock is off brings nothing new
        if recent and measurement.time - recent[-1].time > GAP:
            recent.clear()
            self._rest.clear()
            self._motion = None
        recent.append(measurement)
        if len(recent) == SMOOTHED:
            self._follow(recent[SMOOTHED // 2 - 1].time, recent[SMOOTHED // 2])
        while self._rest and measurement.time - self._rest[0][0] > WINDOW:
            self._rest.popleft()
        self._unjudged += 1
        if self._unjudged >= SAMPLES // 2:
            self._unjudged = 0
            self.off = self._moved() if len(self._rest) > 2 * SAMPLES else 0.0
            self._astray = self._astray + 1 if self.off > 1.0 else 0

    @property
    def is_astray(self) -> bool:
        """Whether they differ by more for some time: enough for a source that has no others beside it."""
        return self._astray >= ALONE

    def _follow(self, before: float, measurement: Measurement) -> None:
        """The path goes on from the time ``before`` to that of ``measurement``."""
        motion = np.median([near.motion for near in self._recent], axis=0)
        if self._motion is not None:
            self._path.go(measurement.time - before, 0.5 * (self._motion + motion))
        self._motion = motion
        self._rest.append((measurement.time, self._path.rest(measurement)))

    def _moved(self) -> float:
        values = np.array([value for _, value in self._rest])
        moved = np.abs(np.median(values[-SAMPLES:], axis=0) - np.median(values[:SAMPLES], axis=0))
        sigma = _FROM_STEPS * np.median(np.abs(np.diff(values, axis=0)), axis=0)
        return float((moved / (self._rounding + SIGMAS * _MEDIAN * sigma)).max())
