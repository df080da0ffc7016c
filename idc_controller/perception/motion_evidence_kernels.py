"""Rays through the places where points of a body were, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel


@inlined
def _meeting(
    origin: Array,
    end: Array,
    variance: float,
    places: Array,
    variances: Array,
    normals: Array,
    beside: float,
    sigmas: float,
) -> tuple[bool, bool]:
    """Return whether a ray ends at one of the places, and whether it passes one and ends beyond."""
    x, y, z = end[0] - origin[0], end[1] - origin[1], end[2] - origin[2]
    length = math.sqrt(x * x + y * y + z * z)
    if not 0.0 < length < math.inf:
        return False, False
    x, y, z = x / length, y / length, z / length
    passes = False
    for m in range(places.shape[0]):
        u, v, w = places[m, 0] - origin[0], places[m, 1] - origin[1], places[m, 2] - origin[2]
        along = u * x + v * y + w * z
        if along <= 0.0 or u * u + v * v + w * w - along * along > beside * beside:
            continue
        beyond, noise = length - along, sigmas * math.sqrt(variance + variances[m])
        if abs(beyond) <= noise:
            return True, False
        if passes or beyond <= noise + beside:
            continue
        # A ray so far beside the place meets the surface there so much farther, by its angle to that.
        across = abs(x * normals[m, 0] + y * normals[m, 1] + z * normals[m, 2])
        is_known = normals[m, 0] != 0.0 or normals[m, 1] != 0.0 or normals[m, 2] != 0.0
        passes = not is_known or (beyond - noise) * across > beside * math.sqrt(max(1.0 - across * across, 0.0))
    return False, passes


@kernel(
    "void(float64[::1], float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1], float64[::1],"
    " float64[:, ::1], float64, float64, float64[::1])"
)
def count_rays(
    origin: Array,
    returns: Array,
    free: Array,
    sigmas: Array,
    places: Array,
    variances: Array,
    normals: Array,
    beside: float,
    deviations: float,
    counts: Array,
) -> None:
    """Count the rays of a scan that end where points of a body were, and those that pass through there.

    Args:
        origin: place of the sensor (3,), NED (m).
        returns: ends of the rays that returned (n, 3).
        free: ends of the rays that returned nothing up to there (k, 3).
        sigmas: standard deviations of range (m), position (m) and attitude (rad).
        places: of the points (m, 3).
        variances: of each on any axis (m,) (m2).
        normals: unit normals of the surface at each (m, 3); zero where it is not known: then it is taken to be turned
            by up to 45 deg from a ray.
        beside: distance of a ray from a point up to which it passes through the place of that (m).
        deviations: standard deviations within which it ends there.
        counts: of rays that end there, and that pass (2,), written to.
    """
    counts[:] = 0.0
    if not places.shape[0]:
        return
    middle, radius, level = np.zeros(3), 0.0, 0.0
    for i in range(3):
        middle[i] = places[:, i].mean() - origin[i]
    for m in range(places.shape[0]):
        square = 0.0
        for i in range(3):
            square += (places[m, i] - origin[i] - middle[i]) ** 2
            if i == 1:
                level = max(level, math.sqrt(square) + beside)
        radius = max(radius, math.sqrt(square) + beside)
    distance = math.sqrt(middle[0] ** 2 + middle[1] ** 2 + middle[2] ** 2)
    level_square = level * level * (1.0 + 1e-9)
    is_beside = middle[0] ** 2 + middle[1] ** 2 > level_square
    for r in range(returns.shape[0] + free.shape[0]):
        returned = r < returns.shape[0]
        end = returns[r] if returned else free[r - returns.shape[0]]
        if is_beside:
            # In plan view, where what is upright is small, rays pass it as near or nearer.
            north, east = end[0] - origin[0], end[1] - origin[1]
            across = north * middle[1] - east * middle[0]
            if north * middle[0] + east * middle[1] <= 0.0 or across * across > level_square * (north**2 + east**2):
                continue
        square, along = 0.0, 0.0
        for i in range(3):
            way = end[i] - origin[i]
            square += way * way
            along += way * middle[i]
        # Nearer to the middle than the places' radius; along is in square metres.
        if distance > radius and (along <= 0.0 or (distance**2 - radius**2) * square > along * along):
            continue
        variance = sigmas[1] ** 2 + sigmas[2] ** 2 * square + (sigmas[0] ** 2 if returned else 0.0)
        ends, passes = _meeting(origin, end, variance, places, variances, normals, beside, deviations)
        if ends and returned:
            counts[0] += 1.0
        elif passes:
            counts[1] += 1.0
