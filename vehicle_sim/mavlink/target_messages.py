"""Messages of what a vehicle is to do: its targets, and the outputs to its rotors."""

import math
from collections.abc import Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import LAYOUTS, packed
from gcs.mavlink.services.aircraft import Built
from gcs.mavlink.services.local_frame import clamp
from idc_controller.rotations_float import Vector, euler_of
from vehicle_sim.autopilot.actuation import LEVEL
from vehicle_sim.autopilot.flight_state import PositionTarget
from vehicle_sim.mavlink.report import VehicleReport

_ATTITUDE_TARGET = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET]
_POSITION_TARGET = LAYOUTS[mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED]
_GLOBAL_TARGET = LAYOUTS[mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT]

_ROTORS = 4
_PULSE_MIN, _PULSE_RANGE = 1000.0, 1000.0  # us
_OUTPUTS = 32  # of ACTUATOR_OUTPUT_STATUS
_FLOAT_MAX = (2.0 - 2.0**-23) * 2.0**127  # in single precision


def attitude_target(report: VehicleReport, now: float) -> Built:
    """Attitude, rates and thrust that are flown, stamped with the moment at which they began to act, as by PX4."""
    actuation = report.autopilot.state.actuation
    attitude, rates, thrust = actuation.target
    since = max(actuation.target_since, report.boot_time)
    mask = 0 if attitude is not None else mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
    return (_ATTITUDE_TARGET.pack(report.time_boot_ms(since), *(attitude or LEVEL), *rates, thrust, mask),)


def position_target(report: VehicleReport, now: float) -> Built:
    """What the position control follows; there is nothing while an attitude is flown."""
    target = report.autopilot.state.position_target(now)
    if target is None:
        return ()
    return (
        _POSITION_TARGET.pack(
            report.time_boot_ms(now), *_known(target.position), *_motion_of(target), _mask(target, target.position),
            mavlink.MAV_FRAME_LOCAL_NED,
        ),
    )  # fmt: skip


def global_position_target(report: VehicleReport, now: float) -> Built:
    """The place where what is flown ends, as by PX4; there is none while an attitude or a velocity is flown."""
    target = report.autopilot.state.position_target(now)
    if target is None or not math.isfinite(sum(target.destination)):
        return ()
    latitude, longitude, altitude = report.frame.place(target.destination)
    return (
        _GLOBAL_TARGET.pack(
            report.time_boot_ms(now), latitude, longitude, altitude * 1e-3, *_motion_of(target),
            _mask(target, target.destination), mavlink.MAV_FRAME_GLOBAL_INT,
        ),
    )  # fmt: skip


def nav_controller_output(report: VehicleReport, now: float) -> Built:
    """The attitude that is flown, distance and bearing of the place where that ends, and the error of the altitude."""
    measured = report.own_state
    if measured is None:
        return ()
    target = report.autopilot.state.actuation.target.attitude
    roll, pitch, yaw = (math.degrees(angle) for angle in euler_of(measured.attitude if target is None else target))
    bearing, distance, above = yaw, 0.0, 0.0
    if (planned := report.autopilot.state.position_target(now)) is not None:
        x, y, _ = planned.destination
        north, east = x - measured.position[0], y - measured.position[1]
        if math.isfinite(north + east):
            distance = min(math.hypot(north, east), 65535.0)
            bearing = math.degrees(math.atan2(east, north))
        if math.isfinite(planned.position[2]):
            above = measured.position[2] - planned.position[2]
    return packed(
        mavlink.MAVLink_nav_controller_output_message(
            roll, pitch, clamp(yaw, 16), clamp(bearing, 16), int(distance), above, 0.0, 0.0
        )
    )


def orbit_execution_status(report: VehicleReport, now: float) -> Built:
    """The circle of an orbit; there is none otherwise."""
    orbit = report.autopilot.state.orbit
    if orbit is None:
        return ()
    latitude, longitude, altitude = report.frame.place(orbit.centre)
    return packed(
        mavlink.MAVLink_orbit_execution_status_message(
            report.time_boot_us(now), orbit.radius, mavlink.MAV_FRAME_GLOBAL_INT, latitude, longitude, altitude * 1e-3
        )
    )


def servo_output_raw(report: VehicleReport, now: float) -> Built:
    """The commanded rotor speeds as pulse widths: 1000 us is none, 2000 us the largest."""
    pulses = [round(_PULSE_MIN + _PULSE_RANGE * share) for share in _speed_shares(report)]
    return packed(mavlink.MAVLink_servo_output_raw_message(report.time_boot_us(now) & 0xFFFFFFFF, 0, *pulses, *[0] * 4))


def actuator_output_status(report: VehicleReport, now: float) -> Built:
    """The commanded rotor speeds as shares of the largest; active while it is armed."""
    outputs = [*_speed_shares(report), *[0.0] * (_OUTPUTS - _ROTORS)]
    active = (1 << _ROTORS) - 1 if report.autopilot.armed else 0
    return packed(mavlink.MAVLink_actuator_output_status_message(report.time_boot_us(now), active, outputs))


def _motion_of(target: PositionTarget) -> tuple[float, ...]:
    """Return velocity, acceleration, yaw and yaw rate, 0 where they are not controlled."""
    return _known((*target.velocity, *target.acceleration, target.yaw, target.yaw_rate))


def _known(values: Sequence[float]) -> tuple[float, ...]:
    # A vector of a body frame may exceed single precision once it is turned.
    return tuple(0.0 if math.isnan(value) else min(max(value, -_FLOAT_MAX), _FLOAT_MAX) for value in values)


def _mask(target: PositionTarget, position: Vector) -> int:
    """Return the POSITION_TARGET_TYPEMASK of what is not controlled, of a place ``position`` (NED, m)."""
    ignored = sum(
        1 << bit for bit, value in enumerate((*position, *target.velocity, *target.acceleration)) if math.isnan(value)
    )
    if math.isnan(target.yaw):
        ignored |= mavlink.POSITION_TARGET_TYPEMASK_YAW_IGNORE
    if math.isnan(target.yaw_rate):
        ignored |= mavlink.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE
    return ignored


def _speed_shares(report: VehicleReport) -> list[float]:
    """Return the commanded rotor speeds as shares of the largest, 0 .. 1, in the order of PX4's X layout."""
    speed_max = report.autopilot.state.airframe.rotors.rotor_speed_max
    speeds = report.autopilot.arrays.speeds[0].tolist() if report.autopilot.armed else [0.0] * _ROTORS
    return [min(speed / speed_max, 1.0) if speed > 0.0 else 0.0 for speed in speeds]  # of NaN, too


MESSAGES = {
    mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET: attitude_target,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: position_target,
    mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: global_position_target,
    mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS: orbit_execution_status,
    mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: nav_controller_output,
    mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: servo_output_raw,
    mavlink.MAVLINK_MSG_ID_ACTUATOR_OUTPUT_STATUS: actuator_output_status,
}
"""Builders by message id."""
