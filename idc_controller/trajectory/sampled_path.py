"""A path sampled at equal intervals, and the spline that smoothing makes of it."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.trajectory.paths import Path
from idc_controller.trajectory.smoothing import Smoothing
from idc_controller.trajectory.spline import SUPPORT, evaluate

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
