"""Limit of the payload's roll, pitch and yaw about the level reference (eq:consOsc), a slack each."""

import numpy as np

from idc_controller.control.constraints.constraint import StateConstraint
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel


class PayloadTilt(StateConstraint):
    """It uses nothing of the limits: the reference is level."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self.limits = np.full(6, settings.tuning.payload_tilt_limit)
        self.slack = np.repeat(np.arange(3), 2)
        self.G = np.zeros((6, model.layout.size))
        self.G[np.arange(6), model.layout.Theta.start + self.slack] = np.tile([1.0, -1.0], 3)
