"""Lowest position of the payload's centre: it is on the ground there."""

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.control.constraints.constraint import StateConstraint
from idc_controller.control.settings import MpcSettings
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.flatness import FlatReference


class LowestPayload(StateConstraint):
    """See :class:`~idc_controller.control.constraints.constraint.StateConstraint`."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self.limits = np.array([-model.parameters.payload.below])
        self.slack = np.zeros(1, dtype=int)
        self.G = np.zeros((1, model.layout.size))
        self.G[0, model.layout.r_0.start + 2] = 1.0

    def used(self, reference: FlatReference, stages: Indices) -> Array:
        """Return how low the reference is (S, 1) (m)."""
        return reference.payload[0, :, 2].take(stages)[:, None]
