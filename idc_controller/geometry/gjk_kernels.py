"""Distance between a convex hull of points and a rounded box, compiled: the algorithm of Gilbert, Johnson and Keerthi.

The point nearest to the origin is sought in the difference of the two bodies: on the simplex of up to four of its
points, which moves towards the origin with the support of both (van den Bergen, "Collision Detection in Interactive 3D
Environments", 2003; nearest points of simplices: Ericson, "Real-Time Collision Detection", 2005).
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array2, Array3, Indices1, Mask1, Mask2
from idc_controller.compiled import inlined, kernel

_TIGHT, _TIGHT_ROUND = 1e-13, 1e-9
"""Gap between distance and its lower bound, over the distance, at which the search ends; of poles, which are round."""
_CERTAIN = 1e-7
"""Gap (m) up to which a distance counts as found."""
_CONTACT = 1e-5
"""Distance (m) between hull and core of the body below which they count as overlapping."""
_MOST_STEPS = 80


@inlined
def _support(
    points: Array, bodies: Array, b: int, x: float, y: float, z: float, v: Array, simplex: Array, at: int
) -> None:
    """Write the point of body less hull that is farthest against ``v`` (3,) into row ``at`` of ``simplex``."""
    best, largest = 0, -math.inf
    for i in range(points.shape[0]):
        along = points[i, 0] * v[0] + points[i, 1] * v[1] + points[i, 2] * v[2]
        if along > largest:
            best, largest = i, along
    # In the body's own frame.
    p = -(bodies[b, 5] * v[0] + bodies[b, 8] * v[1] + bodies[b, 11] * v[2])
    q = -(bodies[b, 6] * v[0] + bodies[b, 9] * v[1] + bodies[b, 12] * v[2])
    r = -(bodies[b, 7] * v[0] + bodies[b, 10] * v[1] + bodies[b, 13] * v[2])
    level = math.sqrt(p * p + q * q)
    share = bodies[b, 3] / level if level > 0.0 else 0.0
    u = math.copysign(bodies[b, 0], p) + share * p
    w = math.copysign(bodies[b, 1], q) + share * q
    t = math.copysign(bodies[b, 2], r)
    simplex[at, 0] = x + bodies[b, 5] * u + bodies[b, 6] * w + bodies[b, 7] * t - points[best, 0]
    simplex[at, 1] = y + bodies[b, 8] * u + bodies[b, 9] * w + bodies[b, 10] * t - points[best, 1]
    simplex[at, 2] = z + bodies[b, 11] * u + bodies[b, 12] * w + bodies[b, 13] * t - points[best, 2]


@inlined
def dot(a: Array, b: Array) -> float:
    """Return the dot product of two vectors (3,)."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@inlined
def _copy(a: Array, b: Array) -> None:
    """Write a vector (3,) into another one."""
    for i in range(3):
        b[i] = a[i]


@inlined
def _nearest_on_edge(a: Array, b: Array, v: Array) -> int:
    """Write the point of an edge nearest to the origin into ``v`` (3,); return the bits of the ends it lies between."""
    along = 0.0
    square = 0.0
    for i in range(3):
        along -= a[i] * (b[i] - a[i])
        square += (b[i] - a[i]) ** 2
    if along <= 0.0:
        _copy(a, v)
        return 1
    if along >= square:
        _copy(b, v)
        return 2
    for i in range(3):
        v[i] = a[i] + along / square * (b[i] - a[i])
    return 3


@inlined
def _nearest_on_triangle(a: Array, b: Array, c: Array, v: Array) -> int:
    """Write the point of a triangle nearest to the origin into ``v`` (3,); return the bits of its corners about it."""
    ab, ac = b - a, c - a
    d1, d2 = -dot(ab, a), -dot(ac, a)
    d3, d4 = -dot(ab, b), -dot(ac, b)
    d5, d6 = -dot(ab, c), -dot(ac, c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    nx, ny, nz = ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]
    square = nx * nx + ny * ny + nz * nz
    if va > 0.0 and vb > 0.0 and vc > 0.0 and square > 0.0:
        along = (a[0] * nx + a[1] * ny + a[2] * nz) / square
        v[0], v[1], v[2] = along * nx, along * ny, along * nz
        return 7
    other = np.empty(3)
    bits = _nearest_on_edge(a, b, v)
    least = dot(v, v)
    found = _nearest_on_edge(a, c, other)
    if dot(other, other) < least:
        least, bits = dot(other, other), (found & 1) | (found & 2) << 1
        _copy(other, v)
    found = _nearest_on_edge(b, c, other)
    if dot(other, other) < least:
        bits = found << 1
        _copy(other, v)
    return bits


@inlined
def nearest_on_simplex(simplex: Array, count: int, v: Array) -> int:
    """Write the point nearest to the origin into ``v`` (3,) and keep the rows about it; return how many.

    Four of them: the origin lies within.
    """
    bits = 1
    if count == 1:
        _copy(simplex[0], v)
    elif count == 2:
        bits = _nearest_on_edge(simplex[0], simplex[1], v)
    elif count == 3:
        bits = _nearest_on_triangle(simplex[0], simplex[1], simplex[2], v)
    else:
        bits, least = 15, math.inf
        other = np.empty(3)
        for left_out in range(4):
            i, j, k = (left_out + 1) % 4, (left_out + 2) % 4, (left_out + 3) % 4
            a, ab, ac = simplex[i], simplex[j] - simplex[i], simplex[k] - simplex[i]
            nx, ny, nz = ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]
            d = simplex[left_out]
            beyond = (d[0] - a[0]) * nx + (d[1] - a[1]) * ny + (d[2] - a[2]) * nz
            if beyond * -(a[0] * nx + a[1] * ny + a[2] * nz) > 0.0:
                continue
            found = _nearest_on_triangle(a, simplex[j], simplex[k], other)
            if dot(other, other) < least:
                least = dot(other, other)
                bits = (found & 1) << i | (found >> 1 & 1) << j | (found >> 2 & 1) << k
                _copy(other, v)
    kept = 0
    for i in range(count):
        if bits >> i & 1:
            _copy(simplex[i], simplex[kept])
            kept += 1
    return kept


@inlined
def _distance(points: Array, bodies: Array, b: int, offset: Array, v: Array) -> float:
    """Return the distance (m) between a hull and the core of a body; -1 where they overlap or it is not found.

    ``v`` (3,) is a direction from hull to body, and then the shortest way from one to the other (m).
    """
    x, y, z = offset[0], offset[1], offset[2]
    simplex, before = np.empty((4, 3)), np.empty(3)
    _support(points, bodies, b, x, y, z, v, simplex, 0)
    _copy(simplex[0], v)
    count, square, gap = 1, dot(v, v), math.inf
    for _ in range(_MOST_STEPS):
        if square < _CONTACT * _CONTACT:
            return -1.0
        _support(points, bodies, b, x, y, z, v, simplex, count)
        gap = square - dot(v, simplex[count])
        if gap <= (_TIGHT if bodies[b, 3] == 0.0 else _TIGHT_ROUND) * square:
            break
        _copy(v, before)
        count = nearest_on_simplex(simplex, count + 1, v)
        if count == 4:
            return -1.0
        now = dot(v, v)
        if now >= square:
            _copy(before, v)
            break
        square = now
    distance = math.sqrt(square)
    return distance if gap <= _CERTAIN * distance else -1.0


@kernel
def measure_distances(
    points: Array3,
    indices: Indices1,
    offsets: Array3,
    bounds: Array2,
    normals: Array3,
    growth: Array2,
    bodies: Array2,
    rounded: Mask1,
    least: float,
    limit: float,
) -> tuple[Array2, Mask2]:
    """Return the signed distances (F, K) (m) of F bodies from a hull at its stages, and where they are missing (F, K).

    They are missing where the hull overlaps the core of the body, and where the body is no rounded box. ``normals``
    are set where the distance is measured.

    Args:
        points: of the hull (K, P, 3) (m).
        indices: of the F bodies among all B (F,).
        offsets: their centres from the origin of the points (F, K, 3) (m).
        bounds: lower bounds of the distances (F, K) (m).
        normals: unit vectors about from hull to body (F, K, 3); then along the shortest way.
        growth: of all bodies (B, K) (m).
        bodies: all bodies (B, 14), see :mod:`idc_controller.geometry.distance_kernels`.
        rounded: whether they are rounded boxes (B,).
        least: stands for a bound below it, where nothing is measured (m).
        limit: from this bound on, beyond the growth, nothing is measured (m).
    """
    distances, missing = np.maximum(bounds, least), np.zeros(bounds.shape, dtype=np.bool_)
    v = np.empty(3)
    for f in range(indices.shape[0]):
        b = indices[f]
        for k in range(points.shape[0]):
            if bounds[f, k] - growth[b, k] >= limit:
                continue
            distance = -1.0
            if rounded[b]:
                _copy(normals[f, k], v)
                distance = _distance(points[k], bodies, b, offsets[f, k], v)
            missing[f, k] = distance < 0.0
            if missing[f, k]:
                continue
            distances[f, k] = distance - bodies[b, 4]
            for axis in range(3):
                normals[f, k, axis] = v[axis] / distance
    return distances, missing
