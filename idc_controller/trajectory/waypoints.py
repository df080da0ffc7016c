"""Trajectories through waypoints, planned leg by leg as time goes on.

The straight lines are flown at constant speed with pauses between them, and smoothed (``smoothing``). A pause
slows a corner down; each is the shortest with which the limits hold and the corner is cut by no more than
allowed. What is planned always ends at rest at the last waypoint read, so a long enough pause always works.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.paths import Circle, Leg, Mark, Piece, pieces
from idc_controller.trajectory.smoothing import smoothing_for
from idc_controller.trajectory.spline import SUPPORT, SplineTrajectory, evaluate, within_limits
from idc_controller.trajectory.trajectory import Limits, Trajectory, checked_times, finite, point, positive

MOST_STANDSTILLS = 1000
"""Legs in a row that neither move nor hold: an endless mission of such legs would never give an answer."""
PIECE_SLOWER = 0.93
"""Factor by which a piece is slowed until it holds the limits."""


@dataclass(frozen=True)
class _Corner:
    time: float  # of the path as sampled, s since its beginning
    position: Array
    leg: int | None


class WaypointTrajectory(Trajectory):
    """From rest at a start point along legs, to rest at the last one; reads legs only as far as needed.

    Args:
        start_position: (3,), m, NED.
        legs: straight legs and circles; may be endless. A leg faster than ``limits.speed`` is flown at that.
        limits: hold at every time. The smoothing is sized for ``limits.speed``: a speed far above what the
            legs ask for makes corners and stops slower than they need to be.
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
        corner: float = 0.2,
        kept: float = 60.0,
    ) -> None:
        self._limits = limits
        self._smoothing = smoothing = smoothing_for(limits)
        self._interval = smoothing.interval
        self._start = finite(start, "start")
        self._corner = positive(corner, "corner")
        self._kept = kept if kept == math.inf else positive(kept, "kept")
        position = point(start_position, "start position")
        short = smoothing.reach * self._interval * limits.speed
        self._pieces: Iterator[Piece] = pieces(position, legs, short)
        # Samples at multiples of the interval up to `_arrival`; the path rests from there until decided.
        # `_offset` is the number of the first sample kept (those up to 0 are the start point).
        self._samples = np.repeat(position[None], 2 * smoothing.reach, axis=0)
        self._offset = 1 - len(self._samples)
        self._rest = position
        self._arrival = 0.0
        self._hold = 0.0
        self._standstills = 0
        self._corners: list[_Corner] = []  # whose passage the next piece may still change
        self._passages: list[tuple[float, int]] = []
        self._exhausted = False
        self._cache: Array | None = None

    @property
    def start(self) -> float:
        """Time at which the motion begins, s."""
        return self._start

    @property
    def end(self) -> float:
        """Time from which on it rests, s; ``inf`` until the legs are exhausted."""
        if not self._exhausted or math.isinf(self._hold):
            return math.inf
        resting = self._smoothing.reach + math.ceil(self._arrival / self._interval - 1e-9) - 1
        moved = resting * self._interval if self._arrival > 0.0 else 0.0
        if self._hold == 0.0:
            return self._start + moved
        held = self._arrival + self._smoothing.delay + self._smoothing.settling + self._hold
        return self._start + max(moved, held)

    @property
    def passages(self) -> list[tuple[float, int]]:
        """(time s, index of the leg) of every waypoint planned so far, in order.

        Without hold the time at which it is closest; with hold the time at which the hold begins.
        """
        open_corners = [(self._passage(corner), corner.leg) for corner in self._corners]
        done = list(self._passages)
        for time, leg in open_corners:
            if leg is not None:
                done.append((max(time, done[-1][0]) if done else time, leg))
        return done

    def derivatives(self, times: ArrayLike, order: int = 4) -> Array:
        """See ``Trajectory.derivatives``."""
        times = checked_times(times, order)
        if len(times) == 0:
            return np.zeros((order + 1, 0, 3))
        self._plan_until(float(times.max()))
        self._forget_before(float(times.min()) - self._kept)
        points, origin = self._control_points()
        arguments = (times - origin) / self._interval
        if arguments.min() < 0.0 and self._offset > 1 - 2 * self._smoothing.reach:
            raise TrajectoryError(f"the trajectory at {times.min():g} s is no longer kept")
        return evaluate(points, self._interval, arguments, order)

    def waypoints(self, begin: float, end: float) -> Array:
        """See ``Trajectory.waypoints``."""
        times = [time for time, _ in self.passages if begin <= time <= end]
        return self.derivatives(times, 0)[0] if times else np.empty((0, 3))

    def stop(self, time: float) -> SplineTrajectory:
        """See ``Trajectory.stop``; at the latest it rests at the last waypoint planned."""
        # Far enough ahead to slow down in any case.
        self._plan_until(finite(time, "time") + 3 * self._smoothing.reach * self._interval)
        points, origin = self._control_points()
        return SplineTrajectory(points, self._interval, origin, self._limits).stop(time)

    def _control_points(self) -> tuple[Array, float]:
        """Control points of all that is planned, ending at rest, and the time of the first one, s."""
        if self._cache is None:
            resting = np.repeat(self._rest[None], len(self._smoothing.weights), axis=0)
            self._cache = self._smoothing.control_points(np.vstack([self._samples, resting]))
        # Control point j averages samples j .. j + n - 1 and acts from the last of them on; sample 1, the
        # first to move, acts from `start` on.
        first = self._offset + len(self._smoothing.weights) - 1
        return self._cache, self._start + (first - 1) * self._interval

    def _plan_until(self, time: float) -> None:
        while not (self._exhausted or math.isinf(self._hold)):
            known = self._arrival + (self._hold if self._hold else 0.0)
            if self._start + known - self._interval > time:
                return
            piece = next(self._pieces, None)
            if piece is None:
                self._exhausted = True
            else:
                self._append(piece)

    def _forget_before(self, time: float) -> None:
        if math.isinf(time):
            return
        oldest = math.floor((time - self._start) / self._interval) - 3 * self._smoothing.reach
        surplus = min(oldest - self._offset, len(self._samples) - 3 * self._smoothing.reach)
        if surplus > 1000:
            self._samples = self._samples[surplus:].copy()
            self._offset += surplus
            self._cache = None

    # Planning

    def _append(self, piece: Piece) -> None:
        if piece.path is None:
            if piece.hold == 0.0 and self._hold == 0.0:
                self._standstills += 1
                if self._standstills > MOST_STANDSTILLS:
                    raise TrajectoryError(f"more than {MOST_STANDSTILLS} waypoints in a row at one place")
            self._add_rest(piece)
            return
        self._standstills = 0
        speed = self._fitting_speed(piece)
        departure = self._departure(piece, speed)
        new = self._sampled(piece, speed, departure)
        self._samples = np.vstack([self._samples, new])
        self._cache = None
        self._arrival = departure + piece.path.length / speed
        self._rest = piece.marks[-1].position
        self._hold = piece.hold
        earlier = self._corners
        self._corners = []
        for corner in earlier:  # nothing that follows can change these any more
            if corner.time + self._smoothing.reach * self._interval < departure:
                self._close(corner)
            else:
                self._corners.append(corner)
        for mark in piece.marks[:-1]:
            self._corners.append(_Corner(departure + mark.distance / speed, mark.position, mark.leg))
        self._add_last(piece)

    def _departure(self, piece: Piece, speed: float) -> float:
        """The earliest time, on the path as sampled, at which the piece may begin."""
        h, reach = self._interval, self._smoothing.reach
        pause = self._hold + 2.0 * self._smoothing.settling if self._hold > 0.0 else 0.0
        earliest = self._arrival + pause
        latest = self._arrival + max(pause, reach * h)
        if math.isinf(earliest):
            raise TrajectoryError("nothing can follow a leg that holds for ever")
        # On whole samples except the first: there a piece was found to hold the limits by itself.
        for candidate in [earliest, *np.arange(math.floor(earliest / h) + 1, math.ceil(latest / h)) * h]:
            if self._holds(piece, speed, candidate):
                return float(candidate)
        return math.ceil(latest / h - 1e-9) * h

    def _holds(self, piece: Piece, speed: float, departure: float) -> bool:
        """Whether limits and corners hold if the piece begins then, as far as what is before plays a part."""
        h, reach = self._interval, self._smoothing.reach
        first = math.floor(self._arrival / h) - 2 * reach
        added = self._sampled(piece, speed, departure, math.ceil(departure / h) + 2 * reach)
        samples = np.vstack([self._samples[max(0, first - self._offset) :], added])
        points = self._smoothing.control_points(samples)
        first = max(first, self._offset) + len(self._smoothing.weights) - 1
        if not within_limits(points, h, self._limits):
            return False
        # The corner just reached without hold, and those before it that the new piece may still draw away.
        if not self._corners:
            return True
        positions, numbers = _dense(points)
        times = (numbers + first - reach / 2.0) * h
        for corner in self._corners:
            near = np.abs(times - corner.time) <= reach * h / 2.0
            # A corner with its pause: what is before and after the pause counts as well.
            near |= (times >= corner.time) & (times <= departure + reach * h / 2.0)
            if near.any() and _distance(corner.position, positions[near]) > self._corner:
                return False
        return True

    def _fitting_speed(self, piece: Piece) -> float:
        """The highest speed, up to the piece's own, at which it holds the limits from rest to rest."""
        assert piece.path is not None
        h, reach, path = self._interval, self._smoothing.reach, piece.path
        speed = min(piece.speed, self._limits.speed)
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
                samples = path.at(numbers * (speed * h))
                points = self._smoothing.control_points(samples)
                if not within_limits(points, h, self._limits):
                    break
                positions, _ = _dense(points)
                nominal = path.at((numbers * speed * h)[reach:-reach:4]) if not path.is_straight else np.empty((0, 3))
                marks = [m.position for m in piece.marks[:-1]]
                if any(_distance(p, positions) > self._corner / 2.0 for p in [*nominal, *marks]):
                    break
            else:
                return speed
            speed *= PIECE_SLOWER

    def _sampled(self, piece: Piece, speed: float, departure: float, stop: int | None = None) -> Array:
        """Samples (M, 3) that follow those there are, to the end of the piece or up to number ``stop``."""
        assert piece.path is not None
        h = self._interval
        begin = self._offset + len(self._samples)
        end = math.floor((departure + piece.path.length / speed) / h) + 1 if stop is None else stop
        times = np.arange(begin, max(begin, end)) * h
        return piece.path.at(np.asarray(speed * (times - departure), dtype=float))

    # Passages

    def _add_rest(self, piece: Piece) -> None:
        """A waypoint where the last one was: only its hold counts, after those before it."""
        before = self._hold
        self._hold += piece.hold
        self._add(piece.marks[-1], self._hold > 0.0, before)

    def _add_last(self, piece: Piece) -> None:
        self._add(piece.marks[-1], piece.hold > 0.0, 0.0)

    def _add(self, mark: Mark, held: bool, before: float) -> None:
        corner = _Corner(self._arrival, mark.position, mark.leg)
        if held:
            if mark.leg is not None:
                settled = self._arrival + self._smoothing.delay + self._smoothing.settling
                self._report(float(self._start + settled + before), mark.leg)
        else:
            self._corners.append(corner)

    def _close(self, corner: _Corner) -> None:
        if corner.leg is not None:
            self._report(self._passage(corner), corner.leg)

    def _report(self, time: float, leg: int) -> None:
        for corner in self._corners:  # all that were before this one
            if corner.leg is not None and corner.leg < leg:
                self._report_now(self._passage(corner), corner.leg)
        self._corners = [c for c in self._corners if c.leg is not None and c.leg >= leg]
        self._report_now(time, leg)

    def _report_now(self, time: float, leg: int) -> None:
        self._passages.append((max(time, self._passages[-1][0]) if self._passages else time, leg))

    def _passage(self, corner: _Corner) -> float:
        """Time at which the trajectory planned so far gets closest (within 1 mm) to the corner, s."""
        points, origin = self._control_points()
        centre = self._start + corner.time + self._smoothing.delay
        times = centre + np.linspace(-0.5, 1.0, 6 * self._smoothing.reach + 1) * (
            self._smoothing.reach * self._interval
        )
        positions = evaluate(points, self._interval, (times - origin) / self._interval, 0)[0]
        distances = np.linalg.norm(positions - corner.position, axis=1)
        return float(times[np.argmax(distances <= distances.min() + 1e-3)])


def fly_on(trajectory: Trajectory, legs: Iterable[Leg | Circle], limits: Limits) -> Trajectory:
    """``trajectory``, then from where it came to rest along further legs."""
    return trajectory.then(lambda time, here: WaypointTrajectory(here, legs, limits, start=time))


def _dense(points: Array) -> tuple[Array, Array]:
    """Positions (K, 3) of the spline of control points (M, 3) twice an interval, and their arguments (K,)."""
    arguments = np.arange(2 * (SUPPORT - 1), 2 * len(points)) / 2.0
    return evaluate(points, 1.0, arguments, 0)[0], arguments


def _distance(position: Array, positions: Array) -> float:
    """Distance from a point (3,) to the line through positions (K, 3), m."""
    if len(positions) == 1:
        return float(np.linalg.norm(positions[0] - position))
    steps = positions[1:] - positions[:-1]
    squares = np.maximum(np.einsum("ij,ij->i", steps, steps), 1e-300)
    along = np.clip(np.einsum("ij,ij->i", position - positions[:-1], steps) / squares, 0.0, 1.0)
    nearest = positions[:-1] + along[:, None] * steps
    return float(np.sqrt(np.min(np.sum((nearest - position) ** 2, axis=1))))
