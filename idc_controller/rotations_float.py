"""Rotations of single vectors in plain floats, for code that runs hundreds of times a second; w-first quaternions.

For arrays see :mod:`idc_controller.rotations`.
"""

import math
from collections.abc import Sequence

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)


def into_body(q: Quaternion, v: Vector) -> Vector:
    """Return the vector ``v`` in the frame whose attitude is ``q`` (body to world)."""
    w, x, y, z = q
    a, b, c = v
    # v + 2 w (v x u) + 2 u x (u x v), u the vector part: the rotation by the conjugate.
    s, t, r = 2.0 * (b * z - c * y), 2.0 * (c * x - a * z), 2.0 * (a * y - b * x)
    return a + w * s + t * z - r * y, b + w * t + r * x - s * z, c + w * r + s * y - t * x


def half_rotation(a: Quaternion, b: Quaternion) -> Vector:
    """Return the vector part of the rotation from attitude ``a`` to ``b``, the shorter way, in the body frame of ``a``.

    For small angles it is half the rotation vector (rad).
    """
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    sign = 1.0 if aw * bw + ax * bx + ay * by + az * bz >= 0.0 else -1.0
    return (
        sign * (aw * bx - ax * bw - ay * bz + az * by),
        sign * (aw * by + ax * bz - ay * bw - az * bx),
        sign * (aw * bz - ax * by + ay * bx - az * bw),
    )


def turned(attitude: Quaternion, rates: Vector, duration: float) -> Quaternion:
    """Return ``attitude`` (body to world) turned by body ``rates`` (rad/s) for a short ``duration`` (s)."""
    w, x, y, z = attitude
    p, q, r = (0.5 * duration * rate for rate in rates)
    w, x, y, z = (
        w - x * p - y * q - z * r,
        x + w * p + y * r - z * q,
        y + w * q + z * p - x * r,
        z + w * r + x * q - y * p,
    )
    length = math.hypot(w, x, y, z)
    return w / length, x / length, y / length, z / length


def euler_of(attitude: Quaternion) -> Vector:
    """Return ZYX Euler angles roll, pitch, yaw (rad) of a unit quaternion (body to world)."""
    w, x, y, z = attitude
    return (
        math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        math.asin(min(max(2.0 * (w * y - z * x), -1.0), 1.0)),
        math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    )


def rotation_vector(q: Quaternion) -> Vector:
    """Return axis times angle (rad), not longer than pi, of a unit quaternion."""
    w, x, y, z = q if q[0] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 if sine < 1e-9 else 2.0 * math.atan2(sine, w) / sine
    return scale * x, scale * y, scale * z


def quaternion_of(vector: Vector) -> Quaternion:
    """Return the unit quaternion of a rotation ``vector`` (rad); of NaN and infinity, those."""
    angle = math.sqrt(sum(v * v for v in vector)) if all(abs(v) < 1e100 for v in vector) else math.nan
    if not math.isfinite(angle):
        worst = next(v for v in vector if not abs(v) < 1e100)
        return worst, worst, worst, worst
    scale = 0.5 if angle < 1e-9 else math.sin(0.5 * angle) / angle
    return math.cos(0.5 * angle), scale * vector[0], scale * vector[1], scale * vector[2]


def attitude_of_direction(direction: Sequence[float]) -> Quaternion:
    """Return the attitude with yaw 0 whose thrust axis, body -z, lies along the unit vector ``direction`` (NED).

    Roll about the body x axis follows pitch about y (ZYX).
    """
    z_x, z_y, z_z = -direction[0], -direction[1], -direction[2]
    roll = -math.asin(max(-1.0, min(1.0, z_y)))
    pitch = math.atan2(z_x, z_z)
    cos_roll, sin_roll = math.cos(roll / 2), math.sin(roll / 2)
    cos_pitch, sin_pitch = math.cos(pitch / 2), math.sin(pitch / 2)
    return (cos_roll * cos_pitch, sin_roll * cos_pitch, cos_roll * sin_pitch, -sin_roll * sin_pitch)


def attitude_of_force(f_x: float, f_y: float, f_z: float, yaw: float) -> Quaternion:
    """Return the attitude (body to world) whose thrust axis, body -z, lies along a force in the world (NED).

    The shortest turn from level that tilts the axis, after a turn by ``yaw`` (rad). The force points upwards.
    """
    size = math.sqrt(f_x * f_x + f_y * f_y + f_z * f_z)
    # From (0, 0, -1) to the force: w = 1 + cos, axis = (0, 0, -1) x force.
    w, x, y = 1.0 - f_z / size, f_y / size, -f_x / size
    scale = 1.0 / math.sqrt(w * w + x * x + y * y)
    w, x, y = w * scale, x * scale, y * scale
    c, s = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    return w * c, x * c + y * s, y * c - x * s, w * s


def mean_attitude(attitudes: Sequence[Quaternion]) -> Quaternion:
    """Return the mean of unit quaternions not far from each other, of either sign."""
    last = attitudes[-1]
    total = [0.0, 0.0, 0.0, 0.0]
    for q in attitudes:
        sign = 1.0 if sum(a * b for a, b in zip(q, last, strict=True)) >= 0.0 else -1.0
        total = [t + sign * v for t, v in zip(total, q, strict=True)]
    norm = math.sqrt(sum(t * t for t in total))
    w, x, y, z = (t / norm for t in total)
    return w, x, y, z
