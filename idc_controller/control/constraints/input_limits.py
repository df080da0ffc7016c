"""Limits of tilt and thrust set-points (eq:inpCon); hard, both ways."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.control.force_components import inputs_in_force_components
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel


class InputLimits:
    """Rows G v <= h on a move v (3 N,) about the reference's set-points, in force components."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self._hover = model.parameters.hover_thrust
        N = model.layout.number_of_uavs
        tilt = np.full(2 * N, np.tan(settings.tuning.uav_tilt_limit))
        thrust_max = settings.thrust_share_max * model.parameters.thrust_max
        self._upper = np.concatenate([tilt, np.full(N, thrust_max)])
        self._lower = np.concatenate([-tilt, np.full(N, settings.thrust_min)])
        self.G = np.vstack([np.eye(3 * N), -np.eye(3 * N)])
        """(6 N, 3 N)"""

    def h(self, u: Array) -> Array:
        """Return the bounds (M, 2, 3 N), upper then lower, for set-points ``u`` (M, 3 N) of the reference."""
        u = inputs_in_force_components(u, self._hover)
        bounds = np.empty((len(u), 2, u.shape[1]))
        np.subtract(self._upper, u, out=bounds[:, 0])
        np.subtract(u, self._lower, out=bounds[:, 1])
        return bounds
