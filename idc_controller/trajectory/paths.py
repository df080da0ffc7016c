"""Legs as the mission gives them, and the pieces of path that they become."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.trajectory import finite, point, positive

COINCIDENT = 1e-6
"""m: points closer than this are the same point."""
STRAIGHT_ON = 1e-6
"""rad: a smaller turn is none, provided that it displaces the path by less than a millimetre."""
GENTLE = 0.35
"""rad: short legs that turn less than this are flown as one curve."""
MOST_STANDSTILLS = 1000
"""Legs in a row that neither move nor hold: an endless mission of such legs would never give an answer."""
MOST_JOINED = 64
"""Legs flown as one piece: bounds how far ahead an endless mission is read."""


@dataclass(frozen=True)
class Leg:
    """Straight to ``position`` (3,), m, NED, at ``speed``, m/s, then rest there for ``hold``, s.

    Without hold the point is passed, not stopped at. ``hold`` may be ``inf``: rest until stopped.

    Raises:
        TrajectoryError: not finite, speed not positive, hold negative.
    """

    position: ArrayLike
    speed: float
    hold: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", point(self.position, "position of a leg"))
        positive(self.speed, "speed of a leg")
        _checked_hold(self.hold)


@dataclass(frozen=True)
class Circle:
    """``turns`` (may be a fraction) round ``centre`` (3,), m, NED, at ``radius``, m, and ``speed``, m/s.

    Begins at the point of the circle next to where the leg before ends and stops where the turns are done;
    ``clockwise`` as seen from above. Flown more slowly where the limits demand it. ``hold`` as in ``Leg``.
    """

    centre: ArrayLike
    radius: float
    turns: float
    speed: float
    clockwise: bool = True
    hold: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", point(self.centre, "centre of a circle"))
        positive(self.radius, "radius of a circle")
        positive(self.turns, "turns of a circle")
        positive(self.speed, "speed of a circle")
        _checked_hold(self.hold)


def _checked_hold(hold: float) -> None:
    if not hold >= 0.0:
        raise TrajectoryError(f"hold must be zero or more seconds, not {hold}")


class Polyline:
    """Straight lines through points (M, 3), m; ``is_uniform`` is a path of the same curvature everywhere."""

    def __init__(self, points: Array) -> None:
        self._points = points
        self._distances = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        self.length = float(self._distances[-1])
        chord = np.linalg.norm(points[-1] - points[0])
        self.is_straight = self.is_uniform = bool(self.length - chord <= 1e-12 * self.length)

    def at(self, distances: Array) -> Array:
        """Return points (K, 3), m, at distances (K,), m, from the beginning; held beyond both ends."""
        return np.column_stack([np.interp(distances, self._distances, axis) for axis in self._points.T])


class Arc:
    """Part of a level circle; angles in rad from north towards east."""

    is_straight = False
    is_uniform = True

    def __init__(self, centre: Array, radius: float, start_angle: float, angle: float) -> None:
        self._centre, self._radius = centre, radius
        self._start_angle, self._sign = start_angle, math.copysign(1.0, angle)
        self.length = radius * abs(angle)

    def at(self, distances: Array) -> Array:
        """See :meth:`Polyline.at`."""
        travelled = np.clip(distances, 0.0, self.length) / self._radius
        angles = self._start_angle + self._sign * travelled
        offsets = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
        return np.asarray(self._centre + self._radius * offsets)


Path = Polyline | Arc


@dataclass(frozen=True, eq=False)
class Mark:
    """A corner of a piece: ``distance`` m from its beginning, ``position`` (3,), m.

    The entry of a circle is no waypoint.
    """

    distance: float
    position: Array
    is_waypoint: bool = True


@dataclass(frozen=True, eq=False)
class Piece:
    """A path flown at one speed (m/s), then a rest (s); the last mark is its end. Without length: only the rest."""

    path: Path
    speed: float
    hold: float
    marks: list[Mark]


def pieces(start: Array, legs: Iterable[Leg | Circle], short: float) -> Iterator[Piece]:
    """Legs from ``start`` (3,), m, joined where nothing is gained by looking at them one by one.

    Joined are legs straight on, and legs shorter than ``short`` (m) that turn gently, at equal speed without
    hold. Reads at most ``MOST_JOINED`` legs ahead.
    """
    here = start
    points: list[Array] = []
    marks: list[Mark] = []
    speed = length = 0.0
    standstills = 0

    def joined(hold: float) -> Piece:
        nonlocal points, marks, length
        piece = Piece(Polyline(np.array(points)), speed, hold, marks)
        points, marks, length = [], [], 0.0
        return piece

    for leg in legs:
        if isinstance(leg, Circle):
            if points:
                yield joined(0.0)
            standstills = 0
            arc = _arc(leg, here)
            entry = arc.at(np.zeros(1))[0]
            to_entry = float(np.linalg.norm(entry - here))
            if to_entry > COINCIDENT:
                yield Piece(Polyline(np.array([here, entry])), leg.speed, 0.0, [Mark(to_entry, entry, False)])
            here = arc.at(np.array([arc.length]))[0]
            yield Piece(arc, leg.speed, leg.hold, [Mark(arc.length, here)])
            continue
        if not isinstance(leg, Leg):
            raise TrajectoryError(f"a leg must be a Leg or a Circle, not {type(leg).__name__}")
        target = np.asarray(leg.position)
        step = float(np.linalg.norm(target - here))
        standstills = standstills + 1 if step <= COINCIDENT and leg.hold == 0.0 else 0
        if standstills > MOST_STANDSTILLS:
            raise TrajectoryError(f"more than {MOST_STANDSTILLS} waypoints in a row at one place")
        if step <= COINCIDENT:
            if points:
                yield joined(0.0)
            yield Piece(Polyline(here[None]), leg.speed, leg.hold, [Mark(0.0, here)])
            continue
        same = speed == leg.speed and len(points) <= MOST_JOINED
        if points and not (same and _joins(points, target, short)):
            yield joined(0.0)
        if not points:
            points, speed = [here], leg.speed
        points.append(target)
        length += step
        marks.append(Mark(length, target))
        here = target
        if leg.hold > 0.0:
            yield joined(leg.hold)
    if points:
        yield joined(0.0)


def _joins(points: list[Array], target: Array, short: float) -> bool:
    before, after = points[-1] - points[-2], target - points[-1]
    lengths = float(np.linalg.norm(before)), float(np.linalg.norm(after))
    turn = math.atan2(float(np.linalg.norm(np.cross(before, after))), float(before @ after))
    if turn <= STRAIGHT_ON and turn * max(lengths) < 1e-3:
        return True
    return turn <= GENTLE and max(lengths) < short


def _arc(circle: Circle, here: Array) -> Arc:
    centre = np.asarray(circle.centre)
    radial = here[:2] - centre[:2]
    angle = math.atan2(radial[1], radial[0]) if np.linalg.norm(radial) > COINCIDENT else 0.0
    turned = (1.0 if circle.clockwise else -1.0) * 2.0 * math.pi * finite(circle.turns, "turns of a circle")
    return Arc(centre, circle.radius, angle, turned)
