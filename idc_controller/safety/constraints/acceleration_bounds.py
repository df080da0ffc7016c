"""Bounds on the acceleration of a plan, along the axes and between north and east, both ways."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.safety.constraints.constraint import Constraint, Penalty, PlanningStep
from idc_controller.safety.settings import PlannerSettings

_DIAGONAL = np.sqrt(0.5)
DIRECTIONS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [_DIAGONAL, _DIAGONAL, 0], [_DIAGONAL, -_DIAGONAL, 0]])
"""Unit vectors along which the acceleration is bounded (5, 3)."""


class AccelerationBounds(Constraint):
    """Rows for every direction; the reference's own acceleration is always allowed."""

    def __init__(self, settings: PlannerSettings, penalty: Penalty) -> None:
        self.penalty = penalty
        self._spare = settings.acceleration_spare
        self._stages = settings.limited_stages
        limits = settings.acceleration_limit
        self._limits = np.array([*limits, limits[:2].min(), limits[:2].min()])
        along = np.einsum("da,kz->dkaz", DIRECTIONS, settings.chain.response[1][self._stages, 2])
        self._G = np.stack([along, -along], axis=1).reshape(-1, 3 * settings.chain.knots)

    def rows(self, step: PlanningStep) -> tuple[Array, Array]:
        """Return G (m, 3 knots) and h (m,) (m/s2)."""
        own = DIRECTIONS @ step.reference[2, self._stages].T
        value = own + DIRECTIONS @ step.free[self._stages, 2].T
        limit = np.maximum(self._limits[:, None], np.abs(own) + self._spare)
        return self._G, np.stack([limit - value, limit + value], axis=1).ravel()
