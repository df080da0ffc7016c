"""The interface of a constraint of the safety QP."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array
from idc_controller.safety.separation import Separation


@dataclass(frozen=True, eq=False)
class PlanningStep:
    """One safety QP: the reference over the stages 0 .. K and what is known about them. NED, SI."""

    reference: Array
    """Position to snap (5, K + 1, 3)."""
    free: Array
    """The deviation's states if all knots are zero (K + 1, 5, 3)."""
    acceleration: Array
    """Acceleration of the plan before, about which the hull's shear is linear (K + 1, 3)."""
    separations: Sequence[Separation]
    snap: Array
    """Snap of the plan in force now (3,)."""
    crackle: Array
    """Crackle of the plan in force until now (3,)."""


@dataclass(frozen=True, eq=False)
class Penalty:
    """Cost of the slacks by which constraints may be exceeded; constraints with the same object share the slacks."""

    linear: float
    quadratic: float


class Constraint(ABC):
    """Rows G z <= h + S slack of the safety QP; z (3 knots,) is the deviation's snap at the knots, axis by axis."""

    penalty: Penalty
    is_lazy = False
    """Whether its rows are many, of which few bind."""
    _G: Array
    """Rows that do not change (m, 3 knots)."""

    @abstractmethod
    def rows(self, step: PlanningStep) -> tuple[Array, Array]:
        """Return G (m, 3 knots) and h (m,)."""

    def slack_shares(self, obstacles: int) -> Array:
        """Return the b blocks of S (b, m / b, s / b), which is else 0, with that number of obstacles.

        S (m, s) is by what share of each slack a row may be exceeded; by default there is one slack for all rows.
        """
        return np.ones((1, len(self._G), 1))
