"""Set-points: a decision of the controller becomes a SET_ATTITUDE_TARGET for each vehicle, and with it a stop plan."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4

IGNORE_RATES = (
    mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
)


def attitude_of(direction: Sequence[float]) -> tuple[float, float, float, float]:
    """w-first quaternion with heading north whose thrust points along the unit vector ``direction`` (NED).

    The body z axis is -direction; roll about the body x axis follows pitch about y (ZYX with yaw 0).
    """
    z_x, z_y, z_z = -direction[0], -direction[1], -direction[2]
    roll = -math.asin(max(-1.0, min(1.0, z_y)))
    pitch = math.atan2(z_x, z_z)
    cos_roll, sin_roll = math.cos(roll / 2), math.sin(roll / 2)
    cos_pitch, sin_pitch = math.cos(pitch / 2), math.sin(pitch / 2)
    return (cos_roll * cos_pitch, sin_roll * cos_pitch, cos_roll * sin_pitch, -sin_roll * sin_pitch)


def attitude_target(
    system_id: int, boot_time: float, direction: Sequence[float], thrust: float, thrust_max: float
) -> mavlink.MAVLink_set_attitude_target_message:
    """SET_ATTITUDE_TARGET for vehicle ``system_id`` at its ``boot_time`` (s): thrust (N) along ``direction``."""
    return mavlink.MAVLink_set_attitude_target_message(
        time_boot_ms=max(round(boot_time * 1000.0), 0) & 0xFFFFFFFF,
        target_system=system_id,
        target_component=px4.AUTOPILOT_COMPONENT,
        type_mask=IGNORE_RATES,
        q=attitude_of(direction),
        body_roll_rate=0.0,
        body_pitch_rate=0.0,
        body_yaw_rate=0.0,
        thrust=max(0.0, min(1.0, thrust / thrust_max)),
    )


def stop_plan_message(
    boot_time: float, duration: float, control_points: Sequence[Sequence[float]]
) -> mavlink.MAVLink_trajectory_representation_bezier_message:
    """TRAJECTORY_REPRESENTATION_BEZIER from a vehicle's ``boot_time`` (s) on, to rest in ``duration`` (s).

    ``control_points``: (5, 3) of its way (m, NED); heading north.
    """
    x, y, z = zip(*control_points, strict=True)
    points = len(x)
    return mavlink.MAVLink_trajectory_representation_bezier_message(
        time_usec=max(round(boot_time * 1e6), 0),
        valid_points=points,
        pos_x=x,
        pos_y=y,
        pos_z=z,
        delta=[duration] * points,
        pos_yaw=[0.0] * points,
    )
