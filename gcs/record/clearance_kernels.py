"""Clearance, compiled: the distance between the formation's hull and a convex obstacle at every time of a flight.

Gilbert-Johnson-Keerthi on support functions: the point of the difference of two convex bodies that is nearest to the
origin, from one simplex of its points to the next (Gilbert, Johnson and Keerthi 1988; the nearest point of a simplex
by the signs of Ericson, Real-Time Collision Detection, 5.1).
"""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel

TOLERANCE = 1e-8
"""m, by which a distance may be too large."""
_MOST_STEPS = 200


@inlined
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@inlined
def _turned(rotation: Array, x: Array) -> Array:
    """Return ``rotation @ x``."""
    return np.array([_dot(rotation[0], x), _dot(rotation[1], x), _dot(rotation[2], x)])


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
        along = _dot(vertices[i], u)
        if along > farthest:
            best, farthest = i, along
    point = _turned(rotation, vertices[best])
    for i in range(len(discs)):
        n = axes[i]
        across = d - _dot(n, d) * n
        length = math.sqrt(_dot(across, across))
        along = _dot(discs[i], d) + radius * length
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
        along = _dot(corners[i], u)
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


@inlined
def _nearest_of_triangle(a: Array, b: Array, c: Array, weights: Array) -> None:
    """Write the weights (3,) of the point of a triangle that is nearest to the origin."""
    ab, ac = b - a, c - a
    d1, d2 = -_dot(ab, a), -_dot(ac, a)
    d3, d4 = -_dot(ab, b), -_dot(ac, b)
    d5, d6 = -_dot(ab, c), -_dot(ac, c)
    vc, vb, va = d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4
    weights[:] = 0.0
    if d1 <= 0.0 and d2 <= 0.0:
        weights[0] = 1.0
    elif d3 >= 0.0 and d4 <= d3:
        weights[1] = 1.0
    elif d6 >= 0.0 and d5 <= d6:
        weights[2] = 1.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        weights[1] = d1 / (d1 - d3)
        weights[0] = 1.0 - weights[1]
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        weights[2] = d2 / (d2 - d6)
        weights[0] = 1.0 - weights[2]
    elif va <= 0.0 and d4 >= d3 and d5 >= d6:
        weights[2] = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        weights[1] = 1.0 - weights[2]
    else:
        whole = va + vb + vc
        weights[1], weights[2] = vb / whole, vc / whole
        weights[0] = 1.0 - weights[1] - weights[2]


@inlined
def _nearest_of_simplex(simplex: Array, count: int, weights: Array) -> bool:
    """Write the weights (4,) of the point of ``simplex`` (4, 3), of whose points ``count`` are in use, nearest to 0.

    Return True if the origin lies within four points.
    """
    weights[:] = 0.0
    if count == 1:
        weights[0] = 1.0
    elif count == 2:
        edge = simplex[1] - simplex[0]
        length = _dot(edge, edge)
        share = -_dot(simplex[0], edge) / length if length > 0.0 else 0.0
        weights[1] = min(max(share, 0.0), 1.0)
        weights[0] = 1.0 - weights[1]
    elif count == 3:
        _nearest_of_triangle(simplex[0], simplex[1], simplex[2], weights[:3])
    else:
        return _nearest_of_tetrahedron(simplex, weights)
    return False


@inlined
def _nearest_of_tetrahedron(simplex: Array, weights: Array) -> bool:
    """Write the weights (4,) of the nearest point of four points (4, 3); return True if the origin lies within."""
    least, within = math.inf, True
    part = np.empty(3)
    for opposite in range(4):
        i, j, k = (opposite + 1) % 4, (opposite + 2) % 4, (opposite + 3) % 4
        a, b, c = simplex[i], simplex[j], simplex[k]
        normal = np.cross(b - a, c - a)
        here, there = -_dot(normal, a), _dot(normal, simplex[opposite] - a)
        if here * there > 0.0:  # the origin is on the side of the fourth point
            continue
        within = False
        _nearest_of_triangle(a, b, c, part)
        point = part[0] * a + part[1] * b + part[2] * c
        distance = _dot(point, point)
        if distance < least:
            least = distance
            weights[:] = 0.0
            weights[i], weights[j], weights[k] = part[0], part[1], part[2]
    return within


@kernel(
    "float64[::1](float64[:, ::1], float64[:, :, ::1], float64[:, :, ::1], float64[:, :, ::1], float64, "
    "float64[:, ::1], float64[::1], float64[:, ::1], float64[:, ::1])"
)
def clearance(
    vertices: Array,
    rotations: Array,
    discs: Array,
    axes: Array,
    radius: float,
    corners: Array,
    box: Array,
    rotation: Array,
    offsets: Array,
) -> Array:
    """Return the distance (T,) (m) between hull and obstacle; 0 where they meet, NaN where a state is not finite.

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
    """
    steps = len(offsets)
    distances = np.full(steps, np.nan)
    simplex, weights = np.zeros((4, 3)), np.zeros(4)
    for t in range(steps):
        known = math.isfinite(np.sum(offsets[t]) + np.sum(rotations[t]) + np.sum(discs[t]) + np.sum(axes[t]))
        if not known:
            continue
        v = -offsets[t]
        if _dot(v, v) == 0.0:
            v[0] = 1.0
        count, distance = 0, math.inf
        for _ in range(_MOST_STEPS):
            w = _formation_support(vertices, rotations[t], discs[t], axes[t], radius, -v)
            w -= _obstacle_support(corners, box, rotation, offsets[t], v)
            if _dot(v, v) - _dot(v, w) <= TOLERANCE * distance and count > 0:
                break
            simplex[count] = w
            count += 1
            if _nearest_of_simplex(simplex, count, weights):
                distance = 0.0
                break
            v = np.zeros(3)
            used = 0
            for i in range(count):
                if weights[i] > 0.0:
                    v += weights[i] * simplex[i]
                    simplex[used] = simplex[i]
                    used += 1
            count = used
            nearer = math.sqrt(_dot(v, v))
            if nearer <= TOLERANCE or nearer >= distance:
                distance = min(nearer, distance)
                break
            distance = nearer
        distances[t] = max(distance - box[4], 0.0)
    return distances
