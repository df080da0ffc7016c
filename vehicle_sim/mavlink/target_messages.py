"""Messages of what a vehicle is to do: its targets, and the outputs to its rotors."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import LAYOUTS, packed
from gcs.mavlink.services.aircraft import Built
from idc_controller.rotations_float import euler_of
from vehicle_sim.autopilot.actuation import LEVEL
from vehicle_sim.autopilot.hold_control import HoldPlan
from vehicle_sim.mavlink.geodesy import clamp
from vehicle_sim.mavlink.report import Report

_ATTITUDE_TARGET = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET]
_POSITION_TARGET = LAYOUTS[mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED]

_ROTORS = 4
_PULSE_MIN, _PULSE_RANGE = 1000.0, 1000.0  # us
_OUTPUTS = 32  # of ACTUATOR_OUTPUT_STATUS


def attitude_target(report: Report, now: float) -> Built:
    """Attitude, rates and thrust that are flown, stamped with the moment at which they began to act, as by PX4."""
    actuation = report.autopilot.state.actuation
    attitude, rates, thrust = actuation.target
    since = max(actuation.target_since, report.boot_time)
    mask = 0 if attitude is not None else mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
    return (_ATTITUDE_TARGET.pack(report.time_boot_ms(since), *(attitude or LEVEL), *rates, thrust, mask),)


def position_target(report: Report, now: float) -> Built:
    """The planned state of a stop, hold or descent; there is none while an attitude is flown."""
    plan = _plan(report)
    if plan is None:
        return ()
    position, velocity, acceleration = plan.at(now)
    mask = mavlink.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE
    return (
        _POSITION_TARGET.pack(
            report.time_boot_ms(now), *position, *velocity, *acceleration, plan.yaw, 0.0,
            mask, mavlink.MAV_FRAME_LOCAL_NED,
        ),
    )  # fmt: skip


def nav_controller_output(report: Report, now: float) -> Built:
    """The attitude that is flown, and distance and bearing of the place where it comes to hold."""
    measured = report.own_state
    if measured is None:
        return ()
    target = report.autopilot.state.actuation.target.attitude
    roll, pitch, yaw = (math.degrees(angle) for angle in euler_of(measured.attitude if target is None else target))
    bearing, distance, above = yaw, 0.0, 0.0
    if (plan := _plan(report)) is not None:
        x, y, _ = plan.control_points[-1]
        north, east = x - measured.position[0], y - measured.position[1]
        distance = min(math.hypot(north, east), 65535.0)
        bearing = math.degrees(math.atan2(east, north))
        above = measured.position[2] - plan.at(now).position[2]
    return packed(
        mavlink.MAVLink_nav_controller_output_message(
            roll, pitch, clamp(yaw, 16), clamp(bearing, 16), int(distance), above, 0.0, 0.0
        )
    )


def servo_output_raw(report: Report, now: float) -> Built:
    """The commanded rotor speeds as pulse widths: 1000 us is none, 2000 us the largest."""
    pulses = [round(_PULSE_MIN + _PULSE_RANGE * share) for share in _speed_shares(report)]
    return packed(mavlink.MAVLink_servo_output_raw_message(report.time_boot_us(now) & 0xFFFFFFFF, 0, *pulses, *[0] * 4))


def actuator_output_status(report: Report, now: float) -> Built:
    """The commanded rotor speeds as shares of the largest; active while it is armed."""
    outputs = [*_speed_shares(report), *[0.0] * (_OUTPUTS - _ROTORS)]
    active = (1 << _ROTORS) - 1 if report.autopilot.armed else 0
    return packed(mavlink.MAVLink_actuator_output_status_message(report.time_boot_us(now), active, outputs))


def _plan(report: Report) -> HoldPlan | None:
    hold = report.autopilot.state.hold
    return None if hold is None else hold.plan


def _speed_shares(report: Report) -> list[float]:
    """Return the commanded rotor speeds as shares of the largest, 0 .. 1, in the order of PX4's X layout."""
    speed_max = report.autopilot.state.airframe.rotors.rotor_speed_max
    speeds = report.autopilot.arrays.speeds[0].tolist() if report.autopilot.armed else [0.0] * _ROTORS
    return [min(speed / speed_max, 1.0) if speed > 0.0 else 0.0 for speed in speeds]  # of NaN, too


MESSAGES = {
    mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET: attitude_target,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: position_target,
    mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: nav_controller_output,
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: servo_output_raw,
    mavlink.MAVLINK_MSG_ID_ACTUATOR_OUTPUT_STATUS: actuator_output_status,
}
"""Builders by message id."""
