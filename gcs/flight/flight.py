"""One flight, from connecting to disarming: its phases, the control step in each, and the reactions to failsafes."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import chain, groupby

import numpy as np

from gcs.flight.alarms import AlarmLog
from gcs.flight.command_sequences import Arming, AutonomousLanding, CommandSequence, Disarming
from gcs.flight.condition import Check, Moment, Reaction, System, Trigger
from gcs.flight.control_loop import ControlLoop, Setpoints, StepRecord
from gcs.flight.failsafe import Failsafe
from gcs.flight.failsafe_state import FailsafeState
from gcs.flight.ground_legs import GroundLegs
from gcs.flight.landing_place import LandingPlace
from gcs.flight.mission_legs import MissionLeg, MissionLegs
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.flight.payload_monitor import PayloadMonitor
from gcs.flight.phase import CONTROLLED, IN_AIR, STANDING, Phase
from gcs.flight.plan_monitor import ImpactMonitor, PlanMonitor
from gcs.flight.preflight import Preflight
from gcs.flight.spool import SpoolUp, Touchdown
from gcs.flight.team import Team
from gcs.mission.cargo import CargoState
from gcs.mission.model import Mission
from idc_controller.arrays import Array
from idc_controller.estimation.grounded_links import LinkStates
from idc_controller.estimation.measurements import Estimate, Measurement
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.trajectory.flatness import Reference
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory


class Flight:
    """Flight phases and control step. Times are the team's (s); it neither sends nor receives."""

    def __init__(
        self, mission: Mission, team: Team, control: ControlLoop, alarms: AlarmLog, obstacle_map: ObstacleMap
    ) -> None:
        self.mission, self.control, self._settings = mission, control, mission.system.flight
        settings = self._settings
        payload, preflight = PayloadMonitor(control.controller.parameters, settings), Preflight(team, settings)
        plan = PlanMonitor(control.controller.parameters.number_of_uavs, settings.failsafe)
        self.landing_place = LandingPlace(mission, control.controller.parameters, obstacle_map)
        self.system = System(
            team, control.estimator, control.controller.guidance, payload, preflight, plan, ImpactMonitor(team.links),
            obstacle_map, settings.failsafe, mission.system.avoidance.margin + mission.system.safety.planner.tracking,
            1.0 / mission.system.rates.control, landing_place=self.landing_place, links=control.links,
            landing_speed=mission.system.motion.landing_speed,
        )  # fmt: skip
        """The objects that the conditions of failsafes are evaluated on."""
        self.failsafes = FailsafeState(self.system, alarms)
        self.phase = Phase.CONNECT
        self.may_arm = self.may_take_off = True
        """Whether it goes on from the check before take-off, and with armed vehicles from the ground, by itself."""
        self.is_redirected = False
        """True if orders in flight have taken the place of the mission."""
        self.is_ready = False
        """True while the check before take-off is passed."""
        self.stands_down = False
        """True if it takes off no more, whatever legs are left."""
        self.time = 0.0
        """Team time of the last control step."""
        self.started = math.nan
        """Team time of the first control step; nan before."""
        self.ground_time = 0.0
        """Ground time of the last control step."""
        self.last_record: StepRecord | None = None
        """The last control step that had an estimate; None before take-off."""
        self.takeoff_time = math.nan
        """Time at which the rotors began to spool up for the first time; nan before."""
        self.legs, self.cargo = MissionLegs.of(mission), CargoState(mission.system)
        self.landings = 0
        self.ground_legs: GroundLegs | None = None
        """What is, or was, done on the ground before the take-off of this flight; None: nothing."""
        self.mission_trajectory: MissionTrajectory | None = None
        """Of this flight, from the beginning of its climb until the rotors spool up for the next; else None."""
        self._flown: list[str] = []
        """Sources of the legs before the trajectory that is flown, in the order of the flight."""
        self._home: Array | None = None
        self._pad: Trajectory | None = None
        self._spool_up: SpoolUp | None = None
        """None once the payload has lifted off."""
        self._touchdown: Touchdown | None = None
        self._sequence: CommandSequence | None = None
        self._ending: CommandSequence | None = None

    @property
    def ended(self) -> bool:
        """True if there is nothing left to do."""
        return self.phase is Phase.ENDED

    @property
    def landed(self) -> bool:
        """True if the vehicles have reported that they are disarmed after the flight."""
        return self.ended and self._ending is not None and self._ending.done

    @property
    def completed(self) -> bool:
        """True if the whole mission was flown and the payload set down."""
        return self.landed and not self.reason

    @property
    def reason(self) -> str:
        """Reason for which the flight was ended early; empty: none."""
        return self.failsafes.reason

    @property
    def elapsed(self) -> float:
        """Time of the last control step without the seconds for which the vehicles had been up: of what is printed."""
        return self.time - self.system.preflight.uptime

    @property
    def expected_end(self) -> float:
        """The end of the mission trajectory (s); inf while that is not known."""
        return self.mission_trajectory.trajectory.end if self.mission_trajectory is not None else math.inf

    def reference(self, times: Array) -> tuple[Array, Array]:
        """Return the mission's position and velocity (K, 3) of the payload at ``times`` since take-off began."""
        if self.mission_trajectory is not None:
            progress = self.system.guidance.progress
            return self.mission_trajectory.reference(np.array([progress(t) for t in times.tolist()]))
        assert self._pad is not None
        position, velocity = self._pad.derivatives(times, 1)
        return position, velocity

    # Telemetry

    def add_measurements(self, measurements: Sequence[Measurement]) -> Sequence[Measurement]:
        """Take telemetry of the vehicles and of the payload unit; return what is used of it."""
        for taken in measurements:
            self.control.estimator.attitude_steps.add(taken)
        if self.phase in CONTROLLED:
            for taken in measurements:
                self.system.plan.add(taken)
                if self._spool_up is not None:
                    self._spool_up.detector.add(taken)
            used = [used for taken in measurements if (used := self.control.estimator.add(taken)) is not None]
            if self.phase not in IN_AIR:
                for taken in used:
                    self.control.add_to_links(taken)
                if self._in_cradles:
                    self._add_to_preflight(measurements)
            return used
        if self.phase in (Phase.CHECK, Phase.ARM):
            self._add_to_preflight(measurements)
        return measurements

    def _add_to_preflight(self, measurements: Sequence[Measurement]) -> None:
        for taken in measurements:
            self.system.preflight.add(taken)
        self.system.preflight.attitude_steps = self.control.estimator.attitude_steps.total.copy()

    @property
    def _in_cradles(self) -> bool:
        """True while the rotors spool up, until they lift a vehicle's own weight."""
        if self.phase is not Phase.SPOOL_UP or self._spool_up is None:
            return False
        p, share = self.control.controller.parameters, self._spool_up.share(self.time)
        return bool(np.all(share * p.hover_thrust < p.m * p.g))

    # Failsafes

    def raise_failsafe(self, time: float, failsafe: Failsafe, trigger: Trigger) -> None:
        """React to a failsafe, unless a reaction at least as severe is under way."""
        if self.ended and failsafe.reaction is not Reaction.END_CONTROL:
            return
        reaction = self.failsafes.raise_failsafe(time, self.phase, failsafe, trigger)
        if reaction in (Reaction.REFUSE, Reaction.END_CONTROL):
            self.phase = Phase.ENDED
        elif reaction is Reaction.DISARM:
            self._disarm(time)
        elif reaction is Reaction.RETURN:
            self._return_home(time)
        elif reaction in (Reaction.BRAKE_AND_LAND, Reaction.AUTONOMOUS_LANDING):
            self._brake_and_land(time)
            if reaction is Reaction.AUTONOMOUS_LANDING:
                self._sequence = self._ending = AutonomousLanding(self.system.team, time, self._settings)
                self.phase = Phase.AUTONOMOUS_LANDING

    def check_links(self, time: float, now: float) -> bool:
        """Return whether an autonomous landing begins at team ``time``, ``now`` on the ground's clock.

        To be called at every exchange: a vehicle that stops late stops elsewhere. Also while the rotors spool down: a
        lost vehicle holds with its hover thrust, and those that stop before it leave it the payload.
        """
        if self.phase not in CONTROLLED:
            return False
        self._evaluate(Check.LINK, time, now)
        return self.phase is Phase.AUTONOMOUS_LANDING

    def _evaluate(self, check: Check, time: float, now: float, estimate: Estimate | None = None) -> bool:
        descent = self._progress(time) if estimate is not None and self.phase is Phase.LAND else None
        raised = self.failsafes.evaluate(check, Moment(self.phase, time, now, self._sequence, estimate, descent))
        if raised is not None:
            self.raise_failsafe(time, *raised)
        return raised is not None

    def _brake_and_land(self, time: float) -> None:
        if (flown := self.mission_trajectory) is not None:
            self._leave(time, flown.brake_and_land)

    def _return_home(self, time: float) -> None:
        if (flown := self.mission_trajectory) is not None and self.phase in IN_AIR:
            self._leave(time, flown.return_home)

    def _leave(self, time: float, change: Callable[[Trajectory, float], None]) -> None:
        """Change what is flown, by a function of the trajectory that is followed and of the progress (s) along it."""
        assert self.mission_trajectory is not None
        self.landing_place.waiting_since = math.inf
        guidance = self.system.guidance
        guidance.speed_limit = math.inf  # of what was flown
        trajectory, rest = self.mission_trajectory.trajectory, self.control.resting_place
        followed, progress = guidance.stopping_trajectory(time, trajectory, rest)
        change(followed, progress)
        guidance.restart(time, progress)

    # Orders

    def begin(self, mission: Mission) -> None:
        """Fly ``mission`` with the next take-off, of the same system and in the same world."""
        self.mission, self.legs = mission, MissionLegs.of(mission)
        self.may_take_off = True
        if not self.legs.takes_off:  # first what is done on the ground, disarmed
            if self.phase is Phase.CHECK:
                self._begin_standing(self.time)
            elif self.phase is Phase.ARM:
                self._disarm(self.time)

    @property
    def is_at_rest(self) -> bool:
        """True while the payload is planned to hold, and is planned to be at rest already."""
        if self.phase is not Phase.HOLD or self.last_record is None:
            return False
        speed = float(np.linalg.norm(self.last_record.decision.flat.payload[1, 0]))
        return speed < self._settings.takeoff_landing.hold_speed

    @property
    def is_held(self) -> bool:
        """True from :meth:`hold` until other legs are flown."""
        return self.mission_trajectory is not None and self.mission_trajectory.is_held

    def hold(self) -> None:
        """Come to rest within the limits, and hold there. Only as :meth:`fly`."""
        if (flown := self.mission_trajectory) is None or flown.is_held:
            return
        mission_progress = self.system.guidance.progress(self.time)
        self._leave(self.time, lambda followed, progress: flown.hold(followed, progress, mission_progress))

    def remaining(self) -> Iterator[MissionLeg]:
        """Return what remains of the legs that were flown before :meth:`hold`."""
        assert self.mission_trajectory is not None
        return chain(self.mission_trajectory.remaining(), self.legs)

    def resume(self, speed: float) -> None:
        """Go on with the legs that were flown before :meth:`hold`, none faster than ``speed`` (m/s)."""
        self._fly_on(self.remaining(), speed)

    def fly(self, legs: Iterator[MissionLeg], speed: float) -> None:
        """Come to rest within the limits, then fly ``legs`` from there, none faster than ``speed`` (m/s).

        They end with a hold or a landing, after which others may follow. Only before the landing, and while no failsafe
        lands the payload.
        """
        self.is_redirected = True
        self._fly_on(legs, speed)

    def _fly_on(self, legs: Iterator[MissionLeg], speed: float) -> None:
        assert self.mission_trajectory is not None
        self._flown, self.legs = self._legs_flown, MissionLegs(legs)
        go_on = self.mission_trajectory.go_on
        self._leave(self.time, lambda followed, progress: go_on(followed, progress, self.legs.flight(), speed))

    def stand_down(self) -> None:
        """On the ground take off no more: disarm what is armed, and end. Without effect in the air."""
        if self.phase not in STANDING and self.phase is not Phase.CONNECT:
            return
        self.stands_down = self.is_redirected = True
        if self.phase is Phase.ARM:
            self._disarm(self.time)
        elif self.phase not in (Phase.DISARM, Phase.SPOOL_DOWN):
            self.phase = Phase.ENDED

    @property
    def passed(self) -> list[str]:
        """Sources of what was done, of each once its last leg was: flown, landed, or carried out on the ground."""
        done = [source for source, _ in groupby(self._legs_flown)]
        return done[:-1] if done and done[-1] == self.next_source else done

    @property
    def _legs_flown(self) -> list[str]:
        flown = None if self._touchdown is not None else self.mission_trajectory
        if flown is None:
            return self._flown
        return [*self._flown, *flown.passed(self.system.guidance.progress(self.time))]

    @property
    def next_source(self) -> str | None:
        """Source of what is flown to, or is done on the ground; None: nothing, or it holds for good at the last."""
        flown = None if self._touchdown is not None else self.mission_trajectory
        if flown is not None:
            return flown.next_source(self.system.guidance.progress(self.time))
        on_ground = self.ground_legs.source if self.phase is Phase.ON_GROUND and self.ground_legs is not None else None
        return on_ground or self.legs.next_source

    # Phases

    def step(
        self, time: float, effective: float, leaves: Array, now: float
    ) -> tuple[Setpoints | None, StepRecord | None]:
        """Make one control step.

        Args:
            time: team time (s).
            effective: when its set-points act (s).
            leaves: when they leave for each vehicle (N,) (s).
            now: the ground's time (s).

        Returns:
            The set-points, None: nothing is to be sent; and what was estimated and decided, if anything was.
        """
        self.time, self.ground_time = time, now
        if math.isnan(self.started):
            self.started = time
        self.system.steps.add(time)
        self._evaluate(Check.STEP, time, now)
        if self.phase in IN_AIR:
            self._evaluate(Check.IN_AIR, time, now)
            if self.mission_trajectory is not None and self.failsafes.reaction is Reaction.NONE:
                self.landing_place.watch(time, self.mission_trajectory, self.system.guidance)
        match self.phase:
            case Phase.CONNECT:
                self._connect(time, now)
            case Phase.CHECK:
                self._check(time, now)
            case Phase.ARM:
                if self._is_armed(time, now) and self.may_take_off:
                    self._begin_spool_up(time)
                return (None if self.reason else self._idle()), None
            case Phase.AUTONOMOUS_LANDING:
                if self._step_sequence(time, now):
                    self.phase = Phase.ENDED
            case Phase.ON_GROUND:
                self._stand(time, now)
            case Phase.DISARM:
                if self._step_sequence(time, now):
                    self._begin_standing(time)
                # A vehicle that is not disarmed yet must not react to set-point loss, and rise.
                return self._idle(), None
            case Phase.ENDED:
                pass
            case _:
                return self._fly(time, effective, leaves, now)
        return None, None

    def _idle(self) -> Setpoints:
        return Setpoints.idle(self.control.controller.parameters.number_of_uavs)

    def _step_sequence(self, time: float, now: float) -> bool:
        assert self._sequence is not None
        self._sequence.step(time, now)
        return not self._evaluate(Check.COMMAND, time, now) and self._sequence.done

    def _is_armed(self, time: float, now: float) -> bool:
        assert self._sequence is not None
        if not self._sequence.done:
            return self._step_sequence(time, now)
        if not self.system.team.armed:
            self.stand_down()  # a vehicle has disarmed by itself
            return False
        return True

    def _connect(self, time: float, now: float) -> None:
        preflight = self.system.preflight
        preflight.uptime = max(float(math.floor(time - now)), 0.0)
        if not preflight.connect(now):
            self._evaluate(Check.CONNECT, time, now)
        elif self.legs.takes_off:
            self._begin_check(time)
        else:
            self._begin_standing(time)

    def _begin_standing(self, time: float) -> None:
        """Go on with the legs on the ground, where the mission has any; the next flight connects anew."""
        if self.reason or self.stands_down or self.legs.ended:
            self.phase = Phase.ENDED
            return
        self.control.stop_plans.clear()
        self.system.preflight.restart(landed=self.landings > 0)
        self._flown = self._legs_flown
        self._sequence = self.ground_legs = GroundLegs(
            self.system.team, time, self.legs.on_ground(), self.cargo, self._settings, self._flown.append
        )
        self.phase = Phase.ON_GROUND

    def _stand(self, time: float, now: float) -> None:
        if not self._step_sequence(time, now):
            return
        if self.legs.ended:
            self.phase = Phase.ENDED
        elif self.system.preflight.connect(now):
            self._begin_check(time)
        else:
            self._evaluate(Check.CONNECT, time, now)

    def _begin_check(self, time: float) -> None:
        self.system.preflight.check_start = time
        self.phase = Phase.CHECK

    def _check(self, time: float, now: float) -> None:
        preflight = self.system.preflight
        passed = not self._evaluate(Check.PREFLIGHT, time, now)
        self.is_ready = passed and preflight.is_current(time) and preflight.is_settled(time)
        if self.is_ready and self.may_arm:
            self._pad = RestTrajectory(preflight.payload, time)
            self._ending = None
            self._sequence = Arming(self.system.team, time, self._settings)
            self.phase = Phase.ARM

    def _begin_spool_up(self, time: float) -> None:
        assert self._pad is not None
        if self.landings:
            self._touchdown = self.mission_trajectory = None
            self.control.controller.start()
        load = self.control.controller.load.estimate
        start = Reference(self.control.controller.parameters, self._pad, load).at(np.array([time])).x[0]
        self.control.estimator.start(time, start, load)
        self.control.estimator.setpoints.add(time, None)
        self.control.start_links(time, start[:12])
        lift_off = self.mission.system.estimation.lift_off
        self._spool_up = SpoolUp(self.control, time, self._settings.takeoff_landing, lift_off)
        if math.isnan(self.takeoff_time):
            self.takeoff_time, self._home = time, self._pad.position(time)
        self.phase = Phase.SPOOL_UP

    def _disarm(self, time: float) -> None:
        self._sequence = self._ending = Disarming(self.system.team, time, self._settings)
        self.phase = Phase.DISARM

    def _fly(
        self, time: float, effective: float, leaves: Array, now: float
    ) -> tuple[Setpoints | None, StepRecord | None]:
        if self._spool_up is not None and self._spool_up.has_lifted_off(time):
            self._spool_up = None
            if self.phase is Phase.SPOOL_UP:
                self._begin_climb(time)
        trajectory = self._followed()
        if (touchdown := self._touchdown) is not None:
            self.control.estimator.hold_payload(time, touchdown.trajectory.position(time), touchdown.yaw)
        estimate = self.control.estimate(effective, trajectory)
        in_air = self.phase in IN_AIR
        if in_air and self._spool_up is not None:
            self._spool_up.continue_in_climb(self.system.plan.below_plan(estimate.x[2]))
        if in_air and self._evaluate(Check.ESTIMATE, time, now, estimate):
            return None, None
        links = None if in_air else self.control.links.at(estimate.time)
        self.last_record = record = self.control.decide(
            estimate,
            trajectory,
            links=links,
            learn_load=self.system.payload.may_be_weighed(estimate),
            touched_down=self._touchdown is not None,
        )
        thrusts = self._thrusts(time, record.decision.thrusts, links)
        if links is not None:
            tilts = record.decision.u[self.control.controller.layout.n_setpoint].reshape(-1, 2)
            self.control.links.command(effective, tilts, thrusts)
        setpoints = Setpoints(record.decision.directions, thrusts)
        if self._spool_up is not None:
            self._spool_up.sent(effective, setpoints, leaves, in_air=in_air)
            if self.system.payload.is_clear(estimate):
                self._spool_up = None
        if in_air:
            self.control.send(record, effective, leaves, self.system.team.hold)
            places = self.control.estimator.measurement_model.vehicles(time, record.decision.flat.x[0])
            contradicted = self.control.estimator.health.uav_positions_isolated
            planned_down = float(record.decision.flat.payload[0, 0, 2])
            self.system.plan.compare(estimate.time, places.values[:, :3], contradicted, planned_down)
        self._advance(time, estimate, thrusts)
        return setpoints, record

    def _begin_climb(self, time: float) -> None:
        assert self._pad is not None
        position, legs = self._pad.position(time), self.legs.flight()
        self.mission_trajectory = MissionTrajectory(self.mission, position, time, legs, self._home)
        self.phase = Phase.CLIMB

    def _followed(self) -> Trajectory:
        if self._touchdown is not None:
            return self._touchdown.trajectory
        if self.mission_trajectory is not None:
            return self.mission_trajectory.trajectory
        assert self._pad is not None
        return self._pad

    def _thrusts(self, time: float, hover: Array, links: LinkStates | None) -> Array:
        """Return the thrusts (N,) (N) of UAVs that need ``hover`` (N,) with the payload in the air."""
        if self.phase is Phase.SPOOL_UP and self._spool_up is not None:
            return hover * self._spool_up.share(time)
        if self._touchdown is None or links is None:
            return hover
        return self._touchdown.thrusts(time, hover, links)

    def _progress(self, time: float) -> tuple[float, Trajectory]:
        """Return the progress along the mission trajectory (s), and that."""
        assert self.mission_trajectory is not None
        return self.system.guidance.progress(time), self.mission_trajectory.trajectory

    def _advance(self, time: float, estimate: Estimate, thrusts: Array) -> None:
        """Go on to the next phase where this one is over."""
        if self.phase is Phase.SPOOL_UP:
            if self._spool_up is not None and self._spool_up.share(time) >= 1.0:
                self._begin_climb(time)
        elif self.phase is Phase.SPOOL_DOWN:
            if not thrusts.any():
                self._disarm(time)
        elif self.mission_trajectory is not None:
            progress, trajectory = self._progress(time)
            self.phase = Phase(self.mission_trajectory.phase(progress))
            if self.phase is Phase.LAND and self.system.payload.has_touched_down(progress, trajectory, estimate):
                self._touch_down(time, estimate)

    def _touch_down(self, time: float, estimate: Estimate) -> None:
        assert self.mission_trajectory is not None
        self._flown = [*self._legs_flown, self.mission_trajectory.landing]
        layout = self.control.controller.layout
        self._touchdown = Touchdown(
            RestTrajectory(estimate.x[layout.r_0], time),
            float(estimate.x[layout.Theta][2]),
            time,
            self.control.controller.parameters.m * self.system.team.parameters.g,
            self._settings.takeoff_landing,
        )
        self.control.estimator.setpoints.add(estimate.time, None)
        self.landings += 1
        self.control.start_links(estimate.time, estimate.x[:12], estimate)
        self.phase = Phase.SPOOL_DOWN
