"""The reference that estimator and controller share: a trajectory, and the estimated load on it."""

from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.flatness import FlatReference, Load, PayloadTrajectory, flat_reference


class Reference(NamedTuple):
    """Exact states and set-points along ``trajectory`` under ``load``."""

    parameters: SystemParameters
    trajectory: PayloadTrajectory
    load: Load

    def at(self, times: Array) -> FlatReference:
        """Reference at ``times`` (K,) (s)."""
        return flat_reference(self.parameters, self.trajectory, np.asarray(times, dtype=float), self.load)
