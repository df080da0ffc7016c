"""Clusters: returns of one vehicle's scan that are near to each other, and which obstacle each of them is of."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Wall
from idc_controller.perception.cluster_kernels import bounded_clusters, connected
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.range_sensors import RayPattern
from idc_controller.perception.surfaces.points import SurfacePoints

_GAP_MIN = 0.6
"""Gap between returns up to which they are one cluster (m), and in mean distances between rays:"""
_GAP_SPACINGS = 1.5
_COMPRESSION = np.array([1.0, 1.0, 1.0 / 3.0])
"""Of distances along each axis: what is thin and upright is hit at few heights."""


class Cluster(NamedTuple):
    """Returns of one vehicle that are near to each other: a part of a scan."""

    uav: int
    number: int
    scan: SurfacePoints
    part: slice = slice(None)
    unexplained: int = 0
    """Returns of it that nothing standing explains."""
    explained: int = 0
    """Returns of it where something has stood before."""

    @property
    def surface_points(self) -> SurfacePoints:
        """The points with all that is known of them."""
        return self.scan[self.part]

    @property
    def points(self) -> Array:
        """The points (n, 3) (NED, m)."""
        return self.scan.points[self.part]

    @property
    def pose_variance(self) -> Array:
        """Variance of each point from the sensor's pose, on every axis (n,) (m2)."""
        return self.scan.pose_variance[self.part]

    def shifted(self, by: Array) -> Cluster:
        """Return the cluster with its points shifted ``by`` (3,) (NED, m), detected from the same place."""
        own = self.surface_points
        return self._replace(scan=replace(own, points=own.points + by), part=slice(None))


class Segmentation:
    """Numbers clusters: no two of them have the same number."""

    def __init__(self, pattern: RayPattern, cut_range: float, size: float) -> None:
        """Set what counts.

        Args:
            pattern: of the rays.
            cut_range: returns beyond are at the end of the range (m).
            size: horizontal extent up to which a cluster is small (m).
        """
        self._spacing, self._cut_range, self._size = pattern.spacing, cut_range, size
        # Beyond the last rays, more of a body may lie out of view.
        elevations = pattern.elevation_min + pattern.spacing, pattern.elevation_max - pattern.spacing
        self._lowest, self._highest = np.sin(elevations).tolist()
        self._numbers = count()

    def candidates(
        self, scan: PlacedScan, rows: Mask, unexplained: Mask, explained: Mask
    ) -> tuple[list[Cluster], set[int]]:
        """Return the clusters of the returns ``rows`` (n,), and the numbers of those whose motion can be seen.

        They are mostly ``unexplained`` (n,) by what stands, or small with both sides in sight.
        ``explained`` (n,): where something has stood before.
        """
        order, clusters = self._segmented(scan, rows)
        if not clusters:
            return clusters, set()
        indices = np.flatnonzero(rows)[order]
        starts = [cluster.part.start for cluster in clusters]
        sizes = np.diff([*starts, len(order)])
        of_parts = (np.add.reduceat(of[indices], starts, dtype=int).tolist() for of in (unexplained, explained))
        clusters = [
            c._replace(unexplained=unknown, explained=known)
            for c, unknown, known in zip(clusters, *of_parts, strict=True)
        ]
        labels = np.full(len(scan.returns), -1)
        labels[indices] = np.repeat(np.arange(len(clusters)), sizes)
        bounded = bounded_clusters(scan.rays, labels, len(clusters), self._spacing, _GAP_MIN)
        level = clusters[0].scan.points[:, :2]
        spans = np.maximum.reduceat(level, starts) - np.minimum.reduceat(level, starts)
        can_be_seen = bounded & (spans.max(axis=1) <= self._size)
        seen = {
            c.number
            for c, is_seen, size in zip(clusters, can_be_seen.tolist(), sizes.tolist(), strict=True)
            if is_seen or 2 * c.unexplained > size
        }
        return clusters, seen

    def clusters(self, scan: PlacedScan, rows: Mask) -> list[Cluster]:
        """Return the clusters of those returns of a scan that ``rows`` (n,) names."""
        return self._segmented(scan, rows)[1]

    def of_bodies(self, scan: PlacedScan, rows: Mask, bodies: Indices) -> list[tuple[Cluster, int]]:
        """Return the clusters of the returns ``rows`` (n,) that are of one body each, with its number.

        ``bodies``: numbers of the returns' bodies (n,).
        """
        order, clusters = self._segmented(scan, rows)
        ordered = bodies[rows][order]
        parts = [(cluster, ordered[cluster.part]) for cluster in clusters]
        return [(cluster, int(of[0])) for cluster, of in parts if (of == of[0]).all()]

    def _segmented(self, scan: PlacedScan, rows: Mask) -> tuple[Indices, list[Cluster]]:
        points = scan.returns[rows]
        if not len(points):
            return np.empty(0, dtype=np.int64), []
        distance = scan.distances[rows]
        gap = np.maximum(_GAP_SPACINGS * self._spacing * distance, _GAP_MIN)
        labels = connected(points * _COMPRESSION, gap)
        order = np.argsort(labels, kind="stable")
        points, distance = points[order], distance[order]
        height = (points - scan.origin) @ scan.up
        cut = (distance > self._cut_range) | (height < self._lowest * distance) | (height > self._highest * distance)
        origins = np.tile(scan.origin, (len(points), 1))
        surface = SurfacePoints(scan.time, points, origins, cut, scan.range_sigma, scan.pose_variance[rows][order])
        ends = np.cumsum(np.bincount(labels, minlength=1)).tolist()
        return order, [
            Cluster(scan.uav, next(self._numbers), surface, slice(first, last))
            for first, last in zip([0, *ends], ends, strict=False)
        ]


def frames(scans: list[PlacedScan], simultaneous: float) -> Iterator[list[PlacedScan]]:
    """Yield scans, oldest first, that are within ``simultaneous`` (s), frame by frame."""
    frame: list[PlacedScan] = []
    for scan in scans:
        if frame and scan.time - frame[0].time > simultaneous:
            yield frame
            frame = []
        frame.append(scan)
    if frame:
        yield frame


def shifted(scan: PlacedScan, by: Array) -> PlacedScan:
    """Return a scan made ``by`` (3,) (NED, m) from where it was."""
    return replace(scan, origin=scan.origin + by, returns=scan.returns + by, free_rays=scan.free_rays + by)


_FAR = 1e3


def gating_shape(shape: Shape, wall_extension: float) -> Shape:
    """Return a tracked shape as large as it may prove to be; ``wall_extension`` (m) beyond what was detected."""
    if not isinstance(shape, Wall):
        return shape
    x, y, z = shape.size
    return Wall((x, y + wall_extension, z + wall_extension), shape.yaw)


def associate(clusters: Sequence[Cluster], distances: Array, gates: Array) -> list[int | None]:
    """Return the body of every cluster, None if it belongs to none.

    Args:
        clusters: of one frame; those of one vehicle are different bodies.
        distances: mean distances (clusters, bodies) (m).
        gates: of the bodies (bodies,) (m).
    """
    result: list[int | None] = [None] * len(clusters)
    if distances.shape[1] == 0:
        return result
    cost = np.where(distances < gates, distances, _FAR)
    rows_of_uav: dict[int, list[int]] = defaultdict(list)
    for row, cluster in enumerate(clusters):
        rows_of_uav[cluster.uav].append(row)
    near = np.flatnonzero(cost.min(axis=0) < _FAR / 2.0)
    cost = cost[:, near]
    for of_uav in rows_of_uav.values():
        own = cost[of_uav]
        assigned, columns = linear_sum_assignment(own)
        is_near = own[assigned, columns] < _FAR / 2.0
        for i, body in zip(assigned[is_near].tolist(), near[columns[is_near]].tolist(), strict=True):
            result[of_uav[i]] = body
    return result
