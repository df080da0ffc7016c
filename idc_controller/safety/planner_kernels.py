"""Kernels of the planner: obstacles within reach of the hull, and the rows of the barrier. SI, NED."""

import math

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.compiled import kernel


@kernel(
    "Tuple((int64[::1], float64[:, ::1], float64[:, :, ::1], float64[:, :, ::1]))"
    "(float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1], float64[:, ::1], float64[::1], boolean[::1], float64)"
)
def within_reach(
    points: Array,
    position: Array,
    centres: Array,
    growth: Array,
    reach: Array,
    upright: NDArray[np.bool_],
    limit: float,
) -> tuple[NDArray[np.int64], Array, Array, Array]:
    """Return the obstacles that may come nearer to the hull than ``limit`` (m) at some stage.

    Hull and obstacles are bounded by balls, upright obstacles and the hull beside them by upright cylinders.

    Args:
        points: of the hull about the payload's centre (K + 1, P, 3) (m).
        position: of the payload's centre (K + 1, 3) (m).
        centres: of the obstacles (O, K + 1, 3) (m).
        growth: of the obstacles (O, K + 1) (m).
        reach: of the obstacles from their centres, of upright ones in plan view (O,) (m).
        upright: whether obstacles are bounded by cylinders (O,).
        limit: (m).

    Returns:
        The obstacles' indices (F,), the distance between the bounds (F, K + 1) (m), the centres from the payload's
        (F, K + 1, 3) (m), and the unit vectors from the middle of the hull to them, level for upright obstacles.
    """
    number, stages = len(centres), len(points)
    middle, level, whole = np.empty((stages, 3)), np.zeros(stages), np.zeros(stages)
    for k in range(stages):
        for axis in range(3):
            least = most = points[k, 0, axis]
            for point in points[k]:
                least, most = min(least, point[axis]), max(most, point[axis])
            middle[k, axis] = (most + least) / 2.0
        for point in points[k]:
            square = (point[0] - middle[k, 0]) ** 2 + (point[1] - middle[k, 1]) ** 2
            level[k] = max(level[k], math.sqrt(square))
            whole[k] = max(whole[k], math.sqrt(square + (point[2] - middle[k, 2]) ** 2))
    found, away = np.empty(number, dtype=np.int64), np.empty((number, stages))
    count = 0
    for i in range(number):
        is_near = False
        for k in range(stages):
            x = centres[i, k, 0] - position[k, 0] - middle[k, 0]
            y = centres[i, k, 1] - position[k, 1] - middle[k, 1]
            z = 0.0 if upright[i] else centres[i, k, 2] - position[k, 2] - middle[k, 2]
            distance = math.sqrt(x * x + y * y + z * z)
            away[count, k] = distance
            is_near |= distance - (level[k] if upright[i] else whole[k]) - reach[i] - growth[i, k] < limit
        if is_near:
            found[count] = i
            count += 1
    offsets, normals = np.empty((count, stages, 3)), np.empty((count, stages, 3))
    for j in range(count):
        i = found[j]
        for k in range(stages):
            for axis in range(3):
                offsets[j, k, axis] = centres[i, k, axis] - position[k, axis]
                normals[j, k, axis] = (offsets[j, k, axis] - middle[k, axis]) / max(away[j, k], 1e-9)
            if upright[i]:
                normals[j, k, 2] = 0.0
            away[j, k] -= (level[k] if upright[i] else whole[k]) + reach[i]
    return found[:count].copy(), away[:count].copy(), offsets, normals


@kernel(
    "float64[:, :, ::1](float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1], "
    "float64[:, ::1])"
)
def barrier_values(
    normals: Array, payload: Array, discs: Array, lever: Array, position: Array, acceleration: Array
) -> Array:
    """Return h of payload and discs along the planes of each of S separations (S, 2, K + 1) (m).

    Args:
        normals: unit vectors from hull to obstacle (S, K + 1, 3).
        payload, discs: constants of h (S, K + 1) (m).
        lever: of the discs, by the payload's level acceleration (K + 1,) (s2).
        position, acceleration: of the payload's centre (K + 1, 3).
    """
    number, stages = payload.shape
    values = np.empty((number, 2, stages))
    for j in range(number):
        for k in range(stages):
            x, y, z = normals[j, k]
            along = x * position[k, 0] + y * position[k, 1] + z * position[k, 2]
            shear = lever[k] * (x * acceleration[k, 0] + y * acceleration[k, 1])
            values[j, 0, k] = payload[j, k] - along
            values[j, 1, k] = discs[j, k] - along - shear
    return values


@kernel("float64[:, ::1](float64[:, :, ::1], float64[::1], float64[:, :, ::1], float64[:, ::1], int64)")
def barrier_rows(normals: Array, lever: Array, response: Array, operator: Array, degree: int) -> Array:
    """Return G (2 K S, 3 knots) of the barrier of S separations: payload, then discs of each, at the stages 1 .. K.

    Args:
        normals: unit vectors from hull to obstacle (S, K + 1, 3).
        lever: of the discs, by the payload's level acceleration (K + 1,) (s2).
        response: of position to snap at the stages to the knots (K + 1, 5, knots).
        operator: of the barrier (K, K + 1); row k - 1 reaches back from column k by ``degree`` columns at most.
        degree: of the barrier.
    """
    number, stages, knots = len(normals), len(operator), response.shape[2]
    rows = np.zeros((2 * stages * number, 3 * knots))
    for j in range(number):
        for k in range(1, stages + 1):
            payload, discs = rows[2 * stages * j + k - 1], rows[2 * stages * j + stages + k - 1]
            for i in range(max(k - degree, 0), k + 1):
                for axis in range(3):
                    share = operator[k - 1, i] * normals[j, i, axis]
                    sheared = share * lever[i] if axis < 2 else 0.0
                    for knot in range(knots):
                        along = share * response[i, 0, knot]
                        payload[axis * knots + knot] += along
                        discs[axis * knots + knot] += along + sheared * response[i, 2, knot]
    return rows
