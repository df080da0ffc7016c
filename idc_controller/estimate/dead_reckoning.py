"""Whether the vehicles' positions go where their own velocities take them.

The outlier gate goes by what most sources say. Positions that are wrong for one common reason (a base station that
drifts, say) agree with each other, and would drag the estimate along. Yet each of them contradicts its own velocity,
whatever the others say.
"""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimate.measurements import PAYLOAD, Position

Array = NDArray[np.float64]

WINDOW = 2.0
"""Over which a position is compared with its velocity (s)."""
GAP = 0.3
"""Longer (s) without a sample nobody knows where the velocity has led."""
SAMPLES = 9
"""At either end of the window, whose median counts: single samples may be anything."""
SMOOTHED = 5
"""Velocities whose median counts, for the same reason."""
ROUNDING = 0.03
"""What sums of sampled velocities may be off by over the window (m)."""
SIGMAS = 5.0
"""Of the difference of two such medians, beside that."""
DOUBTED = 0.5
"""Of what makes a contradiction, at which the payload unit is no witness any more."""
_MEDIAN = 1.2533 / SAMPLES**0.5 * 2.0**0.5  # standard deviation of that difference over that of one sample
_FROM_STEPS = 1.4826 / 2.0**0.5  # standard deviation of a sample over the median step from one to the next


class DeadReckoning:
    """Of ``vehicles`` UAVs and the payload unit."""

    def __init__(self, vehicles: int) -> None:
        self._vehicles = vehicles
        self._tracks: dict[int, _Track] = {}

    def add(self, measurement: Position) -> None:
        """A position with its velocity; what comes late is passed over, and what lacks either."""
        if measurement.has_pose and measurement.has_motion:
            self._tracks.setdefault(measurement.source, _Track()).add(measurement)

    @property
    def vehicles_astray(self) -> bool:
        """Whether most vehicles' positions contradict their velocities, while the payload unit's do not."""
        payload = self._tracks.get(PAYLOAD)
        if payload is None or payload.off > DOUBTED:
            return False
        return 2 * sum(track.off > 1.0 for track in self._tracks.values()) > self._vehicles


class _Track:
    """Of one source: position less the path by its velocity, which is constant but for noise."""

    def __init__(self) -> None:
        self.off = 0.0
        """What the position and the velocity differ by, over what they may."""
        self._recent: deque[Position] = deque(maxlen=SMOOTHED)
        self._path = np.zeros(3)
        self._velocity: Array | None = None
        self._rest: deque[tuple[float, Array]] = deque()
        self._unjudged = 0

    def add(self, measurement: Position) -> None:
        recent = self._recent
        if recent and measurement.time <= recent[-1].time:
            return
        if recent and measurement.time - recent[-1].time > GAP:
            recent.clear()
            self._rest.clear()
            self._velocity = None
        recent.append(measurement)
        if len(recent) == SMOOTHED:
            self._follow(recent[SMOOTHED // 2 - 1].time, recent[SMOOTHED // 2])
        while self._rest and measurement.time - self._rest[0][0] > WINDOW:
            self._rest.popleft()
        self._unjudged += 1
        if self._unjudged >= SAMPLES // 2:
            self._unjudged = 0
            self.off = self._moved() if len(self._rest) > 2 * SAMPLES else 0.0

    def _follow(self, before: float, measurement: Position) -> None:
        """The path goes on from the time ``before`` to that of ``measurement``."""
        velocity = np.median([near.velocity for near in self._recent], axis=0)
        if self._velocity is not None:
            self._path = self._path + (measurement.time - before) / 2.0 * (self._velocity + velocity)
        self._velocity = velocity
        self._rest.append((measurement.time, measurement.position - self._path))

    def _moved(self) -> float:
        values = np.array([value for _, value in self._rest])
        moved = np.abs(np.median(values[-SAMPLES:], axis=0) - np.median(values[:SAMPLES], axis=0))
        sigma = _FROM_STEPS * np.median(np.abs(np.diff(values, axis=0)), axis=0)
        return float((moved / (ROUNDING + SIGMAS * _MEDIAN * sigma)).max())
