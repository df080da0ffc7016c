"""Points within reach of a range sensor, and what it measures of them, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import kernel


@kernel("float64[:, ::1](float64[:, ::1], float64, float64, float64, float64)")
def rays_in_reach(points: Array, x: float, y: float, z: float, reach: float) -> Array:
    """Return the rays (m, 3) (m) from a sensor at (x, y, z) to those of ``points`` (n, 3) that are in ``reach`` (m)."""
    rays, count = np.empty(points.shape), 0
    for p in range(points.shape[0]):
        a, b, c = points[p, 0] - x, points[p, 1] - y, points[p, 2] - z
        if math.sqrt(a * a + b * b + c * c) <= reach:
            rays[count, 0], rays[count, 1], rays[count, 2] = a, b, c
            count += 1
    return rays[:count].copy()


@kernel("float64[:, ::1](float64[:, ::1], float64[::1], float64, float64, float64, float64, float64)")
def measured(rays: Array, errors: Array, w: float, i: float, j: float, k: float, nearest: float) -> Array:
    """Return what a sensor measures of points: their places in the body frame (n, 3) (m), nan for those too near.

    Args:
        rays: from the sensor to the points in the world (n, 3), NED (m).
        errors: of the distances (n,) (m).
        w, i, j, k: attitude of the sensor, body to world.
        nearest: distance (m) below which it measures nothing.
    """
    found = np.full(rays.shape, math.nan)
    for p in range(rays.shape[0]):
        a, b, c = rays[p, 0], rays[p, 1], rays[p, 2]
        distance = math.sqrt(a * a + b * b + c * c)
        if distance >= nearest:
            # v + 2 w (v x u) + 2 u x (u x v), u the vector part: the rotation by the conjugate.
            s, t, r = 2.0 * (b * k - c * j), 2.0 * (c * i - a * k), 2.0 * (a * j - b * i)
            scale = max(1.0 + errors[p] / distance, 0.0)
            found[p, 0] = scale * (a + w * s + t * k - r * j)
            found[p, 1] = scale * (b + w * t + r * i - s * k)
            found[p, 2] = scale * (c + w * r + s * j - t * i)
    return found
