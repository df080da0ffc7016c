"""Trajectories through waypoints, planned leg by leg as time goes on.

The straight lines are flown at constant speed with pauses between them, and smoothed (``smoothing``). A pause
slows a corner down; each is the shortest with which the limits hold and the corner is cut by no more than
allowed. What is planned always ends at rest at the last waypoint read, so a long enough pause always works.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.paths import Circle, Leg, Mark, Piece, pieces
from idc_controller.trajectory.sampled_path import (
    SampledPath,
    Smoothing,
    at_half_intervals,
    distance_to_line,
    smoothing_for,
)
from idc_controller.trajectory.settings import CORNER, Limits
from idc_controller.trajectory.spline import SplineTrajectory, within_limits
from idc_controller.trajectory.trajectory import Times, Trajectory, finite, point, positive

PIECE_SLOWER = 0.93
"""Factor by which a piece is slowed until it holds the limits."""


@dataclass(frozen=True, eq=False)
class _Corner:
    """A waypoint without hold whose corner the next piece may still change."""

    time: float  # of the path as sampled, s since its beginning
    mark: Mark


class WaypointTrajectory(Trajectory):
    """A trajectory from rest at a start point along legs to rest at the last one; reads legs only as far as needed.

    Args:
        start_position: (3,), m, NED.
        legs: straight legs and circles; may be endless. A leg faster than ``limits.speed`` is flown at that.
        limits: hold at every time. The smoothing is sized for ``limits.speed``: one far above those of the legs
            makes corners and stops slower than they need to be.
        start: s, when the motion begins.
        corner: m, the farthest a waypoint without hold may be passed from. With hold: within 1 mm.
        kept: s (may be ``inf``) before the earliest time of a call that may still be evaluated later.

    Raises:
        TrajectoryError: not finite or not positive. Also raised by ``derivatives`` for times no longer kept,
            and for endless legs without motion.
    """

    def __init__(
        self,
        start_position: ArrayLike,
        legs: Iterable[Leg | Circle],
        limits: Limits,
        start: float = 0.0,
        corner: float = CORNER,
        kept: float = 60.0,
    ) -> None:
        self._limits = limits
        smoothing = smoothing_for(limits)
        self.start, self._end = finite(start, "start"), math.inf
        self._corner = positive(corner, "corner")
        self._kept = kept if kept == math.inf else positive(kept, "kept")
        position = point(start_position, "start position")
        self._path = SampledPath(position, self.start, smoothing)
        self._pieces = pieces(position, legs, smoothing.reach * smoothing.interval * limits.speed)
        # The path rests from `_arrival` on (s after the start), for `_hold` (s) at least.
        self._arrival = self._hold = 0.0
        self._open: list[_Corner] = []
        self._passages: list[float] = []
        self._planned_passages: list[float] | None = None
        """:attr:`passages`; None: not computed since the last piece was planned."""

    @property
    def passages(self) -> Sequence[float]:
        """Time (s) of every waypoint planned so far, in order.

        Without hold the time at which it is closest; with hold the time at which the hold begins.
        """
        if self._planned_passages is None:
            times = [self._passage(corner) for corner in self._open if corner.mark.is_waypoint]
            self._planned_passages = list(accumulate([*self._passages, *times], max))
        return self._planned_passages

    def evaluate(self, times: Times, order: int) -> Array:
        """See ``Trajectory.evaluate``."""
        self._plan_until(times.latest)
        if math.isfinite(self._kept):
            self._path.drop_before(times.earliest - self._kept)
        if not self._path.is_kept(times.earliest):
            raise TrajectoryError(f"the trajectory at {times.earliest:g} s is no longer kept")
        return self._path.derivatives(times.values, order)

    def waypoints(self, begin: float, end: float) -> Array:
        """See ``Trajectory.waypoints``."""
        times = [time for time in self.passages if begin <= time <= end]
        return self.derivatives(times, 0)[0] if times else np.empty((0, 3))

    def stop(self, time: float) -> SplineTrajectory:
        """See ``Trajectory.stop``; at the latest it rests at the last waypoint planned."""
        return self._spline(time).stop(time)

    def scaled(self, begin: float, rate: float, time: float) -> SplineTrajectory:
        """See ``Trajectory.scaled``; at the latest it rests at the last waypoint planned."""
        return self._spline(begin).scaled(begin, rate, time)

    def _spline(self, time: float) -> SplineTrajectory:
        """Return what is planned, far enough ahead to slow down from ``time`` (s) on in any case."""
        smoothing = self._path.smoothing
        self._plan_until(finite(time, "time") + 3 * smoothing.reach * smoothing.interval)
        points, origin = self._path.spline()
        return SplineTrajectory(points, smoothing.interval, origin, self._limits)

    # Planning

    def _plan_until(self, time: float) -> None:
        interval = self._path.smoothing.interval
        while math.isinf(self._end) and self.start + (self._arrival + self._hold) - interval <= time:
            piece = next(self._pieces, None)
            self._planned_passages = None
            if piece is None:
                self._end = self._resting_time()
            elif piece.path.length == 0.0:
                # The waypoint is where the last one was: only its hold counts, after those before it.
                before, self._hold = self._hold, self._hold + piece.hold
                self._reach(piece.marks[-1], before)
            else:
                self._append(piece)

    def _resting_time(self) -> float:
        """Time (s) from which on the trajectory rests, all legs planned."""
        s = self._path.smoothing
        resting = s.reach + math.ceil(self._arrival / s.interval - 1e-9) - 1
        moved = resting * s.interval if self._arrival > 0.0 else 0.0
        if self._hold == 0.0:
            return self.start + moved
        return self.start + max(moved, self._arrival + s.delay + s.settling + self._hold)

    def _append(self, piece: Piece) -> None:
        speed = fitting_speed(piece, self._limits, self._path.smoothing, self._corner / 2.0)
        departure = self._departure(piece, speed)
        self._path.append(piece.path, speed, departure)
        self._arrival = departure + piece.path.length / speed
        self._hold = piece.hold
        reach = self._path.smoothing.reach * self._path.smoothing.interval
        self._close([corner for corner in self._open if corner.time + reach < departure])
        self._open += [_Corner(departure + mark.distance / speed, mark) for mark in piece.marks[:-1]]
        self._reach(piece.marks[-1], 0.0)

    def _departure(self, piece: Piece, speed: float) -> float:
        """Return the earliest time, on the path as sampled, at which the piece may begin."""
        s = self._path.smoothing
        pause = self._hold + 2.0 * s.settling if self._hold > 0.0 else 0.0
        earliest = self._arrival + pause
        latest = self._arrival + max(pause, s.reach * s.interval)
        # On whole samples except the first: there a piece was found to hold the limits by itself.
        whole = np.arange(math.floor(earliest / s.interval) + 1, math.ceil(latest / s.interval)) * s.interval
        for candidate in [earliest, *whole]:
            if self._holds(piece, speed, candidate):
                return float(candidate)
        return math.ceil(latest / s.interval - 1e-9) * s.interval

    def _holds(self, piece: Piece, speed: float, departure: float) -> bool:
        """Return whether limits and corners hold if the piece begins then."""
        s = self._path.smoothing
        since = math.floor(self._arrival / s.interval) - 2 * s.reach
        points, first = self._path.extended(piece.path, speed, departure, since)
        if not within_limits(points, s.interval, self._limits):
            return False
        # The corner just reached without hold, and those before it that the new piece may still draw away.
        if not self._open:
            return True
        positions, numbers = at_half_intervals(points)
        times = (numbers + first - s.reach / 2.0) * s.interval
        for corner in self._open:
            near = np.abs(times - corner.time) <= s.reach * s.interval / 2.0
            # A corner with its pause: what is before and after the pause counts as well.
            near |= (times >= corner.time) & (times <= departure + s.reach * s.interval / 2.0)
            if near.any() and distance_to_line(corner.mark.position, positions[near]) > self._corner:
                return False
        return True

    # Passages

    def _reach(self, mark: Mark, before: float) -> None:
        """Note the last mark planned; its own hold begins ``before`` (s) after the path comes to rest there."""
        if self._hold > 0.0:
            self._close(self._open)
            settled = self._arrival + self._path.smoothing.delay + self._path.smoothing.settling
            self._passages.append(self.start + settled + before)
        else:
            self._open.append(_Corner(self._arrival, mark))

    def _close(self, corners: list[_Corner]) -> None:
        """Note the passages of corners that nothing can change any more."""
        self._passages += [self._passage(corner) for corner in corners if corner.mark.is_waypoint]
        self._open = [corner for corner in self._open if corner not in corners]

    def _passage(self, corner: _Corner) -> float:
        """Time at which the trajectory planned so far gets closest (within 1 mm) to the corner, s."""
        s = self._path.smoothing
        centre = self.start + corner.time + s.delay
        times = centre + np.linspace(-0.5, 1.0, 6 * s.reach + 1) * (s.reach * s.interval)
        distances = np.linalg.norm(self._path.derivatives(times, 0)[0] - corner.mark.position, axis=1)
        return float(times[np.argmax(distances <= distances.min() + 1e-3)])


def fitting_speed(piece: Piece, limits: Limits, smoothing: Smoothing, deviation: float) -> float:
    """Return the highest speed (m/s), up to the piece's own, at which it holds the limits from rest to rest.

    A curved path, and the marks on the way, are kept within ``deviation`` (m).
    """
    h, reach, path = smoothing.interval, smoothing.reach, piece.path
    speed = min(piece.speed, limits.speed)
    while True:
        number = math.ceil(path.length / (speed * h))
        if path.is_straight and number >= reach:
            return speed  # start and stop do not meet: the filter is made for that
        # Of a long circle the beginning and the end suffice.
        inner = np.arange(min(number, 4 * reach) if path.is_uniform else number)
        for offset in {0, number - len(inner)}:
            numbers = np.concatenate([np.zeros(reach), inner + offset, np.full(reach, number)])
            if offset:
                numbers = numbers[reach:]
            elif len(inner) < number:
                numbers = numbers[:-reach]
            points = smoothing.control_points(path.at(numbers * (speed * h)))
            if not within_limits(points, h, limits):
                break
            positions, _ = at_half_intervals(points)
            nominal = path.at((numbers * speed * h)[reach:-reach:4]) if not path.is_straight else np.empty((0, 3))
            marks = [mark.position for mark in piece.marks[:-1]]
            if any(distance_to_line(p, positions) > deviation for p in [*nominal, *marks]):
                break
        else:
            return speed
        speed *= PIECE_SLOWER
