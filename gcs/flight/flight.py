"""One flight, from connecting to disarming: phases, the control step, and every way in which it can end."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gcs.flight.mission_trajectory import Course
from gcs.flight.orders import Arming, Disarming, LandingAlone
from gcs.flight.pad import Pad
from gcs.flight.payload_monitor import PayloadWatch
from gcs.flight.phase import IN_THE_AIR, Phase
from gcs.flight.spool import SpoolDown, spooling_up
from gcs.flight.team import DropOut, Team
from gcs.mission.model import Mission
from idc_controller.control.controller import Decision, IntegratedDecisionController
from idc_controller.estimation.estimate import Estimate
from idc_controller.estimation.estimator import Estimator
from idc_controller.estimation.measurements import Measurement
from idc_controller.estimation.setpoint_history import Confirmation
from idc_controller.trajectory.reference import Reference
from idc_controller.trajectory.stop_plan import Braking, StopPlan, stop_plan
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory

Array = NDArray[np.float64]

CONNECT_TIMEOUT = 10.0  # s
SETTLE_BEFORE_CHECK = 0.5  # s of telemetry that are averaged before take-off
STOP_PLANS = 100  # control steps whose stop plans are remembered
TOLERANCE = 0.01  # s


@dataclass(frozen=True, eq=False)
class StepRecord:
    """One control step, for the records. Times in s; ``*_time`` are spent on it, the rest is team time."""

    estimate: Estimate
    decision: Decision
    estimator_time: float
    controller_time: float


@dataclass(frozen=True, eq=False)
class Setpoints:
    """What the vehicles are to do: unit thrust directions (N, 3) and thrusts (N,) (N)."""

    directions: Array
    thrusts: Array


class Flight:
    """The flight phases and the control step. Times are the team's (s); it neither sends nor receives."""

    def __init__(
        self,
        mission: Mission,
        team: Team,
        estimator: Estimator,
        controller: IntegratedDecisionController,
        stopwatch: Callable[[], float],
        brake: Callable[[float, Array], Braking] = lambda time, state: Braking(),
    ) -> None:
        """``brake``: the stop of a vehicle without set-points, see :mod:`idc_controller.trajectory.stop_plan`."""
        self._brake = brake
        self.mission, self.team = mission, team
        self.estimator, self.controller = estimator, controller
        self._stopwatch = stopwatch
        self._parameters = controller.parameters
        self.phase = Phase.CONNECT
        self.reason = ""
        """Why the flight was broken off; empty: it was not."""
        self.broken_off_time = math.nan
        """When the reason to end early was found (s)."""
        self.interrupted = False
        self.course: Course | None = None
        self.time = 0.0
        """Team time of the last control step."""
        self.takeoff_time = math.nan
        """When the rotors began to spool up; nan before."""
        self.landed = False
        self._called = math.nan
        self._since = math.nan
        self._on_pad = Pad(controller.parameters.number_of_uavs)
        self.payload = PayloadWatch(controller.parameters)
        self._pad: Trajectory | None = None
        self._arming: Arming | None = None
        self._disarming: Disarming | None = None
        self._landing_alone: LandingAlone | None = None
        self._down: Trajectory | None = None
        self._yaw = 0.0
        self._spool_down: SpoolDown | None = None
        self._stop_plans: deque[StopPlan] = deque(maxlen=STOP_PLANS)
        self.stop_plan: StopPlan | None = None
        """What all vehicles are to do together when they hear no more; goes out with the set-points."""

    @property
    def ended(self) -> bool:
        """Whether there is nothing left to do."""
        return self.phase is Phase.ENDED

    @property
    def completed(self) -> bool:
        """Whether the whole mission was flown and the payload set down."""
        return self.ended and self.landed and not self.reason and not self.interrupted

    @property
    def owes_descent(self) -> bool:
        """Whether vehicles hold that are still to be told to descend."""
        return self._landing_alone is not None and not self._landing_alone.descends

    @property
    def expected_end(self) -> float:
        """When the course ends (s); inf while that is not known."""
        return self.course.trajectory.end if self.course is not None else math.inf

    @property
    def reference(self) -> Trajectory | None:
        """What the mission asks of the payload; None before take-off."""
        if self.course is not None:
            return self.course.trajectory
        return self._pad

    @property
    def pose_noise(self) -> float:
        """Factor of the noise of telemetry over that of the system file, as the filter sees it, 1 or more."""
        return math.sqrt(self.estimator.health.adaptation.measurement_scale)

    def asked(self, times: Array) -> tuple[Array, Array]:
        """Position and velocity (K, 3) that the mission asks of the payload at ``times`` since take-off began."""
        if self.course is not None:
            clock = self.controller.guidance.progress
            return self.course.asked(np.array([clock(t) for t in times]))
        assert self._pad is not None
        position, velocity = self._pad.derivatives(times, 1)
        return position, velocity

    def measured(self, measurement: Measurement) -> Measurement | None:
        """Telemetry of a vehicle or of the payload; returns what is to be believed of it."""
        if self._started:
            return self.estimator.add(measurement)
        if self.phase in (Phase.CHECK, Phase.ARM):
            self._on_pad.measured(measurement)
        return measurement

    def flown(
        self, uav: int, since: float, until: float, told: Array, spread: float, longest: float
    ) -> Confirmation | None:
        """A vehicle says what it flew from ``since`` to ``until``, tilt (north, east) and thrust (N) (3,).

        ``spread``: by how much the time varies that datagrams take to it (s); ``longest``: the longest that set-points
        can take to it (s). Returns what the estimator learns of it.
        """
        if self.phase not in IN_THE_AIR:
            return None
        return self.estimator.confirm_setpoint(uav, since, until, told, spread, longest)

    def break_off(self, time: float, reason: str, *, interrupted: bool = False) -> None:
        """End the flight early and safely: on the ground at once, in the air by stopping and landing."""
        if self.phase is Phase.ENDED:
            return
        self.interrupted |= interrupted
        self._note(time, reason)
        if self.phase in (Phase.CONNECT, Phase.CHECK):
            self.phase = Phase.ENDED
        elif self.phase in (Phase.ARM, Phase.SPOOL_UP):
            self._begin_disarming(time)
        elif self.course is not None:
            guidance = self.controller.guidance
            followed, progress = guidance.stopping_trajectory(time, self.course.trajectory)
            self.course.break_off(followed, progress)
            guidance.restart(time, progress)

    def give_up(self, reason: str) -> None:
        """The vehicles cannot be reached any more: they are on their own."""
        self._note(self.time, reason)
        self.phase = Phase.ENDED

    def _note(self, time: float, reason: str) -> None:
        """The first reason counts."""
        if not self.reason:
            self.reason, self.broken_off_time = reason, time

    def watch_team(self, time: float, now: float) -> bool:
        """Whether one has dropped out at team ``time``, ``now`` on the ground's clock, so that now all are left alone.

        Asked whenever something has come: who stops late, stops elsewhere.
        """
        if self.phase not in (Phase.SPOOL_UP, *IN_THE_AIR) or (problem := self._dropped_out(now)) is None:
            return False
        if self.phase is Phase.SPOOL_UP:
            self.break_off(time, problem.reason)
            return False
        self._leave_alone(time, problem.reason, problem.unheard)
        return True

    def _dropped_out(self, now: float) -> DropOut | None:
        if len(lost := self.estimator.health.isolation.uavs_without_position) > 1:
            names = " and ".join(str(self.team.links[i].system_id) for i in lost)
            return DropOut(f"nothing is believed of where vehicles {names} are", 0.0)
        return self.team.dropped_out(now)

    def step(
        self, time: float, effective: float, leaves: Array, now: float
    ) -> tuple[Setpoints | None, StepRecord | None]:
        """One control step at team ``time``; set-points leave at ``leaves`` (N,) and act at ``effective`` (s).

        ``now`` is the ground's time. None as set-points: nothing is to be sent.
        """
        self.time = time
        match self.phase:
            case Phase.CONNECT:
                self._connect(time, now)
            case Phase.CHECK:
                self._check(time)
            case Phase.ARM:
                return self._arm(time), None
            case Phase.ON_THEIR_OWN:
                self._watch_landing(time, now)
            case Phase.DISARM:
                self._disarm(time)
                # One that is not disarmed yet must not take itself for forsaken, and rise.
                return self._idle, None
            case Phase.ENDED:
                pass
            case _:
                return self._fly(time, effective, leaves)
        return None, None

    # On the ground

    def _connect(self, time: float, now: float) -> None:
        # The team's time jumps when the first vehicle is heard: only the ground's own tells how long it has taken.
        if math.isnan(self._called):
            self._called = now
        missing = self.team.missing(now)
        if missing is None:
            self._enter(Phase.CHECK, time)
        elif now - self._called > CONNECT_TIMEOUT:
            self.give_up(missing)

    def _check(self, time: float) -> None:
        if (problem := self.team.unfit()) is not None:
            self.give_up(problem)
            return
        if time - self._since < SETTLE_BEFORE_CHECK:
            return
        if not self._on_pad.is_known:
            if time - self._since > CONNECT_TIMEOUT:
                self.give_up("no position of every vehicle and of the payload")
            return
        if (problem := self.team.misplaced(self._on_pad.vehicles, self._on_pad.payload)) is not None:
            self.give_up(problem)
            return
        self._pad = RestTrajectory(self._on_pad.payload, time)
        self._arming = Arming(self.team, time)
        self._enter(Phase.ARM, time)

    def _arm(self, time: float) -> Setpoints | None:
        assert self._arming is not None and self._pad is not None
        outcome = self._arming.step(time)
        if outcome.problem:
            self.break_off(time, outcome.problem)
            return None
        if outcome.done:
            rest = Reference(self._parameters, self._pad, self.controller.load)
            self.estimator.start(time, rest.at(np.array([time])).x[0])
            self.estimator.add_setpoint(time, None)
            self.takeoff_time = time
            self._enter(Phase.SPOOL_UP, time)
        return self._idle

    def _disarm(self, time: float) -> None:
        assert self._disarming is not None
        outcome = self._disarming.step(time)
        if outcome.done or outcome.problem:
            self.landed = outcome.done
            self.reason = self.reason or outcome.problem
            self._enter(Phase.ENDED, time)

    def _begin_disarming(self, time: float) -> None:
        self._disarming = Disarming(self.team, time)
        self._enter(Phase.DISARM, time)

    # Without one of the vehicles

    def _leave_alone(self, time: float, reason: str, unheard: float = 0.0) -> None:
        """One vehicle is lost to the ground: all do at once what that one does on its own.

        It follows the last stop plan that it has heard, ``unheard`` (s) ago, and descends a set time later. Whatever
        the ground had the others do instead would tear at the payload.
        """
        self.break_off(time, reason)
        heard = [plan for plan in self._stop_plans if plan.start <= time - unheard + TOLERANCE]
        self.stop_plan = heard[-1] if heard else self.stop_plan
        self._landing_alone = LandingAlone(self.team, time)
        self._enter(Phase.ON_THEIR_OWN, time)

    def _watch_landing(self, time: float, now: float) -> None:
        assert self._landing_alone is not None
        outcome = self._landing_alone.step(time, now)
        if outcome.done or outcome.problem:
            self.landed = outcome.done
            self._enter(Phase.ENDED, time)

    # In the air, and on the way there and back

    @property
    def _started(self) -> bool:
        return self.phase in (Phase.SPOOL_UP, *IN_THE_AIR, Phase.SPOOL_DOWN)

    def _fly(self, time: float, effective: float, leaves: Array) -> tuple[Setpoints | None, StepRecord | None]:
        if self.phase in IN_THE_AIR and (blocked := self.controller.guidance.blocked(time)):
            self.break_off(time, blocked)
        trajectory = self._trajectory(time)
        if self._down is not None:
            self.estimator.hold_payload(time, self._down.position(time), self._yaw)
        begin = self._stopwatch()
        estimate = self.estimator.estimate(effective, self.controller.reference(trajectory))
        if self.phase in IN_THE_AIR and self.payload.is_out_of_control(time, estimate):
            self._leave_alone(time, "control of the payload is lost")
            return None, None
        if self.phase is Phase.LAND and self.payload.stays_up(*self._descent(time), estimate):
            self._leave_alone(time, "the payload does not come down")
            return None, None
        estimated = self._stopwatch()
        decision = self.controller.decide(
            estimate, trajectory, standing=self.phase not in IN_THE_AIR, learn_load=self.payload.is_clear(estimate)
        )
        decided = self._stopwatch()
        share = self._thrust_share(time, estimate)
        if self.phase in IN_THE_AIR:
            self.estimator.add_setpoint(effective, decision.u, leaves)
            self.stop_plan = stop_plan(self._parameters, decision.flat, effective, estimate.x, self._brake)
            self._stop_plans.append(self.stop_plan)
        self._advance(time, estimate, share)
        setpoints = Setpoints(decision.directions, decision.thrusts * share)
        return setpoints, StepRecord(estimate, decision, estimated - begin, decided - estimated)

    def _thrust_share(self, time: float, estimate: Estimate) -> float:
        """Of the thrust that carries payload and vehicles."""
        if self.phase is Phase.SPOOL_UP:
            return spooling_up(time - self._since)
        if self._spool_down is None:
            return 1.0
        return self._spool_down.share(time, float(np.abs(estimate.x[self.controller.layout.s]).max()))

    def _trajectory(self, time: float) -> Trajectory:
        if self._down is not None:
            return self._down
        trajectory = self.reference
        assert trajectory is not None
        return trajectory

    def _descent(self, time: float) -> tuple[float, Trajectory]:
        """The course and its clock (s)."""
        assert self.course is not None
        return self.controller.guidance.progress(time), self.course.trajectory

    def _advance(self, time: float, estimate: Estimate, share: float) -> None:
        """From one phase to the next."""
        if self.phase is Phase.SPOOL_UP:
            if share >= 1.0:
                assert self._pad is not None
                self.course = Course(self.mission, self._pad.position(time), time)
                self._enter(Phase.CLIMB, time)
        elif self.phase is Phase.SPOOL_DOWN:
            if share <= 0.0:
                self._begin_disarming(time)
        elif self.course is not None:
            clock = self.controller.guidance.progress(time)
            self.phase = Phase(self.course.phase(clock))
            if self.phase is Phase.LAND and self.payload.has_touched(*self._descent(time), estimate):
                position = estimate.x[self.controller.layout.r_0]
                self._down = RestTrajectory(position, time)
                self._yaw = float(estimate.x[self.controller.layout.Theta][2])
                self.estimator.add_setpoint(estimate.time, None)
                self._spool_down = SpoolDown(time)
                self._enter(Phase.SPOOL_DOWN, time)

    @property
    def _idle(self) -> Setpoints:
        n = self._parameters.number_of_uavs
        return Setpoints(np.tile([0.0, 0.0, -1.0], (n, 1)), np.zeros(n))

    def _enter(self, phase: Phase, time: float) -> None:
        self.phase, self._since = phase, time
