"""Alarms of the safety guarantee: the plan that is flown, and what flies it, against what the margins allow for."""

import numpy as np

from gcs.flight.alarms import Severity
from gcs.flight.control_loop import StepRecord
from gcs.flight.flight import Flight
from gcs.flight.monitor_step import MonitorStep, Scope, ScopedAlarm
from idc_controller.arrays import Array


class GuaranteeAlarm(ScopedAlarm):
    """Alarms of :class:`Guarantee`. They compare the estimate with bounds: their false-alarm rate is the estimate's."""

    # fmt: off
    PLAN_UNVERIFIED = (Scope.IN_AIR, Severity.WARNING, "check the clearance; fly slower",
        "the plan that is flown comes nearer to an obstacle than the margin (`avoidance.margin`), by exact distances "
        "over its horizon")
    SAFETY_GUARANTEE_VOID = (Scope.IN_AIR, Severity.WARNING, "check the clearance; fly slower",
        "the plan that is flown leads into an obstacle, by exact distances to where it may be, or no QP of the planner "
        "has a solution")
    PLAN_DEVIATION_EXCEEDED = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "check the clearance; check for wind",
        "payload or a UAV is farther from the plan, by the estimate, than the margins allow for "
        "(`safety.planner.tracking`, `uav_tracking`)")
    # fmt: on


class Guarantee:
    """The detector of these."""

    def __init__(self, flight: Flight) -> None:
        self._flight = flight
        self._parameters = flight.mission.system.parameters()
        self._vehicles = flight.control.estimator.measurement_model.vehicles

    def __call__(self, step: MonitorStep) -> None:
        """Raise the alarms of one control step."""
        if step.record is None or not step.in_air:
            return
        safety = step.record.decision.safety
        if safety.infeasible:
            text = "no QP has a solution: the safest of the plan in force and of stops is flown"
            step.raise_alarm(safety.nearest or "team", GuaranteeAlarm.SAFETY_GUARANTEE_VOID, text)
        if not safety.verified:
            is_void = safety.clearance < 0.0
            code = GuaranteeAlarm.SAFETY_GUARANTEE_VOID if is_void else GuaranteeAlarm.PLAN_UNVERIFIED
            margin = self._flight.mission.system.avoidance.margin
            text = f"the plan keeps {safety.clearance:.2f} m (margin {margin:.2f} m)"
            step.raise_alarm(safety.nearest or "team", code, text)
        if safety.payload_bound is None or safety.uav_bound is None:
            return
        payload, uavs = self.deviations(step.record)
        if payload > safety.payload_bound:
            text = f"{payload:.2f} m off the plan (bound {safety.payload_bound:.2f} m)"
            step.raise_alarm("payload", GuaranteeAlarm.PLAN_DEVIATION_EXCEEDED, text)
        for i in np.flatnonzero(uavs > safety.uav_bound).tolist():
            text = f"{uavs[i]:.2f} m off the plan (bound {safety.uav_bound:.2f} m)"
            step.raise_alarm(step.names[i], GuaranteeAlarm.PLAN_DEVIATION_EXCEEDED, text)

    def deviations(self, record: StepRecord) -> tuple[float, Array]:
        """Return how far payload and UAVs (N,) (m) are from the plan, by the estimate.

        The plan is that of the safety filter: a level payload, links along the thrust that its acceleration takes.
        """
        p, estimate = self._parameters, record.estimate
        position, _, acceleration = record.decision.flat.payload[:3, 0]
        link = np.array([0.0, 0.0, p.g]) - acceleration
        expected = position + p.p - np.outer(p.l, link / np.linalg.norm(link))
        found = self._vehicles(estimate.time, estimate.x).values[:, :3]
        return (
            float(np.linalg.norm(estimate.x[:3] - position)),
            np.asarray(np.linalg.norm(found - expected, axis=1)),
        )
