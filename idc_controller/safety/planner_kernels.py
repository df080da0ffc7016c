"""Kernels of the planner: obstacles within reach of the hull, and the rows of the barrier. SI, NED."""

import math

import numpy as np

from idc_controller.arrays import Array1, Array2, Array3, Indices1, Mask1
from idc_controller.compiled import kernel


@kernel
def within_reach(
    points: Array3,
    position: Array2,
    centres: Array3,
    growth: Array2,
    reach: Array1,
    upright: Mask1,
    limit: float,
) -> tuple[Indices1, Array2, Array3, Array3]:
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


@kernel
def barrier_planes(
    normals: Array3,
    centres: Array3,
    growth: Array2,
    bodies: Array2,
    supports: Array2,
    vertices: Array2,
    hover_offsets: Array2,
    lengths: Array1,
    disc_radius: float,
    g: float,
    margin: float,
    uav_margin: float,
    acceleration: Array2,
) -> tuple[Array2, Array2, Array1]:
    """Return the constants of h of payload and discs (S, K + 1) (m) and the lever of the discs (K + 1,) (s2).

    Args:
        normals: unit vectors from hull to obstacle of S separations (S, K + 1, 3).
        centres: of the obstacles (S, K + 1, 3) (m).
        growth: of the obstacles (S, K + 1) (m).
        bodies: obstacles that are rounded boxes (S, 14), see :mod:`idc_controller.geometry.distance_kernels`.
        supports: of all others: the largest ``-normal . y`` over the body (S, K + 1) (m); of rounded boxes zero.
        vertices: of the payload (V, 3) (m).
        hover_offsets: UAVs from the payload's centre in hover (N, 3) (m).
        lengths: of the links (N,) (m).
        disc_radius: (m).
        g: gravity (m/s2).
        margin: between payload and obstacle (m).
        uav_margin: what the discs have to keep beyond it (m).
        acceleration: of the payload (K + 1, 3).
    """
    number, stages = growth.shape
    payload, discs, lever = np.empty((number, stages)), np.empty((number, stages)), np.empty(stages)
    for k in range(stages):
        lever[k] = lengths[0] / max(g - acceleration[k, 2], 0.2 * g)
        # The discs lie about normal to the thrust; a little is added for what they do beyond that.
        north, east, down = acceleration[k, 0], acceleration[k, 1], acceleration[k, 2] - g
        thrust = math.sqrt(north * north + east * east + down * down)
        for j in range(number):
            x, y, z = normals[j, k, 0], normals[j, k, 1], normals[j, k, 2]
            u = bodies[j, 5] * x + bodies[j, 8] * y + bodies[j, 11] * z
            v = bodies[j, 6] * x + bodies[j, 9] * y + bodies[j, 12] * z
            w = bodies[j, 7] * x + bodies[j, 10] * y + bodies[j, 13] * z
            support = bodies[j, 0] * abs(u) + bodies[j, 1] * abs(v) + bodies[j, 2] * abs(w)
            support += bodies[j, 3] * math.sqrt(u * u + v * v) + bodies[j, 4] + supports[j, k]
            along = x * centres[j, k, 0] + y * centres[j, k, 1] + z * centres[j, k, 2]
            surface = along - support - growth[j, k] - margin
            reach = -math.inf
            for corner in vertices:
                reach = max(reach, x * corner[0] + y * corner[1] + z * corner[2])
            payload[j, k] = surface - reach
            reach = -math.inf
            for offset in hover_offsets:
                reach = max(reach, x * offset[0] + y * offset[1] + z * offset[2])
            across = (x * north + y * east + z * down) / thrust
            flat = math.sqrt(max(1.0 - across * across, 0.0)) + 0.1
            discs[j, k] = surface - uav_margin - (reach + disc_radius * min(flat, 1.0))
    return payload, discs, lever


@kernel
def barrier_values(
    normals: Array3, payload: Array2, discs: Array2, lever: Array1, position: Array2, acceleration: Array2
) -> Array3:
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


@kernel
def barrier_rows(normals: Array3, lever: Array1, response: Array3, operator: Array2, degree: int) -> Array2:
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
