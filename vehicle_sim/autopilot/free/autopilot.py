"""The autopilot of a free vehicle: what any vehicle's does, and flight by position set-points and by itself."""

import math
from typing import ClassVar

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied, rejected_for_now
from idc_controller.rotations_float import Vector, attitude_of_force, euler_of
from vehicle_sim.autopilot.actuation import NO_RATES
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.failsafe import check_failsafes
from vehicle_sim.autopilot.flight_state import TIME_TOLERANCE
from vehicle_sim.autopilot.free import modes
from vehicle_sim.autopilot.free.auto_flight import filled, turn_angle
from vehicle_sim.autopilot.free.failsafe import FREE, is_data_link_lost
from vehicle_sim.autopilot.free.mission import Mission, MissionStep
from vehicle_sim.autopilot.free.position_control import Reference
from vehicle_sim.autopilot.free.state import FreeFlightState
from vehicle_sim.autopilot.position_setpoints import PositionSetpoint
from vehicle_sim.autopilot.setpoint_stream import Setpoint
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.world.sensors import Measurement

_GROUNDED_IN_OFFBOARD = 3.0  # s; until a vehicle that set-points have put on the ground disarms
_OF_OTHER_SPEEDS = {
    px4.MODE_OFFBOARD: "flies the speed of its set-points",
    px4.MODE_LAND: "has no horizontal speed",
    px4.MODE_ORBIT: "flies the speed of its command",
}
"""Modes in which no change of speed has an effect."""


class FreeAutopilot(Autopilot):
    """One vehicle without a payload; see :class:`.Autopilot`, whose interface it has."""

    state: FreeFlightState
    state_class: ClassVar[type[FreeFlightState]] = FreeFlightState
    _control_due = -math.inf
    _last_control = -math.inf
    _held_by_ground_since = math.inf

    @property
    def home(self) -> Vector:
        """Where it returns to (NED, m): where it was armed last, before that where it was first, or as commanded."""
        return self.state.home or super().home

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        found = super().landed_state
        takes_off = found == mavlink.MAV_LANDED_STATE_IN_AIR and self.mode == px4.MODE_TAKEOFF
        return mavlink.MAV_LANDED_STATE_TAKEOFF if takes_off else found

    # What the ground commands

    def arming_problem(self, now: float) -> str | None:
        """See :meth:`.Autopilot.arming_problem`; as in PX4 it wants the ground station whose loss it would react to."""
        problem = super().arming_problem(now)
        if problem is None and self.state.reckoning.is_lost:
            return "no position"
        if problem is None and is_data_link_lost(self.state, now):
            return "NAV_DLL_ACT is set, and no HEARTBEAT of a ground station (MAV_TYPE_GCS) comes"
        estimate = self.state.estimate
        if problem is None and estimate is not None and (breach := self.state.refused_by_fence(estimate.position)):
            return f"beyond the fence: {breach}"
        return problem

    def arm(self, now: float, force: bool = False) -> Answer:
        """See :meth:`.Autopilot.arm`; home is where it stands, and what its mode flies begins."""
        was_armed = self.state.armed
        answer = super().arm(now, force)
        estimate = self.state.estimate
        if answer == ACCEPTED and not was_armed and estimate is not None:
            self.state.reckoning.restart()
            self.state.armed_at = estimate.position
            if not self.state.home_is_commanded:
                self.state.home = estimate.position
            modes.begin(self.state)
        return answer

    def follow(self, setpoint: Setpoint, now: float) -> None:
        """A set-point of the ground that is in control."""
        was_in_failsafe = self.state.failsafe
        super().follow(setpoint, now)
        if was_in_failsafe and not self.state.failsafe:
            self.state.flight = None

    def enter_offboard(self, setpoint: Setpoint, received: float, now: float) -> Answer:
        """Fly the set-points of a ground, the last of which was ``received`` (s) a moment ago."""
        if self.state.armed and self.state.reckoning.is_lost and not isinstance(setpoint, AttitudeSetpoint):
            return modes.without_position("OFFBOARD by position")
        answer = super().enter_offboard(setpoint, received, now)
        if answer == ACCEPTED:
            self.state.flight = None
            estimate = self.state.estimate
            if estimate is not None:
                self.state.motion.start(estimate.position, estimate.velocity, euler_of(estimate.attitude)[2])
        return answer

    def enter_mode(self, custom_mode: int, now: float) -> Answer:
        """Any mode but OFFBOARD; a take-off is to the height of the parameter."""
        return self._enter(custom_mode)

    def _enter(self, custom_mode: int, take_off_altitude: float = math.nan) -> Answer:
        state = self.state
        before, state.take_off_altitude = state.take_off_altitude, take_off_altitude
        answer = modes.enter_mode(state, custom_mode)
        if answer != ACCEPTED:
            state.take_off_altitude = before
        self._decide_anew()
        return answer

    def take_off(self, altitude: float, now: float) -> Answer:
        """Take off to ``altitude`` (m above the ground; NaN: the parameter's), at once or when it is armed."""
        return self._enter(px4.MODE_TAKEOFF, altitude)

    def go_to(self, position: Vector, yaw: float, speed: float, now: float) -> Answer:
        """Fly to ``position`` (NED, m; NaN: where it is) and hold there. ``yaw`` in rad, ``speed`` in m/s; NaN: as is.

        The mode is then HOLD.
        """
        state = self.state
        if not state.armed or not state.land.in_air:
            return rejected_for_now("Reposition denied: not flying")
        if state.reckoning.is_lost:
            return modes.without_position("Reposition")
        estimate = state.estimate
        assert estimate is not None
        if breach := state.refused_by_fence(filled(position, estimate.position)):
            return denied(f"Reposition denied: beyond the fence: {breach}")
        state.mode, state.failsafe = px4.MODE_HOLD, False
        state.speed = speed if speed > 0.0 else state.speed
        state.fly([state.goal(position, yaw, hold=math.inf)])
        self._decide_anew()
        return ACCEPTED

    def change_speed(self, speed: float, now: float) -> Answer:
        """Fly with another horizontal speed (m/s) from now on, up to the next mode that is commanded."""
        state = self.state
        if not state.armed or (not state.land.in_air and state.flight is None):
            return rejected_for_now("Speed change denied: not flying")
        if self.mode in _OF_OTHER_SPEEDS:
            return rejected_for_now(f"Speed change denied: {px4.mode_name(self.mode)} {_OF_OTHER_SPEEDS[self.mode]}")
        state.speed = speed
        return ACCEPTED

    def turn(self, angle: float, rate: float, direction: int, is_relative: bool) -> Answer:
        """Turn to a heading (rad), or by an angle, where it holds or on the way to where it will.

        ``rate`` in rad/s (NaN: that of moving set-points); ``direction`` 1 clockwise, -1 counter-clockwise, 0 the
        shorter way.
        """
        state, rate_max = self.state, self.state.settings.free.yaw_rate
        if not state.armed or state.flight is None or not state.land.in_air:
            return rejected_for_now("Turn denied: not flying")
        if self.mode != px4.MODE_HOLD:
            return rejected_for_now(f"Turn denied: {px4.mode_name(self.mode)} has its own heading; enter AUTO.LOITER")
        if rate > rate_max:
            return denied(
                f"Turn denied: {math.degrees(rate):g} deg/s, the limit is {math.degrees(rate_max):.4g} deg/s", 2
            )
        state.flight.turn(
            turn_angle(state.motion.yaw, angle, direction, is_relative), rate_max if math.isnan(rate) else rate
        )
        return ACCEPTED

    def set_home(self, place: Vector | None) -> Answer:
        """Return to ``place`` (NED, m) from now on, None: to where it is."""
        estimate = self.state.estimate
        if place is None and (estimate is None or not self.state.has_position(self.state.now)):
            return modes.without_position("Home")
        self.state.home_is_commanded = place is not None
        self.state.home = estimate.position if place is None and estimate is not None else place
        if self.mode == px4.MODE_RETURN and self.state.armed:
            modes.return_home(self.state)
        return ACCEPTED

    def replace_steps(self, steps: tuple[MissionStep, ...]) -> None:
        """Fly the mission's items at other places from now on; its progress stays."""
        state = self.state
        state.mission.steps = steps
        if state.armed and state.mode == px4.MODE_MISSION and not state.failsafe:
            modes.fly_mission(state)

    def take_mission(self, mission: Mission) -> None:
        """Have another mission from now on; one that is being flown is flown from its current item."""
        state = self.state
        state.mission = mission
        if state.armed and state.mode == px4.MODE_MISSION and not state.failsafe:
            modes.fly_mission(state)

    def set_current_item(self, index: int) -> None:
        """Go on with item ``index`` of the mission."""
        state = self.state
        state.mission.restart(index)
        if state.armed and state.mode == px4.MODE_MISSION and not state.failsafe:
            modes.fly_mission(state)

    # The onboard loop

    def feel(self, force: Vector, now: float) -> None:
        """See :meth:`.Autopilot.feel`; in flight the position goes on by it while none is measured."""
        super().feel(force, now)
        state = self.state
        if (state.armed or state.reckoning.is_lost) and state.specific_force is not None:
            is_clipped = state.specific_force != force
            state.reckoning.advance(state.specific_force, is_clipped=is_clipped, now=now)

    def _supervise(self, now: float) -> None:
        state = self.state
        estimate = state.estimate
        assert estimate is not None
        if state.home is None:
            state.home = state.armed_at = estimate.position
        check_failsafes(FREE, state, now)
        if state.armed and state.land.in_air:
            self._check_ground(estimate, now)
        if not state.armed or state.flight is None or not state.flight.finished or state.failsafe:
            return
        if state.mode == px4.MODE_MISSION:
            state.mission.done()
            modes.fly_mission(state)
        elif state.mode == px4.MODE_TAKEOFF:
            state.mode = px4.MODE_HOLD
            state.fly([state.goal(state.flight.place, hold=math.inf)])
        elif state.mode == px4.MODE_ORBIT:
            state.mode = px4.MODE_HOLD
            state.hold_here()

    def _check_ground(self, estimate: Measurement, now: float) -> None:
        """Disarm a vehicle that sinks no more though it is commanded to."""
        state, settings = self.state, self.state.settings.free
        carried = state.actuation.thrust < settings.touchdown_thrust * state.airframe.mass * state.airframe.g
        if not carried or abs(estimate.velocity[2]) > settings.touchdown_speed:
            self._held_by_ground_since = math.inf
            return
        self._held_by_ground_since = min(self._held_by_ground_since, now)
        needed = settings.touchdown_time if state.is_descending else _GROUNDED_IN_OFFBOARD
        if now - self._held_by_ground_since < needed:
            return
        if state.mode == px4.MODE_MISSION and state.is_descending and not state.failsafe:
            state.mission.done()
        self._held_by_ground_since = math.inf
        state.notices.append("Touch-down: disarmed")
        state.stop()

    def _decide_anew(self) -> None:
        super()._decide_anew()
        self.arrays.learns[0] = self.state.armed

    def _idle_until(self) -> float:
        return self._control_due - 2.0 * TIME_TOLERANCE if self.state.armed else super()._idle_until()

    def _fly(self, now: float) -> None:
        state, settings = self.state, self.state.settings.free
        follows = state.mode == px4.MODE_OFFBOARD and not state.failsafe
        setpoint = state.setpoints.at(now) if follows else None
        if isinstance(setpoint, AttitudeSetpoint):
            state.reference = None
            state.actuation.follow(setpoint, now)
            self._control_due = now + settings.control_interval
            return
        if now < self._control_due - TIME_TOLERANCE:
            return
        step = min(now - self._last_control, settings.step_max)
        self._last_control, self._control_due = now, now + settings.control_interval
        measured = state.estimate
        assert measured is not None
        if setpoint is not None:
            state.reference = self._reference_of(setpoint, step)
        elif state.flight is not None:
            state.flight.advance(state.motion, measured, state.limits, state.landing_speed, now, step)
            state.reference = state.motion.reference
        else:
            state.reference = None
            level = attitude_of_force(0.0, 0.0, -1.0, euler_of(measured.attitude)[2])
            state.actuation.command(level, NO_RATES, 0.0, now)
            return
        attitude, thrust = state.controller.command(state.reference, measured, state.limits_of_setpoints, step)
        state.actuation.command(attitude, NO_RATES, thrust, now)

    def _reference_of(self, setpoint: PositionSetpoint, step: float) -> Reference:
        """Return what to fly of a set-point; without a yaw it keeps the last, or turns with the yaw rate."""
        motion = self.state.motion
        rate = 0.0 if math.isnan(setpoint.yaw_rate) else setpoint.yaw_rate
        yaw = motion.yaw + rate * step if math.isnan(setpoint.yaw) else setpoint.yaw
        motion.yaw = math.remainder(yaw, 2.0 * math.pi)
        return Reference(setpoint.position, setpoint.velocity, setpoint.acceleration, motion.yaw, setpoint.yaw_rate)
