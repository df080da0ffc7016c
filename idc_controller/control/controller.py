"""The Integrated Decision Controller: reference and estimate in, set-points out (fig:schCont).

Two interfaces keep it open. Any :class:`~idc_controller.control.mpc.Tracker` can take the MPC's place. A
:class:`~idc_controller.safety.filter_protocol.SafetyFilter` is between the guidance's reference and the tracker,
and deflects it to keep obstacles out of the hull.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.control.force_kernels import directions, setpoints, tracking_error
from idc_controller.control.ground_controller import GroundController
from idc_controller.control.load_adaptation import LoadAdaptation
from idc_controller.control.mpc import Tracker, TrackingOutput
from idc_controller.control.settings import ControllerSettings
from idc_controller.estimation.grounded_links import LinkStates
from idc_controller.estimation.measurements import Estimate
from idc_controller.guidance.progress import Guidance
from idc_controller.guidance.sight import SightLimit
from idc_controller.model.drag import Air
from idc_controller.model.linear import LinearModel
from idc_controller.parameters import SystemParameters
from idc_controller.safety.filter_protocol import SafetyFilter, SafetyReport
from idc_controller.trajectory.flatness import FlatReference, PayloadTrajectory, Reference
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory


class ComputeTime(NamedTuple):
    """Time spent in parts of a step, by the stopwatch that the caller gave (s)."""

    planner: float
    tracker: float


class Decision(NamedTuple):
    """Set-points for all UAVs, and how they came about."""

    time: float
    """Time from which on they act (s)."""
    u: Array
    """Thrust directions (north, east) of all UAVs, then thrusts (3 N,), in the model's coordinates."""
    directions: Array
    """Unit thrust vectors (N, 3) in the world."""
    thrusts: Array
    """(N,) (N)"""
    reference: Reference
    """Reference that was tracked."""
    flat: FlatReference
    """The reference from ``time`` on, one stage a period."""
    iterations: int
    infeasible: bool
    """The tracker's QP had no solution."""
    compute_time: ComputeTime
    safety: SafetyReport
    """Outcome of the safety filter; on the ground it plans nothing."""
    progress_rate: float
    """Rate of the mission's progress: 1 is its own speed, 0 rest."""
    sight: SightLimit
    """Limit of that rate by sight."""
    detours: int
    """Detours taken so far."""


class IntegratedDecisionController:
    """One object a flight; :meth:`decide` once a control period."""

    def __init__(
        self,
        model: LinearModel,
        tracker: Tracker,
        safety: SafetyFilter,
        settings: ControllerSettings,
        stopwatch: Callable[[], float] = lambda: 0.0,
        guidance: Guidance | None = None,
    ) -> None:
        """Args: ``stopwatch`` (s) times the parts of a step for the records; ``guidance``, None: follow the mission."""
        self.parameters: SystemParameters = model.parameters
        self.layout = model.layout
        self.tracker, self.safety, self.settings = tracker, safety, settings
        self.guidance = guidance or Guidance()
        self.load = LoadAdaptation(model, settings)
        self._ground_controller = GroundController(model, settings.period, settings.ground)
        self._hover = self.parameters.hover_thrust
        self._tracked: PayloadTrajectory | None = None
        self._error_limits = settings.position_error_limit, settings.velocity_error_limit
        """Position (m) and velocity error (m/s) of the payload that are answered at most."""
        self._stopwatch = stopwatch
        self._times = settings.period * np.append(np.arange(tracker.horizon + 1), 0.5)

    def reference(self, mission: PayloadTrajectory) -> Reference:
        """Return the reference until the next decision, for the estimator; at first the mission itself."""
        return Reference(self.parameters, self._tracked or mission, self.load.estimate)

    def hover_forces(self, time: float) -> Array:
        """Return the thrusts that hold each UAV at rest under the load as it is learnt, in the wind (N, 3) (N, NED).

        Together they leave the payload level, and no link is loaded against another: vehicles that each learnt their
        own in a manoeuvre would pull it askew.
        """
        rest = RestTrajectory(np.zeros(3), time)
        u = Reference(self.parameters, rest, self.load.estimate).at(np.array([time])).u[0]
        thrusts = u[self.layout.f_setpoint, None]
        tilts = u[self.layout.n_setpoint].reshape(-1, 2)
        down = -np.sqrt(1.0 - np.square(tilts).sum(axis=1, keepdims=True))
        return np.asarray(thrusts * np.hstack([tilts, down]))

    def start(self) -> None:
        """Begin a flight from rest on the ground: the load stays as it was learnt, and the wind."""
        self.load.start()
        self.guidance.start()
        self.safety.start()
        self._tracked = None
        self._error_limits = self.settings.position_error_limit, self.settings.velocity_error_limit

    def decide(
        self,
        estimate: Estimate,
        mission: Trajectory,
        *,
        links: LinkStates | None = None,
        learn_load: bool = True,
        touched_down: bool = True,
    ) -> Decision:
        """Set-points that act from ``estimate.time`` on for one period.

        ``links``: those over a payload on the ground; None: it is in the air. ``touched_down``: it is there after a
        flight, not before it. ``learn_load`` is off while the ground may carry part of it.
        """
        begin, on_ground = self._stopwatch(), links is not None
        trajectory: PayloadTrajectory = mission
        if not on_ground:
            trajectory = plan(self.safety, self.guidance, estimate, mission, self.load.estimate.air)
        self._tracked = None if on_ground else trajectory
        planned = self._stopwatch()
        if on_ground:
            if touched_down:
                self.load.release()
        elif learn_load:
            self.load.learn(estimate)
            self._error_limits = self._followed_limits()
        reference = Reference(self.parameters, trajectory, self.load.estimate)
        # The stages 0 .. N_p, then the middle of the first: a set-point is held for one period, and the reference's at
        # the middle of it leaves the least error.
        flat = reference.at(estimate.time + self._times)
        stages = flat.part(slice(0, -1))
        error = tracking_error(estimate.x, stages.x[0], self._hover, self.layout.n.start, *self._error_limits)
        ready = self._stopwatch()
        if links is not None:
            output = TrackingOutput(np.zeros(self.layout.inputs))
            # Before lift-off thrust along the reference aligns the links, and UAVs that turn after noise would be
            # innovations of rates to an estimator for which the team still stands.
            u = self._ground_controller.setpoints(links, stages) if touched_down else stages.u[0].copy()
            tracked = self._stopwatch()
        else:
            output = self.tracker.track(error, stages, estimate.age)
            tracked = self._stopwatch()
            u = setpoints(output.delta_u, flat.u[-1], self._hover)
            u = self.safety.correct(estimate.time, u, estimate)
        return Decision(
            time=estimate.time,
            u=u,
            directions=directions(u),
            thrusts=u[self.layout.f_setpoint],
            reference=reference,
            flat=stages,
            iterations=output.iterations,
            infeasible=output.infeasible,
            compute_time=ComputeTime(planned - begin, tracked - ready),
            safety=SafetyReport() if on_ground else self.safety.report,
            progress_rate=self.guidance.rate,
            sight=self.guidance.sight,
            detours=self.guidance.detours,
        )

    def _followed_limits(self) -> tuple[float, float]:
        """Return the error limits of the next step.

        A wind that is found raises them as the load is followed: a payload that it has displaced is not to be tilted
        after at once.
        """
        s, (position, velocity) = self.settings, self._error_limits
        wanted = s.position_error_limit, s.velocity_error_limit
        if self.load.wind.air is not None:
            wanted = s.position_error_limit_in_wind, s.velocity_error_limit_in_wind
        share = s.period / s.load_time_constant
        return position + share * (wanted[0] - position), velocity + share * (wanted[1] - velocity)


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
