"""Rays of a scan: places of the returns on them, and ends of those without a return, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array1, Array2, Indices1, Mask1
from idc_controller.compiled import kernel

_ON_RAY = 2e-4
"""Angle (rad) within which a return lies on a ray; far more than the rounding of the wire's 32-bit floats."""


@kernel
def rays_of_returns(points: Array2, directions: Array2) -> tuple[Indices1, Array1]:
    """Return the ray next to each return (n,), and the angle between them (n,) (rad).

    Args:
        points: returns in the body frame (n, 3), finite and not 0 (m).
        directions: of the rays (m, 3), unit vectors, sorted by their third component, the largest first, in which they
            are evenly distributed.
    """
    n, m = points.shape[0], directions.shape[0]
    rays, angles = np.empty(n, np.int64), np.empty(n)
    low = directions[0, 2]
    step = (directions[m - 1, 2] - low) / max(m - 1, 1)
    for i in range(n):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        distance = math.sqrt(x * x + y * y + z * z)
        guess = 0 if m == 1 else round((z / distance - low) / step)
        first, last = max(guess - 1, 0), min(guess + 2, m)
        for _attempt in range(2):  # where no ray of that elevation fits, look at all
            least = math.inf
            for j in range(first, last):
                u, v, w = (
                    x - distance * directions[j, 0],
                    y - distance * directions[j, 1],
                    z - distance * directions[j, 2],
                )
                apart = math.sqrt(u * u + v * v + w * w) / distance
                if apart < least:
                    least, rays[i] = apart, j
            if least < _ON_RAY:
                break
            first, last = 0, m
        angles[i] = 2.0 * math.asin(min(0.5 * least, 1.0))
    return rays, angles


@kernel
def repeated_returns(points: Array2, rays: Indices1, count: int) -> Mask1:
    """Return which returns (n, 3) repeat the one before on their ray (n,), of ``count`` rays, to the digit."""
    n = points.shape[0]
    last, repeated = np.full(count, -1, np.int64), np.zeros(n, np.bool_)
    for i in range(n):
        k = last[rays[i]]
        if k >= 0 and points[i, 0] == points[k, 0] and points[i, 1] == points[k, 1] and points[i, 2] == points[k, 2]:
            repeated[i] = True
        last[rays[i]] = i
    return repeated


@kernel
def placed_returns(
    points: Array2, directions: Array2, place: Array1, rotation: Array2
) -> tuple[Array2, Indices1, Array1]:
    """Return the places of returns (k, 3) (NED, m), repeated ones once, their rays (k,), and how far they are off them.

    That is the mean square of their distances from the rays (m2), and the largest angle from one (rad) (2,).

    Args:
        points: returns in the body frame (n, 3) (m), finite and not 0.
        directions: of the rays (m, 3) as in :func:`rays_of_returns`.
        place: of the vehicle (3,), NED (m).
        rotation: of the vehicle (3, 3), body to world.
    """
    rays, angles = rays_of_returns(points, directions)
    repeated = repeated_returns(points, rays, directions.shape[0])
    places, off, count = np.empty(points.shape), np.zeros(2), 0
    for i in range(points.shape[0]):
        if repeated[i]:
            continue
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for k in range(3):
            places[count, k] = place[k] + (rotation[k, 0] * x + rotation[k, 1] * y + rotation[k, 2] * z)
        rays[count] = rays[i]
        off[0] += angles[i] * angles[i] * (x * x + y * y + z * z)
        off[1] = max(off[1], angles[i])
        count += 1
    if count:
        off[0] /= count
    return places[:count].copy(), rays[:count].copy(), off


@kernel
def free_ends(
    directions: Array2, rays: Indices1, place: Array1, rotation: Array2, reach: float, height: float
) -> Array2:
    """Return the ends (k, 3) (NED, m) of the rays without a return.

    Args:
        directions: of all rays (m, 3), unit vectors in the body frame.
        rays: those with a return (n,).
        place: of the vehicle (3,), NED (m).
        rotation: of the vehicle (3, 3), body to world.
        reach: range, at which they end (m).
        height: above the ground, at which they end as well (m).
    """
    m = directions.shape[0]
    is_free, ends, count = np.ones(m, np.bool_), np.empty((m, 3)), 0
    for i in range(rays.shape[0]):
        is_free[rays[i]] = False
    above = -place[2] - height
    for i in range(m):
        if not is_free[i] or above <= 0.0:
            continue
        x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
        down = rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2] * z
        length = min(reach, above / down) if down > 0.0 else reach
        for k in range(3):
            ends[count, k] = place[k] + length * (rotation[k, 0] * x + rotation[k, 1] * y + rotation[k, 2] * z)
        count += 1
    return ends[:count].copy()
