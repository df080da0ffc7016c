"""One step of planning: the guidance's reference, the safety filter, and what the guidance observes of its plan."""

from idc_controller.estimation.estimate import Estimate
from idc_controller.guidance.progress import Guidance
from idc_controller.model.drag import Air
from idc_controller.safety.filter_protocol import SafetyFilter
from idc_controller.trajectory.flatness import PayloadTrajectory
from idc_controller.trajectory.trajectory import Trajectory


def plan(
    safety: SafetyFilter, guidance: Guidance, estimate: Estimate, mission: Trajectory, air: Air | None = None
) -> PayloadTrajectory:
    """Return the trajectory to track along ``mission`` from the time of an ``estimate`` on.

    ``air``: estimated motion and drag of the air; None: not estimated.
    """
    trajectory = safety.filter(estimate.time, guidance.reference(estimate.time, mission), estimate)
    report = safety.report
    guidance.observe(trajectory, report.lag, report.deviation, air, report.standing_slack)
    return trajectory
