"""Free space of the whole formation: its upright bounds against obstacles, altitudes and the area of a fence.

The bounds, a rounded rectangle in plan view, move with the payload's centre and are not turned. The obstacles, by their
upright bounds (a box turned about the vertical, rounded), have closed forms of distance to them, or of a lower bound of
it: a horizontal and a vertical gap, joined by Pythagoras. Every distance is a convex function along a straight line, so
its least value on a segment is found exactly by golden section.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array, Mask
from idc_controller.errors import TrajectoryError
from idc_controller.geometry.free_space_kernels import keep_away
from idc_controller.geometry.shape import Shape

if TYPE_CHECKING:
    pass


from dataclasses import dataclass
from functools import cached_property, reduce
from typing import TYPE_CHECKING

from idc_controller.parameters import SystemParameters

if TYPE_CHECKING:
    import shapely  # takes long to import, spent only where there is a fence


Ring = tuple[tuple[float, float], ...]
"""Corners (north, east) of a polygon, m from home."""


@dataclass(frozen=True)
class FlightArea:
    """Where the payload's centre may be in plan view; its edges belong to it, and it has no top.

    Whoever plans takes walls along its edges for obstacles as well: a path that keeps away from these, and begins
    inside, stays inside.
    """

    boundary: tuple[Ring, ...] = ()
    """Rings about the area: inside is what an odd number of them encloses; none: everywhere."""
    excluded: tuple[Ring, ...] = ()
    """Polygons that must not be entered."""

    def contains(self, places: Array) -> Mask:
        """Return whether the area holds each of ``places`` (P, 2 or 3), NED (m)."""
        import shapely

        north, east = places[:, 0], places[:, 1]
        inside = np.ones(len(places), dtype=bool)
        if self._included is not None:
            inside &= shapely.intersects_xy(self._included, north, east)
        if self.excluded:
            inside &= ~shapely.contains_xy(self._excluded, north, east)
        return inside

    def within(self, region: shapely.Geometry) -> shapely.Geometry:
        """Return the part of a ``region`` in plan view (north, east, m) that lies in the area."""
        included = region if self._included is None else region.intersection(self._included)
        return included.difference(self._excluded)

    def is_hole(self, ring: Ring) -> bool:
        """Return whether one of the rings of the boundary has the area on its outer side."""
        import shapely

        polygon = shapely.Polygon(ring)
        around = (other for other in self.boundary if other != ring)
        return sum(bool(shapely.Polygon(other).contains(polygon)) for other in around) % 2 == 1

    @cached_property
    def _included(self) -> shapely.Geometry | None:
        import shapely

        if not self.boundary:
            return None
        included = reduce(shapely.symmetric_difference, map(shapely.Polygon, self.boundary))
        shapely.prepare(included)
        return included

    @cached_property
    def _excluded(self) -> shapely.Geometry:
        import shapely

        excluded = shapely.union_all([shapely.Polygon(ring) for ring in self.excluded])
        shapely.prepare(excluded)
        return excluded


@dataclass(frozen=True)
class BoundingCylinder:
    """The upright cylinder that holds payload, links and discs, about the payload's centre (m).

    In plan view they lie within a rectangle with rounded corners as well, its edges north and east.
    """

    radius: float
    above: float
    """Height of the highest disc above the payload's centre."""
    below: float
    """Depth of the payload's lowest point below its centre."""
    core: tuple[float, float] = (0.0, 0.0)
    """Half edges of that rectangle, north and east, without its rounding."""
    rounding: float = math.inf
    """Distance from the core to its edge; infinite: only the cylinder counts."""

    def __post_init__(self) -> None:
        for name in ("radius", "above", "below"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) >= 0.0):
                raise TrajectoryError(f"the formation's {name} must be zero or more, not {getattr(self, name)}")

    @classmethod
    def of(cls, parameters: SystemParameters, link_tilt: float = 0.0) -> BoundingCylinder:
        """Return that of the formation at rest, its links tilted together by up to ``link_tilt`` (rad)."""
        swing = parameters.l * math.sin(link_tilt)
        reach = np.linalg.norm(parameters.p[:, :2], axis=1) + swing
        top = parameters.l - parameters.p[:, 2] + parameters.disc_radius * math.sin(link_tilt)
        radius = max(parameters.payload.horizontal_reach, float(reach.max()) + parameters.disc_radius)
        rounding = float(swing.max()) + parameters.disc_radius
        payload = np.abs(parameters.payload.bounds[:, :2]).max(axis=0) - rounding
        north, east = np.maximum(np.abs(parameters.p[:, :2]).max(axis=0), payload).tolist()
        return cls(radius, float(top.max()), parameters.payload.below, (north, east), rounding)


TOUCHING = 1e-6
"""m; a place that keeps the margin to within this keeps it."""


class FreeSpace:
    """Clearance of the formation at places of the payload's centre, (P, 3) NED (m), in free space.

    Args:
        obstacles: (shape, centre (3,)) of each.
        formation: the upright bounds of what must keep away.
        margin: m, the least distance to keep between formation and obstacles.
        lowest, highest: altitudes between which the payload's centre may be (m, up).
        growth: m, by how much each obstacle is to be taken larger; None: not at all.
        area: that must not be left, its edges among the obstacles; None: everywhere.

    Raises:
        TrajectoryError: what is given has no meaning.
    """

    def __init__(
        self,
        obstacles: Sequence[tuple[Shape, ArrayLike]],
        formation: BoundingCylinder,
        margin: float,
        lowest: float,
        highest: float,
        growth: ArrayLike | None = None,
        area: FlightArea | None = None,
    ) -> None:
        if not (math.isfinite(margin) and margin >= 0.0):
            raise TrajectoryError(f"the margin must be zero or more metres, not {margin}")
        if not lowest < highest:
            raise TrajectoryError(f"the highest altitude, {highest:g} m, is not above the lowest, {lowest:g} m")
        self.formation, self.margin, self.lowest, self.highest = formation, margin, lowest, highest
        self.area = area
        self.centres = np.array([centre for _, centre in obstacles], dtype=float).reshape(len(obstacles), 3)
        self.growth = np.zeros(len(obstacles)) if growth is None else np.array(growth, dtype=float)
        if self.growth.shape != (len(obstacles),) or not np.isfinite(self.centres).all():
            raise TrajectoryError("every obstacle needs a finite centre and one growth")
        self.shapes = tuple(shape for shape, _ in obstacles)
        self._bodies = _Bodies.of(self.shapes)
        f = formation
        self._formation = np.array([f.radius, f.above, f.below, *f.core, f.rounding])
        self.lateral_reach = np.array([shape.horizontal_reach for shape, _ in obstacles]) + self.growth
        """Extent of each obstacle from its centre outwards (M,) (m)."""
        self.vertical_reach = self._bodies.half_height + self.growth
        """Extent of each obstacle from its centre up and down (M,) (m)."""

    def clearance(self, places: Array) -> Array:
        """Distance of the formation at each place to each obstacle (P, M); negative inside (m)."""
        return self._bodies.distance(places[:, None] - self.centres, self.formation) - self.growth

    def is_free(self, places: Array) -> Mask:
        """Return the places (P,) at which the formation keeps the margin and all bounds."""
        free = self.within_bounds(places)
        if len(self.centres):
            free &= (self.clearance(places) >= self.margin - TOUCHING).all(axis=1)
        return free

    def free_lattice(self, north: Array, east: Array, down: Array, extra: float) -> Mask:
        """:meth:`is_free`, ``extra`` (m) beyond the margin, at all combinations of (X,), (Y,), (Z,) -> (X, Y, Z)."""
        altitude = (-down >= self.lowest - TOUCHING) & (-down <= self.highest + TOUCHING)
        free = np.broadcast_to(altitude, (len(north), len(east), len(down))).copy()
        keep = self.margin + extra + self.growth - TOUCHING
        around = self.lateral_reach - self.growth + self.formation.radius + keep
        if self.area is not None:
            level = np.stack(np.meshgrid(north, east, indexing="ij"), axis=-1)
            free &= self.area.contains(level.reshape(-1, 2)).reshape(len(north), len(east), 1)
        for m, (x, y, z) in enumerate(self.centres):
            i, j = (
                slice(*np.searchsorted(axis, (place - around[m], place + around[m])))
                for axis, place in ((north, x), (east, y))
            )
            body = _Bodies(self._bodies.sizes[m])
            level = body.level_gaps(north[i, None] - x, east[j] - y, self.formation)[..., None]
            free[i, j] &= _joined(level, body.height_gaps(down - z, self.formation)) >= keep[m] + body.ball
        return free

    def within_bounds(self, places: Array) -> Mask:
        """Return whether the altitude is within its bounds, and the place in the area, at each place (P,)."""
        within = (-places[:, 2] >= self.lowest - TOUCHING) & (-places[:, 2] <= self.highest + TOUCHING)
        return np.asarray(within if self.area is None else within & self.area.contains(places))

    def are_free_segments(self, starts: Array, ends: Array) -> Mask:
        """Return whether the margin and the bounds are kept on the segments from ``starts`` to ``ends`` (E, 3)."""
        free = self.within_bounds(starts) & self.within_bounds(ends)
        free[free] = self.keep_away(starts[free], ends[free], np.full(len(self.centres), self.margin - TOUCHING))
        return np.asarray(free)

    def keep_away(self, starts: Array, ends: Array, least: Array) -> Mask:
        """Return whether the clearance is ``least`` (M,) or more on the segments ``starts`` to ``ends`` (E, 3)."""
        places = np.ascontiguousarray(starts), np.ascontiguousarray(ends)
        return keep_away(*places, least, self.centres, self.growth, self._bodies.sizes, self._formation)


class _Bodies:
    """The obstacles' sizes as arrays: a box with half edges, rounded horizontally or in all directions."""

    def __init__(self, sizes: Array) -> None:
        self.sizes = sizes
        self._half_x, self._half_y, self._half_z, self._upright, self.ball, self._cosine, self._sine = self.sizes.T
        self._turned = bool(np.any(self._sine))

    @classmethod
    def of(cls, shapes: Sequence[Shape]) -> _Bodies:
        """Return those of M ``shapes``."""
        return cls(np.array([shape.upright_bounds for shape in shapes]).reshape(len(shapes), 7))

    @property
    def half_height(self) -> Array:
        """(M,) (m)."""
        return np.asarray(self._half_z + self.ball)

    def distance(self, offsets: Array, formation: BoundingCylinder) -> Array:
        """Distance between bodies (M) and the formation ``offsets`` (..., M, 3) away from them; < 0 inside (m)."""
        level = self.level_gaps(offsets[..., 0], offsets[..., 1], formation)
        return np.asarray(_joined(level, self.height_gaps(offsets[..., 2], formation)) - self.ball)

    def level_gaps(self, x: Array, y: Array, formation: BoundingCylinder) -> Array:
        """Horizontal part (..., M) of the distance to the bodies less their ``ball`` (m)."""
        c, s = np.abs(self._cosine), np.abs(self._sine)
        half_x, half_y = formation.core
        along = np.maximum(
            np.abs(x) - half_x - self._half_x * c - self._half_y * s,
            np.abs(y) - half_y - self._half_x * s - self._half_y * c,
        )
        if self._turned:
            x, y = self._cosine * x + self._sine * y, self._cosine * y - self._sine * x
        x, y = np.abs(x) - self._half_x, np.abs(y) - self._half_y
        along = np.maximum(along, np.maximum(x - half_x * c - half_y * s, y - half_x * s - half_y * c))
        circle = _joined(x, y) - formation.radius
        return np.asarray(np.maximum(circle, along - formation.rounding) - self._upright)

    def height_gaps(self, z: Array, formation: BoundingCylinder) -> Array:
        """Vertical part (..., M) of the distance to the bodies less their ``ball`` (m)."""
        # The formation reaches from `below` under the payload's centre (down is positive) to `above` over it.
        z = z + (formation.below - formation.above) / 2.0
        return np.asarray(np.abs(z) - self._half_z - (formation.below + formation.above) / 2.0)


def _joined(a: Array, b: Array) -> Array:
    """Distance to the region where both gaps, at right angles, are below zero; negative inside."""
    outside = np.sqrt(np.maximum(a, 0.0) ** 2 + np.maximum(b, 0.0) ** 2)
    return np.asarray(outside + np.minimum(np.maximum(a, b), 0.0))
