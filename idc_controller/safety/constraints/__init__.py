"""The constraints of the safety QP, one a file; :func:`planner_constraints` is where a new one is registered."""

from idc_controller.safety.constraints.acceleration_bounds import AccelerationBounds
from idc_controller.safety.constraints.constraint import Constraint, Penalty
from idc_controller.safety.constraints.exponential_barrier import ExponentialBarrier
from idc_controller.safety.constraints.lowest_altitude import LowestAltitude
from idc_controller.safety.constraints.pop_bounds import PopBounds
from idc_controller.safety.settings import PlannerSettings

__all__ = ["planner_constraints"]


def planner_constraints(barrier: ExponentialBarrier, settings: PlannerSettings) -> tuple[Constraint, ...]:
    """Return the rows of the QP in their order; those that share a penalty share its slacks."""
    limits = Penalty(settings.limit_slack_linear, settings.limit_slack_quadratic)
    return (
        barrier,
        AccelerationBounds(settings, limits),
        LowestAltitude(barrier.formation, settings, limits),
        PopBounds(settings, Penalty(settings.limit_slack_linear, settings.limit_slack_quadratic)),
    )
