"""Points within reach of a range sensor, and what it measures of them, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.compiled import kernel
from idc_controller.geometry.pole import RIM, SIDE
from idc_controller.geometry.sphere import RING
from idc_controller.geometry.visibility_kernels import points_of_pole, points_of_sphere


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


@kernel(
    "Tuple((int64[::1], float64[:, ::1]))"
    "(npy_rng, float64[:, ::1], float64[:, ::1], int64, int64, float64[::1], float64[::1])"
)
def scanned(
    generator: np.random.Generator, centres: Array, forms: Array, begin: int, end: int, pose: Array, limits: Array
) -> tuple[Indices, Array]:
    """Return what a sensor measures of spheres and poles: row of each point's body (n,), points in the body frame.

    The same points and random numbers as body by body: a turn of the pattern for each that may be in reach, then an
    error for each of its points.

    Args:
        generator: of the sensor.
        centres: of all bodies (B, 3), NED (m).
        forms: of all bodies (B, 3): bounding radius, radius, half height (m), that of a sphere 0.
        begin, end: rows that are scanned.
        pose: of the sensor (7,): position, attitude body to world.
        limits: its range, least distance, and standard deviation of the noise (3,) (m).

    Returns:
        Rows (n,), and points (n, 3) (m), nan for those too near.
    """
    x, y, z = pose[0], pose[1], pose[2]
    reach, nearest, noise = limits[0], limits[1], limits[2]
    ring, side = RING.copy(), SIDE.copy()
    most = side.shape[0] + 5
    rows, points, count = np.empty((end - begin) * most, np.int64), np.empty(((end - begin) * most, 3)), 0
    for b in range(begin, end):
        a, e, d = x - centres[b, 0], y - centres[b, 1], z - centres[b, 2]
        if math.sqrt(a * a + e * e + d * d) > reach + forms[b, 0]:
            continue
        radius, half_height = forms[b, 1], forms[b, 2]
        turn = generator.uniform(0.0, math.pi / 3.0)
        if half_height > 0.0:
            visible = points_of_pole(a, e, d, radius, half_height, reach, side, RIM)
        else:
            visible = points_of_sphere(a, e, d, radius, turn, ring)
        rays = rays_in_reach(visible, a, e, d, reach + 1e-9)
        errors = noise * generator.standard_normal(rays.shape[0])
        n = rays.shape[0]
        points[count : count + n] = measured(rays, errors, pose[3], pose[4], pose[5], pose[6], nearest)
        rows[count : count + n] = b
        count += n
    return rows[:count].copy(), points[:count].copy()
