"""The lowest altitude of a plan: the payload is not led into the ground."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.safety.constraints.constraint import Constraint, Penalty, PlanningStep
from idc_controller.safety.settings import PlannerSettings


class LowestAltitude(Constraint):
    """Rows on the height of the payload's centre; the reference's own height is always allowed."""

    def __init__(self, formation: Formation, settings: PlannerSettings, penalty: Penalty) -> None:
        self.penalty = penalty
        self.lowest = -(formation.payload.below + settings.ground_clearance)
        """Greatest z (NED) of the payload's centre (m)."""
        self._stages = settings.limited_stages
        knots = settings.chain.knots
        self._G = np.zeros((len(self._stages), 3 * knots))
        self._G[:, 2 * knots :] = settings.chain.response[1][self._stages, 0]

    def rows(self, step: PlanningStep) -> tuple[Array, Array]:
        """Return G (m, 3 knots) and h (m,) (m)."""
        z = step.reference[0, self._stages, 2]
        return self._G, np.maximum(self.lowest, z) - z - step.free[self._stages, 0, 2]
