"""Telemetry: MAVLink messages of the vehicles become measurements for the estimator."""

import math

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.messages import Received
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position
from idc_controller.perception.scan_assembly import Detection


def setpoint_flown(message: mavlink.MAVLink_attitude_target_message, thrust_max: float) -> Array | None:
    """Return the tilt of the thrust (north, east) and thrust (N), (3,), in an ATTITUDE_TARGET; None: it has neither.

    ``thrust_max`` (N) is what the vehicle means by thrust 1.
    """
    if message.type_mask & mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE:
        return None
    w, x, y, z = message.q
    flown = (-2.0 * (x * z + w * y), -2.0 * (y * z - w * x), message.thrust * thrust_max)
    return np.array(flown) if math.isfinite(sum(flown)) else None


def measurement(received: Received, uav: int, time: float) -> Measurement | None:
    """Return the measurement in a message of UAV ``uav`` (0 .. N-1), true at ``time`` (s, team time).

    None for messages that measure nothing and for values that cannot be measurements (not finite, no rotation). Where
    only the pose or only the motion cannot be one, that part is nan, as MAVLink has it for an unknown rate.
    The payload's navigation unit is a component of its own, relayed by every vehicle.
    """
    message, component = received.message, received.component
    if component == px4.PAYLOAD_UNIT_COMPONENT:
        source = PAYLOAD
    elif component == px4.AUTOPILOT_COMPONENT:
        source = uav
    else:
        return None
    if isinstance(message, mavlink.MAVLink_attitude_quaternion_message):
        quaternion = (message.q1, message.q2, message.q3, message.q4)
        rates = (message.rollspeed, message.pitchspeed, message.yawspeed)
        norm = math.sqrt(sum(c * c for c in quaternion))
        attitude = Attitude(time, source, np.array(quaternion) / (norm or 1.0), np.array(rates))
        return _usable(attitude, 0.9 < norm < 1.1, math.isfinite(sum(rates)))
    if isinstance(message, mavlink.MAVLink_local_position_ned_message):
        position, velocity = (message.x, message.y, message.z), (message.vx, message.vy, message.vz)
        sample = Position(time, source, np.array(position), np.array(velocity))
        return _usable(sample, math.isfinite(sum(position)), math.isfinite(sum(velocity)))
    return None


def detection(message: mavlink.MAVLink_obstacle_distance_3d_message) -> Detection:
    """Return the detection in an OBSTACLE_DISTANCE_3D; one in a frame other than the body's has no point (nan)."""
    is_body = message.frame == mavlink.MAV_FRAME_BODY_FRD
    point = (message.x, message.y, message.z) if is_body else (math.nan, math.nan, math.nan)
    return Detection(message.time_boot_ms, message.obstacle_id, point, message.max_distance)


def _usable(sample: Measurement, pose: bool, motion: bool) -> Measurement | None:
    """Return a sample without the part, ``pose`` or ``motion``, that cannot be a measurement."""
    if pose and motion:
        return sample
    return sample.without(not pose, not motion) if pose or motion else None
