"""Distances to rounded boxes, compiled: spheres, poles, walls, capsules and boxes in one formula.

A body is a row of 14 numbers: half edges x, y, z, radial and ball (m) of its
:class:`~idc_controller.geometry.shape.RoundedBox`, then its rotation to the world, row by row.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Array3, Indices1
from idc_controller.compiled import inlined, kernel


@inlined
def distance_to(bodies: Array, b: int, x: float, y: float, z: float) -> float:
    """Return the signed distance (m) of a point about the centre of body ``b`` of ``bodies`` (B, 14), world axes."""
    u = bodies[b, 5] * x + bodies[b, 8] * y + bodies[b, 11] * z
    v = bodies[b, 6] * x + bodies[b, 9] * y + bodies[b, 12] * z
    w = abs(bodies[b, 7] * x + bodies[b, 10] * y + bodies[b, 13] * z) - bodies[b, 2]
    beyond = max(w, 0.0)
    if bodies[b, 0] == 0.0 and bodies[b, 1] == 0.0:
        u = math.hypot(u, v) - bodies[b, 3]
        inside = min(max(u, w), 0.0)
        u = max(u, 0.0)
        return float(math.sqrt(u * u + beyond * beyond) + inside - bodies[b, 4])
    u, v = abs(u) - bodies[b, 0], abs(v) - bodies[b, 1]
    inside = min(max(max(u, v), w), 0.0)
    u, v = max(u, 0.0), max(v, 0.0)
    return float(math.sqrt(u * u + v * v + beyond * beyond) + inside - bodies[b, 4])


@kernel
def distances_of_offsets(bodies: Array2, offsets: Array3) -> Array2:
    """Return signed distances (B, n) (m) of points (B, n, 3) about the centres of ``bodies`` (B, 14), world axes."""
    count, n = offsets.shape[0], offsets.shape[1]
    distance = np.empty((count, n))
    for b in range(count):
        for i in range(n):
            distance[b, i] = distance_to(bodies, b, offsets[b, i, 0], offsets[b, i, 1], offsets[b, i, 2])
    return distance


@kernel
def distances_of_points(bodies: Array2, reach: Array1, centres: Array2, points: Array2, far: float) -> Array2:
    """Return signed distances (B, n) (m) of ``points`` (n, 3) to ``bodies`` (B, 14) at ``centres`` (B, 3), world.

    Those that are surely above ``far`` (m), of bodies within upright cylinders of radius ``reach`` (B,) (m), are inf.
    """
    count, n = centres.shape[0], points.shape[0]
    distance = np.empty((count, n))
    for b in range(count):
        limit = (far + reach[b]) ** 2
        for i in range(n):
            x, y, z = points[i, 0] - centres[b, 0], points[i, 1] - centres[b, 1], points[i, 2] - centres[b, 2]
            distance[b, i] = math.inf if x * x + y * y > limit else distance_to(bodies, b, x, y, z)
    return distance


@kernel
def mean_distances_of_groups(
    bodies: Array2, reach: Array1, centres: Array2, points: Array2, starts: Indices1, far: float
) -> Array2:
    """Return the mean distance of the points of G groups from the surfaces of B bodies (G, B) (m), inf without points.

    Args:
        bodies: (B, 14).
        reach: radius of the upright cylinder that holds each of them (B,) (m).
        centres: of them (B, 3), world (m).
        points: of all groups, one group after the other (n, 3), world (m).
        starts: index of the first point of each group, then n (G + 1,).
        far: distances that are surely above this (m) are inf.
    """
    groups, count = starts.shape[0] - 1, bodies.shape[0]
    mean = np.full((groups, count), math.inf)
    for g in range(groups):
        first, size, spread = starts[g], starts[g + 1] - starts[g], 0.0
        if size == 0:
            continue
        x, y = points[first, 0], points[first, 1]
        for i in range(first, starts[g + 1]):
            spread = max(spread, (points[i, 0] - x) ** 2 + (points[i, 1] - y) ** 2)
        spread = math.sqrt(spread)
        for b in range(count):
            cx, cy, cz = centres[b, 0], centres[b, 1], centres[b, 2]
            if (x - cx) ** 2 + (y - cy) ** 2 > (far + spread + reach[b]) ** 2:
                continue
            total = 0.0
            for i in range(first, starts[g + 1]):
                total += abs(distance_to(bodies, b, points[i, 0] - cx, points[i, 1] - cy, points[i, 2] - cz))
            mean[g, b] = total / size
    return mean
