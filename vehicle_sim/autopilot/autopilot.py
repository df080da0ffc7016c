"""The onboard autopilot: arming, modes, failsafes, and the loop from measurements to rotor speeds.

It knows no bytes and no addresses. Time is an argument everywhere.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from idc_controller.rotations_float import Quaternion, Vector, attitude_of_force, euler_of
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.attitude_control import LEVEL, NO_RATES, AttitudeController
from vehicle_sim.autopilot.hold_control import DESCENT_RAMP, HoldController, HoldPlan
from vehicle_sim.autopilot.land_detector import LandDetector
from vehicle_sim.autopilot.navigation import Navigation
from vehicle_sim.autopilot.parameter_table import ParameterTable
from vehicle_sim.autopilot.setpoint_stream import SetpointStream
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint, StopPlan
from vehicle_sim.world.rotors import IDLE, Four, Mixer
from vehicle_sim.world.sensors import Measurement

MEASUREMENT_TIMEOUT = 0.2  # s without a usable sample: the navigation has failed
STANDING_THRUST = 0.9  # of its own weight: with less thrust, something else holds the vehicle
ARMING_TILT_MAX = math.radians(60.0)
ARMING_SPEED_MAX = 1.0  # m/s
ARMING_RATE_MAX = 2.0  # rad/s
STOP_PLAN_AGE = 2.0  # s since the start of a stop plan in which it may still be begun
STOP_PLAN_DISTANCE = 2.0  # m from it: farther away something else has happened
_TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact

_MANUAL_MODES = (px4.MODE_MANUAL, px4.MODE_ALTCTL, px4.MODE_POSCTL)
_TOGETHER_MODES = (px4.MODE_TAKEOFF, px4.MODE_MISSION, px4.MODE_RETURN)


class Answer(NamedTuple):
    """A command's outcome: a MAV_RESULT, and for people the reason of a refusal."""

    result: int
    text: str = ""


ACCEPTED = Answer(mavlink.MAV_RESULT_ACCEPTED)


def denied(text: str) -> Answer:
    """A command that the vehicle does not obey."""
    return Answer(mavlink.MAV_RESULT_DENIED, text)


def rejected_for_now(text: str) -> Answer:
    """A command that may succeed later."""
    return Answer(mavlink.MAV_RESULT_TEMPORARILY_REJECTED, text)


Target = tuple[Quaternion | None, Vector, float]


class Autopilot:
    """One vehicle's autopilot.

    Public state, to be read only: ``armed``, ``failsafe`` (it flies on its own against the ground's intention),
    ``changes`` (rises with every change of what a HEARTBEAT shows), ``measurement`` (the last usable one, or None),
    ``attitude_target`` (attitude or None, rates, thrust 0 .. 1) as last flown, ``target_since`` (s: from when on),
    ``notices`` (texts for people, to be taken away by whoever tells them). ``stop_plan``: the newest of the ground in
    control, to be set.
    """

    def __init__(self, airframe: Airframe, parameters: ParameterTable) -> None:
        self._parameters = parameters
        self._thrust_max = airframe.rotors.thrust_max
        self._weight = airframe.mass * airframe.g
        self._g = airframe.g
        self._attitude_control = AttitudeController(airframe.inertia, airframe.attitude_kp, airframe.attitude_kd)
        self._mixer = Mixer(airframe.rotors)
        self._navigation = Navigation(airframe.motor_time_constant)
        self._land = LandDetector(self._weight, self._thrust_max)
        self._mode = px4.MODE_HOLD
        self._hold: HoldController | None = None
        self._setpoints = SetpointStream()
        self._link_time = -math.inf
        self._measured_at = -math.inf
        self._thrust = 0.0  # N, as commanded last
        self._now = -math.inf  # of the last step
        self._shown: tuple[int, bool, bool, int] | None = None
        self.armed = False
        self.failsafe = False
        self.changes = 0
        self.measurement: Measurement | None = None
        self.attitude_target: Target = (LEVEL, NO_RATES, 0.0)
        self.target_since = -math.inf
        self.notices: list[str] = []
        self.stop_plan: StopPlan | None = None

    # What the ground sees

    @property
    def mode(self) -> int:
        """The custom mode that is flown, which in a failsafe is not the one that was asked for."""
        if not self.failsafe:
            return self._mode
        return px4.MODE_LAND if self._is_descending else px4.MODE_HOLD

    @property
    def in_air(self) -> bool:
        """Whether the vehicle flies."""
        return self._land.in_air

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        if not self._land.in_air:
            return mavlink.MAV_LANDED_STATE_ON_GROUND
        return mavlink.MAV_LANDED_STATE_LANDING if self._is_descending else mavlink.MAV_LANDED_STATE_IN_AIR

    @property
    def told_measurement(self) -> Measurement | None:
        """:attr:`measurement` as it is to be told: NaN where it was not measured."""
        return self._navigation.told

    @property
    def hover_thrust(self) -> float | None:
        """The vertical thrust (N) that the vehicle has learned to fly with; None before it has flown."""
        return self._land.hover_thrust

    @property
    def setpoint_loss_time(self) -> float:
        """Seconds without set-points until the vehicle brakes and holds."""
        return self._parameters[px4.PARAM_SETPOINT_LOSS]

    @property
    def wants_setpoints(self) -> bool:
        """Whether the mode asked for is OFFBOARD, flown or interrupted by a failsafe."""
        return self._mode == px4.MODE_OFFBOARD

    def has_fresh_setpoints(self, now: float) -> bool:
        """Whether the set-points of OFFBOARD have not stopped."""
        return now - self._setpoints.last_time < self.setpoint_loss_time - _TIME_TOLERANCE

    def is_navigating(self, now: float) -> bool:
        """Whether the sensors deliver."""
        return now - self._measured_at <= MEASUREMENT_TIMEOUT

    def arming_problem(self, now: float) -> str | None:
        """Why the vehicle cannot be armed now, None if it can."""
        measured = self.measurement
        if measured is None or not self.is_navigating(now):
            return "no navigation data"
        _, x, y, _ = measured.attitude
        if 1.0 - 2.0 * (x * x + y * y) < math.cos(ARMING_TILT_MAX):
            return "the vehicle lies on its side"
        if math.hypot(*measured.velocity) > ARMING_SPEED_MAX or math.hypot(*measured.rates) > ARMING_RATE_MAX:
            return "the vehicle moves"
        if self._mode == px4.MODE_OFFBOARD and not self.has_fresh_setpoints(now):
            return "OFFBOARD without set-points"
        return None

    # What the ground commands

    def ground_message_received(self, now: float) -> None:
        """A message of any ground has come: the data link is up."""
        self._link_time = now

    def arm(self, now: float, force: bool = False) -> Answer:
        """Arm, unless something is wrong; ``force`` skips the checks except that of the sensors."""
        if self.armed:
            return ACCEPTED
        problem = self.arming_problem(now)
        if problem is not None and (not force or not self.is_navigating(now)):
            return rejected_for_now(f"Arming denied: {problem}")
        self.armed = True
        self.failsafe = False
        self._hold = None
        self._thrust = 0.0
        self._land.start()
        return ACCEPTED

    def disarm(self, force: bool = False) -> Answer:
        """Stop the rotors, in the air only with ``force``."""
        if self.armed and self._land.in_air and not force:
            return denied("Disarming denied: in the air")
        self._stop()
        return ACCEPTED

    def follow(self, setpoint: AttitudeSetpoint, now: float) -> None:
        """A set-point of the ground that is in control. Two in time end the failsafe that their loss caused."""
        if self.failsafe and self.wants_setpoints and self.has_fresh_setpoints(now):
            self.failsafe = False
            self._hold = None
            self.notices.append("Set-points are back")
        self._setpoints.add(setpoint, now)

    def enter_offboard(self, setpoint: AttitudeSetpoint, received: float, now: float) -> Answer:
        """Fly the set-points of a ground, the last of which was ``received`` (s) a moment ago."""
        if self._land.in_air and not self.is_navigating(now):
            return rejected_for_now("OFFBOARD denied: no navigation data")
        self._mode = px4.MODE_OFFBOARD
        self.failsafe = False
        self._hold = None
        self._setpoints.clear()
        self._setpoints.add(setpoint, received)
        return ACCEPTED

    def enter_mode(self, custom_mode: int, now: float) -> Answer:
        """Any mode but OFFBOARD."""
        name = px4.mode_name(custom_mode)
        if custom_mode in _TOGETHER_MODES:
            return denied(f"{name} denied: one vehicle alone would tip the payload; fly together in OFFBOARD")
        if custom_mode in _MANUAL_MODES:
            if self.armed:
                return denied(f"{name} denied: no manual control")
            self._mode = custom_mode
            return ACCEPTED
        if custom_mode == px4.MODE_LAND:
            return self._land_here(now)
        if custom_mode != px4.MODE_HOLD:
            return denied(f"{name} denied: no such mode")
        # Asked again, or while it stops on its own, it goes on with its plan: its neighbours do.
        keeps = self._hold is not None and not self._is_descending
        self._mode = px4.MODE_HOLD
        self.failsafe = False
        if keeps and self._hold is not None:
            self._hold.plan = replace(self._hold.plan, descent_start=math.inf)
        else:
            self._hold = None
            if self.armed and self._is_up:
                self._begin_hold(now, descent_start=math.inf)
        return ACCEPTED

    # The onboard loop

    def step(self, measurement: Measurement | None, now: float) -> Four:
        """One step of the onboard loop: four rotor-speed commands (rad/s). None: no sample came this time."""
        self._now = now
        if measurement is not None:
            self.measurement = self._navigation.update(measurement, self._attitude_control.asked)
            if measurement.is_usable():
                self._measured_at = now
        measured = self.measurement
        if measured is None:
            return IDLE
        flies_setpoints = self.armed and self._mode == px4.MODE_OFFBOARD and not self.failsafe
        self._land.update(measured, self._thrust, now, learn=flies_setpoints)
        self._watch(now)
        speeds = self._fly(measured, now) if self.armed else IDLE
        shown = (self.mode, self.armed, self.failsafe, self.landed_state)
        if shown != self._shown:
            self._shown = shown
            self.changes += 1
        return speeds

    def _fly(self, measured: Measurement, now: float) -> Four:
        attitude: Quaternion | None
        rates = NO_RATES
        if self._hold is not None:
            attitude, thrust = self._hold.command(measured, now, self._is_standing(now))
        elif self._mode == px4.MODE_OFFBOARD and (setpoint := self._setpoints.at(now)) is not None:
            attitude, rates, share, _ = setpoint
            thrust = self._thrust if share is None else share * self._thrust_max
        else:  # armed, on the ground, waiting
            attitude, thrust = attitude_of_force(0.0, 0.0, -1.0, euler_of(measured.attitude)[2]), 0.0
        if thrust > self._thrust_max:
            thrust = self._thrust_max
        self._thrust = thrust
        self._show_target((attitude, rates, thrust / self._thrust_max))
        if thrust <= 0.0:
            self._attitude_control.asked = NO_RATES
            return IDLE
        tau_x, tau_y, tau_z = self._attitude_control.torque(measured.attitude, measured.rates, attitude, rates)
        return self._mixer.rotor_speeds(thrust, tau_x, tau_y, tau_z)

    def _watch(self, now: float) -> None:
        """Failsafes and touch-down."""
        if self._mode == px4.MODE_OFFBOARD and not self.failsafe and not self.has_fresh_setpoints(now):
            if self.armed and self._is_up:
                self.failsafe = True
                self._begin_hold(now, descent_start=now + self._parameters[px4.PARAM_LAND_DELAY])
                self.notices.append("Set-points lost: braking and holding")
            else:
                if self.armed:
                    self.notices.append("Set-points lost on the ground: disarmed")
                self._stop()
        elif (
            self._mode == px4.MODE_HOLD
            and self._hold is not None
            and not self._is_descending
            and now - self._link_time > self._parameters[px4.PARAM_LINK_LOSS]
        ):
            self._land_here(now)
            self.failsafe = True
            self.notices.append("No ground station: descending")
        if self.armed and self._hold is not None:
            landed = self._land.touched_down and self._is_standing(now)
            if self._is_descending and (landed or not self._land.in_air):
                self.notices.append("Touch-down: disarmed")
                self._stop()

    @property
    def _is_descending(self) -> bool:
        return self._hold is not None and self._hold.plan.is_descending(self._now)

    @property
    def _is_up(self) -> bool:
        """Off the ground, or upright on its link only because its rotors turn."""
        return self._land.in_air or self._thrust > STANDING_THRUST * self._weight

    def _is_standing(self, now: float) -> bool:
        """Whether it would sink, but something under its payload keeps it from that."""
        sinks = self._hold is not None and now - self._hold.plan.descent_start > DESCENT_RAMP
        return sinks and self._land.touching

    def _land_here(self, now: float) -> Answer:
        if not self.armed:
            return rejected_for_now("AUTO.LAND denied: not flying")
        if not self._land.in_air:
            self._stop()
            return ACCEPTED
        if self._hold is None:
            self._begin_hold(now, descent_start=now)
        elif not self._is_descending:
            self._hold.plan = replace(self._hold.plan, descent_start=now)
        self._mode = px4.MODE_LAND
        self.failsafe = False
        return ACCEPTED

    def _begin_hold(self, now: float, descent_start: float) -> None:
        measured = self.measurement
        if measured is None:
            return
        speed = self._parameters[px4.PARAM_LAND_SPEED]
        plan = self._plan_of_all(measured, now, descent_start, speed) or HoldPlan.braking(
            now, measured.position, measured.velocity, euler_of(measured.attitude)[2], descent_start, speed
        )
        if not self._land.in_air:
            self._land.lift(self._thrust)
        hover = self._land.hover_thrust or max(self._thrust, self._weight)
        self._hold = HoldController(plan, hover, self._weight, self._g)

    def _plan_of_all(
        self, measured: Measurement, now: float, descent_start: float, descent_speed: float
    ) -> HoldPlan | None:
        """The ground's stop plan, if it is of now and of here."""
        told = self.stop_plan
        if told is None or not -self.setpoint_loss_time <= now - told.start <= STOP_PLAN_AGE:
            return None
        plan = HoldPlan(told.start, told.duration, told.control_points, told.yaw, descent_start, descent_speed)
        return plan if math.dist(plan.at(now).position, measured.position) <= STOP_PLAN_DISTANCE else None

    def _show_target(self, target: Target) -> None:
        if target != self.attitude_target:
            self.attitude_target, self.target_since = target, self._now

    def _stop(self) -> None:
        """Rotors off. The vehicle is then in HOLD, and any ground may begin anew."""
        self.armed = False
        self.failsafe = False
        self._hold = None
        self._setpoints.clear()
        self.stop_plan = None
        self._thrust = 0.0
        self._show_target((LEVEL, NO_RATES, 0.0))
        self._mode = px4.MODE_HOLD
        self._land.start()
