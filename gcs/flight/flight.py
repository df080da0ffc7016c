"""One flight, from connecting to disarming: its phases, what is done in each, and the reactions to failsafes."""

import math
from collections.abc import Sequence
from itertools import groupby

import numpy as np

from gcs.flight.alarms import AlarmLog
from gcs.flight.command_sequences import Arming, AutonomousLanding, CommandSequence, Disarming
from gcs.flight.condition import Check, Moment, System, Trigger
from gcs.flight.control_loop import ControlLoop, Setpoints, StepRecord
from gcs.flight.failsafe import Failsafe
from gcs.flight.failsafe_state import FailsafeState
from gcs.flight.flown_mission import FlownMission
from gcs.flight.ground_legs import GroundLegs
from gcs.flight.landing_place import LandingPlace
from gcs.flight.payload_control import PayloadControl
from gcs.flight.phase import CONTROLLED, IN_AIR, STANDING, Phase
from gcs.flight.team import Team
from gcs.mavlink.team_failsafe import Reaction, TeamState
from gcs.mission.cargo import CargoState
from gcs.mission.model import Mission
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Estimate, Measurement
from idc_controller.perception.obstacle_map import ObstacleMap
from idc_controller.trajectory.trajectory import RestTrajectory


class Flight:
    """Flight phases. Times are the team's (s); it neither sends nor receives."""

    def __init__(
        self, mission: Mission, team: Team, control: ControlLoop, alarms: AlarmLog, obstacle_map: ObstacleMap
    ) -> None:
        self.mission, self.control, self._settings = mission, control, mission.system.flight
        self.landing_place = LandingPlace(mission, control.controller.parameters, obstacle_map)
        self.system = System.of(mission, team, control, obstacle_map, self.landing_place)
        """The objects that the conditions of failsafes are evaluated on."""
        self.flown = FlownMission(mission, control, self.landing_place)
        """What is flown of the mission."""
        self.payload_control = PayloadControl(
            control, self.system, self.flown, self._settings.takeoff_landing, mission.system.estimation.lift_off
        )
        self.failsafes = FailsafeState(self.system, alarms)
        self.phase = Phase.CONNECT
        self.may_arm = self.may_take_off = True
        """Whether it goes on from the check before take-off, and with armed vehicles from the ground, by itself."""
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
        self.cargo = CargoState(mission.system)
        self.landings = 0
        self.ground_legs: GroundLegs | None = None
        """What is, or was, done on the ground before the take-off of this flight; None: nothing."""
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
    def is_redirected(self) -> bool:
        """True if orders have taken the place of the mission."""
        return self.stands_down or self.flown.is_redirected

    @property
    def elapsed(self) -> float:
        """Time of the last control step without the seconds for which the vehicles had been up: of what is printed."""
        return self.time - self.system.preflight.uptime

    def reference(self, times: Array) -> tuple[Array, Array]:
        """Return the mission's position and velocity (K, 3) of the payload at ``times`` since take-off began."""
        return self.payload_control.reference(times)

    # Telemetry

    def add_measurements(self, measurements: Sequence[Measurement]) -> Sequence[Measurement]:
        """Take telemetry of the vehicles and of the payload unit; return what is used of it."""
        for taken in measurements:
            self.control.estimator.attitude_steps.add(taken)
        used = self.payload_control.add(measurements) if self.phase in CONTROLLED else measurements
        if self.phase in (Phase.CHECK, Phase.ARM) or self._in_cradles:
            for taken in measurements:
                self.system.preflight.add(taken)
        return used

    @property
    def _in_cradles(self) -> bool:
        return self.phase is Phase.SPOOL_UP and self.payload_control.in_cradles(self.time)

    # Failsafes

    @property
    def _team_state(self) -> TeamState:
        """State of the team. Vehicles that the thrust has lifted from their cradles fly, by their own state."""
        return TeamState.OFFBOARD if self.phase is Phase.SPOOL_UP and not self._in_cradles else self.phase.state

    def raise_failsafe(self, time: float, failsafe: Failsafe, trigger: Trigger) -> None:
        """React to a failsafe, unless a reaction at least as severe is under way."""
        if self.ended and failsafe.reaction is not Reaction.END_CONTROL:
            return
        reaction = self.failsafes.raise_failsafe(time, self._team_state, failsafe, trigger)
        if reaction in (Reaction.REFUSE, Reaction.END_CONTROL):
            self.phase = Phase.ENDED
        elif reaction is Reaction.DISARM:
            self._disarm(time)
        elif reaction is Reaction.RETURN:
            if self.phase in IN_AIR:
                self.flown.return_home(time)
        elif reaction in (Reaction.BRAKE_AND_LAND, Reaction.AUTONOMOUS_LANDING):
            self.flown.brake_and_land(time)
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
        descent = self.flown.descent(time) if estimate is not None and self.phase is Phase.LAND else None
        moment = Moment(self.phase, time, now, self._sequence, estimate, descent)
        raised = self.failsafes.evaluate(check, moment, self._team_state)
        if raised is not None:
            self.raise_failsafe(time, *raised)
        return raised is not None

    # Orders

    def begin(self, mission: Mission) -> None:
        """Fly ``mission`` with the next take-off, of the same system and in the same world."""
        self.mission, self.may_take_off = mission, True
        self.flown.begin(mission)
        if not self.flown.legs.takes_off:  # first what is done on the ground, disarmed
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

    def stand_down(self) -> None:
        """On the ground take off no more: disarm what is armed, and end. Without effect in the air."""
        if self.phase not in STANDING and self.phase is not Phase.CONNECT:
            return
        self.stands_down = True
        if self.phase is Phase.ARM:
            self._disarm(self.time)
        elif self.phase not in (Phase.DISARM, Phase.SPOOL_DOWN):
            self.phase = Phase.ENDED

    @property
    def passed(self) -> list[str]:
        """Sources of what was done, of each once its last leg was: flown, landed, or carried out on the ground."""
        done = [source for source, _ in groupby(self.flown.passed(self.time))]
        return done[:-1] if done and done[-1] == self.next_source else done

    @property
    def next_source(self) -> str | None:
        """Source of what is flown to, or is done on the ground; None: nothing, or it holds for good at the last."""
        on_ground = self.ground_legs.source if self.phase is Phase.ON_GROUND and self.ground_legs is not None else None
        return on_ground or self.flown.next_source(self.time)

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
            if self.failsafes.reaction is Reaction.NONE:
                self.flown.watch_landing_place(time)
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
        elif self.flown.legs.takes_off:
            self._begin_check(time)
        else:
            self._begin_standing(time)

    def _begin_standing(self, time: float) -> None:
        """Go on with the legs on the ground, where the mission has any; the next flight connects anew."""
        if self.reason or self.stands_down or self.flown.legs.ended:
            self.phase = Phase.ENDED
            return
        self.control.stop_plans.clear()
        self.system.preflight.restart(landed=self.landings > 0)
        self._sequence = self.ground_legs = GroundLegs(
            self.system.team, time, self.flown.legs.on_ground(), self.cargo, self._settings, self.flown.carried_out
        )
        self.phase = Phase.ON_GROUND

    def _stand(self, time: float, now: float) -> None:
        if not self._step_sequence(time, now):
            return
        if self.flown.legs.ended:
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
            self.payload_control.pad = RestTrajectory(preflight.payload, time)
            self._ending = None
            self._sequence = Arming(self.system.team, time, self._settings)
            self.phase = Phase.ARM

    def _begin_spool_up(self, time: float) -> None:
        self.flown.spool_up()
        self.payload_control.start(time)
        if math.isnan(self.takeoff_time):
            self.takeoff_time = time
        self.phase = Phase.SPOOL_UP

    def _disarm(self, time: float) -> None:
        self._sequence = self._ending = Disarming(self.system.team, time, self._settings)
        self.phase = Phase.DISARM

    def _fly(
        self, time: float, effective: float, leaves: Array, now: float
    ) -> tuple[Setpoints | None, StepRecord | None]:
        payload = self.payload_control
        if payload.has_lifted_off(time) and self.phase is Phase.SPOOL_UP:
            self._begin_climb(time)
            if self.reason:
                self.flown.brake_and_land(time)
        estimate = payload.estimate(time, effective)
        if self.phase in IN_AIR and self._evaluate(Check.ESTIMATE, time, now, estimate):
            return None, None
        setpoints, self.last_record = payload.control(time, effective, leaves, estimate)
        self._advance(time, estimate, setpoints.thrusts)
        return setpoints, self.last_record

    def _begin_climb(self, time: float) -> None:
        assert self.payload_control.pad is not None
        self.flown.climb(self.mission, time, self.payload_control.pad.position(time))
        self.phase = Phase.CLIMB

    def _advance(self, time: float, estimate: Estimate, thrusts: Array) -> None:
        """Go on to the next phase where this one is over."""
        if self.phase is Phase.SPOOL_UP:
            if self.reason:
                self._spool_down(time, estimate)
            elif self.payload_control.is_spooled_up(time):
                self._begin_climb(time)
        elif self.phase is Phase.SPOOL_DOWN:
            if not thrusts.any():
                self._disarm(time)
        else:
            self.phase = self.flown.phase(time)
            if self.phase is Phase.LAND and self.system.payload.has_touched_down(*self.flown.descent(time), estimate):
                self._touch_down(time, estimate)

    def _touch_down(self, time: float, estimate: Estimate) -> None:
        self.flown.touch_down(time)
        self.landings += 1
        self._spool_down(time, estimate)

    def _spool_down(self, time: float, estimate: Estimate) -> None:
        self.payload_control.stand(time, estimate)
        self.phase = Phase.SPOOL_DOWN
