"""Set-points: the controller's output as a SET_ATTITUDE_TARGET for each vehicle, and with it a stop plan."""

from __future__ import annotations

from collections.abc import Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from idc_controller.rotations_float import attitude_of_direction

IGNORE_RATES = (
    mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
)


def attitude_target(
    system_id: int, boot_time: float, direction: Sequence[float], thrust: float, thrust_max: float
) -> mavlink.MAVLink_set_attitude_target_message:
    """SET_ATTITUDE_TARGET for vehicle ``system_id`` at its ``boot_time`` (s): thrust (N) along ``direction``."""
    return mavlink.MAVLink_set_attitude_target_message(
        time_boot_ms=max(round(boot_time * 1000.0), 0) & 0xFFFFFFFF,
        target_system=system_id,
        target_component=px4.AUTOPILOT_COMPONENT,
        type_mask=IGNORE_RATES,
        q=attitude_of_direction(direction),
        body_roll_rate=0.0,
        body_pitch_rate=0.0,
        body_yaw_rate=0.0,
        thrust=max(0.0, min(1.0, thrust / thrust_max)),
    )


def stop_plan_message(
    boot_time: float, duration: float, control_points: Sequence[Sequence[float]]
) -> mavlink.MAVLink_trajectory_representation_bezier_message:
    """TRAJECTORY_REPRESENTATION_BEZIER from a vehicle's ``boot_time`` (s) on, to rest in ``duration`` (s).

    ``control_points``: (5, 3) of its path (m, NED); heading north.
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
