"""A free vehicle's fence: areas of the plane that it stays in, and others that it stays out of."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

Point = tuple[float, float]
"""North and east (m)."""


@dataclass(frozen=True)
class Polygon:
    """An area with three corners or more."""

    corners: tuple[Point, ...]

    def contains(self, north: float, east: float) -> bool:
        """Return True if a point is in it: a line from there crosses its boundary an odd number of times."""
        inside = False
        for (x, y), (next_x, next_y) in pairwise((*self.corners, self.corners[0])):
            if (y > east) != (next_y > east) and north < x + (east - y) / (next_y - y) * (next_x - x):
                inside = not inside
        return inside


@dataclass(frozen=True)
class Circle:
    """An area about a ``centre``; ``radius`` in m."""

    centre: Point
    radius: float

    def contains(self, north: float, east: float) -> bool:
        """Return True if a point is in it."""
        return math.hypot(north - self.centre[0], east - self.centre[1]) <= self.radius


class Fence(NamedTuple):
    """Inclusions, in one of which a vehicle must be if there are any, and exclusions, in none of which it may be."""

    inclusions: tuple[Polygon | Circle, ...] = ()
    exclusions: tuple[Polygon | Circle, ...] = ()

    def breach(self, north: float, east: float) -> str | None:
        """Return how a point breaches the fence; None: it does not."""
        if self.inclusions and not any(area.contains(north, east) for area in self.inclusions):
            return "outside the inclusion areas"
        if any(area.contains(north, east) for area in self.exclusions):
            return "in an exclusion area"
        return None
