"""The area that the formation must not leave, in plan view: what a fence includes, less what it excludes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, reduce
from typing import TYPE_CHECKING

import numpy as np

from idc_controller.arrays import Array, Mask

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
