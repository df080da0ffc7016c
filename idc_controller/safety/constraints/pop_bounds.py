"""Bounds on the pop of a plan: how much its crackle changes at each knot of the snap.

The set-points of the UAVs' tilt follow the snap and its first two derivatives, because the attitude loops are inverted
(:mod:`idc_controller.trajectory.flatness`): a plan whose crackle jumps needs a tilt that jumps.
"""

import numpy as np
from scipy.linalg import block_diag

from idc_controller.arrays import Array
from idc_controller.safety.constraints.constraint import Constraint, Penalty, PlanningStep
from idc_controller.safety.settings import PlannerSettings


class PopBounds(Constraint):
    """Rows for every knot and axis, from the crackle in force on; the reference's own pop is always allowed."""

    def __init__(self, settings: PlannerSettings, penalty: Penalty) -> None:
        self.penalty = penalty
        chain = settings.chain
        self._knots = np.cumsum([0, *chain.blocks])
        intervals = chain.period * np.array(chain.blocks)
        # Pop at a knot: the change of crackle over half the intervals about it.
        self._crackle = np.diff(np.eye(chain.knots + 1), axis=0) / intervals[:, None]
        self._spans = 0.5 * (intervals + np.concatenate([intervals[:1], intervals[:-1]]))
        change = np.diff(self._crackle, axis=0, prepend=0.0) / self._spans[:, None]
        self._pop_of_snap = change
        """Pop at the knots but the last, of the snap at all knots (knots, knots + 1), without the crackle before."""
        rows = block_diag(*[change[:, 1:]] * 3)
        self._G = np.vstack([rows, -rows])
        self._limit, self._spare = np.array(settings.pop_limit), settings.pop_spare

    def rows(self, step: PlanningStep) -> tuple[Array, Array]:
        """Return G (6 knots, 3 knots) and h (6 knots,) (m/s6)."""
        reference = step.reference[4, self._knots]
        own = self._pop_of_snap @ reference
        own[0] = 0.0  # where the reference changes, it has no crackle of its own
        fixed = self._pop_of_snap[:, :1] * (step.snap - reference[0]) + self._pop_of_snap @ reference
        fixed[0] -= step.crackle / self._spans[0]
        limit = np.maximum(self._limit, np.abs(own) + self._spare)
        return self._G, np.concatenate([(limit - fixed).T.ravel(), (limit + fixed).T.ravel()])

    def slack_shares(self, obstacles: int) -> Array:
        """Return S (1, 6 knots, 1): one slack for all, in shares of the limit."""
        return np.tile(np.repeat(self._limit, len(self._spans)), 2)[None, :, None]
