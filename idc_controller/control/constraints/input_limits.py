"""Limits of tilt and thrust set-points (eq:inpCon); hard, both ways."""

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.control.force_kernels import fill_input_bounds
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel


class InputLimits:
    """Rows G v <= h on a move v (3 N,) about the reference's set-points, in force components."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self._hover = model.parameters.hover_thrust
        N, p = model.layout.number_of_uavs, model.parameters
        tilt = np.full(2 * N, np.tan(settings.tuning.uav_tilt_limit))
        thrust_max = settings.thrust_share_max * p.thrust_max
        self._upper = np.concatenate([tilt, np.full(N, thrust_max)])
        self._lower = np.concatenate([-tilt, settings.least_lift * p.m * p.g])
        self.G = np.vstack([np.eye(3 * N), -np.eye(3 * N)])
        """(6 N, 3 N)"""

    def fill(self, h: Array, u: Array, stages: Indices) -> None:
        """Fill the first M 6 N of ``h`` with the bounds at ``stages`` (M,), upper then lower ones by stage.

        ``u`` (K, 3 N): the reference's set-points at all stages.
        """
        fill_input_bounds(h, u, stages, self._hover, self._lower, self._upper)
