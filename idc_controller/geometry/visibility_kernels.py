"""Points of spheres and poles that a range sensor hits, compiled: about the centre of the body, NED (m)."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import kernel


@kernel("float64[:, ::1](float64, float64, float64, float64, float64, float64[::1])")
def points_of_sphere(x: float, y: float, z: float, radius: float, turn: float, shares: Array) -> Array:
    """Return the points (n, 3) of a sphere of ``radius`` (m) that a sensor at (x, y, z) hits, the nearest first.

    None from inside. The ring of rays, at ``shares`` (n - 1,) of the radius off the axis, is turned by ``turn`` (rad).
    """
    distance = math.sqrt(x * x + y * y + z * z)
    if distance <= radius:
        return np.empty((0, 3))
    e = np.array([-x / distance, -y / distance, -z / distance])
    # Two directions across the line of sight.
    least = 0
    for k in range(1, 3):
        if abs(e[k]) < abs(e[least]):
            least = k
    a = -e[least] * e
    a[least] += 1.0
    a /= math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    b = np.array([e[1] * a[2] - e[2] * a[1], e[2] * a[0] - e[0] * a[2], e[0] * a[1] - e[1] * a[0]])
    points = np.empty((shares.shape[0] + 1, 3))
    for p in range(points.shape[0]):
        share = 0.0 if p == 0 else shares[p - 1]
        sine = share * radius / distance
        cosine = math.sqrt(1.0 - sine * sine)
        bearing = turn + (p - 1) * math.pi / 3.0
        across, up = sine * math.cos(bearing), sine * math.sin(bearing)
        length = distance * cosine - radius * math.sqrt(1.0 - share * share)
        points[p, 0] = x + length * (cosine * e[0] + across * a[0] + up * b[0])
        points[p, 1] = y + length * (cosine * e[1] + across * a[1] + up * b[1])
        points[p, 2] = z + length * (cosine * e[2] + across * a[2] + up * b[2])
    return points


@kernel("float64[:, ::1](float64, float64, float64, float64, float64, float64, float64[:, ::1], float64)")
def points_of_pole(
    x: float, y: float, z: float, radius: float, half_height: float, reach: float, side: Array, rim: float
) -> Array:
    """Return the points (n, 3) of a pole that a sensor of that ``reach`` (m) at (x, y, z) hits, the nearest first.

    Args:
        x, y, z: place of the sensor.
        radius, half_height: of the pole (m).
        reach: range of the sensor (m).
        side: rays at the side (s, 2): share of the radius to the right; share of the visible length up (1), down (-1).
        rim: share of the radius for points on the end.
    """
    distance = math.hypot(x, y)
    points, count = np.empty((side.shape[0] + 5, 3)), 0
    if distance > radius:
        north, east = -x / distance, -y / distance
        for k in range(side.shape[0]):
            share, along = side[k, 0], side[k, 1]
            sine = share * radius / distance
            cosine = math.sqrt(1.0 - sine * sine)
            flat = distance * cosine - radius * math.sqrt(1.0 - share * share)
            if flat > reach:
                continue
            extent = math.sqrt(reach * reach - flat * flat)
            top, bottom = max(-half_height, z - extent), min(half_height, z + extent)
            if top > bottom:
                continue
            nearest = min(max(z, top), bottom)
            sign = math.copysign(1.0, along)
            points[count, 0] = x + flat * (cosine * north - sine * east)
            points[count, 1] = y + flat * (cosine * east + sine * north)
            points[count, 2] = nearest + along * ((top if along > 0.0 else bottom) - nearest) * sign
            count += 1
    if abs(z) > half_height:  # the end is visible, too
        end = math.copysign(half_height, z)
        inward = min(1.0, rim * radius / distance) if distance > 0.0 else 0.0
        points[count, 0], points[count, 1], points[count, 2] = x * inward, y * inward, end
        count += 1
        for k in range(4):
            bearing = math.pi / 4.0 + k * math.pi / 2.0
            points[count, 0] = rim * radius * math.cos(bearing)
            points[count, 1] = rim * radius * math.sin(bearing)
            points[count, 2] = end
            count += 1
    return points[:count].copy()
