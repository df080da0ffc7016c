"""Messages of what an aircraft is and of the state that it is in."""

import math
from importlib.metadata import version

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import newer_messages, px4
from gcs.mavlink.layout import LAYOUTS, packed
from gcs.mavlink.services.aircraft import Built
from gcs.mavlink.services.report import Report
from idc_controller.rotations_float import IDENTITY

_SENSORS: int = (
    mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    | mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG
    | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
    | mavlink.MAV_SYS_STATUS_SENSOR_GPS
    | mavlink.MAV_SYS_STATUS_AHRS
)
_ALWAYS: int = mavlink.MAV_SYS_STATUS_SENSOR_BATTERY | mavlink.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
_RANGE_SENSOR: int = mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY
_PREARM: int = mavlink.MAV_SYS_STATUS_PREARM_CHECK

_EXTENDED_SYS_STATE = LAYOUTS[mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE]
_RC_CHANNELS = LAYOUTS[mavlink.MAVLINK_MSG_ID_RC_CHANNELS]
_PROTOCOL_VERSION = LAYOUTS[newer_messages.PROTOCOL_VERSION]
_CURRENT_MODE = LAYOUTS[newer_messages.CURRENT_MODE]
_AVAILABLE_MODES_MONITOR = LAYOUTS[newer_messages.AVAILABLE_MODES_MONITOR]

_MAVLINK_1, _MAVLINK_2 = 100, 200
_CELLS = [4000, 4000, 4000, 4000, 65535, 65535, 65535, 65535, 65535, 65535]
_NO_CHANNEL, _NO_SIGNAL = 65535, 255
_NAN = math.nan
_MAKER = b"cooplift".ljust(17, b"\0")
"""Of ``uid2``, before the system id."""


def _software_version() -> int:
    """Return the package's version, as AUTOPILOT_VERSION has it: a development version."""
    numbers = [int(part) for part in version("cooplift").split(".")[:3] if part.isdigit()]
    major, minor, patch = (*numbers, 0, 0, 0)[:3]
    return major << 24 | minor << 16 | patch << 8 | mavlink.FIRMWARE_VERSION_TYPE_DEV


_VERSION = _software_version()


def heartbeat(report: Report, now: float) -> Built:
    """Mode, arming and failsafe."""
    base_mode = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
    main, _ = px4.decode_custom_mode(report.mode)
    if main in (px4.MainMode.AUTO, px4.MainMode.OFFBOARD):
        base_mode |= mavlink.MAV_MODE_FLAG_AUTO_ENABLED | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
    else:
        base_mode |= mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
    state = mavlink.MAV_STATE_STANDBY
    if report.failsafe:
        state = mavlink.MAV_STATE_CRITICAL
    elif report.armed:
        state = mavlink.MAV_STATE_ACTIVE
    elif report.is_booting:
        state = mavlink.MAV_STATE_BOOT
    if report.armed:
        base_mode |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    return packed(
        mavlink.MAVLink_heartbeat_message(report.mav_type, mavlink.MAV_AUTOPILOT_PX4, base_mode, report.mode, state, 3)
    )


def sys_status(report: Report, now: float) -> Built:
    """Health of sensors and range sensor, and whether it can be armed."""
    present = _SENSORS | _ALWAYS | _PREARM
    health = _ALWAYS
    if (works := report.range_sensor_works) is not None:
        present |= _RANGE_SENSOR
        if works:
            health |= _RANGE_SENSOR
    if report.has_attitude(now):
        health |= _SENSORS
        if not report.has_position(now):
            health &= ~mavlink.MAV_SYS_STATUS_SENSOR_GPS
    if report.arming_problem(now) is None:
        health |= _PREARM
    return packed(mavlink.MAVLink_sys_status_message(present, present, health, 100, 16000, -1, 100, 0, 0, 0, 0, 0, 0))


def extended_sys_state(report: Report, now: float) -> Built:
    """On the ground, in the air, landing."""
    return (_EXTENDED_SYS_STATE.pack(mavlink.MAV_VTOL_STATE_UNDEFINED, report.landed_state),)


def current_mode(report: Report, now: float) -> Built:
    """The mode that is flown, and the one that was commanded."""
    flown, intended = report.mode, report.intended_mode
    return (_CURRENT_MODE.pack(flown, intended, px4.standard_mode(flown)),)


def available_modes_monitor(report: Report, now: float) -> Built:
    """The list of modes never changes."""
    return (_AVAILABLE_MODES_MONITOR.pack(0),)


def system_time(report: Report, now: float) -> Built:
    """Time since boot; a simulated world has no time of day (0)."""
    return packed(mavlink.MAVLink_system_time_message(0, report.time_boot_ms(now)))


def home_position(report: Report, now: float) -> Built:
    """The place of home."""
    home = report.return_position
    return packed(
        mavlink.MAVLink_home_position_message(
            *report.frame.place(home), *home, list(IDENTITY), _NAN, _NAN, _NAN, report.time_boot_us(now)
        )
    )


def global_origin(report: Report, now: float) -> Built:
    """The place of the origin of the local frame."""
    return packed(mavlink.MAVLink_gps_global_origin_message(*report.frame.origin, report.time_boot_us(now)))


def battery(report: Report, now: float) -> Built:
    """A battery that stays full: none is simulated."""
    return packed(
        mavlink.MAVLink_battery_status_message(
            0, mavlink.MAV_BATTERY_FUNCTION_ALL, mavlink.MAV_BATTERY_TYPE_LIPO, 32767, _CELLS, -1, -1, -1, 100
        )
    )


def rc_channels(report: Report, now: float) -> Built:
    """No remote control: no channel, no signal."""
    return (_RC_CHANNELS.pack(report.time_boot_ms(now), *[_NO_CHANNEL] * 18, 0, _NO_SIGNAL),)


def autopilot_version(report: Report, now: float) -> Built:
    """Capabilities and the package's version; there is no board and no vendor, as in PX4's simulation."""
    uid2 = list(_MAKER + bytes([report.system_id]))
    none = [0] * 8
    return packed(
        mavlink.MAVLink_autopilot_version_message(
            report.capabilities, _VERSION, 0, 0, 0, none, none, none, 0, 0, report.system_id, uid2
        )
    )


def protocol_version(report: Report, now: float) -> Built:
    """MAVLink 2 is sent, MAVLink 1 understood, too."""
    return (_PROTOCOL_VERSION.pack(_MAVLINK_2, _MAVLINK_1, _MAVLINK_2, *[0] * 16),)


MESSAGES = {
    mavlink.MAVLINK_MSG_ID_HEARTBEAT: heartbeat,
    mavlink.MAVLINK_MSG_ID_SYS_STATUS: sys_status,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: extended_sys_state,
    newer_messages.CURRENT_MODE: current_mode,
    newer_messages.AVAILABLE_MODES_MONITOR: available_modes_monitor,
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: system_time,
    mavlink.MAVLINK_MSG_ID_HOME_POSITION: home_position,
    mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: global_origin,
    mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: battery,
    mavlink.MAVLINK_MSG_ID_RC_CHANNELS: rc_channels,
    mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: autopilot_version,
    newer_messages.PROTOCOL_VERSION: protocol_version,
}
"""Builders by message id."""
