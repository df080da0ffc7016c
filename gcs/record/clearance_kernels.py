"""Clearance, compiled: the distance between the formation's hull and the nearest of convex obstacles over a flight.

Gilbert-Johnson-Keerthi on support functions, as in :mod:`idc_controller.geometry.gjk_kernels`, with the discs as they
are and obstacles of any convex shape.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Array3
from idc_controller.compiled import inlined, kernel
from idc_controller.geometry.gjk_kernels import dot, nearest_on_simplex

TOLERANCE = 1e-8
"""m, by which a distance may be too large."""
_MOST_STEPS = 200


@inlined
def _turned(rotation: Array, x: Array) -> Array:
    """Return ``rotation @ x``."""
    return np.array([dot(rotation[0], x), dot(rotation[1], x), dot(rotation[2], x)])


@inlined
def _turned_back(rotation: Array, x: Array) -> Array:
    """Return ``rotation.T @ x``."""
    return np.asarray(rotation[0] * x[0] + rotation[1] * x[1] + rotation[2] * x[2])


@inlined
def _formation_support(vertices: Array, rotation: Array, discs: Array, axes: Array, radius: float, d: Array) -> Array:
    """Return the point (3,) of the hull that lies farthest along ``d`` (3,), about the payload (m)."""
    u = _turned_back(rotation, d)
    best, farthest = 0, -math.inf
    for i in range(len(vertices)):
        along = dot(vertices[i], u)
        if along > farthest:
            best, farthest = i, along
    point = _turned(rotation, vertices[best])
    for i in range(len(discs)):
        n = axes[i]
        across = d - dot(n, d) * n
        across -= dot(n, across) * n  # along the disc's axis, what is left is rounding that leads out of its plane
        length = math.sqrt(dot(across, across))
        along = dot(discs[i], d) + radius * length
        if along > farthest:
            farthest = along
            point = discs[i] + (radius / length * across if length > 0.0 else 0.0 * across)
    return point


@inlined
def _obstacle_support(corners: Array, box: Array, rotation: Array, offset: Array, d: Array) -> Array:
    """Return the point (3,) of the obstacle without its ball that lies farthest along ``d`` (3,), about the payload."""
    u = _turned_back(rotation, d)
    best, farthest = 0, -math.inf
    for i in range(len(corners)):
        along = dot(corners[i], u)
        if along > farthest:
            best, farthest = i, along
    point = corners[best].copy()
    for i in range(3):
        point[i] += math.copysign(box[i], u[i])
    lateral = math.hypot(u[0], u[1])
    if lateral > 0.0:
        point[0] += box[3] * u[0] / lateral
        point[1] += box[3] * u[1] / lateral
    return offset + _turned(rotation, point)


@kernel
def lower_clearance(
    vertices: Array2,
    rotations: Array3,
    discs: Array3,
    axes: Array3,
    radius: float,
    corners: Array2,
    box: Array1,
    rotation: Array2,
    offsets: Array2,
    way: Array1,
    least: Array1,
) -> None:
    """Lower ``least`` (T,) (m) to the distance between hull and obstacle, 0 where they meet, where that is less.

    Where a state is not finite it stays.

    Args:
        vertices: corners (V, 3) of the payload in its frame (m).
        rotations: payload to world (T, 3, 3).
        discs: centres (T, N, 3) of the discs about the payload, world axes (m).
        axes: their unit normals (T, N, 3), world axes.
        radius: of the discs (m).
        corners: of the obstacle (C, 3) in its frame (m), of which it is the hull,
        box: widened by half edges x, y, z, by a radius about its z axis and by a ball (5,) (m).
        rotation: obstacle to world (3, 3).
        offsets: centres (T, 3) of the obstacle about the payload, world axes (m).
        way: by how much the distance may have changed at most since the first row (T,) (m); NaN: not known.
        least: changed in place.
    """
    simplex, v, reach = np.zeros((4, 3)), np.zeros(3), -math.inf
    for t in range(len(offsets)):
        if reach - way[t] >= least[t]:
            continue
        known = math.isfinite(np.sum(offsets[t]) + np.sum(rotations[t]) + np.sum(discs[t]) + np.sum(axes[t]))
        if not known:
            continue
        # Begin where the last row has ended: from row to row, bodies hardly move.
        if dot(v, v) == 0.0:
            v = -offsets[t]
        if dot(v, v) == 0.0:
            v[0] = 1.0
        count, distance = 0, math.inf
        for _ in range(_MOST_STEPS):
            w = _formation_support(vertices, rotations[t], discs[t], axes[t], radius, -v)
            w -= _obstacle_support(corners, box, rotation, offsets[t], v)
            if dot(v, v) - dot(v, w) <= TOLERANCE * distance and count > 0:
                break
            for i in range(3):
                simplex[count, i] = w[i]
            count = nearest_on_simplex(simplex, count + 1, v)
            if count == 4:
                distance = 0.0
                break
            nearer = math.sqrt(dot(v, v))
            if nearer <= TOLERANCE or nearer >= distance:
                distance = min(nearer, distance)
                break
            distance = nearer
        distance = max(distance - box[4], 0.0)
        reach = distance + way[t]
        least[t] = min(least[t], distance)
