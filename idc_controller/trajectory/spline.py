"""Uniform B-splines of degree 5 as trajectories.

The d-th derivative of such a spline is a spline of lower degree whose control points are the d-th differences
of the control points over interval^d. A spline lies in the convex hull of its control points, so limits that
hold for these differences hold for the derivatives at every time.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, PPoly, make_interp_spline
from scipy.special import binom

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.trajectory import Times, Trajectory, finite, positive
from idc_controller.trajectory.trajectory_kernels import spline

DEGREE = 5
SUPPORT = DEGREE + 1
"""Intervals over which one control point acts."""
LONGEST_STOP = 100
"""Intervals within which ``stop`` looks for a deceleration."""
DELAYS = (0, 1, 2, 4, 6, 9, 12, 16)
"""Intervals for which ``stop`` may wait: in a corner the limits may be used up already."""


@lru_cache(maxsize=32)
def _basis(interval: float) -> Array:
    """Polynomials of the basis function and its derivatives up to the fourth (5, 6 control points, 6 powers).

    The control points are those that act, oldest first; the powers, lowest first, are of the fraction of an interval.
    """
    # Rows of PPoly.c: highest power first; columns: interval 0..5 of the basis function.
    powers = PPoly.from_spline(BSpline.basis_element(np.arange(SUPPORT + 1.0), extrapolate=False))
    inside = np.flatnonzero((powers.x[:-1] >= 0.0) & (np.diff(powers.x) > 0.0))[:SUPPORT]
    basis = np.zeros((5, SUPPORT, SUPPORT))
    for d in range(5):
        c = powers.derivative(d).c[::-1, inside] if d else powers.c[::-1, inside]
        basis[d, ::-1, : len(c)] = c.T / interval**d  # the oldest control point is in its last interval
    return basis


def evaluate(control_points: Array, interval: float, arguments: Array, order: int) -> Array:
    """Position and derivatives of a uniform spline that rests at its first and last control point outside.

    Args:
        control_points: (M, 3), m; point j acts on arguments j to j + 6.
        interval: between control points, s.
        arguments: (K,), time in intervals.
        order: highest derivative, 0 to 4.

    Returns:
        (order + 1, K, 3).
    """
    return spline(control_points, _basis(interval), arguments, order)


def within_limits(control_points: Array, interval: float, limits: Limits, slack: float = 1e-7) -> bool:
    """Return whether the differences of control points (M, 3) hold all limits: then the spline does."""
    differences = control_points
    for d, limit in enumerate(limits.as_array(), start=1):
        differences = differences[1:] - differences[:-1]
        bound = limit * interval**d * (1.0 + slack)
        if len(differences) and np.einsum("ij,ij->i", differences, differences).max() > bound * bound:
            return False
    return True


class SplineTrajectory(Trajectory):
    """A uniform B-spline of degree 5 from rest to rest.

    Args:
        control_points: (M, 3), m, NED; it rests at the first and the last one.
        interval: between control points, s.
        origin: time at which the first control point begins to act, s.
        limits: what ``stop`` has to keep; the control points themselves are not checked.

    Raises:
        TrajectoryError: no control point, not (M, 3), not finite, or the interval is not positive.
    """

    def __init__(self, control_points: ArrayLike, interval: float, origin: float, limits: Limits) -> None:
        self.control_points = np.array(control_points, dtype=float)
        shape = self.control_points.shape
        if len(shape) != 2 or shape[0] == 0 or shape[1] != 3:
            raise TrajectoryError("control points must have shape (M, 3) with M of at least 1")
        if not np.isfinite(self.control_points).all():
            raise TrajectoryError("control points must be finite")
        self.interval = positive(interval, "interval")
        self.origin = finite(origin, "origin")
        self.limits = limits
        moving = np.flatnonzero((self.control_points[1:] != self.control_points[:-1]).any(axis=1))
        self.start = self._end = self.origin
        if len(moving):
            self.start += (moving[0] + 1) * self.interval
            self._end += (moving[-1] + SUPPORT) * self.interval

    def evaluate(self, times: Times, order: int) -> Array:
        """See ``Trajectory.evaluate``."""
        return evaluate(self.control_points, self.interval, (times.values - self.origin) / self.interval, order)

    def stop(self, time: float) -> SplineTrajectory:
        """See ``Trajectory.stop``."""
        last = max(0, math.floor((finite(time, "time") - self.origin) / self.interval))
        points = _slowed_to_rest(self.control_points, last, self.interval, self.limits)
        return SplineTrajectory(points, self.interval, self.origin, self.limits)

    def scaled(self, begin: float, rate: float, time: float) -> SplineTrajectory:
        """See ``Trajectory.scaled``; with control points as dense in the new time, so that it stops as soon."""
        points, interval, origin = self.control_points, self.interval / rate, time - (begin - self.origin) / rate
        while interval > self.interval * (1.0 + 1e-9):
            points, interval, origin = _refined(points), 0.5 * interval, origin - SUPPORT * interval
        return SplineTrajectory(points, interval, origin, self.limits)


def _refined(points: Array) -> Array:
    """Return the control points of the same spline at half of their interval, the first ``SUPPORT`` intervals before.

    By the two-scale relation of uniform B-splines: a basis function is a binomial mean of those half as wide.
    """
    padded = np.vstack([np.repeat(points[:1], SUPPORT, axis=0), points, np.repeat(points[-1:], SUPPORT, axis=0)])
    spread = np.zeros((2 * len(padded), 3))
    spread[::2] = padded
    weights = binom(SUPPORT, np.arange(SUPPORT + 1)) / 2.0**DEGREE
    refined = np.stack([np.convolve(axis, weights)[: len(spread)] for axis in spread.T], axis=1)
    refined[:SUPPORT] = points[0]  # of which not all that act are in the padding
    return refined


def _slowed_to_rest(points: Array, last: int, interval: float, limits: Limits) -> Array:
    """Control points that agree up to index ``last``, then run on along the same curve ever more slowly.

    The decelerations (begin later, take longer) are tried by the number of points they need; what there
    is already, which comes to rest as well, is the last resort.
    """
    if last >= len(points) - 1:
        return points
    moving = np.flatnonzero((points[1:] != points[:-1]).any(axis=1))
    final = int(moving[-1]) + 1 if len(moving) else 0
    first = max(0, last - 8)
    ahead = points[first : final + 1 + DEGREE]
    if len(ahead) < SUPPORT + 1:
        return points
    # A smooth curve through the control points: between them a straight line would break the snap limit.
    longest = min(final - last, LONGEST_STOP)
    ahead = ahead[: last - first + longest + SUPPORT]
    curve = make_interp_spline(np.arange(len(ahead), dtype=float), ahead, k=DEGREE)
    for total in range(1, longest):
        for delay in (d for d in DELAYS if d < total):
            steps = total - delay
            rates = np.concatenate([np.ones(delay), _braking_rates(steps)])
            arguments = (last - first) + np.cumsum(rates)
            braked = np.vstack([ahead[: last - first + 1 + delay], curve(arguments[delay:])])
            braked = np.vstack([braked, np.repeat(braked[-1:], 4, axis=0)])
            if within_limits(braked[max(0, last - first - 4) :], interval, limits):
                return np.vstack([points[:first], braked])
    return points


@lru_cache(maxsize=LONGEST_STOP)
def _braking_rates(steps: int) -> Array:
    """Rates along the curve from 1 to 0 in ``steps`` steps, in the proportions that limited snap favours."""
    a = max(1, round(steps / 2))
    b = max(1, round((steps + 2 - a) / 2)) if steps > 1 else 1
    c = max(1, steps + 2 - a - b)
    kernel = np.convolve(np.convolve(np.full(a, 1.0 / a), np.full(b, 1.0 / b)), np.full(c, 1.0 / c))
    return 1.0 - np.cumsum(kernel)
