"""The onboard autopilot: commands of the ground, and the loop from measurements to rotor speeds.

It knows no bytes and no addresses. Time is an argument everywhere. Where to find what: modes in :mod:`.modes`,
failsafes in :mod:`.failsafe`, prearm checks in :mod:`.arming`, what they share in :mod:`.flight_state`.
"""

import math
from typing import ClassVar

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import AutopilotSettings
from gcs.mavlink import px4
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied, rejected_for_now
from gcs.mavlink.services.parameter_table import ParameterTable
from idc_controller.rotations_float import Vector, attitude_of_force, euler_of
from vehicle_sim.autopilot import modes
from vehicle_sim.autopilot.actuation import NO_RATES, Actuation
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.arming import arming_problem
from vehicle_sim.autopilot.failsafe import COUPLED, check_failsafes
from vehicle_sim.autopilot.flight_state import TIME_TOLERANCE, FlightState
from vehicle_sim.autopilot.land_detector import LandDetector
from vehicle_sim.autopilot.navigation import Navigation
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.setpoint_stream import Setpoint, SetpointStream
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint, StopPlan
from vehicle_sim.world.sensors import ACCELEROMETER_RANGE, Measurement

_ORIGIN: Vector = (0.0, 0.0, 0.0)


class Autopilot:
    """One vehicle's autopilot, which takes its steps with its team in :func:`.onboard_loop.step_together`.

    ``arrays``: its row of the team's. ``changes`` rises with every change of a HEARTBEAT; ``state`` is to be read only.
    """

    state_class: ClassVar[type[FlightState]] = FlightState

    def __init__(
        self,
        airframe: Airframe,
        parameters: ParameterTable,
        settings: AutopilotSettings = AutopilotSettings(),
        arrays: OnboardArrays | None = None,
    ) -> None:
        """``arrays`` of this vehicle in its team; None: it is a team of its own."""
        self.arrays = arrays or OnboardArrays.of([airframe], settings.land_detector)
        self.state = self.state_class(
            airframe,
            parameters,
            settings,
            Navigation(airframe.motor_time_constant, airframe.g, settings.navigation, self.arrays),
            LandDetector(self.arrays),
            Actuation(airframe.rotors.thrust_max, self.arrays),
            SetpointStream(settings.setpoints),
        )
        self._shown: tuple[int, bool, bool, int] | None = None
        self._stands_since = math.inf
        """Since when it has stood on its payload in a descent (s)."""
        self.changes = 0

    # Interface to the ground

    @property
    def armed(self) -> bool:
        """Return True if the rotors may turn."""
        return self.state.armed

    @property
    def is_flying(self) -> bool:
        """Return True if it is armed, and in the air."""
        return self.state.armed and self.state.land.in_air

    @property
    def failsafe(self) -> bool:
        """Return True if the vehicle flies otherwise than it was commanded."""
        return self.state.failsafe

    @property
    def home(self) -> Vector:
        """Where it returns to (NED, m): the origin."""
        return _ORIGIN

    @property
    def mode(self) -> int:
        """The custom mode that is flown, which in a failsafe is not the one that was commanded."""
        return self.state.flown_mode

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        state = self.state
        if not state.land.in_air:
            return mavlink.MAV_LANDED_STATE_ON_GROUND
        return mavlink.MAV_LANDED_STATE_LANDING if state.is_descending else mavlink.MAV_LANDED_STATE_IN_AIR

    @property
    def wants_setpoints(self) -> bool:
        """Return True if the commanded mode is OFFBOARD, flown or interrupted by a failsafe."""
        return self.state.mode == px4.MODE_OFFBOARD

    def arming_problem(self, now: float) -> str | None:
        """Return why the vehicle cannot be armed now, None if it can."""
        return arming_problem(self.state, now)

    def take_notices(self) -> list[str]:
        """Return the STATUSTEXTs to the operator since the last call."""
        notices, self.state.notices = self.state.notices, []
        return notices

    # What the ground commands

    def message_received(self) -> None:
        """A message has come, which may have set a parameter."""
        self._decide_anew()

    def ground_heard(self, now: float) -> None:
        """The data link to the ground is up."""
        self.state.link_time = now

    def arm(self, now: float, force: bool = False) -> Answer:
        """Arm, unless something is wrong; ``force`` skips the checks except that of the sensors."""
        state = self.state
        if state.armed:
            return ACCEPTED
        problem = self.arming_problem(now)
        if problem is not None and (not force or not state.navigation.is_valid(now)):
            return rejected_for_now(f"Arming denied: {problem}")
        state.armed = True
        state.failsafe = False
        state.hold = None
        state.land.start()
        self._decide_anew()
        return ACCEPTED

    def disarm(self, force: bool = False) -> Answer:
        """Stop the rotors, in the air only with ``force``."""
        if self.is_flying and not force:
            return denied("Disarming denied: in the air")
        self.state.stop()
        self._decide_anew()
        return ACCEPTED

    def follow(self, setpoint: Setpoint, now: float) -> None:
        """A set-point of the ground that is in control. Two in time end the failsafe that their loss caused."""
        state = self.state
        if state.failsafe and self.wants_setpoints and state.has_fresh_setpoints(now):
            state.failsafe = False
            state.hold = None
            state.notices.append("Set-points are back")
        state.setpoints.add(setpoint, now)
        self._decide_anew()

    def take_stop_plan(self, plan: StopPlan) -> None:
        """A stop plan of the ground in control, in place of the last one."""
        self.state.stop_plan = plan

    def enter_offboard(self, setpoint: Setpoint, received: float, now: float) -> Answer:
        """Fly the set-points of a ground, the last of which was ``received`` (s) a moment ago."""
        answer = modes.enter_offboard(self.state, setpoint, received, now)
        self._decide_anew()
        return answer

    def enter_mode(self, custom_mode: int, now: float) -> Answer:
        """Any mode but OFFBOARD."""
        answer = modes.enter_mode(self.state, custom_mode, now)
        self._decide_anew()
        return answer

    # The onboard loop

    def sense(self, sample: Measurement, now: float) -> None:
        """Take a sample that is not fresh."""
        estimate = self.state.navigation.update(sample, self.state.actuation.commanded_acceleration, now)
        self.arrays.estimates[0] = math.nan if estimate is None else estimate.as_row()

    def feel(self, force: Vector, now: float) -> None:
        """Take the specific force (body frame, m/s2) of the time since the last step, up to ``now`` (s)."""
        size = math.hypot(*force)
        share = min(ACCELEROMETER_RANGE / size, 1.0) if size > 0.0 else 1.0
        self.state.specific_force = force[0] * share, force[1] * share, force[2] * share

    def decide(self, now: float) -> bool:
        """Check the failsafes, and say what the rotors are to do; return True if a HEARTBEAT changes."""
        state = self.state
        if not state.navigation.has_estimate:
            return False
        self._supervise(now)
        if state.armed:
            self._fly(now)
        shown = (state.flown_mode, state.armed, state.failsafe, self.landed_state)
        self._decide_anew()
        if shown == self._shown:
            self.arrays.idle_until[0] = self._idle_until()
            return False
        self._shown = shown
        self.changes += 1
        return True

    def _supervise(self, now: float) -> None:
        """Take the actions of failsafes and of a touch-down."""
        check_failsafes(COUPLED, self.state, now)
        if self.state.hold is not None:
            self._check_touchdown(now)

    def _decide_anew(self) -> None:
        """Decide with the next step, too: a message of a ground, or the last decision, may have changed anything."""
        state = self.state
        self.arrays.idle_until[0] = -math.inf
        self.arrays.learns[0] = state.armed and state.mode == px4.MODE_OFFBOARD and not state.failsafe

    def _idle_until(self) -> float:
        """Return until when (s) it would decide as it just did, without a ground's message, lift-off or landing."""
        state = self.state
        if state.hold is not None:
            return -math.inf  # its target follows the estimate
        if state.mode == px4.MODE_OFFBOARD:
            setpoints = state.setpoints
            return min(setpoints.held_until, setpoints.last_time + state.setpoint_loss_time) - 2.0 * TIME_TOLERANCE
        return -math.inf if state.armed else math.inf

    def _fly(self, now: float) -> None:
        """The control law of what is flown: hold and descent, the set-points of OFFBOARD, or waiting armed."""
        state = self.state
        if state.hold is None and state.mode == px4.MODE_OFFBOARD:
            setpoint = state.setpoints.at(now)
            if isinstance(setpoint, AttitudeSetpoint):
                state.actuation.follow(setpoint, now)
                return
        measured = state.navigation.estimate
        assert measured is not None
        if state.hold is not None:
            attitude, thrust = state.hold.command(measured, now, state.is_supported(now), state.navigation.is_reckoned)
            state.actuation.command(attitude, NO_RATES, thrust, now)
        else:
            level = attitude_of_force(0.0, 0.0, -1.0, euler_of(measured.attitude)[2])
            state.actuation.command(level, NO_RATES, 0.0, now)

    def _check_touchdown(self, now: float) -> None:
        state = self.state
        if not (state.armed and state.is_descending and not state.land.in_air):
            self._stands_since = math.inf
            return
        self._stands_since = min(self._stands_since, now)
        if self._moves_aside and now - self._stands_since < state.settings.land_detector.rest_timeout:
            return  # with its rotors off its link would fall over
        state.notices.append("Touch-down: disarmed")
        state.stop()

    @property
    def _moves_aside(self) -> bool:
        state, measured = self.state, self.state.navigation.estimate
        if measured is None or state.navigation.is_reckoned:
            return False
        return math.hypot(*measured.velocity[:2]) > state.settings.land_detector.horizontal_speed_max
