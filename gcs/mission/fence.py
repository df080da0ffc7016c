"""Geofence: exclusion circles are poles, exclusion polygons walls, an inclusion area is the boundary."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gcs.mission.model import Obstacle
from gcs.mission.route import Position
from idc_controller.geometry.box import Wall
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.shape import Shape

Point = tuple[float, float]
Corners = tuple[Point, ...]

FENCE_HEIGHT = 150.0
"""m. A fence has no top; this is above what regulations let fly."""
WALL_THICKNESS = 0.2
CIRCLE_CORNERS = 32


@dataclass(frozen=True)
class Fence:
    """A geofence in m about home: what it excludes, and the corners of the area that must not be left."""

    obstacles: tuple[Obstacle, ...] = ()
    boundary: Corners | None = None

    def violation(self, place: Position) -> str | None:
        """Return the reason why a place must not be flown to; None if it may."""
        reason = None
        if self.boundary is not None and not _covers(self.boundary, place):
            reason = "outside the fence's inclusion area"
        for obstacle in self.obstacles:
            if -place[2] <= _top(obstacle) and obstacle.shape.plan_view.contains(_from_centre(place, obstacle)):
                reason = f"inside {obstacle.name}, which the fence excludes"
        return reason

    def crossings(self, start: Position, end: Position) -> list[str]:
        """Return the names of the parts that a straight line from ``start`` to ``end`` crosses."""
        crossed = []
        if self.boundary is not None and start[:2] != end[:2] and _crosses(self.boundary, start, end):
            crossed.append("the fence's inclusion area")
        low = min(-start[2], -end[2])
        for obstacle in self.obstacles:
            here, there = (_from_centre(place, obstacle) for place in (start, end))
            if low < _top(obstacle) and obstacle.shape.plan_view.is_crossed(here, there):
                crossed.append(obstacle.name)
        return crossed


def circle_corners(centre: Point, radius: float) -> Corners:
    """Return corners on a circle: the polygon lies inside it."""
    angles = np.arange(CIRCLE_CORNERS) * (2.0 * math.pi / CIRCLE_CORNERS)
    return tuple((centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles)


def encloses_area(polygon: Corners) -> bool:
    """Return whether a polygon does not cross itself, and has an area."""
    import shapely  # takes long to import, spent only where there is a fence

    area = shapely.Polygon(polygon)
    return bool(area.is_valid and area.area >= 1e-3)


def excluded_circle(name: str, centre: Point, radius: float) -> Obstacle:
    """Return the pole in place of an exclusion circle."""
    return _standing(name, centre, Pole(radius, FENCE_HEIGHT))


def excluded_polygon(name: str, polygon: Corners) -> list[Obstacle]:
    """Return one wall for a rectangle; for any other polygon one along each edge, on its inner side."""
    if (rectangle := _rectangle(polygon)) is not None:
        centre, size, yaw = rectangle
        return [_standing(name, centre, Wall((*size, FENCE_HEIGHT), yaw))]
    return _walls_along(name, polygon, inside=True)


def boundary_walls(polygon: Corners) -> list[Obstacle]:
    """Return one wall along each edge of an area that must not be left, on its outer side."""
    return _walls_along("boundary", polygon, inside=False)


def _walls_along(name: str, polygon: Corners, *, inside: bool) -> list[Obstacle]:
    """Return one wall along each edge of a polygon, on its inner or its outer side."""
    import shapely

    inward = 1.0 if shapely.LinearRing(polygon).is_ccw == inside else -1.0
    walls = []
    for number, (a, b) in enumerate(pairwise((*polygon, polygon[0])), start=1):
        length = math.dist(a, b)
        if length < 1e-6:
            continue
        along = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
        offset = inward * WALL_THICKNESS / 2.0
        centre = ((a[0] + b[0]) / 2.0 - along[1] * offset, (a[1] + b[1]) / 2.0 + along[0] * offset)
        wall = Wall((length, WALL_THICKNESS, FENCE_HEIGHT), math.atan2(along[1], along[0]))
        walls.append(_standing(f"{name} edge {number}", centre, wall))
    return walls


def _standing(name: str, place: Point, shape: Shape) -> Obstacle:
    """Return an obstacle as high as a fence that stands on the ground at ``place``."""
    return Obstacle(name, (*place, -FENCE_HEIGHT / 2.0), shape)


def _rectangle(polygon: Corners) -> tuple[Point, Point, float] | None:
    """Return centre, edge lengths and heading (rad) of a rectangle (within 5 cm); None for another polygon."""
    if len(polygon) != 4:
        return None
    a, b, c, d = (np.array(p) for p in polygon)
    x, y = float(np.linalg.norm(b - a)), float(np.linalg.norm(d - a))
    if np.linalg.norm(a + c - b - d) > 0.05 or abs((b - a) @ (d - a)) > 0.05 * max(x, y):
        return None
    centre = (a + b + c + d) / 4.0
    heading = math.atan2(b[1] - a[1], b[0] - a[0])
    return (float(centre[0]), float(centre[1])), (x, y), heading


def _covers(area: Corners, place: Position) -> bool:
    """Return whether a place is above an area."""
    import shapely  # takes long to import, spent only where there is a fence

    return bool(shapely.Polygon(area).covers(shapely.Point(place[:2])))


def _crosses(area: Corners, start: Position, end: Position) -> bool:
    """Return whether the straight line from ``start`` to ``end`` leaves or enters an area."""
    import shapely

    return bool(shapely.LineString([start[:2], end[:2]]).crosses(shapely.Polygon(area)))


def _from_centre(place: Position, obstacle: Obstacle) -> Point:
    return place[0] - obstacle.position[0], place[1] - obstacle.position[1]


def _top(obstacle: Obstacle) -> float:
    """Return the altitude of its top (m)."""
    return obstacle.shape.half_height - obstacle.position[2]
