"""Control step: estimate, decision, set-points, and the stop plan that goes out with them."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gcs.flight.compute_times import ComputeTimes, Part
from idc_controller.arrays import Array
from idc_controller.control.controller import Decision, IntegratedDecisionController
from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.grounded_links import N_ACC, N_DOT, OFF, S_DOT, GroundedLinks, LinkStates, N, S
from idc_controller.estimation.measurements import PAYLOAD, Channel, Estimate, Measurement, Position
from idc_controller.trajectory.stop_plan import Braking, Descent, StopPlan, stop_plan
from idc_controller.trajectory.trajectory import Trajectory


class Setpoints(NamedTuple):
    """Set-points of all vehicles: unit thrust directions (N, 3), NED, and thrusts (N,) (N)."""

    directions: Array
    thrusts: Array

    @classmethod
    def idle(cls, number_of_uavs: int) -> Setpoints:
        """Return upright rotors without thrust."""
        return cls(np.tile([0.0, 0.0, -1.0], (number_of_uavs, 1)), np.zeros(number_of_uavs))


class Hold(NamedTuple):
    """Time (s) from the last set-points that all vehicles have received to their descent without others.

    ``unconfirmed_max``: by how much they may be older than the newest ones; later, a loss of them is detected.
    """

    duration: float = 5.0
    unconfirmed_max: float = 1.0


_HOLD = Hold()
_DESCENT = Descent()


class StepRecord(NamedTuple):
    """One control step, for the records."""

    estimate: Estimate
    decision: Decision


class ControlLoop:
    """Estimator, controller and stop plan. Times are the team's (s)."""

    def __init__(
        self,
        estimator: Estimator,
        controller: IntegratedDecisionController,
        compute_times: ComputeTimes,
        links: GroundedLinks,
        brake: Callable[[float, Array], Braking] = lambda time, state: Braking(),
        descent: Descent = _DESCENT,
    ) -> None:
        """``brake``: the stop of a vehicle without set-points, and ``descent``: how it lands then.

        See :mod:`idc_controller.trajectory.stop_plan`.
        """
        self.estimator, self.controller = estimator, controller
        self.links = links
        self.compute_times, self.brake, self._descent = compute_times, brake, descent
        self.stop_plans: deque[StopPlan] = deque()
        """Of the control steps since the last set-points that all vehicles have received; the first one goes out."""

    @property
    def stop_plan(self) -> StopPlan | None:
        """Stop of all vehicles when set-points are lost; it goes out with the set-points. None: not flying yet."""
        return self.stop_plans[0] if self.stop_plans else None

    @property
    def resting_place(self) -> Array | None:
        """Where the payload (3,) comes to rest by the newest stop plan (m, NED); None: it is not flying yet."""
        if not self.stop_plans:
            return None
        newest = self.stop_plans[-1]
        place: Array = newest.payload_positions(self.controller.parameters, np.array([newest.duration]))[0]
        return place

    def start_links(self, time: float, payload: Array, estimate: Estimate | None = None) -> None:
        """Begin to estimate links over a ``payload`` (12,) on the ground: upright ones, or those of an ``estimate``.

        What the UAVs have of their own of the disturbance forces in the air is an error of their thrusts' directions.
        What all have is the wind's drag, as it was learnt before the ground could push the payload aside.
        """
        p, layout = self.controller.parameters, self.controller.layout
        x, drag, thrusts = np.zeros((6, p.number_of_uavs, 2)), np.zeros(2), np.zeros(p.number_of_uavs)
        unlocated: frozenset[int] = frozenset()
        if estimate is not None:
            parts = (layout.s, layout.s_dot, layout.n, layout.n_dot, layout.n_acc)
            forces, thrusts = estimate.uav_force[:, :2], p.hover_thrust
            drag = np.median(self.controller.load.on_uavs, axis=0)[:2]
            x[[S, S_DOT, N, N_DOT, N_ACC]] = [estimate.x[part].reshape(-1, 2) for part in parts]
            x[OFF] = (forces - np.median(forces, axis=0)) / thrusts[:, None]
            unlocated = self.estimator.health.unusable_poses(Position, time) | self.links.unlocated
        self.links.start(time, payload, x, thrusts, drag, unlocated - {PAYLOAD})

    def add_to_links(self, measurement: Measurement) -> None:
        """Take a measurement over a payload on the ground, without channels that are isolated."""
        measurement = self.estimator.health.usable(measurement)
        if isinstance(measurement, Position):
            isolated = self.estimator.health.isolation.isolated
            wrong = [Channel(measurement.source, Position, part) in isolated for part in (0, 1)]
            measurement = measurement.without(*wrong)
        self.links.add(measurement)

    def estimate(self, effective: float, trajectory: Trajectory) -> Estimate:
        """Return the estimate at ``effective`` (s), about ``trajectory``."""
        self.compute_times.lap(Part.MONITORING)
        estimate = self.estimator.estimate(effective, self.controller.reference(trajectory))
        if steps := self.estimator.new_attitude_steps():
            for step in steps:
                self.estimator.take_attitude_step(step)
                self.controller.load.take_attitude_step(step)
                self.links.take_attitude_step(step)
            estimate = self.estimator.estimate(effective, self.controller.reference(trajectory))
        self.compute_times.lap(Part.ESTIMATION)
        return estimate

    def decide(
        self,
        estimate: Estimate,
        trajectory: Trajectory,
        *,
        links: LinkStates | None = None,
        learn_load: bool,
        touched_down: bool = True,
    ) -> StepRecord:
        """Return the decision on an ``estimate`` of this step; ``links``: over a payload on the ground."""
        self.compute_times.lap(Part.MONITORING)
        decision = self.controller.decide(
            estimate, trajectory, links=links, learn_load=learn_load, touched_down=touched_down
        )
        self.compute_times.lap(Part.CONTROL)
        if links is None and learn_load:
            self.estimator.follow_mass(self.controller.load.payload_mass)
        self.compute_times.shift(decision.compute_time.planner, Part.CONTROL, Part.PLANNING)
        return StepRecord(estimate, decision)

    def send(
        self,
        record: StepRecord,
        effective: float,
        leaves: Array,
        hold: Hold = _HOLD,
        until_landing: float = math.inf,
    ) -> None:
        """Take over the set-points of a step in the air, which leave at ``leaves`` (N,) and act at ``effective``.

        Without set-points the vehicles hold for a while, but land when the payload would: in ``until_landing`` (s),
        zero while it lands. From one plan to the next the descent is brought forward by no more than the time that has
        passed, and put off by no more than twice that: vehicles with plans that differ by a round trip still descend
        together.

        The stop plan goes on only with what every vehicle is known to have received. So a vehicle that is cut off, and
        all that are later, have plans that differ by a round trip of the links at most, whichever each received last.
        """
        self.compute_times.lap(Part.MONITORING)
        self.estimator.setpoints.add(effective, record.decision.u, leaves)
        plans, forces, flat = self.stop_plans, self.controller.hover_forces(effective), record.decision.flat
        left = min(hold.duration, max(until_landing, 0.0))
        if plans:
            passed, left_before = effective - plans[-1].start, plans[-1].descent - plans[-1].start
            left = min(max(left, left_before - 2.0 * passed), left_before + passed)
        landing = self._descent if left <= 0.0 else None
        plan = stop_plan(self.controller.parameters, flat, effective, record.estimate.x, self.brake, landing)
        if landing is None:
            plan = plan._replace(descent=effective + left)
        plans.append(plan._replace(hover_forces=forces))
        received = self.estimator.setpoints.received_by_all(effective, hold.unconfirmed_max)
        while len(plans) > 1 and plans[1].start <= received:
            plans.popleft()
        self.compute_times.lap(Part.STOP_PLAN)

    def stand(self, record: StepRecord, effective: float, links: LinkStates, setpoints: Setpoints) -> None:
        """Take over ``setpoints`` over a payload that stands, which act at ``effective`` (s).

        Vehicles without others descend at once, with the thrust that they have: what they lifted would fall again.
        """
        self.compute_times.lap(Part.MONITORING)
        layout, x = self.controller.layout, record.estimate.x.copy()
        x[layout.s], x[layout.s_dot] = links.x[S].ravel(), links.x[S_DOT].ravel()
        plan = stop_plan(self.controller.parameters, record.decision.flat, effective, x, landing=self._descent)
        self.stop_plans.clear()
        self.stop_plans.append(plan._replace(hover_forces=setpoints.thrusts[:, None] * setpoints.directions))
        self.compute_times.lap(Part.STOP_PLAN)
