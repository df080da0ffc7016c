"""Geofence: exclusion circles are poles, exclusion polygons walls, inclusion areas have a boundary."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gcs.mission.model import Obstacle
from gcs.mission.route import Position
from idc_controller.geometry.free_space import FlightArea, Ring
from idc_controller.geometry.shape import PlanView, Shape
from idc_controller.geometry.shapes import Pole, Wall

if TYPE_CHECKING:
    import shapely  # takes long to import, spent only where there is a fence

Point = tuple[float, float]

FENCE_HEIGHT = 150.0
"""m. A fence has no top; this is above what regulations let fly."""
WALL_THICKNESS = 0.2
CIRCLE_CORNERS = 32
_SNAP = 1e-3
"""m, within which edges of several inclusion areas are the same."""


class Exclusion(NamedTuple):
    """An area that must not be entered: its name, its plan view about home, and the bodies that stand in its place."""

    name: str
    view: PlanView
    obstacles: tuple[Obstacle, ...]


@dataclass(frozen=True)
class Fence:
    """A geofence in m about home: rings about the area that must not be left (none: no limit), and exclusions."""

    boundary: tuple[Ring, ...] = ()
    exclusions: tuple[Exclusion, ...] = ()

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """The bodies in place of what is excluded."""
        return tuple(obstacle for exclusion in self.exclusions for obstacle in exclusion.obstacles)

    @property
    def excluded(self) -> tuple[Ring, ...]:
        """The corners of the excluded polygons: circles are solid poles."""
        return tuple(_corners(e.view.core.exterior) for e in self.exclusions if e.view.radius == 0.0)

    @cached_property
    def included(self) -> FlightArea:
        """The area that must not be left."""
        return FlightArea(self.boundary)

    def violation(self, place: Position) -> str | None:
        """Return the reason why a place must not be flown to; None if it may."""
        reason = None
        if self.boundary and not self.included.contains(np.array([place]))[0]:
            reason = "outside the fence's inclusion area"
        for exclusion in self.exclusions:
            if exclusion.view.contains(place[:2]):
                reason = f"inside {exclusion.name}, which the fence excludes"
        return reason


def circle_corners(centre: Point, radius: float) -> Ring:
    """Return corners on a circle: the polygon lies inside it."""
    angles = np.arange(CIRCLE_CORNERS) * (2.0 * math.pi / CIRCLE_CORNERS)
    return tuple((centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles)


def encloses_area(polygon: Ring) -> bool:
    """Return whether a polygon does not cross itself, and has an area."""
    import shapely  # takes long to import, spent only where there is a fence

    area = shapely.Polygon(polygon)
    return bool(area.is_valid and area.area >= 1e-3)


def boundary_of(areas: Sequence[Ring], *, common: bool) -> tuple[Ring, ...]:
    """Return the rings about what inclusion areas (one or more) have in ``common``, else about all of them together.

    The ring about a single area has its own corners. There are none where areas have nothing in common.
    """
    import shapely

    whole = shapely.Polygon(areas[0])
    for area in areas[1:]:
        join = shapely.intersection if common else shapely.union
        whole = join(whole, shapely.Polygon(area), grid_size=_SNAP)
    parts = [part for part in shapely.get_parts(whole) if part.geom_type == "Polygon"]
    rings = [_corners(ring) for part in parts for ring in (part.exterior, *part.interiors)]
    return tuple(ring for ring in rings if encloses_area(ring))


def excluded_circle(name: str, centre: Point, radius: float) -> Exclusion:
    """Return an exclusion circle, a pole in its place."""
    import shapely

    pole = _standing(name, centre, Pole(radius, FENCE_HEIGHT))
    return Exclusion(name, PlanView(shapely.Point(centre), radius), (pole,))


def excluded_polygon(name: str, polygon: Ring) -> Exclusion:
    """Return an exclusion polygon: one wall for a rectangle; else one along each edge, on its inner side."""
    import shapely

    if (rectangle := _rectangle(polygon)) is not None:
        centre, size, yaw = rectangle
        walls = [_standing(name, centre, Wall((*size, FENCE_HEIGHT), yaw))]
    else:
        walls = _walls_along(f"{name} edge {{}}", polygon, inside=True)
    return Exclusion(name, PlanView(shapely.Polygon(polygon), 0.0), tuple(walls))


def boundary_walls(boundary: Sequence[Ring]) -> list[Obstacle]:
    """Return one wall along each edge of a boundary, on the side that must not be entered."""
    area, walls, first = FlightArea(tuple(boundary)), list[Obstacle](), 1
    for ring in boundary:
        walls += _walls_along("the fence (boundary edge {})", ring, inside=area.is_hole(ring), first=first)
        first += len(ring)
    return walls


def _walls_along(name: str, polygon: Ring, *, inside: bool, first: int = 1) -> list[Obstacle]:
    """Return one wall along each edge of a polygon, on its inner or its outer side, its number in its ``name``."""
    import shapely

    inward = 1.0 if shapely.LinearRing(polygon).is_ccw == inside else -1.0
    walls = []
    for number, (a, b) in enumerate(pairwise((*polygon, polygon[0])), start=first):
        length = math.dist(a, b)
        if length < 1e-6:
            continue
        along = ((b[0] - a[0]) / length, (b[1] - a[1]) / length)
        offset = inward * WALL_THICKNESS / 2.0
        centre = ((a[0] + b[0]) / 2.0 - along[1] * offset, (a[1] + b[1]) / 2.0 + along[0] * offset)
        wall = Wall((length, WALL_THICKNESS, FENCE_HEIGHT), math.atan2(along[1], along[0]))
        walls.append(_standing(name.format(number), centre, wall))
    return walls


def _standing(name: str, place: Point, shape: Shape) -> Obstacle:
    """Return an obstacle as high as a fence that stands on the ground at ``place``."""
    return Obstacle(name, (*place, -FENCE_HEIGHT / 2.0), shape)


def _rectangle(polygon: Ring) -> tuple[Point, Point, float] | None:
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


def _corners(ring: "shapely.LinearRing") -> Ring:
    """Return the corners of a ring, none of them twice."""
    return tuple((north, east) for north, east in list(ring.coords)[:-1])
