"""Drag of moving air on payload and UAVs: along the air's velocity against the body, and quadratic in it.

The payload is level. Its drag is 1/2 rho c_d (sum_i A_i |u_i|) u, u = wind - velocity, where A_i is the area of its
hull's silhouette along axis i: exact for a box, which shows less of itself to wind on a face than to wind on a
corner. A UAV is the same from all sides.
"""

from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array

AIR_DENSITY = 1.225  # kg/m3
BOX_DRAG = 1.05  # c_d of a cube, across a face

SMOOTHING = 0.3
"""|u| is sqrt(u^2 + SMOOTHING^2) (m/s): what is planned with drag needs its derivatives."""


@dataclass(frozen=True, eq=False)
class Air:
    """The wind, and what drag it makes.

    ``wind``: velocity of the air (3,) (m/s, NED). ``payload``: 1/2 rho c_d A of its silhouettes along x, y, z (3,),
    ``uav``: 1/2 rho c_d A of each of the UAVs (kg/m). ``limit``: the drag on the payload fades to this (N).
    """

    wind: Array
    payload: Array
    uav: float
    limit: float = np.inf

    def on_payload(self, velocity: Array) -> Array:
        """Force (..., 3) (N, NED) on a payload that moves at ``velocity`` (..., 3) (m/s)."""
        force = payload_drag(self.payload, self.wind - velocity)
        return force * _fading(_dot(force, force), self.limit)[0]

    def on_uav(self, velocity: Array) -> Array:
        """The same on a UAV."""
        u = self.wind - velocity
        return np.asarray(self.uav * np.linalg.norm(u, axis=-1, keepdims=True) * u)

    def on_payload_along(self, derivatives: Array) -> Array:
        """Force and its first two derivatives (3, K, 3) along ``derivatives`` (4 or more, K, 3): position to jerk."""
        u, u_dot, u_ddot = self.wind - derivatives[1], -derivatives[2], -derivatives[3]
        size = _size(u)
        along = u * u_dot / size
        s = (size @ self.payload)[..., None]
        s_dot = (along @ self.payload)[..., None]
        s_ddot = (((u_dot**2 + u * u_ddot - along**2) / size) @ self.payload)[..., None]
        F, F_dot, F_ddot = s * u, s_dot * u + s * u_dot, s_ddot * u + 2.0 * s_dot * u_dot + s * u_ddot
        square = _dot(F, F)
        square_dot, square_ddot = 2.0 * _dot(F, F_dot), 2.0 * (_dot(F_dot, F_dot) + _dot(F, F_ddot))
        c, c_1, c_2 = _fading(square, self.limit)
        c_dot, c_ddot = c_1 * square_dot, c_2 * square_dot**2 + c_1 * square_ddot
        return np.stack([c * F, c_dot * F + c * F_dot, c_ddot * F + 2.0 * c_dot * F_dot + c * F_ddot])


def drag_coefficients(areas: Array) -> Array:
    """1/2 rho c_d A (3,) (kg/m) of a payload whose silhouettes along x, y, z have these ``areas`` (3,) (m2)."""
    return 0.5 * AIR_DENSITY * BOX_DRAG * areas


def payload_drag(coefficients: Array, u: Array) -> Array:
    """Drag (..., 3) (N) of a payload with ``coefficients`` (3,) (kg/m) in air that passes it at ``u`` (..., 3)."""
    return (_size(u) @ coefficients)[..., None] * u


def _size(u: Array) -> Array:
    return np.sqrt(u * u + SMOOTHING * SMOOTHING)


def _fading(square: Array, limit: float) -> tuple[Array, Array, Array]:
    """(1 + |F|^4 / limit^4)^(-1/4) and its first two derivatives by |F|^2, at ``square`` = |F|^2."""
    a = limit**-4
    z = 1.0 + a * square**2
    c = z**-0.25
    c_1 = -0.5 * a * square * c / z
    return c, c_1, -0.5 * a * c / z + 1.25 * a * a * square**2 * c / z**2


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=-1, keepdims=True))
