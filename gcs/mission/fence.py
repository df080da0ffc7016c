"""QGroundControl's geofence: exclusion circles are poles, exclusion polygons walls, an inclusion the boundary."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, TypeGuard

import numpy as np
import shapely

from gcs.mission.content import Fence, FileHome
from gcs.mission.geodesy import north_east
from gcs.mission.items import ItemError
from gcs.mission.model import Obstacle
from idc_controller.geometry.box import Wall
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.shape import Shape

Point = tuple[float, float]

FENCE_HEIGHT = 150.0
"""m. A fence has no top; this is above what regulations let fly."""
WALL_THICKNESS = 0.2
CORNER_LIMIT = 500
CIRCLE_CORNERS = 32


def read_fence(section: dict[str, Any], home: FileHome) -> Fence:
    """The ``geoFence`` section of a plan in m about home. Raises :class:`ItemError`."""
    origin = (home.latitude, home.longitude, home.altitude or 0.0)
    obstacles: list[Obstacle] = []
    boundaries: list[tuple[Point, ...]] = []
    for number, (where, raw) in enumerate(_entries(section, "circles"), start=1):
        circle = raw.get("circle")
        if not isinstance(circle, dict):
            raise ItemError(where, "circle: missing")
        centre = _place(circle.get("center"), f"{where}.center", origin)
        radius = circle.get("radius")
        if not _is_number(radius) or not 0.0 < radius < 1e5:
            raise ItemError(where, "radius: must be a positive number of metres")
        if _inclusion(raw, where):
            # Corners on the circle: the polygon lies inside it.
            angles = np.arange(CIRCLE_CORNERS) * (2.0 * math.pi / CIRCLE_CORNERS)
            boundaries.append(
                tuple((centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles)
            )
        else:
            obstacles.append(_standing(f"fence circle {number}", centre, Pole(float(radius), FENCE_HEIGHT)))
    for number, (where, raw) in enumerate(_entries(section, "polygons"), start=1):
        corners = raw.get("polygon")
        if not isinstance(corners, list) or not 3 <= len(corners) <= CORNER_LIMIT:
            raise ItemError(where, f"polygon: expected 3 to {CORNER_LIMIT} corners")
        polygon = tuple(_place(c, f"{where}.polygon", origin) for c in corners)
        if not (area := shapely.Polygon(polygon)).is_valid or area.area < 1e-3:
            raise ItemError(where, "polygon: has no area, or crosses itself")
        if _inclusion(raw, where):
            boundaries.append(polygon)
        else:
            obstacles.extend(_walls(f"fence polygon {number}", polygon))
    if len(boundaries) > 1:
        raise ItemError("inclusion", f"{len(boundaries)} areas: at most one boundary is supported")
    return Fence(tuple(obstacles), boundaries[0] if boundaries else None)


def is_inside(point: Point, polygon: tuple[Point, ...]) -> bool:
    """Whether a point lies in a polygon."""
    return bool(shapely.Polygon(polygon).covers(shapely.Point(point)))


def leaves(start: Point, end: Point, polygon: tuple[Point, ...]) -> bool:
    """Whether a straight line between two points crosses an edge of a polygon."""
    return start != end and bool(shapely.LineString([start, end]).crosses(shapely.Polygon(polygon)))


def _entries(section: dict[str, Any], kind: str) -> list[tuple[str, dict[str, Any]]]:
    entries = section.get(kind, [])
    if not isinstance(entries, list) or not all(isinstance(e, dict) for e in entries):
        raise ItemError(kind, "expected a list of objects")
    for number, entry in enumerate(entries, start=1):
        if isinstance(entry.get("version"), bool) or entry.get("version") != 1:
            raise ItemError(f"{kind}[{number}]", f"version: {entry.get('version')!s:.20} is not supported, only 1")
    return [(f"{kind}[{number}]", entry) for number, entry in enumerate(entries, start=1)]


def _inclusion(raw: dict[str, Any], where: str) -> bool:
    inclusion = raw.get("inclusion")
    if not isinstance(inclusion, bool):
        raise ItemError(where, "inclusion: must be true or false")
    return inclusion


def _is_number(value: Any) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _place(value: Any, where: str, origin: tuple[float, float, float]) -> Point:
    if not isinstance(value, list) or len(value) < 2 or not all(_is_number(v) for v in value[:2]):
        raise ItemError(where, "expected [latitude, longitude]")
    try:
        latitude, longitude = float(value[0]), float(value[1])
        return north_east(latitude, longitude, origin)
    except (ItemError, OverflowError) as problem:
        raise ItemError(where, str(problem)) from problem


def boundary_walls(polygon: tuple[Point, ...]) -> list[Obstacle]:
    """One wall along each edge of an area that must not be left, on its outer side."""
    return walls_along("boundary", polygon, inside=False)


def _walls(name: str, polygon: tuple[Point, ...]) -> list[Obstacle]:
    """One wall for a rectangle; for any other polygon one along each edge, on its inner side."""
    if (rectangle := _rectangle(polygon)) is not None:
        centre, size, yaw = rectangle
        return [_standing(name, centre, Wall((*size, FENCE_HEIGHT), yaw))]
    return walls_along(name, polygon, inside=True)


def walls_along(name: str, polygon: tuple[Point, ...], *, inside: bool) -> list[Obstacle]:
    """One wall along each edge of a polygon, on its inner or its outer side."""
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


def _rectangle(polygon: tuple[Point, ...]) -> tuple[Point, Point, float] | None:
    """Centre, edge lengths and heading (rad) of a polygon that is a rectangle within 5 cm; otherwise None."""
    if len(polygon) != 4:
        return None
    a, b, c, d = (np.array(p) for p in polygon)
    x, y = float(np.linalg.norm(b - a)), float(np.linalg.norm(d - a))
    if np.linalg.norm(a + c - b - d) > 0.05 or abs((b - a) @ (d - a)) > 0.05 * max(x, y):
        return None
    centre = (a + b + c + d) / 4.0
    heading = math.atan2(b[1] - a[1], b[0] - a[0])
    return (float(centre[0]), float(centre[1])), (x, y), heading
