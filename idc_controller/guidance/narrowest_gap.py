"""The narrowest gap on the widest path of the formation between two places, and where it is.

Bodies are taken by their plan views (shapely), in layers of altitude: in each layer those count that the formation at
that altitude would meet. Grown by the formation's radius and a clearance, they leave parts of the plane free; parts of
neighbouring layers join where they overlap. The largest clearance that still joins start and goal follows by bisection:
plan views are exact, so the width of a gap between two of them is their distance.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from idc_controller.arrays import Array
from idc_controller.geometry.free_space import FreeSpace
from idc_controller.guidance.detour import names_of, whole_region
from idc_controller.guidance.settings import DetourSettings

WIDEST = 2.0
"""Clearance (m) beyond which no gap is narrow."""
_PRECISION = 0.01
"""Of the clearance (m)."""
_SEGMENTS = 8
"""Segments of a quarter of a circle."""
_LAYERS = 1.0
"""Least distance (m) between the altitudes at which bodies begin or end to count."""
_NEAR = 0.03
"""m, within which a gap is the one that the bisection found."""


@dataclass(frozen=True)
class Gap:
    """A gap between bodies, under one of them, or about a place that is too near one.

    ``width`` (m): free width, or height under a body; 0: closed. ``clearance`` (m): the formation's there, negative
    where it does not fit.
    """

    clearance: float
    width: float
    place: tuple[float, float, float]
    names: tuple[str, ...]
    is_height: bool = False
    is_at_waypoint: bool = False

    def __str__(self) -> str:
        """Return the gap in words, as reasons of flights name it."""
        north, east, down = self.place
        extent = "high" if self.is_height else "wide"
        what = f" ({' and '.join(self.names)})" if self.names else ""
        return f"{self.width:.2f} m {extent} at {north:.1f} m north, {east:.1f} m east, {-down:.1f} m high{what}"


def narrowest_gap(
    space: FreeSpace,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    names: Sequence[str] | None = None,
    settings: DetourSettings = DetourSettings(),
) -> Gap | None:
    """Return the narrowest gap of the widest path in a ``space`` from ``start`` to ``goal`` (3,), NED (m).

    None: all gaps of a path leave the formation ``WIDEST`` m. Paths lead past the bodies, over them with the margin to
    spare, or under them.

    ``names``: the obstacles', for the gap; None: by their kinds. ``settings`` of the search for detours, whose region
    bounds the paths.
    """
    begin, end = np.asarray(start, dtype=float), np.asarray(goal, dtype=float)
    bodies = _Bodies(space, begin, end, settings)
    if bodies.joins(WIDEST):
        return None
    low, high = -space.formation.radius + 1e-3, WIDEST
    closed = not bodies.joins(low)
    while not closed and high - low > _PRECISION:
        middle = (low + high) / 2.0
        low, high = (middle, high) if bodies.joins(middle) else (low, middle)
    called = names_of(space, names)
    return bodies.gap(low if closed else high, called, closed)


class _Bodies:
    """Obstacles in plan view, and the layers in which the formation meets them."""

    def __init__(self, space: FreeSpace, start: Array, goal: Array, settings: DetourSettings) -> None:
        self._formation, self._margin, self._start, self._goal = space.formation, space.margin, start, goal
        self._lowest, self._highest = space.lowest, space.highest
        centres = space.centres
        views = [shape.plan_view for shape in space.shapes]
        self._cores = np.array(
            [shapely.affinity.translate(v.core, x, y) for v, (x, y, _) in zip(views, centres.tolist(), strict=True)],
            dtype=object,
        )
        self._radii = np.array([view.radius for view in views], dtype=float) + space.growth
        half = np.array([shape.half_height for shape in space.shapes], dtype=float) + space.growth
        self._top, self._bottom = half - centres[:, 2], -half - centres[:, 2]
        self._is_round = np.array([shape.round_axes == (1.0, 1.0, 1.0) for shape in space.shapes], dtype=bool)
        low, high = whole_region(space, start, goal, settings)
        self._region = shapely.box(*low[:2], *high[:2])
        if space.area is not None:
            self._region = space.area.within(self._region)

    def joins(self, clearance: float) -> bool:
        """Return whether a path from start to goal has this ``clearance`` (m)."""
        begin, end, part, _ = self._parts(clearance)
        return begin >= 0 and end >= 0 and bool(part[begin] == part[end])

    def gap(self, clearance: float, names: Sequence[str], closed: bool) -> Gap:
        """Return the gap that no longer joins start and goal at this ``clearance`` (m)."""
        begin, end, part, free = self._parts(clearance)
        for at, place in ((begin, self._start), (end, self._goal)):
            if at < 0:
                return self._about(place, clearance, names)
        sides = [shapely.union_all(free[part == part[at]]) for at in (begin, end)]
        if closed:
            place = shapely.shortest_line(*sides).interpolate(0.5, normalized=True)
            nearest = int(np.argmin(shapely.distance(self._cores, place) - self._radii))
            return Gap(clearance, 0.0, _place(place.x, place.y, float(self._start[2])), (names[nearest],))
        width = 2.0 * (self._formation.radius + clearance)
        if (pair := self._pair(width, sides)) is not None:
            (first, second), place, distance = pair
            altitude = self._altitude_between(first, second)
            exact = distance / 2.0 - self._formation.radius
            return Gap(exact, distance, _place(place.x, place.y, -altitude), (names[first], names[second]))
        return self._under(clearance, names, sides)

    def _about(self, place: Array, clearance: float, names: Sequence[str]) -> Gap:
        """Return the gap about a start or goal that is itself too near a body, beside or above it."""
        away = shapely.distance(self._cores, shapely.Point(place[:2])) - self._radii
        away[~self._active(-float(place[2]), clearance)] = math.inf
        nearest = int(np.argmin(away))
        beside, above = float(away[nearest]), float(self._bottom[nearest])
        is_height = beside <= 0.0 and above > 0.0
        width = above if is_height else max(0.0, 2.0 * beside)
        exact = clearance if beside <= 0.0 else beside - self._formation.radius
        return Gap(exact, width, _place(*place.tolist()), (names[nearest],), is_height, is_at_waypoint=True)

    def _pair(self, width: float, sides: list[Any]) -> tuple[tuple[int, int], Any, float] | None:
        """Return the two bodies so far apart between the ``sides``, the middle between them, and their distance (m)."""
        tree = shapely.STRtree(shapely.buffer(self._cores, self._radii))
        found = []
        for i, core in enumerate(self._cores):
            near = tree.query(core, predicate="dwithin", distance=width + _NEAR + self._radii[i])
            for j in near[near > i].tolist():
                distance = float(shapely.distance(core, self._cores[j]) - self._radii[i] - self._radii[j])
                apart = max(self._bottom[i] - self._top[j], self._bottom[j] - self._top[i])
                if abs(distance - width) < 2.0 * _NEAR and apart < self._height:
                    line = shapely.shortest_line(core, self._cores[j])
                    whole = max(line.length, 1e-9)
                    middle = line.interpolate((self._radii[i] + distance / 2.0) / whole, normalized=True)
                    if self._region.intersects(middle):  # else it leads outside an area
                        found.append((sum(side.distance(middle) for side in sides), (i, j), middle, distance))
        best = min(found, key=lambda each: each[:2], default=None)
        if best is None or best[0] > width + 1.0:
            return None
        return best[1], best[2], best[3]

    @property
    def _height(self) -> float:
        return self._formation.above + self._formation.below

    def _altitude_between(self, first: int, second: int) -> float:
        """Return the altitude of the payload (m) nearest to the start's at which both bodies count."""
        low = max(self._bottom[first], self._bottom[second]) - self._formation.above
        high = min(self._top[first], self._top[second]) + self._formation.below
        low, high = max(low, self._lowest), min(high, self._highest)
        return float(min(max(-self._start[2], low), max(low, high)))

    def _under(self, clearance: float, names: Sequence[str], sides: list[Any]) -> Gap:
        """Return the gap under a body."""
        floor = self._lowest - self._formation.below  # ground, and what is kept from it
        supports = [floor, *(self._top + self._margin).tolist()]
        heights = np.array([[b - s for s in supports] for b in self._bottom]) - self._height - clearance
        candidates = np.argwhere(np.abs(heights) < 2.0 * _NEAR)
        away = [sum(side.distance(self._cores[i]) for side in sides) for i, _ in candidates]
        line = shapely.LineString([self._start[:2], self._goal[:2]])
        if not len(candidates):  # round bodies, met at other heights than their middles'
            place = shapely.shortest_line(*sides).interpolate(0.5, normalized=True)
            near = np.argsort(shapely.distance(self._cores, place) - self._radii)[:2]
            width = 2.0 * (self._formation.radius + clearance)
            where = _place(place.x, place.y, float(self._start[2]))
            return Gap(clearance, width, where, tuple(names[i] for i in near))
        body, support = candidates[int(np.argmin(away))].tolist()
        place = shapely.shortest_line(line, self._cores[body]).interpolate(1.0, normalized=True)
        base = 0.0 if support == 0 else float(self._top[support - 1])
        altitude = (base + float(self._bottom[body])) / 2.0
        called = (names[body],) if support == 0 else (names[body], names[support - 1])
        exact = clearance + float(heights[body, support])
        return Gap(exact, float(self._bottom[body]) - base, _place(place.x, place.y, -altitude), called, True)

    # Layers

    def _parts(self, clearance: float) -> tuple[int, int, NDArray[np.int32], NDArray[Any]]:
        """Return the free parts with start and goal (-1: not free), what each part is joined to, and all free parts."""
        altitudes = self._altitudes(clearance)
        free: list[Any] = []
        layers: list[list[int]] = []
        seen: dict[bytes, list[Any]] = {}
        for altitude in altitudes:
            key, grown = self._grown(altitude, clearance)
            if key not in seen:
                left = self._region.difference(shapely.union_all(grown)) if len(grown) else self._region
                seen[key] = [part for part in shapely.get_parts(left) if part.area > 1e-6]
                shapely.prepare(seen[key])
            layers.append(list(range(len(free), len(free) + len(seen[key]))))
            free += seen[key]
        parts = np.array(free, dtype=object)
        joined = [
            (i, j)
            for lower, upper in pairwise(layers)
            for i in lower
            for j in upper
            if free[i] is free[j] or free[i].intersects(free[j])
        ]
        rows, columns = np.array(joined, dtype=int).reshape(-1, 2).T
        graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(free), len(free)))
        number = connected_components(graph, directed=False)[1] if free else np.empty(0, dtype=np.int32)
        ends = []
        for place in (self._start, self._goal):
            layer = layers[int(np.argmin(np.abs(altitudes + place[2])))]
            point = shapely.Point(place[:2])
            ends.append(next((i for i in layer if free[i].intersects(point)), -1))
        return ends[0], ends[1], number, parts

    def _altitudes(self, clearance: float) -> Array:
        """Return altitudes (L,) such that between two of them no body begins or ends to count unnoticed."""
        over = self._top + self._formation.below + self._margin
        under = self._bottom - self._formation.above - clearance
        critical = [*over.tolist(), *under.tolist()]
        for i in np.flatnonzero(self._is_round):
            critical += np.arange(under[i], over[i], _LAYERS).tolist()
        ends = [min(max(-float(place[2]), self._lowest), self._highest) for place in (self._start, self._goal)]
        bounds = [self._lowest, self._highest, *ends]
        inner = {value for value in critical if self._lowest < value < self._highest}
        if len(inner) > (self._highest - self._lowest) / _LAYERS:  # so many that evenly spaced ones do
            return np.unique(np.round([*bounds, *np.arange(self._lowest, self._highest, _LAYERS).tolist()], 6))
        levels = np.unique(np.round([*bounds, *inner], 6))
        return np.sort(np.concatenate([levels, (levels[1:] + levels[:-1]) / 2.0]))

    def _active(self, altitude: float, clearance: float) -> NDArray[np.bool_]:
        over = altitude - self._formation.below - self._margin >= self._top - 1e-6
        under = altitude + self._formation.above + clearance <= self._bottom + 1e-6
        return np.asarray(~(over | under))

    def _grown(self, altitude: float, clearance: float) -> tuple[bytes, NDArray[Any]]:
        """Return the bodies that count at an ``altitude``, grown by radius and ``clearance``, and a key for them."""
        active = self._active(altitude, clearance)
        radii = self._radii.copy()
        low, high = altitude - self._formation.below, altitude + self._formation.above
        for i in np.flatnonzero(active & self._is_round):  # the widest section at the formation's heights
            middle = (self._top[i] + self._bottom[i]) / 2.0
            beyond = max(low - middle, middle - high, 0.0)
            radii[i] = math.sqrt(max(radii[i] ** 2 - beyond**2, 0.0))
        chosen = radii[active] + self._formation.radius + clearance
        key = active.tobytes() + chosen.tobytes()
        return key, shapely.buffer(self._cores[active], chosen, quad_segs=_SEGMENTS)


def _place(north: float, east: float, down: float) -> tuple[float, float, float]:
    return float(north), float(east), float(down)
