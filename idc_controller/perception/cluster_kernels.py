"""Whether the sides of clusters are in sight, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array1, Array2, Indices, Indices1, Mask1
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.voxel_kernels import Rays

#: Angle to a neighbouring ray (mean angles between rays): beyond the nearest ones, before those behind them.
_NEIGHBOURS = 1.8


@inlined
def _length(x: float, y: float, z: float) -> float:
    return math.sqrt(x * x + y * y + z * z)


@kernel
def bounded_clusters(rays: Rays, labels: Indices1, count: int, spacing: float, gap: float) -> Mask1:
    """Return of which clusters (count,) both sides are in sight: the rays beside them end well behind, or nowhere.

    Only to the left and right: what is higher than the field of view has sides as well.

    Args:
        rays: of the scan.
        labels: cluster of each of its returns (n,), -1: none.
        count: number of clusters.
        spacing: mean angle between rays (rad).
        gap: depth from which on one return is behind another (m).
    """
    origin, returns, free, _ = rays
    n, m = returns.shape[0], free.shape[0]
    directions, ranges = np.empty((n + m, 3)), np.empty(n + m)
    for j in range(n + m):
        for k in range(3):
            directions[j, k] = (returns[j, k] if j < n else free[j - n, k]) - origin[k]
        ranges[j] = _length(directions[j, 0], directions[j, 1], directions[j, 2])
        for k in range(3):
            directions[j, k] /= max(ranges[j], 1e-9)
    is_open, sides = np.zeros(count, np.bool_), np.zeros((count, 2), np.bool_)
    limit = (_NEIGHBOURS * spacing) ** 2
    for i in range(n):
        label = labels[i]
        if label < 0 or is_open[label]:
            continue
        x, y, z = directions[i]
        level = math.sqrt(x * x + y * y)
        if level < 1e-3:
            is_open[label] = True
            continue
        u, v = -y / level, x / level
        for j in range(n + m):
            a, b, c = directions[j, 0] - x, directions[j, 1] - y, directions[j, 2] - z
            square = a * a + b * b + c * c
            if square > limit or (j < n and labels[j] == label):
                continue
            lateral = a * u + b * v
            if 2.0 * lateral * lateral < square:
                continue
            if j < n and ranges[j] < ranges[i] + gap:
                is_open[label] = True
                break
            sides[label, 1 if lateral > 0.0 else 0] = True
    return ~is_open & sides[:, 0] & sides[:, 1]


@inlined
def _root(parents: Indices, i: int) -> int:
    while parents[i] != i:
        parents[i] = parents[parents[i]]
        i = parents[i]
    return i


@kernel
def connected(points: Array2, gaps: Array1) -> Indices1:
    """Return the number of the cluster of each point (n,), counted from 0 in the order of their first points.

    Two points are connected if they are as near as both of their ``gaps`` (n,) (m) allow (single linkage).
    """
    n = points.shape[0]
    parents = np.arange(n)
    for i in range(n):
        for j in range(i):
            gap = min(gaps[i], gaps[j])
            square = 0.0
            for k in range(3):
                square += (points[i, k] - points[j, k]) ** 2
            if square <= gap * gap:
                a, b = _root(parents, i), _root(parents, j)
                parents[max(a, b)] = min(a, b)
    labels, count = np.empty(n, np.int64), 0
    for i in range(n):
        if parents[i] == i:
            labels[i] = count
            count += 1
        else:
            labels[i] = labels[_root(parents, i)]
    return labels
