"""Detected points: which are possible, and their places in the world, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.compiled import kernel

_POSE = "Array(float64, 1, 'C', readonly=True)"
"""Type of a part of a pose, which is only read."""


@kernel(
    "Tuple((float64[:, ::1], boolean[::1], float64[::1]))"
    f"(float64[:, ::1], {_POSE}, {_POSE}, float64, float64, float64)"
)
def placed_points(
    body: Array, position: Array, quaternion: Array, cut_range: float, position_sigma: float, attitude_sigma: float
) -> tuple[Array, Mask, Array]:
    """Return points in the world (n, 3), whether they are beyond ``cut_range`` (m) (n,), and their variance (n,).

    Args:
        body: points in the vehicle's frame (n, 3).
        position: of the vehicle (3,), NED.
        quaternion: its attitude, body to world, w first (4,).
        cut_range: distance from which on a point ends the sensor's range.
        position_sigma, attitude_sigma: standard deviations of the pose (m, rad).
    """
    n, (w, x, y, z) = body.shape[0], quaternion
    rotation = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    world, cut, variance = np.empty((n, 3)), np.empty(n, np.bool_), np.empty(n)
    for p in range(n):
        a, b, c = body[p, 0], body[p, 1], body[p, 2]
        distance = math.sqrt(a * a + b * b + c * c)
        for i in range(3):
            world[p, i] = position[i] + (a * rotation[i][0] + b * rotation[i][1] + c * rotation[i][2])
        cut[p] = distance > cut_range
        variance[p] = position_sigma**2 + (attitude_sigma * distance) ** 2
    return world, cut, variance


@kernel("int64[::1](float64[:, ::1], float64[::1], float64)")
def possible_points(body: Array, max_range: Array, factor: float) -> Indices:
    """Return which of the points in the body frame (n, 3) a sensor of ``max_range`` (n,) can have detected.

    Those that are finite, not at its own place, and nearer than ``factor`` times its range (m).
    """
    n = body.shape[0]
    found, count = np.empty(n, np.int64), 0
    for p in range(n):
        distance = math.sqrt(body[p, 0] ** 2 + body[p, 1] ** 2 + body[p, 2] ** 2)
        if math.isfinite(max_range[p]) and 0.0 < distance < factor * max_range[p]:
            found[count] = p
            count += 1
    return found[:count].copy()


@kernel("Tuple((int64[::1], int64[::1], int64[::1]))(int64[::1])")
def grouped(numbers: Indices) -> tuple[Indices, Indices, Indices]:
    """Return the order of ``numbers`` (n,) by which equal ones stand together, each number (G,), and its end (G,).

    Numbers come in the order of their first appearance, equal ones in their own order.
    """
    n = numbers.shape[0]
    group, found, sizes, count = np.empty(n, np.int64), np.empty(n, np.int64), np.zeros(n, np.int64), 0
    for i in range(n):
        g = group[i - 1] if i > 0 and numbers[i] == numbers[i - 1] else 0
        while g < count and found[g] != numbers[i]:
            g += 1
        if g == count:
            found[g] = numbers[i]
            count += 1
        group[i] = g
        sizes[g] += 1
    ends = np.cumsum(sizes[:count])
    order, next_place = np.empty(n, np.int64), ends - sizes[:count]
    for i in range(n):
        order[next_place[group[i]]] = i
        next_place[group[i]] += 1
    return order, found[:count].copy(), ends
