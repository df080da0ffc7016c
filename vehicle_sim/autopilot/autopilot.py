"""The onboard autopilot: commands of the ground, and the loop from measurements to rotor speeds.

It knows no bytes and no addresses. Time is an argument everywhere. Where to find what: modes in :mod:`.modes`,
failsafes in :mod:`.failsafe`, prearm checks in :mod:`.arming`, what they share in :mod:`.flight_state`.
"""

from __future__ import annotations

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import AutopilotSettings
from gcs.mavlink import px4
from idc_controller.rotations_float import attitude_of_force, euler_of
from vehicle_sim.autopilot import modes
from vehicle_sim.autopilot.actuation import Actuation, AttitudeTarget
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.answer import ACCEPTED, Answer, denied, rejected_for_now
from vehicle_sim.autopilot.arming import arming_problem
from vehicle_sim.autopilot.attitude_control import NO_RATES
from vehicle_sim.autopilot.failsafe import check_failsafes
from vehicle_sim.autopilot.flight_state import FlightState
from vehicle_sim.autopilot.hold_control import HoldPlan
from vehicle_sim.autopilot.land_detector import LandDetector
from vehicle_sim.autopilot.navigation import Navigation
from vehicle_sim.autopilot.parameter_table import ParameterTable
from vehicle_sim.autopilot.setpoint_stream import SetpointStream
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint, StopPlan
from vehicle_sim.world.rotors import IDLE, Four
from vehicle_sim.world.sensors import Measurement


class Autopilot:
    """One vehicle's autopilot. ``changes`` rises with every change of what a HEARTBEAT shows."""

    def __init__(
        self, airframe: Airframe, parameters: ParameterTable, settings: AutopilotSettings = AutopilotSettings()
    ) -> None:
        weight, thrust_max = airframe.mass * airframe.g, airframe.rotors.thrust_max
        self._state = FlightState(
            airframe,
            parameters,
            settings,
            Navigation(airframe.motor_time_constant, settings.navigation),
            LandDetector(weight, thrust_max, settings.land_detector),
            Actuation(airframe),
            SetpointStream(settings.setpoints),
        )
        self._shown: tuple[int, bool, bool, int] | None = None
        self.changes = 0

    # What the ground sees

    @property
    def armed(self) -> bool:
        """Whether the rotors may turn."""
        return self._state.armed

    @property
    def failsafe(self) -> bool:
        """Whether the vehicle flies otherwise than it was commanded."""
        return self._state.failsafe

    @property
    def mode(self) -> int:
        """The custom mode that is flown, which in a failsafe is not the one that was commanded."""
        return self._state.flown_mode

    @property
    def in_air(self) -> bool:
        """Whether the vehicle flies."""
        return self._state.land.in_air

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        state = self._state
        if not state.land.in_air:
            return mavlink.MAV_LANDED_STATE_ON_GROUND
        return mavlink.MAV_LANDED_STATE_LANDING if state.is_descending else mavlink.MAV_LANDED_STATE_IN_AIR

    @property
    def measurement(self) -> Measurement | None:
        """The vehicle's estimate of its own state; None before the first usable sample."""
        return self._state.navigation.estimate

    @property
    def reported_measurement(self) -> Measurement | None:
        """:attr:`measurement` as it is to be sent: NaN where it was not measured."""
        return self._state.navigation.reported

    @property
    def attitude_target(self) -> AttitudeTarget:
        """What was flown last."""
        return self._state.actuation.target

    @property
    def target_since(self) -> float:
        """When :attr:`attitude_target` began to act (s)."""
        return self._state.actuation.target_since

    @property
    def hover_thrust(self) -> float | None:
        """The vertical thrust (N) that the vehicle has learned to fly with; None before it has flown."""
        return self._state.land.hover_thrust

    @property
    def hold_plan(self) -> HoldPlan | None:
        """How it brakes, holds and descends; None: it does not."""
        return None if self._state.hold is None else self._state.hold.plan

    @property
    def settings(self) -> AutopilotSettings:
        """What it was set up with."""
        return self._state.settings

    @property
    def setpoint_loss_time(self) -> float:
        """Seconds without set-points until the vehicle brakes and holds."""
        return self._state.setpoint_loss_time

    @property
    def wants_setpoints(self) -> bool:
        """Whether the commanded mode is OFFBOARD, flown or interrupted by a failsafe."""
        return self._state.mode == px4.MODE_OFFBOARD

    def is_navigating(self, now: float) -> bool:
        """Whether the sensors deliver."""
        return self._state.navigation.is_valid(now)

    def arming_problem(self, now: float) -> str | None:
        """Return why the vehicle cannot be armed now, None if it can."""
        return arming_problem(self._state, now)

    def has_notices(self) -> bool:
        """Whether there are texts for people that have not been taken."""
        return bool(self._state.notices)

    def take_notices(self) -> list[str]:
        """Return the texts for people since the last call."""
        notices, self._state.notices = self._state.notices, []
        return notices

    # What the ground commands

    def ground_message_received(self, now: float) -> None:
        """A message of any ground has come: the data link is up."""
        self._state.link_time = now

    def arm(self, now: float, force: bool = False) -> Answer:
        """Arm, unless something is wrong; ``force`` skips the checks except that of the sensors."""
        state = self._state
        if state.armed:
            return ACCEPTED
        problem = self.arming_problem(now)
        if problem is not None and (not force or not state.navigation.is_valid(now)):
            return rejected_for_now(f"Arming denied: {problem}")
        state.armed = True
        state.failsafe = False
        state.hold = None
        state.actuation.thrust = 0.0
        state.land.start()
        return ACCEPTED

    def disarm(self, force: bool = False) -> Answer:
        """Stop the rotors, in the air only with ``force``."""
        if self._state.armed and self._state.land.in_air and not force:
            return denied("Disarming denied: in the air")
        self._state.stop()
        return ACCEPTED

    def follow(self, setpoint: AttitudeSetpoint, now: float) -> None:
        """A set-point of the ground that is in control. Two in time end the failsafe that their loss caused."""
        state = self._state
        if state.failsafe and self.wants_setpoints and state.has_fresh_setpoints(now):
            state.failsafe = False
            state.hold = None
            state.notices.append("Set-points are back")
        state.setpoints.add(setpoint, now)

    def take_stop_plan(self, plan: StopPlan) -> None:
        """A stop plan of the ground in control, in place of the last one."""
        self._state.stop_plan = plan

    def enter_offboard(self, setpoint: AttitudeSetpoint, received: float, now: float) -> Answer:
        """Fly the set-points of a ground, the last of which was ``received`` (s) a moment ago."""
        return modes.enter_offboard(self._state, setpoint, received, now)

    def enter_mode(self, custom_mode: int, now: float) -> Answer:
        """Any mode but OFFBOARD."""
        return modes.enter_mode(self._state, custom_mode, now)

    # The onboard loop

    def step(self, measurement: Measurement | None, now: float) -> Four:
        """One step of the onboard loop: four rotor-speed commands (rad/s). None: no sample came this time."""
        state = self._state
        state.now = now
        if measurement is not None:
            state.navigation.update(measurement, state.actuation.commanded_acceleration, now)
        measured = state.navigation.estimate
        if measured is None:
            return IDLE
        flies_setpoints = state.armed and state.mode == px4.MODE_OFFBOARD and not state.failsafe
        state.land.update(measured, state.actuation.thrust, now, learn=flies_setpoints)
        check_failsafes(state, now)
        self._check_touchdown(now)
        speeds = self._fly(measured, now) if state.armed else IDLE
        shown = (self.mode, state.armed, state.failsafe, self.landed_state)
        if shown != self._shown:
            self._shown = shown
            self.changes += 1
        return speeds

    def _fly(self, measured: Measurement, now: float) -> Four:
        """The control law of what is flown: hold and descent, the set-points of OFFBOARD, or waiting armed."""
        state = self._state
        if state.hold is not None:
            attitude, thrust = state.hold.command(measured, now, state.is_supported(now))
            return state.actuation.command(measured, attitude, NO_RATES, thrust, now)
        if state.mode == px4.MODE_OFFBOARD and (setpoint := state.setpoints.at(now)) is not None:
            share = setpoint.thrust
            thrust = state.actuation.thrust if share is None else share * state.airframe.rotors.thrust_max
            return state.actuation.command(measured, setpoint.attitude, setpoint.rates, thrust, now)
        level = attitude_of_force(0.0, 0.0, -1.0, euler_of(measured.attitude)[2])
        return state.actuation.command(measured, level, NO_RATES, 0.0, now)

    def _check_touchdown(self, now: float) -> None:
        state = self._state
        if state.armed and state.is_descending:
            landed = state.land.touched_down and state.is_supported(now)
            if landed or not state.land.in_air:
                state.notices.append("Touch-down: disarmed")
                state.stop()
