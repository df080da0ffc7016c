"""Segmentation of scans: returns that are near to each other are one cluster."""

import math
from itertools import count

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.scan_assembly import Cluster
from idc_controller.perception.surfaces.points import SurfacePoints

_GAP_MIN = 0.6
"""Gap between returns up to which they are one cluster (m), and in mean distances between rays:"""
_GAP_SPACINGS = 1.5


class Segmentation:
    """Numbers clusters: no two of them have the same number."""

    def __init__(self, spacing: float, cut_range: float) -> None:
        """``spacing``: angle between rays (rad); returns beyond ``cut_range`` (m) are at the end of the range."""
        self._spacing, self._cut_range = spacing, cut_range
        self._numbers = count()

    def frames(self, scans: list[PlacedScan], simultaneous: float) -> list[list[Cluster]]:
        """Return the clusters of scans, oldest first, that are within ``simultaneous`` (s), frame by frame."""
        frames: list[list[Cluster]] = []
        begin = -math.inf
        for scan in scans:
            if not len(scan.returns):
                continue
            if scan.time - begin > simultaneous:
                begin = scan.time
                frames.append([])
            frames[-1] += self._clusters(scan)
        return frames

    def _clusters(self, scan: PlacedScan) -> list[Cluster]:
        points = scan.returns
        distance = np.linalg.norm(points - scan.origin, axis=1)
        gap = np.maximum(_GAP_SPACINGS * self._spacing * distance, _GAP_MIN)
        i, j = cKDTree(points).query_pairs(float(gap.max()), output_type="ndarray").T
        near = np.linalg.norm(points[i] - points[j], axis=1) <= np.minimum(gap[i], gap[j])
        pairs = coo_array((near[near], (i[near], j[near])), shape=(len(points), len(points)))
        found, labels = connected_components(pairs, directed=False)
        order = np.argsort(labels, kind="stable")
        points, distance = points[order], distance[order]
        surface = SurfacePoints(
            scan.time, points, np.tile(scan.origin, (len(points), 1)), distance > self._cut_range, scan.range_sigma,
            scan.position_sigma**2 + (scan.attitude_sigma * distance) ** 2,
        )  # fmt: skip
        ends = np.cumsum(np.bincount(labels, minlength=found)).tolist()
        return [
            Cluster(scan.uav, next(self._numbers), surface, slice(first, last))
            for first, last in zip([0, *ends], ends, strict=False)
        ]
