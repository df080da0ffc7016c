"""Drag of moving air on payload and UAVs: along the air's velocity against the body, and quadratic in it.

The payload is level. Its drag is 1/2 rho c_d (sum_i A_i |u_i|) u, u = wind - velocity, where A_i is the area of its
hull's silhouette along axis i: exact for a box, which shows less of itself to wind on a face than to wind on a
corner. A UAV is the same from all sides.
"""

from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Array1

AIR_DENSITY = 1.225  # kg/m3
BOX_DRAG = 1.05  # c_d of a cube, across a face

SMOOTHING = 0.3
"""|u| is sqrt(u^2 + SMOOTHING^2) (m/s): what is planned with drag needs its derivatives."""


class Air(NamedTuple):
    """The wind, and what drag it makes.

    ``wind``: velocity of the air (3,) (m/s, NED). ``payload``: 1/2 rho c_d A of its silhouettes along x, y, z (3,),
    ``uav``: 1/2 rho c_d A of each of the UAVs (kg/m). ``limit``: the drag on the payload fades to this (N).
    """

    wind: Array1
    payload: Array1
    uav: float
    limit: float = np.inf

    def on_payload(self, velocity: Array) -> Array:
        """Force (..., 3) (N, NED) on a payload that moves at ``velocity`` (..., 3) (m/s)."""
        force = payload_drag(self.payload, self.wind - velocity)
        square = np.sum(force * force, axis=-1, keepdims=True)
        return np.asarray(force * (1.0 + self.limit**-4 * square**2) ** -0.25)

    def on_uav(self, velocity: Array) -> Array:
        """The same on a UAV."""
        u = self.wind - velocity
        return np.asarray(self.uav * np.linalg.norm(u, axis=-1, keepdims=True) * u)


def drag_coefficients(areas: Array) -> Array:
    """1/2 rho c_d A (3,) (kg/m) of a payload whose silhouettes along x, y, z have these ``areas`` (3,) (m2)."""
    return 0.5 * AIR_DENSITY * BOX_DRAG * areas


def payload_drag(coefficients: Array, u: Array) -> Array:
    """Drag (..., 3) (N) of a payload with ``coefficients`` (3,) (kg/m) in air that passes it at ``u`` (..., 3)."""
    return (_size(u) @ coefficients)[..., None] * u


def _size(u: Array) -> Array:
    return np.sqrt(u * u + SMOOTHING * SMOOTHING)
