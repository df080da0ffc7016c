"""Time that a plan takes to give way: the shortest in which the planner's own limits let it move aside."""

from bisect import bisect_left

import numpy as np
from scipy.optimize import linprog

from idc_controller.safety.constraints.acceleration_bounds import AccelerationBounds
from idc_controller.safety.constraints.constraint import Penalty, PlanningStep
from idc_controller.safety.constraints.pop_bounds import PopBounds
from idc_controller.safety.constraints.snap_bounds import SnapBounds
from idc_controller.safety.settings import PlannerSettings

_HARD = Penalty(0.0, 0.0)
_ASIDE = 1
"""The axis along which it moves aside: level, where acceleration and snap are limited most."""


def give_way_time(settings: PlannerSettings, distance: float) -> float:
    """Return the time (s) in which a plan from steady motion is a ``distance`` (m) aside of it, at the earliest.

    The farthest place at a stage is the solution of a linear programme: the limits of acceleration, snap and pop of
    the safety QP, kept without slack, on the snap at its knots. Between stages the place is linear, beyond the horizon
    at the mean speed until then.
    """
    chain = settings.chain
    count = chain.stages + 1
    steady = np.zeros((5, count, 3))
    step = PlanningStep(steady, np.zeros((count, 5, 3)), steady[2], (), np.zeros(3), np.zeros(3))
    rows = [bounds(settings, _HARD).rows(step) for bounds in (AccelerationBounds, PopBounds)]
    G, h = np.vstack([G for G, _ in rows]), np.concatenate([h for _, h in rows])
    limits = np.column_stack(SnapBounds(settings).bounds(step))

    def farthest(k: int) -> float:
        aside = np.zeros((3, chain.knots))
        aside[_ASIDE] = chain.response[1][k, 0]
        return -float(linprog(-aside.ravel(), A_ub=G, b_ub=h, bounds=limits).fun)

    last = farthest(count - 1)
    if last < distance:
        return float(chain.times[-1] * distance / last)
    k = bisect_left(range(count), distance, key=farthest)
    before = farthest(k - 1)
    return float(chain.times[k - 1] + chain.period * (distance - before) / (farthest(k) - before))
