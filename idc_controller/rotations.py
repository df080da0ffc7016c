"""Rotations: w-first unit quaternions, rotation matrices and the hat map. Pure functions."""

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array


def hat(v: ArrayLike) -> Array:
    """The hat map R3 -> so(3): ``hat(a) @ b`` is the cross product of a and b. (..., 3) -> (..., 3, 3)."""
    v = np.asarray(v, dtype=float)
    matrix = np.zeros((*v.shape[:-1], 3, 3))
    matrix[..., 0, 1], matrix[..., 0, 2], matrix[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    matrix[..., 1, 0], matrix[..., 2, 0], matrix[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return matrix


def rotation_from_quaternion(q: ArrayLike) -> Array:
    """Rotation matrix body to world of a w-first unit quaternion. (..., 4) -> (..., 3, 3)."""
    q = np.asarray(q, dtype=float)
    w, x, y, z = q.tolist() if q.ndim == 1 else np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows) if q.ndim == 1 else np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def quaternion_from_euler(roll: float, pitch: float, yaw: float) -> Array:
    """w-first quaternion body to world of ZYX Euler angles (rad). -> (4,)."""
    cr, sr = np.cos(roll / 2), np.sin(roll / 2)
    cp, sp = np.cos(pitch / 2), np.sin(pitch / 2)
    cy, sy = np.cos(yaw / 2), np.sin(yaw / 2)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def euler_from_quaternion(q: ArrayLike) -> Array:
    """ZYX Euler angles roll, pitch, yaw (rad) of a w-first unit quaternion. (..., 4) -> (..., 3)."""
    w, x, y, z = np.moveaxis(np.asarray(q, dtype=float), -1, 0)
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=-1)
