"""First hits of rays from one place on bodies and on the ground, compiled.

Spheres, poles, walls, boxes and capsules are rows as in :mod:`idc_controller.geometry.distance_kernels`; other convex
bodies are the planes of their faces.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Indices1
from idc_controller.compiled import inlined, kernel

_SECTORS = 64
"""Number of sectors about the vertical by which rays are sorted."""
_SLACK = 1e-9
"""By which what holds a body is widened for rounding errors: share of its radius, and m."""


@inlined
def _bearing(x: float, y: float) -> float:
    """Return a number from 0 up to 4 that grows with the bearing of (x, y), north to east, without a function."""
    size = abs(x) + abs(y)
    if size == 0.0:
        return 0.0
    turn = 1.0 - x / size if y >= 0.0 else 3.0 + x / size
    return turn if turn < 4.0 else 0.0


@inlined
def _sector(x: float, y: float) -> int:
    return min(int(_bearing(x, y) * (_SECTORS / 4)), _SECTORS - 1)


@inlined
def _ball_hit(x: float, y: float, z: float, u: float, v: float, w: float, radius: float) -> float:
    """Return the distance along a ray of direction (u, v, w) from (x, y, z) to a ball about 0, inf without a hit."""
    along, beside = x * u + y * v + z * w, x * x + y * y + z * z - radius * radius
    if beside <= 0.0:
        return 0.0
    square = along * along - beside
    if square < 0.0 or along > 0.0:
        return math.inf
    return float(beside / (math.sqrt(square) - along))


@inlined
def _slab(x: float, u: float, half: float) -> tuple[float, float]:
    """Return where a ray of slope ``u`` from ``x`` enters and leaves the slab from -half to half."""
    if u == 0.0:
        return (-math.inf, math.inf) if abs(x) <= half else (math.inf, -math.inf)
    a, b = (-half - x) / u, (half - x) / u
    return (a, b) if a <= b else (b, a)


@inlined
def _box_hit(
    x: float, y: float, z: float, u: float, v: float, w: float, half_x: float, half_y: float, half_z: float
) -> float:
    """Return the same as :func:`_ball_hit` for a box."""
    enter_x, leave_x = _slab(x, u, half_x)
    enter_y, leave_y = _slab(y, v, half_y)
    enter_z, leave_z = _slab(z, w, half_z)
    enter = max(max(enter_x, enter_y), max(enter_z, 0.0))
    return enter if enter <= min(min(leave_x, leave_y), leave_z) else math.inf


@inlined
def _cylinder_hit(x: float, y: float, z: float, u: float, v: float, w: float, radius: float, half_z: float) -> float:
    """Return the same as :func:`_ball_hit` for a cylinder about the z axis with flat ends."""
    across, along, beside = u * u + v * v, x * u + y * v, x * x + y * y - radius * radius
    square = along * along - across * beside
    if square < 0.0 or (beside > 0.0 and along >= 0.0):
        return math.inf
    enter, leave = _slab(z, w, half_z)
    enter = max(enter, 0.0)
    if across > 0.0:
        root = math.sqrt(square)
        # The stable one of the two forms of each root.
        if along <= 0.0:
            enter, leave = (
                max(enter, beside / (root - along) if beside > 0.0 else 0.0),
                min(leave, (root - along) / across),
            )
        else:
            leave = min(leave, -beside / (root + along))
    return enter if enter <= leave else math.inf


@inlined
def _hull_hit(planes: Array, begin: int, end: int, x: float, y: float, z: float, u: float, v: float, w: float) -> float:
    """Return the same as :func:`_ball_hit` for the body below the ``planes`` from ``begin`` to ``end``."""
    enter, leave = 0.0, math.inf
    for p in range(begin, end):
        slope = planes[p, 0] * u + planes[p, 1] * v + planes[p, 2] * w
        above = planes[p, 0] * x + planes[p, 1] * y + planes[p, 2] * z - planes[p, 3]
        if slope < 0.0:
            enter = max(enter, -above / slope)
        elif slope > 0.0:
            leave = min(leave, -above / slope)
        elif above > 0.0:
            return math.inf
        if enter > leave:
            return math.inf
    return enter


@kernel
def first_hits(
    directions: Array2, pose: Array1, reach: float, centres: Array2, bodies: Array2, bounds: Array2, planes: Array2,
    starts: Indices1,
) -> Array1:  # fmt: skip
    """Return the distance (n,) (m) to the first body or the ground on each ray, 0 inside of one, inf beyond ``reach``.

    Args:
        directions: of the rays (n, 3), unit vectors in the frame of the sensor.
        pose: of the sensor (7,): position (NED, m), attitude (to world, w first). The ground is at down = 0.
        reach: range (m).
        centres: of the bodies (B, 3), NED (m).
        bodies: rows (B, 14) as in :attr:`idc_controller.geometry.shape.Shape.row`.
        bounds: radius of the ball, and of the upright cylinder, about the centre that holds each (B, 2) (m).
        planes: outward normals in world axes, and distances from the centre, of the faces of bodies without a row
            (P, 4).
        starts: row of the first plane of each body, then P (B + 1,).
    """
    n, a, b, c = directions.shape[0], pose[0], pose[1], pose[2]
    qw, qx, qy, qz = pose[3], pose[4], pose[5], pose[6]
    rays, distance = np.empty((n, 3)), np.empty(n)
    sector, first = np.empty(n, np.int64), np.zeros(_SECTORS + 1, np.int64)
    for i in range(n):
        x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
        # v + 2 w (u x v) + 2 u x (u x v), u the vector part.
        s, t, r = 2.0 * (qy * z - qz * y), 2.0 * (qz * x - qx * z), 2.0 * (qx * y - qy * x)
        u, v, w = x + qw * s + qy * r - qz * t, y + qw * t + qz * s - qx * r, z + qw * r + qx * t - qy * s
        rays[i, 0], rays[i, 1], rays[i, 2] = u, v, w
        distance[i] = max(-c / w, 0.0) if w > 0.0 else math.inf
        if c >= 0.0:
            distance[i] = 0.0
        sector[i] = _sector(u, v)
        first[sector[i] + 1] += 1
    first = np.cumsum(first)
    order, place = np.empty(n, np.int64), first.copy()
    for i in range(n):
        order[place[sector[i]]] = i
        place[sector[i]] += 1
    for k in range(centres.shape[0]):
        x, y, z = a - centres[k, 0], b - centres[k, 1], c - centres[k, 2]
        radius = bounds[k, 1] * (1.0 + _SLACK) + _SLACK
        level = math.sqrt(x * x + y * y)
        if level > reach + radius or math.sqrt(x * x + y * y + z * z) > reach + bounds[k, 0] + _SLACK:
            continue
        begin, count = 0, _SECTORS
        if level > radius:
            # Bearings of the tangents to the upright cylinder.
            sine = radius / level
            cosine = math.sqrt(1.0 - sine * sine)
            begin = _sector(-cosine * x - sine * y, sine * x - cosine * y)
            count = (_sector(-cosine * x + sine * y, -sine * x - cosine * y) - begin) % _SECTORS + 1
        is_hull = starts[k + 1] > starts[k]
        half_x, half_y, half_z, radial, ball = bodies[k, 0], bodies[k, 1], bodies[k, 2], bodies[k, 3], bodies[k, 4]
        f = bodies[k, 5] * x + bodies[k, 8] * y + bodies[k, 11] * z
        g = bodies[k, 6] * x + bodies[k, 9] * y + bodies[k, 12] * z
        h = bodies[k, 7] * x + bodies[k, 10] * y + bodies[k, 13] * z
        for j in range(begin, begin + count):
            for at in range(first[j % _SECTORS], first[j % _SECTORS + 1]):
                i = order[at]
                u, v, w = rays[i, 0], rays[i, 1], rays[i, 2]
                if is_hull:
                    hit = _hull_hit(planes, starts[k], starts[k + 1], x, y, z, u, v, w)
                elif half_z == 0.0 and radial == 0.0:
                    hit = _ball_hit(x, y, z, u, v, w, ball)
                else:
                    o = bodies[k, 5] * u + bodies[k, 8] * v + bodies[k, 11] * w
                    p = bodies[k, 6] * u + bodies[k, 9] * v + bodies[k, 12] * w
                    q = bodies[k, 7] * u + bodies[k, 10] * v + bodies[k, 13] * w
                    if half_x > 0.0:
                        hit = _box_hit(f, g, h, o, p, q, half_x, half_y, half_z)
                    elif radial > 0.0:
                        hit = _cylinder_hit(f, g, h, o, p, q, radial, half_z)
                    else:
                        hit = _cylinder_hit(f, g, h, o, p, q, ball, half_z)
                        hit = min(hit, _ball_hit(f, g, h - half_z, o, p, q, ball))
                        hit = min(hit, _ball_hit(f, g, h + half_z, o, p, q, ball))
                distance[i] = min(distance[i], hit)
    for i in range(n):
        if distance[i] > reach:
            distance[i] = math.inf
    return distance


@kernel
def measured_returns(
    directions: Array2, distances: Array1, errors: Array1, chances: Array1, pose: Array1, limits: Array1
) -> Array2:
    """Return what a sensor reports of its rays' first hits (m, 3), in its own frame (m), in the order of the rays.

    Args:
        directions: of the rays (n, 3), unit vectors in the frame of the sensor.
        distances: to the first hits (n,) (m), inf without.
        errors: of the distances (n,) (m).
        chances: evenly from 0 to 1 (n,), by which returns are missed.
        pose: of the sensor by its own estimate (7,), nan where it has none: no return is taken for the ground.
        limits: least distance (m), missed share, height up to which a return is taken for the ground (m) (3,).
    """
    qw, qx, qy, qz = pose[3], pose[4], pose[5], pose[6]
    # Third row of the rotation to the world: down.
    down_x, down_y = 2.0 * (qx * qz - qw * qy), 2.0 * (qy * qz + qw * qx)
    down_z = 1.0 - 2.0 * (qx * qx + qy * qy)
    nearest, missed, lowest = limits[0], limits[1], limits[2]
    found, count = np.empty(directions.shape), 0
    for i in range(directions.shape[0]):
        if not nearest <= distances[i] < math.inf or chances[i] < missed:
            continue
        distance = max(distances[i] + errors[i], nearest)
        x, y, z = distance * directions[i, 0], distance * directions[i, 1], distance * directions[i, 2]
        height = -(pose[2] + down_x * x + down_y * y + down_z * z)
        if height <= lowest:
            continue
        found[count, 0], found[count, 1], found[count, 2] = x, y, z
        count += 1
    return found[:count].copy()
