"""A path sampled at equal intervals, and the spline within limits up to crackle that smoothing makes of it.

The samples of a path flown at constant speed are averaged by three boxes and used as control points of a spline of
degree 5. Averages stay in the convex hull, so nothing overshoots. Three boxes in the right proportion need about two
thirds of the time of the plain spline for the same snap.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from idc_controller.arrays import Array
from idc_controller.trajectory.paths import Path
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.spline import SUPPORT, evaluate

TURN = 2.0**0.5
"""Change of velocity, in full speeds, that holds the limits without a pause: a right angle."""
SHORTEST_INTERVAL = 0.02
"""s; looser limits than this could use are not used."""
MOST_SAMPLES = 12
"""Samples of the three boxes together: more would gain little time and cost planning time."""
SETTLED = 0.4e-3
"""m, of either the motion before or after a pause, beyond which a hold does not count."""


@dataclass(frozen=True)
class Smoothing:
    """``interval`` s between samples; ``weights`` (n,) of the averages, sum 1; ``settling`` see below."""

    interval: float
    weights: Array
    settling: float
    """s before the (delayed) end of a motion at full speed is reached to ``SETTLED``."""

    @property
    def reach(self) -> int:
        """Samples over which one sample acts on the trajectory."""
        return len(self.weights) - 1 + SUPPORT

    @property
    def delay(self) -> float:
        """Mean delay of the trajectory after the path as sampled, s, if sample 1 acts from time 0 on."""
        return self.interval * (self.reach / 2.0 - 1.0)

    def control_points(self, samples: Array) -> Array:
        """Averages (M - n + 1, 3) of samples (M, 3), each over itself and the n - 1 before it."""
        windows = np.lib.stride_tricks.sliding_window_view(samples, len(self.weights), axis=0)
        # Relative to one sample: rest stays exactly rest.
        newest = windows[..., -1:]
        return np.asarray(newest[..., 0] + (windows - newest) @ self.weights)


@lru_cache(maxsize=16)
def smoothing_for(limits: Limits) -> Smoothing:
    """The shortest filter that holds the limits for any start, stop or right angle at ``limits.speed``."""
    best: tuple[float, float, Array] | None = None
    for a in range(1, MOST_SAMPLES):
        for b in range(1, min(a, MOST_SAMPLES - a) + 1):
            for c in range(1, min(b, MOST_SAMPLES - a - b) + 1):
                weights = np.convolve(np.convolve(np.full(a, 1 / a), np.full(b, 1 / b)), np.full(c, 1 / c))
                interval = _interval(weights, limits)
                duration = interval * (len(weights) - 1 + SUPPORT)
                if best is None or duration < best[0] * (1 - 1e-9):
                    best = duration, interval, weights
    assert best is not None  # the loops run at least once
    _, interval, weights = best
    weights.setflags(write=False)
    return Smoothing(interval, weights, _settling(interval, weights, limits.speed))


def _interval(weights: Array, limits: Limits) -> float:
    """The interval at which a right angle at full speed holds acceleration, jerk, snap and crackle."""
    shortest = SHORTEST_INTERVAL
    differences = weights
    for power, limit in enumerate(limits.as_array()[1:].tolist(), start=1):
        needed = TURN * limits.speed * np.abs(differences).max() / (0.999 * limit)
        shortest = max(shortest, float(needed ** (1.0 / power)))
        differences = np.diff(np.concatenate([[0.0], differences, [0.0]]))
    return shortest


def _settling(interval: float, weights: Array, speed: float) -> float:
    reach = len(weights) - 1 + SUPPORT
    samples = np.arange(-3.0 * reach, 3.0 * reach).clip(max=0.0)[:, None] * [1.0, 0.0, 0.0]
    smooth = Smoothing(interval, weights, 0.0).control_points(samples)
    arguments = np.linspace(2 * reach, 5 * reach, 60 * reach + 1)
    distance = -evaluate(smooth, interval, arguments, 0)[0, :, 0] * speed * interval
    settled = arguments[np.flatnonzero(distance > SETTLED)[-1] + 1] if (distance > SETTLED).any() else 0.0
    # Sample 3 * reach is the first at rest; control point j needs samples j .. j + n - 1.
    stopped = 3 * reach - (len(weights) - 1) + reach / 2.0
    return max(0.0, (settled - stopped) * interval)


DROPPED_TOGETHER = 1000
"""Samples: each drop copies those that stay."""


class SampledPath:
    """Samples at multiples of an interval from ``begin`` (s) on: ``start`` (3,) up to number 0, at rest after the last.

    Numbers of samples, and distances in time from ``begin``, are those of the path itself; the spline is later by the
    delay of the smoothing.
    """

    def __init__(self, start: Array, begin: float, smoothing: Smoothing) -> None:
        self.begin, self.smoothing = begin, smoothing
        self._samples = np.repeat(start[None], 2 * smoothing.reach, axis=0)
        self._offset = 1 - len(self._samples)
        """Number of the first sample kept."""
        self._rest = start
        self._spline: tuple[Array, float] | None = None

    def spline(self) -> tuple[Array, float]:
        """Return the control points (M, 3) (m) to the present end, and when the first begins to act (s)."""
        if self._spline is None:
            averaged = len(self.smoothing.weights)
            resting = np.repeat(self._rest[None], averaged, axis=0)
            points = self.smoothing.control_points(np.vstack([self._samples, resting]))
            # Control point j averages samples j .. j + n - 1 and acts from the last of them on; sample 1, the
            # first to move, acts from `begin` on.
            first = self._offset + averaged - 1
            self._spline = points, self.begin + (first - 1) * self.smoothing.interval
        return self._spline

    def derivatives(self, times: Array, order: int) -> Array:
        """Return position and derivatives (order + 1, K, 3) of the spline at ``times`` (K,) (s)."""
        points, origin = self.spline()
        return evaluate(points, self.smoothing.interval, (times - origin) / self.smoothing.interval, order)

    def is_kept(self, time: float) -> bool:
        """Return whether the spline can be evaluated at ``time`` (s)."""
        return time >= self.spline()[1] or self._offset == 1 - 2 * self.smoothing.reach

    def extended(self, path: Path, speed: float, departure: float, since: int) -> tuple[Array, int]:
        """Return the control points if ``path`` came next, from sample ``since`` on, and the number of the first.

        Only as much of it as its beginning needs.
        """
        first = max(since, self._offset)
        added = self._samples_of(
            path, speed, departure, math.ceil(departure / self.smoothing.interval) + 2 * self.smoothing.reach
        )
        points = self.smoothing.control_points(np.vstack([self._samples[first - self._offset :], added]))
        return points, first + len(self.smoothing.weights) - 1

    def append(self, path: Path, speed: float, departure: float) -> None:
        """Go on along ``path`` at ``speed`` (m/s) from ``departure`` (s after ``begin``) on, then rest at its end."""
        end = math.floor((departure + path.length / speed) / self.smoothing.interval) + 1
        self._samples = np.vstack([self._samples, self._samples_of(path, speed, departure, end)])
        self._rest = path.at(np.array([path.length]))[0]
        self._spline = None

    def drop_before(self, time: float) -> None:
        """Drop samples that act on no time after ``time`` (s), once they are many."""
        reach = self.smoothing.reach
        oldest = math.floor((time - self.begin) / self.smoothing.interval) - 3 * reach
        surplus = min(oldest - self._offset, len(self._samples) - 3 * reach)
        if surplus > DROPPED_TOGETHER:
            self._samples = self._samples[surplus:].copy()
            self._offset += surplus
            self._spline = None

    def _samples_of(self, path: Path, speed: float, departure: float, end: int) -> Array:
        """Samples (M, 3) of ``path`` that follow those there are, up to number ``end``."""
        begin = self._offset + len(self._samples)
        times = np.arange(begin, max(begin, end)) * self.smoothing.interval
        return path.at(np.asarray(speed * (times - departure), dtype=float))


def at_half_intervals(control_points: Array) -> tuple[Array, Array]:
    """Return positions (K, 3) of the spline of ``control_points`` (M, 3), and where they are (K,) in intervals."""
    arguments = np.arange(2 * (SUPPORT - 1), 2 * len(control_points)) / 2.0
    return evaluate(control_points, 1.0, arguments, 0)[0], arguments


def distance_to_line(position: Array, positions: Array) -> float:
    """Return the distance (m) from a point (3,) to the line through ``positions`` (K, 3)."""
    if len(positions) == 1:
        return float(np.linalg.norm(positions[0] - position))
    steps = positions[1:] - positions[:-1]
    squares = np.maximum(np.einsum("ij,ij->i", steps, steps), 1e-300)
    along = np.clip(np.einsum("ij,ij->i", position - positions[:-1], steps) / squares, 0.0, 1.0)
    nearest = positions[:-1] + along[:, None] * steps
    return float(np.sqrt(np.min(np.sum((nearest - position) ** 2, axis=1))))
