"""Bounds on the snap of a plan at its knots: bounds of the QP's variables themselves, so not rows, and hard."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.safety.constraints.constraint import PlanningStep
from idc_controller.safety.settings import PlannerSettings


class SnapBounds:
    """The snap limit less the snap of the reference, which is always allowed."""

    def __init__(self, settings: PlannerSettings) -> None:
        self._limit, self._spare = settings.snap_limit, settings.snap_spare
        self._knots = np.cumsum(settings.blocks)

    def bounds(self, step: PlanningStep) -> tuple[Array, Array]:
        """Return the lower and the upper bound of z (3 knots,) (m/s4)."""
        snap = step.reference[4, self._knots]
        limit = np.maximum(self._limit, np.abs(snap).max(axis=0) + self._spare)
        return (-limit - snap).T.ravel(), (limit - snap).T.ravel()
