"""Reference trajectories: position to snap at many times at once, at rest before and after; time scaling."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.trajectory_kernels import span


class Times(NamedTuple):
    """Times of an evaluation (s), one at least, all finite."""

    values: Array
    """(K,), contiguous, in any order."""
    earliest: float
    latest: float

    def checked(self) -> Times:
        """Return it; raises TrajectoryError unless all times are finite."""
        if not (math.isfinite(self.earliest) and math.isfinite(self.latest)):
            raise TrajectoryError("times must be a list of finite numbers")
        return self


class Trajectory(ABC):
    """A path of the payload in time: four times continuously differentiable, NED, SI.

    Before ``start`` and after ``end`` (s) it rests: position held, derivatives exactly zero.
    """

    start: float
    """Time at which the motion begins, s."""
    _end: float

    @property
    def end(self) -> float:
        """Time from which on it rests, s; ``inf`` while that is not known."""
        return self._end

    def derivatives(self, times: ArrayLike, order: int = 4) -> Array:
        """Position and its time derivatives.

        Args:
            times: shape (K,), s, in any order.
            order: highest derivative, 0 to 4.

        Returns:
            Shape (order + 1, K, 3): position m, velocity m/s, acceleration, jerk, snap in NED.

        Raises:
            TrajectoryError: a time is not finite, or there is no derivative of that order.
        """
        array = np.ascontiguousarray(times, dtype=float)
        if array.ndim != 1:
            raise TrajectoryError("times must be a list of finite numbers")
        if not 0 <= order <= 4:
            raise TrajectoryError(f"derivatives exist for order 0 to 4, not {order}")
        if not len(array):
            return np.zeros((order + 1, 0, 3))
        return self.evaluate(Times(array, *span(array)).checked(), order)

    @abstractmethod
    def evaluate(self, times: Times, order: int) -> Array:
        """Return :meth:`derivatives` at ``times`` that are checked."""

    @abstractmethod
    def stop(self, time: float) -> Trajectory:
        """Return the same trajectory up to ``time`` (s), then to rest along its path as soon as its limits allow.

        It leaves this one continuously up to snap and never comes to rest later than this one would.
        """

    @abstractmethod
    def scaled(self, begin: float, rate: float, time: float) -> Trajectory:
        """Return it in another time, to be stopped: from ``begin`` (s) on, which becomes ``time``, ``rate`` as fast."""

    def waypoints(self, begin: float, end: float) -> Array:
        """Return the positions (M, 3), m, NED, at which it passes its waypoints between two times (s)."""
        return np.empty((0, 3))

    def position(self, time: float) -> Array:
        """Position in NED at one time, shape (3,), m."""
        return np.asarray(self.derivatives(np.array([time]), 0)[0, 0])

    def then(self, follow: Callable[[float, Array], Trajectory]) -> Trajectory:
        """This trajectory, followed by another one from rest to rest.

        Args:
            follow: called once with this one's end (s) and last position (3,) as soon as the end is known
                and something beyond it is evaluated; returns a trajectory that starts there, not earlier.
        """
        return SequenceTrajectory(self, follow)


class RestTrajectory(Trajectory):
    """Stays at ``position_in_world`` (3,), m, for ever; nominally from ``start`` to ``end``, s."""

    def __init__(self, position_in_world: ArrayLike, start: float = 0.0, end: float | None = None) -> None:
        self._position = point(position_in_world, "position")
        self.start = finite(start, "start")
        self._end = self.start if end is None else float(end)
        if not self._end >= self.start:
            raise TrajectoryError(f"end {end} s lies before start {start} s")

    def evaluate(self, times: Times, order: int) -> Array:
        """See ``Trajectory.evaluate``."""
        result = np.zeros((order + 1, len(times.values), 3))
        result[0] = self._position
        return result

    def stop(self, time: float) -> Trajectory:
        """Return the same rest, which ends at ``time`` (s) if it would not have ended before."""
        return RestTrajectory(self._position, self.start, min(self._end, max(self.start, time)))

    def scaled(self, begin: float, rate: float, time: float) -> Trajectory:
        """See ``Trajectory.scaled``."""
        return RestTrajectory(self._position, time)


class SequenceTrajectory(Trajectory):
    """One trajectory, then another that is made when the end of the first is known (``Trajectory.then``)."""

    def __init__(self, first: Trajectory, follow: Callable[[float, Array], Trajectory]) -> None:
        self.start = first.start
        self._first, self._follow = first, follow
        self._second: Trajectory | None = None
        self._end = math.inf
        self._in_force: tuple[float, float, Trajectory] = math.inf, -math.inf, first
        """The part that was evaluated last, and the times (s) after which and until which it is the only one."""

    @property
    def end(self) -> float:
        """End of the second trajectory, s; ``inf`` while the first one's end is not known."""
        if self._end == math.inf and self._first.end < math.inf:
            self._end = self._next().end
        return self._end

    def evaluate(self, times: Times, order: int) -> Array:
        """See ``Trajectory.evaluate``."""
        after, until, part = self._in_force
        if after < times.earliest and times.latest <= until:
            return part.evaluate(times, order)
        first = self._first
        if times.earliest > first.end:
            result = self._next().evaluate(times, order)
            self._set_in_force(self._next(), first.end, math.inf)
            return result
        # Evaluated first: a lazy trajectory learns of its end while it looks ahead, and rests beyond it.
        result = first.evaluate(times, order)
        if times.latest > first.end:
            later = times.values > first.end
            result[:, later] = self._next().derivatives(times.values[later], order)
        elif first.end < math.inf or (isinstance(first, SequenceTrajectory) and first._in_force[1] < math.inf):
            # A sequence whose end is not known yet has parts whose own end is.
            self._set_in_force(first, -math.inf, first.end)
        return result

    def _set_in_force(self, part: Trajectory, after: float, until: float) -> None:
        """Note the part in force, of sequences in sequences the innermost; an end that is known does not change."""
        if isinstance(part, SequenceTrajectory):
            begin, end, part = part._in_force
            after, until = max(after, begin), min(until, end)
        self._in_force = after, until, part

    def waypoints(self, begin: float, end: float) -> Array:
        """See ``Trajectory.waypoints``."""
        found = self._first.waypoints(begin, end)
        if end > self._first.end:
            found = np.vstack([found, self._next().waypoints(max(begin, self._first.end), end)])
        return found

    def stop(self, time: float) -> Trajectory:
        """See ``Trajectory.stop``; what was to follow is dropped unless it has begun."""
        self.derivatives([time], 0)
        if time < self._first.end:
            return self._first.stop(time)
        return SequenceTrajectory(self._first, lambda _end, _position: self._next().stop(time))

    def scaled(self, begin: float, rate: float, time: float) -> Trajectory:
        """See ``Trajectory.scaled``; only of the part that is in force at ``begin``."""
        self.derivatives([begin], 0)
        return (self._first if begin < self._first.end else self._next()).scaled(begin, rate, time)

    def _next(self) -> Trajectory:
        if self._second is None:
            end = self._first.end
            self._second = self._follow(end, self._first.position(end))
            if self._second.start < end - 1e-9:
                raise TrajectoryError(f"what starts at {self._second.start:g} s cannot follow what ends at {end:g} s")
        return self._second


def finite(value: float, name: str) -> float:
    """``value`` as a float; raises TrajectoryError unless it is finite."""
    if not math.isfinite(value):
        raise TrajectoryError(f"{name} must be a finite number, not {value}")
    return float(value)


def positive(value: float, name: str) -> float:
    """``value`` as a float; raises TrajectoryError unless it is finite and above zero."""
    if not (math.isfinite(value) and value > 0.0):
        raise TrajectoryError(f"{name} must be a positive number, not {value}")
    return float(value)


def point(value: ArrayLike, name: str) -> Array:
    """``value`` as a point (3,); raises TrajectoryError unless it is three finite numbers."""
    array = np.array(value, dtype=float)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise TrajectoryError(f"{name} must be three finite numbers (north, east, down), not {value!r}")
    return array


@dataclass(frozen=True, eq=False)
class ScaledReference:
    """``trajectory`` with its time replaced by the progress s(t) = progress + rate (t - start)."""

    trajectory: Trajectory
    start: float = 0.0
    """Time (s) of ``progress``."""
    progress: float = 0.0
    """Path parameter (s): the trajectory's own time."""
    rate: float = 1.0
    """Rate of the progress: 1 is the trajectory's own speed, 0 rest."""

    def progress_at(self, time: float) -> float:
        """Return the progress (s) at ``time`` (s)."""
        return self.progress + self.rate * (time - self.start)

    def after(self, elapsed: Array, order: int = 4) -> Array:
        """Return position and derivatives (order + 1, K, 3), NED, SI, at ``elapsed`` (K,) (s) since the start."""
        derivatives = self.trajectory.derivatives(self.progress + self.rate * elapsed, order)
        if self.rate == 1.0:
            return derivatives
        return derivatives * (self.rate ** np.arange(order + 1))[:, None, None]

    def derivatives(self, times: Array, order: int = 4) -> Array:
        """Return position and derivatives (order + 1, K, 3), NED, SI, at ``times`` (K,) (s)."""
        return self.after(np.asarray(times, dtype=float) - self.start, order)
