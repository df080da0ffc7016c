"""Which points of an obstacle's surface a range sensor hits: the nearest, and some out to the edges of what it sees.

Plain floats: the shapes are few and numpy's calls would cost more than the arithmetic. An obstacle hides its own far
side; it does not hide others.
"""

from __future__ import annotations

import math

from vehicle_sim.world.obstacle_bodies import Obstacle
from vehicle_sim.world.world_state import Vector

#: Off-axis positions of the rays at a sphere: share of the radius; six of them, turned by a random angle.
_RING = (0.9, 0.6, 0.9, 0.6, 0.9, 0.6)
#: Rays at a pole's side: share of the radius to the right; share of the visible length up (1) or down (-1).
_SIDE = ((0.8, 0.0), (-0.8, 0.0), (0.5, 1.0), (-0.5, -1.0), (-0.85, 0.6), (0.85, -0.6), (-0.3, 1.0), (0.3, -1.0))
_RIM = 0.95  # of the radius, for points on a pole's end


def visible_points(obstacle: Obstacle, sensor: Vector, reach: float, turn: float) -> list[Vector]:
    """Points of the surface in the world, the nearest first; empty if none is within ``reach`` (m).

    ``sensor``: where it is (NED, m). ``turn`` (rad) turns the pattern on a sphere. A sensor inside sees nothing.
    """
    x, y, z = obstacle.position_in_world
    offset = (sensor[0] - x, sensor[1] - y, sensor[2] - z)
    if obstacle.shape == "sphere":
        points = _sphere(obstacle.radius, offset, turn)
    elif obstacle.shape == "pole":
        points = _pole(obstacle.radius, obstacle.size[2] / 2.0, offset, reach)
    else:
        cosine, sine = math.cos(obstacle.yaw), math.sin(obstacle.yaw)
        a, b, c = offset
        local = (cosine * a + sine * b, cosine * b - sine * a, c)
        halves = (obstacle.size[0] / 2.0, obstacle.size[1] / 2.0, obstacle.size[2] / 2.0)
        points = [(cosine * u - sine * v, sine * u + cosine * v, w) for u, v, w in _box(halves, local, reach)]
    limit = reach + 1e-9
    return [(x + a, y + b, z + c) for a, b, c in points if math.dist((a, b, c), offset) <= limit]


def is_beyond(obstacle: Obstacle, sensor: Vector, reach: float) -> bool:
    """Whether an obstacle is surely out of reach: a cheap check before the others."""
    a, b, c = obstacle.size
    size = obstacle.radius + 0.5 * math.sqrt(a * a + b * b + c * c)
    return math.dist(obstacle.position_in_world, sensor) > reach + size


def _sphere(radius: float, s: Vector, turn: float) -> list[Vector]:
    """About the centre, seen from ``s``."""
    distance = math.hypot(*s)
    if distance <= radius:
        return []
    e = (-s[0] / distance, -s[1] / distance, -s[2] / distance)
    # Two directions across the line of sight.
    i = min(range(3), key=lambda k: abs(e[k]))
    a = [-e[i] * e[k] for k in range(3)]
    a[i] += 1.0
    norm = math.hypot(*a)
    a = [value / norm for value in a]
    b = (e[1] * a[2] - e[2] * a[1], e[2] * a[0] - e[0] * a[2], e[0] * a[1] - e[1] * a[0])
    points = [_along(s, e, distance - radius)]
    for k, share in enumerate(_RING):
        sine = share * radius / distance
        cosine = math.sqrt(1.0 - sine * sine)
        angle = turn + k * math.pi / 3.0
        across, up = sine * math.cos(angle), sine * math.sin(angle)
        ray = (
            cosine * e[0] + across * a[0] + up * b[0],
            cosine * e[1] + across * a[1] + up * b[1],
            cosine * e[2] + across * a[2] + up * b[2],
        )
        points.append(_along(s, ray, distance * cosine - radius * math.sqrt(1.0 - share * share)))
    return points


def _pole(radius: float, half_height: float, s: Vector, reach: float) -> list[Vector]:
    """About the centre, the axis along z, seen from ``s``."""
    x, y, z = s
    distance = math.hypot(x, y)
    points: list[Vector] = []
    if distance > radius:
        e = (-x / distance, -y / distance)

        def side(share: float, along: float) -> Vector | None:
            sine = share * radius / distance
            cosine = math.sqrt(1.0 - sine * sine)
            flat = distance * cosine - radius * math.sqrt(1.0 - share * share)
            if flat > reach:
                return None
            length = math.sqrt(reach * reach - flat * flat)
            top, bottom = max(-half_height, z - length), min(half_height, z + length)
            if top > bottom:
                return None
            nearest = min(max(z, top), bottom)
            height = nearest + along * ((top if along > 0.0 else bottom) - nearest) * math.copysign(1.0, along)
            ray = (cosine * e[0] - sine * e[1], cosine * e[1] + sine * e[0])
            return x + flat * ray[0], y + flat * ray[1], height

        points += [p for p in (side(0.0, 0.0), *(side(*place) for place in _SIDE)) if p is not None]
    if abs(z) > half_height:  # the end is seen, too
        end = math.copysign(half_height, z)
        inward = min(1.0, _RIM * radius / distance) if distance > 0.0 else 0.0
        ends = [(x * inward, y * inward, end)]
        for k in range(4):
            angle = math.pi / 4.0 + k * math.pi / 2.0
            ends.append((_RIM * radius * math.cos(angle), _RIM * radius * math.sin(angle), end))
        points = points + ends if distance > radius else ends
    return points


def _box(halves: Vector, s: Vector, reach: float) -> list[Vector]:
    """About the centre, in the box's own frame, seen from ``s``."""
    visible = [k for k in range(3) if abs(s[k]) > halves[k]]
    if not visible:
        return []
    nearest = _clamped(s, halves)
    if math.dist(nearest, s) > reach:
        return []
    # The face that shows most of itself first.
    visible.sort(key=lambda k: -_shown(halves, s, k))
    points = [nearest]
    for rank, axis in enumerate(visible):
        foot = list(nearest)
        foot[axis] = math.copysign(halves[axis], s[axis])
        corners = [_shortened(s, foot, corner, reach) for corner in _corners(halves, axis, foot[axis])]
        if rank > 0:  # its near corners are the first face's
            corners = sorted(corners, key=lambda p: -math.dist(p, s))[:2]
        points += corners
        if rank == 0:
            middle = [0.5 * (corners[0][k] + corners[2][k]) for k in range(3)]
            points.append((middle[0], middle[1], middle[2]))
    return points


def _corners(halves: Vector, axis: int, level: float) -> list[Vector]:
    """Of the face across ``axis`` at ``level``, in turn."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    corners = []
    for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1)):
        corner = [0.0, 0.0, 0.0]
        corner[axis], corner[j], corner[k] = level, a * halves[j], b * halves[k]
        corners.append((corner[0], corner[1], corner[2]))
    return corners


def _shown(halves: Vector, s: Vector, axis: int) -> float:
    """How much of a face the sensor sees: its area times the cosine of the angle of incidence."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    return halves[j] * halves[k] * (abs(s[axis]) - halves[axis]) / math.dist(s, (0.0, 0.0, 0.0))


def _shortened(s: Vector, start: list[float], end: Vector, reach: float) -> Vector:
    """From ``start``, which is in reach, towards ``end`` as far as the reach goes."""
    d = [end[k] - start[k] for k in range(3)]
    o = [start[k] - s[k] for k in range(3)]
    a = sum(v * v for v in d)
    b = sum(v * w for v, w in zip(d, o, strict=True))
    c = sum(v * v for v in o) - reach * reach
    share = 1.0
    if a > 0.0:
        share = min(1.0, max(0.0, (-b + math.sqrt(max(b * b - a * c, 0.0))) / a))
    return start[0] + share * d[0], start[1] + share * d[1], start[2] + share * d[2]


def _clamped(s: Vector, halves: Vector) -> Vector:
    x, y, z = (min(max(value, -half), half) for value, half in zip(s, halves, strict=True))
    return x, y, z


def _along(s: Vector, direction: Vector, length: float) -> Vector:
    return s[0] + length * direction[0], s[1] + length * direction[1], s[2] + length * direction[2]
