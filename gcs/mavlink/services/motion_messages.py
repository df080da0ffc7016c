"""Messages of attitude, place and motion, built from the sample that an aircraft reports."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import LAYOUTS, packed
from gcs.mavlink.services.aircraft import Built
from gcs.mavlink.services.local_frame import Motion, clamp, is_finite
from gcs.mavlink.services.report import Report
from idc_controller.rotations_float import euler_of, into_body

_NAN = math.nan
_NO_OFFSET = (0.0, 0.0, 0.0, 0.0)

# What is sent often is packed without a message object, its fields in the order of the wire.
_ATTITUDE = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE]
_ATTITUDE_QUATERNION = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION]
_GLOBAL_POSITION_INT = LAYOUTS[mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT]
_VFR_HUD = LAYOUTS[mavlink.MAVLINK_MSG_ID_VFR_HUD]
_LOCAL_POSITION_NED = LAYOUTS[mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED]
_ALTITUDE = LAYOUTS[mavlink.MAVLINK_MSG_ID_ALTITUDE]
_SCALED_PRESSURE = LAYOUTS[mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE]

_GYROS: int = mavlink.HIGHRES_IMU_UPDATED_XGYRO | mavlink.HIGHRES_IMU_UPDATED_YGYRO | mavlink.HIGHRES_IMU_UPDATED_ZGYRO
_ACCELEROMETERS: int = (
    mavlink.HIGHRES_IMU_UPDATED_XACC | mavlink.HIGHRES_IMU_UPDATED_YACC | mavlink.HIGHRES_IMU_UPDATED_ZACC
)
_BAROMETER: int = (
    mavlink.HIGHRES_IMU_UPDATED_ABS_PRESSURE
    | mavlink.HIGHRES_IMU_UPDATED_PRESSURE_ALT
    | mavlink.HIGHRES_IMU_UPDATED_TEMPERATURE
)
_ESTIMATED: int = (
    mavlink.ESTIMATOR_ATTITUDE
    | mavlink.ESTIMATOR_VELOCITY_HORIZ
    | mavlink.ESTIMATOR_VELOCITY_VERT
    | mavlink.ESTIMATOR_POS_HORIZ_REL
    | mavlink.ESTIMATOR_POS_HORIZ_ABS
    | mavlink.ESTIMATOR_POS_VERT_ABS
    | mavlink.ESTIMATOR_PRED_POS_HORIZ_REL
    | mavlink.ESTIMATOR_PRED_POS_HORIZ_ABS
)

# The standard atmosphere at sea level, and below 11 km.
_PRESSURE = 1013.25  # hPa
_TEMPERATURE = 288.15  # K
_LAPSE = 0.0065  # K/m
_EXPONENT = 5.25588
_LOWEST = -5000.0  # m
_ZERO_CELSIUS = 273.15  # K


def attitude_of(report: Report, measured: Motion | None) -> Built:
    """Attitude and body rates of a sample, as a quaternion."""
    if measured is None:
        return ()
    stamp = report.time_boot_ms(measured.time)
    return (_ATTITUDE_QUATERNION.pack(stamp, *measured.attitude, *measured.rates, *_NO_OFFSET),)


def position_of(report: Report, measured: Motion | None) -> Built:
    """Position and velocity of a sample, from home."""
    if measured is None:
        return ()
    return (_LOCAL_POSITION_NED.pack(report.time_boot_ms(measured.time), *measured.position, *measured.velocity),)


def vibration(report: Report, now: float, component: int) -> Built:
    """The clipping of a component's accelerometer."""
    clipping = report.clipping[component]
    return packed(mavlink.MAVLink_vibration_message(report.time_boot_us(now), 0.0, 0.0, 0.0, clipping, 0, 0))


def attitude_quaternion(report: Report, now: float) -> Built:
    """Attitude as a quaternion, and body rates."""
    return attitude_of(report, report.own_attitude)


def local_position(report: Report, now: float) -> Built:
    """Position from home and velocity, north-east-down."""
    return position_of(report, report.own_position)


def own_vibration(report: Report, now: float) -> Built:
    """How often an impact drove the accelerometer out of its range; no vibration is simulated."""
    return vibration(report, now, px4.AUTOPILOT_COMPONENT)


def attitude(report: Report, now: float) -> Built:
    """Attitude in Euler angles, and body rates."""
    measured = report.own_attitude
    if measured is None or not is_finite(measured):
        return ()
    roll, pitch, yaw = euler_of(measured.attitude)
    return (_ATTITUDE.pack(report.time_boot_ms(measured.time), roll, pitch, yaw, *measured.rates),)


def global_position(report: Report, now: float) -> Built:
    """Place on the ellipsoid, height above home, velocity and heading."""
    measured = report.own_state
    if measured is None:
        return ()
    latitude, longitude, altitude = report.frame.place_of(measured)
    v_x, v_y, v_z = (clamp(100.0 * v, 16) for v in measured.velocity)
    heading = round(math.degrees(euler_of(measured.attitude)[2]) * 100.0) % 36000
    height = clamp(1e3 * (report.return_position[2] - measured.position[2]), 32)
    stamp = report.time_boot_ms(measured.time)
    return (_GLOBAL_POSITION_INT.pack(stamp, latitude, longitude, altitude, height, v_x, v_y, v_z, heading),)


def gps_raw(report: Report, now: float) -> Built:
    """Place, ground speed and course over ground of a GNSS receiver."""
    measured = report.own_state
    if measured is None:
        return ()
    latitude, longitude, altitude = report.frame.place_of(measured)
    v_n, v_e, _ = measured.velocity
    speed = min(round(100.0 * math.hypot(v_n, v_e)), 65534)
    course = round(math.degrees(math.atan2(v_e, v_n)) * 100.0) % 36000
    return packed(
        mavlink.MAVLink_gps_raw_int_message(
            report.time_boot_us(measured.time), mavlink.GPS_FIX_TYPE_RTK_FIXED,
            latitude, longitude, altitude, 50, 50, speed, course, 20,
        )
    )  # fmt: skip


def vfr_hud(report: Report, now: float) -> Built:
    """Speeds, heading, altitude above mean sea level and throttle."""
    measured = report.own_state
    if measured is None:
        return ()
    v_n, v_e, v_d = measured.velocity
    speed = math.hypot(v_n, v_e)
    heading = round(math.degrees(euler_of(measured.attitude)[2])) % 360
    throttle = round(100.0 * report.throttle)
    return (_VFR_HUD.pack(speed, speed, _altitude_of(report, measured), -v_d, heading, throttle),)


def odometry(report: Report, now: float) -> Built:
    """Pose from home and motion in the body frame."""
    measured = report.own_state
    if measured is None:
        return ()
    unknown = [_NAN] + [0.0] * 20
    velocity = into_body(measured.attitude, measured.velocity)
    return packed(
        mavlink.MAVLink_odometry_message(
            report.time_boot_us(measured.time), mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_FRD,
            *measured.position, list(measured.attitude), *velocity, *measured.rates, unknown, unknown,
        )
    )  # fmt: skip


def altitude(report: Report, now: float) -> Built:
    """Altitude above mean sea level, height in the local frame, above home and above the flat ground."""
    measured = report.own_state
    if measured is None:
        return ()
    above_sea, height = _altitude_of(report, measured), -measured.position[2]
    above_home = report.return_position[2] + height
    stamp = report.time_boot_us(measured.time)
    return (_ALTITUDE.pack(stamp, above_sea, above_sea, height, above_home, report.home.altitude, height),)


def highres_imu(report: Report, now: float) -> Built:
    """Body rates, specific force of a free vehicle, and pressure by the standard atmosphere; the rest is NaN."""
    measured = report.own_state
    if measured is None:
        return ()
    above_sea = _altitude_of(report, measured)
    pressure, temperature = _air_at(above_sea)
    force = report.specific_force
    updated = _GYROS | _BAROMETER | (0 if force is None else _ACCELEROMETERS)
    return packed(
        mavlink.MAVLink_highres_imu_message(
            report.time_boot_us(measured.time), *(force or (_NAN, _NAN, _NAN)), *measured.rates, _NAN, _NAN, _NAN,
            pressure, _NAN, above_sea, temperature - _ZERO_CELSIUS, updated,
        )
    )  # fmt: skip


def scaled_pressure(report: Report, now: float) -> Built:
    """Pressure and temperature of the standard atmosphere at its altitude."""
    measured = report.own_state
    if measured is None:
        return ()
    pressure, temperature = _air_at(_altitude_of(report, measured))
    celsius = clamp(100.0 * (temperature - _ZERO_CELSIUS), 16)
    return (_SCALED_PRESSURE.pack(report.time_boot_ms(measured.time), pressure, 0.0, celsius, 0),)


def estimator_status(report: Report, now: float) -> Built:
    """What the estimate holds: all while samples come, attitude alone without a position; no test ratios."""
    flags = _ESTIMATED if report.has_position(now) else 0
    if report.has_attitude(now):
        flags |= mavlink.ESTIMATOR_ATTITUDE
    return packed(mavlink.MAVLink_estimator_status_message(report.time_boot_us(now), flags, *[_NAN] * 8))


def _altitude_of(report: Report, measured: Motion) -> float:
    """Return the altitude above mean sea level (m)."""
    return report.home.altitude - measured.position[2]


def _air_at(above_sea: float) -> tuple[float, float]:
    """Return pressure (hPa) and temperature (K) of the standard atmosphere at an altitude (m)."""
    share = max(1.0 - _LAPSE * max(above_sea, _LOWEST) / _TEMPERATURE, 0.0)
    return _PRESSURE * share**_EXPONENT, _TEMPERATURE * share


MESSAGES = {
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: attitude_quaternion,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: local_position,
    mavlink.MAVLINK_MSG_ID_ATTITUDE: attitude,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: global_position,
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: gps_raw,
    mavlink.MAVLINK_MSG_ID_VFR_HUD: vfr_hud,
    mavlink.MAVLINK_MSG_ID_ODOMETRY: odometry,
    mavlink.MAVLINK_MSG_ID_ALTITUDE: altitude,
    mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: highres_imu,
    mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE: scaled_pressure,
    mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS: estimator_status,
    mavlink.MAVLINK_MSG_ID_VIBRATION: own_vibration,
}
"""Builders by message id."""
