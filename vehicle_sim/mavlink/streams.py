"""The streams of a vehicle: which messages it sends unasked, and how often."""

from dataclasses import fields

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import StreamIntervals
from gcs.mavlink import newer_messages, px4
from gcs.mavlink.services.aircraft import MessageKey

_AUTOPILOT, _PAYLOAD = px4.AUTOPILOT_COMPONENT, px4.PAYLOAD_UNIT_COMPONENT

#: Offsets (s) of streams from the multiples of their intervals: with other telemetry, but between scans of the range
#: sensor, so that what is due at one instant stays within a datagram.
OFFSETS: dict[MessageKey, float] = {
    **dict.fromkeys(
        [
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_SYSTEM_TIME),
            (_AUTOPILOT, newer_messages.CURRENT_MODE),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ALTITUDE),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_HIGHRES_IMU),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_RC_CHANNELS),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT),
        ],
        0.04,
    ),
    **dict.fromkeys(
        [
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ODOMETRY),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW),
            (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ACTUATOR_OUTPUT_STATUS),
        ],
        0.08,
    ),
}

CLIENT_STREAMS: frozenset[MessageKey] = frozenset(OFFSETS) - {
    (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_SYSTEM_TIME),
    (_AUTOPILOT, newer_messages.CURRENT_MODE),
}
"""Streams that only the ports of clients get unasked: a ground that calls in may do so by a slow link."""


def default_intervals(intervals: StreamIntervals, telemetry_interval: float) -> dict[MessageKey, float]:
    """Return the intervals (s) of all streams by component and message, in the order in which they are sent.

    ``telemetry_interval`` of position and attitude, the vehicle's and the payload's. With every sample goes the
    set-point that was being flown, because set-points may be lost. A scan is sent as soon as there is one, behind the
    attitude and position at which it was made: its returns, then the message that ends it.
    """
    return {
        # The settings have the names of the messages.
        **{
            (_AUTOPILOT, newer_messages.message_number(setting.name)): getattr(intervals, setting.name)
            for setting in fields(intervals)
        },
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_HEARTBEAT): intervals.heartbeat,
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_VIBRATION): intervals.vibration,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED): telemetry_interval,
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION): telemetry_interval,
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE): telemetry_interval,
    }
