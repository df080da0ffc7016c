"""Standing map: what range sensors have hit, kept until it is looked through, and what they have seen free.

Sparse voxels, each of which holds the rays that passed it and, where it was hit, a surface element: mean, covariance
and bounds of its points, with their variance at the pose of that moment (as in NDT occupancy maps: Saarinen et al., "3D
normal distributions transform occupancy maps", 2013). A voxel is never freed by time nor by rays that pass beside its
points or along their surface, but by rays through the place of its points that end beyond, in as many scans as their
own record of hits and passes makes improbable while they stand.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.estimation.health.chi_squared import upper_quantile
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception import map_query_kernels as queries
from idc_controller.perception import upright_box_kernels as boxes
from idc_controller.perception.carving_kernels import carve, followed_rays, release
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.return_kernels import add_returns, capacity_for, enter_pages
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.sight_kernels import first_hidden, unseen_cells
from idc_controller.perception.voxel_kernels import (
    BLOCKS,
    BORN,
    CELLS,
    CHANGE,
    COLUMNS,
    EDGE,
    HITS,
    KEY,
    MEAN,
    NUMBER,
    PAGE_BLOCKS,
    PAGES,
    SURFACE,
    USED,
    Rays,
    Rules,
    Voxels,
)

_FIRST_PAGES, _FIRST_BLOCKS, _FIRST_ELEMENTS = 16, 4096, 4096


def no_voxels() -> Voxels:
    """Return the voxels of a map without scans."""
    return Voxels(
        table=np.full((4 * _FIRST_PAGES, 2), -1),
        pages=np.full((_FIRST_PAGES, PAGE_BLOCKS), -1, dtype=np.int32),
        blocks=np.zeros((_FIRST_BLOCKS, 4), dtype=np.int64),
        cells=np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.uint8),
        links=np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.int32),
        elements=np.zeros((_FIRST_ELEMENTS, COLUMNS)),
        counts=np.zeros(5, dtype=np.int64),
    )


def reserved(voxels: Voxels, size: float, rays: Rays) -> Voxels:
    """Return ``voxels`` of that ``size`` (m) with capacity for all that a scan can add."""
    blocks, pages = capacity_for(rays, EDGE * size)
    number = voxels.counts.tolist()
    if number[PAGES] + pages > len(voxels.pages):
        grown = _grown(voxels.pages, number[PAGES] + pages, -1)
        voxels = voxels._replace(pages=grown, table=np.full((4 << (len(grown) - 1).bit_length(), 2), -1))
        enter_pages(voxels.table, voxels.pages, voxels.blocks, number[PAGES])
    if (rows := number[BLOCKS] + blocks) > len(voxels.blocks):
        grown_of = {name: _grown(getattr(voxels, name), rows) for name in ("blocks", "cells", "links")}
        voxels = voxels._replace(**grown_of)
    if (rows := number[USED] + len(rays.returns)) > len(voxels.elements):
        voxels = voxels._replace(elements=_grown(voxels.elements, rows))
    return voxels


def _grown(rows: NDArray[Any], count: int, value: int = 0) -> NDArray[Any]:
    """Return ``rows`` with ``count`` of them or more, at least twice as many as before."""
    shape = max(count, 2 * len(rows)), *rows.shape[1:]
    # Zeros take no memory until they are written to.
    grown = np.full(shape, value, dtype=rows.dtype) if value else np.zeros(shape, dtype=rows.dtype)
    grown[: len(rows)] = rows
    return grown


_ALL = np.empty(0, dtype=np.int64)


class SurfaceElements(NamedTuple):
    """What is known of the points in n voxels. SI units, NED."""

    indices: Indices
    """Index of each in the map (n,): used again once it is freed."""
    numbers: Indices
    """Serial number (n,): never used again."""
    means: Array
    """Mean of the points (n, 3)."""


class StandingMap:
    """Occupied, seen free and unknown space. Times are the team's (s); rays are counted until a voxel is seen free."""

    def __init__(self, settings: StandingMapSettings = StandingMapSettings()) -> None:
        self.settings = s = settings
        self._voxels = no_voxels()
        scans = np.arange(1.0, s.memory + 1.0)
        # All of so many scans report a surface short of where it is with the stated probability. Inwards, not more than
        # one: not all points need lie on one surface.
        self._sigmas = np.maximum(-ndtri(s.uncovered ** (1.0 / scans)), -1.0)
        self._scan = 0
        self._rules = Rules(
            size=s.voxel, free_passes=s.free_passes, sigmas_beyond=s.sigmas_beyond, incidence=s.incidence_min,
            prior=np.array([s.prior_hits, s.prior_passes]),
            evidence=np.array([s.evidence_of_hit, s.evidence_max, *s.evidence_of_pass]),
            memory=s.memory, settling=s.settling_time, tolerance=s.tolerance,
            chi_squared=float(upper_quantile(s.false_alarm, 3)),
            sight_width=s.sight_width, sight_rays=s.sight_rays,
        )  # fmt: skip

    def add(self, scan: PlacedScan, moving: Mask | None = None) -> None:
        """Add one scan; ``moving``: returns (n,) of what is known to move, which leave no points."""
        rules, free = self._rules, followed_rays(self._voxels, scan.rays, self._scan, self.settings.exploring_stride)
        rays = scan.rays._replace(free=free)
        taken = np.ones(len(rays.returns), dtype=bool) if moving is None else ~moving
        self._scan += 1
        self._voxels = reserved(self._voxels, rules.size, rays)
        add_returns(self._voxels, rules, rays, taken, scan.time, float(self._scan))
        carve(self._voxels, rules, rays, float(self._scan))

    def normals(self, points: Array) -> Array:
        """Return the unit normals of what stands at ``points`` (n, 3) -> (n, 3); zero where they are not known."""
        points = np.ascontiguousarray(points, dtype=float).reshape(-1, 3)
        return queries.normals_at(self._voxels, points, self.settings.voxel)

    def release(self, bodies: Sequence[tuple[Shape, Array, float]], gap: float) -> None:
        """Remove the points within ``gap`` (m) of bodies that move, unless they have stood for longer than these.

        Each body is a shape, its centre (3,) (NED, m) and the time (s) since which it has been seen: what was hit more
        than the settling time before is not of it.
        """
        voxels, indices = self._voxels, self._used()
        if not len(indices) or not bodies:
            return
        means = voxels.elements[indices, MEAN : MEAN + 3]
        shapes, centres, first = zip(*bodies, strict=True)
        distance = Bodies(shapes).distance(means, np.array(centres))
        since = np.array(first) - self.settings.settling_time
        is_its = (distance <= gap) & (voxels.elements[indices, BORN] >= since[:, None])
        release(voxels, indices[is_its.any(axis=0)], self.settings.free_passes)

    def unseen(self, path: Array, body: Array, most: int) -> tuple[Indices, Array]:
        """Return up to ``most`` cells on the way of a body along its ``path`` (P, 3) that were not seen free.

        Of each the index of the last place before it (n,), and its middle (n, 3) (NED, m). ``body`` (4,): see
        :func:`~idc_controller.perception.sight_kernels.unseen_cells`.
        """
        found = np.empty((most, 4))
        count = unseen_cells(self._voxels, self._rules, np.ascontiguousarray(path), body, found)
        return found[:count, 0].astype(np.int64), found[:count, 1:]

    def first_hidden(self, path: Array, sensors: Array, heights: Array) -> int:
        """See :func:`~idc_controller.perception.sight_kernels.first_hidden`."""
        path = np.ascontiguousarray(path)
        return int(first_hidden(self._voxels, path, sensors, heights, self.settings.voxel))

    @property
    def is_empty(self) -> bool:
        """Return whether no scan has been added."""
        return self._scan == 0

    @property
    def cell(self) -> float:
        """Edge of the cells in which space is seen (m)."""
        return self.settings.sight_width * self.settings.voxel

    def is_standing(self, points: Array, since: float = math.inf) -> Mask:
        """Return whether the voxels with ``points`` (n, 3) hold what stands, and was first hit before ``since`` (s)."""
        points = np.ascontiguousarray(points, dtype=float).reshape(-1, 3)
        return queries.stands_at(self._voxels, points, self.settings.voxel, since)

    def unexplained(self, scan: PlacedScan) -> Mask:
        """Return the returns (n,) of a scan, before it is added, that standing points and noise do not explain.

        All that lies within their noise was seen free, and they are farther from all standing points than their noise
        and those points' spread explain, at the stated false-alarm probability.
        """
        return queries.unexplained_returns(self._voxels, self._rules, scan.rays)

    def take_changed_blocks(self) -> tuple[Indices, Indices, Mask]:
        """Return the blocks that changed since the last call.

        Numbers (n,); first voxels of each (n, 3), which has ``EDGE`` along each edge; whether points came or went (n,),
        not only free voxels.
        """
        count = int(self._voxels.counts[BLOCKS])
        changes = self._voxels.blocks[:count, CHANGE]
        changed = np.flatnonzero(changes)
        surface = changes[changed] & SURFACE != 0
        changes[changed] = 0
        return changed, self._corners(changed), np.asarray(surface)

    def elements_of(self, blocks: Indices) -> SurfaceElements:
        """Return the surface elements in some ``blocks`` (n,)."""
        found = (self._voxels.links[blocks].ravel() >> 8).astype(np.int64) - 1
        return self.elements(found[found >= 0])

    def elements(self, indices: Indices) -> SurfaceElements:
        """Return the surface elements with these ``indices`` (n,)."""
        means = self._voxels.elements[indices, MEAN : MEAN + 3]
        return SurfaceElements(indices, self.numbers(indices), means)

    def are_current(self, indices: Indices, numbers: Indices) -> Mask:
        """Return whether elements are still those with these serial ``numbers`` (n,)."""
        return np.asarray(self._voxels.elements[indices, NUMBER] == numbers)

    def gaps(self, box: Array, most: int, among: Indices = _ALL) -> Array:
        """Return the middles (n, 3) of up to ``most`` gaps in a box: seen free, with no point in the 27 voxels about.

        ``box`` (8,): see :mod:`idc_controller.perception.upright_box_kernels`; ``among``: blocks that are searched.
        """
        return boxes.gaps_within(self._voxels, self._rules, among, box, most)

    def cover(self, indices: Indices, bounds: Array) -> None:
        """Write the bounds of the true surface at elements ``indices`` (n,) into ``bounds`` (E, 6) (m)."""
        boxes.cover_points(self._voxels, indices, self._sigmas, self.settings.tolerance, bounds)

    def nearest_owners(self, indices: Indices, owners: Indices) -> Indices:
        """Return for elements ``indices`` (n,) the owner of the nearest that has one within the bridged gap, or -1.

        ``owners``: owner and serial number of each element (E, 2); of another serial number: none.
        """
        reach = math.ceil(self.settings.bridged_gap / self.settings.voxel)
        return queries.nearest_owners(self._voxels, indices, owners, reach)

    def hits(self, indices: Indices) -> float:
        """Return the sum of the scans that hit elements ``indices`` (n,)."""
        return float(self._voxels.elements[indices, HITS].sum())

    def numbers(self, indices: Indices) -> Indices:
        """Return the serial numbers of elements ``indices`` (n,)."""
        return np.asarray(self._voxels.elements[indices, NUMBER].astype(np.int64))

    @property
    def element_count(self) -> int:
        """Elements ever used: their indices are smaller."""
        return int(self._voxels.counts[USED])

    def _used(self) -> Indices:
        """Return the indices of the elements that are no spare ones."""
        return np.flatnonzero(self._voxels.elements[: self.element_count, NUMBER] > 0.0)

    def _corners(self, blocks: Indices) -> Indices:
        """Return the first voxels (n, 3) of ``blocks`` (n,)."""
        keys = self._voxels.blocks[blocks, KEY]
        return np.asarray(((keys[:, None] >> (42, 21, 0) & 0x1FFFFF) - (1 << 20)) * EDGE)
