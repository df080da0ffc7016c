"""Well-formed messages that only the ground in control, or the vehicle itself, may send."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink
from packed_messages import message_of

from gcs.mavlink import px4
from gcs.mavlink.setpoints import attitude_target
from gcs.mavlink.stop_plan import StopPlanContent, stop_plan_message

NAN, HUGE = math.nan, 3e38


def hostile_to_vehicle(i):
    """Well-formed messages that would end vehicle ``i``'s flight, or change it."""
    m = mavlink
    commands = [
        (m.MAV_CMD_COMPONENT_ARM_DISARM, 0), (m.MAV_CMD_COMPONENT_ARM_DISARM, 0, px4.FORCE_ARM_DISARM),
        (m.MAV_CMD_COMPONENT_ARM_DISARM, 1, px4.FORCE_ARM_DISARM), (m.MAV_CMD_COMPONENT_ARM_DISARM, NAN, NAN),
        (m.MAV_CMD_DO_SET_MODE, 1, px4.MainMode.AUTO, px4.AutoMode.LAND),
        (m.MAV_CMD_DO_SET_MODE, 1, px4.MainMode.AUTO, px4.AutoMode.LOITER),
        (m.MAV_CMD_DO_SET_MODE, 1, px4.MainMode.OFFBOARD), (m.MAV_CMD_DO_SET_MODE, 1, px4.MainMode.MANUAL),
        (m.MAV_CMD_DO_SET_MODE, HUGE, -HUGE, NAN), (m.MAV_CMD_NAV_LAND,), (m.MAV_CMD_NAV_TAKEOFF,),
        (m.MAV_CMD_NAV_RETURN_TO_LAUNCH,), (m.MAV_CMD_DO_FLIGHTTERMINATION, 1),
        (m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1), (m.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, 1, 2, 3),
        (m.MAV_CMD_DO_MOTOR_TEST, 1, 0, 100, 10), (m.MAV_CMD_INJECT_FAILURE, 0, 1),
        (m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_HOME_POSITION), (m.MAV_CMD_REQUEST_MESSAGE, HUGE),
        *((m.MAV_CMD_SET_MESSAGE_INTERVAL, number, us)
          for number in (m.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, m.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
                         m.MAVLINK_MSG_ID_HEARTBEAT, m.MAVLINK_MSG_ID_ODOMETRY)
          for us in (-1, 0, 4000, NAN, HUGE)),
    ]  # fmt: skip
    messages = []
    for number, *parameters in commands:
        filled = [*parameters, *[0.0] * (7 - len(parameters))]
        for target in ((i, 1), (i, 0), (0, 0)):
            messages.append(m.MAVLink_command_long_message(*target, number, 0, *filled))
            messages.append(m.MAVLink_command_int_message(*target, 0, number, 0, 0, *filled[:4], 1, 2, filled[6]))
    for mode in (px4.MODE_LAND, px4.MODE_HOLD, px4.MODE_MANUAL, px4.MODE_OFFBOARD, 0xFFFFFFFF):
        messages.append(m.MAVLink_set_mode_message(i, 1, mode))
    parameters = (px4.PARAM_SETPOINT_LOSS, px4.PARAM_LAND_DELAY, px4.PARAM_LINK_LOSS, px4.PARAM_LAND_SPEED,
                  px4.PARAM_THRUST_MAX, px4.PARAM_MASS, px4.PARAM_SYSTEM_ID, "NO_SUCH")  # fmt: skip
    for name in parameters:
        for value, kind in ((60.0, 9), (0.1, 9), (NAN, 9), (HUGE, 9), (px4.parameter_to_wire(300, 6), 6), (1.0, 77)):
            messages.append(m.MAVLink_param_set_message(i, 1, name.encode(), value, kind))
    for direction, thrust in (((0, 0, -1), 0.0), ((0, 0, -1), 30.0), ((0.9, 0, -0.436), 20.0), ((0, 0, 1), 30.0)):
        messages += [message_of(attitude_target(i, stamp, direction, thrust, 30.0)) for stamp in (0.0, 10.0, 20.0, 4e6)]
    for q, mask, thrust in (([NAN] * 4, 7, 0.5), ([HUGE] * 4, 7, HUGE), ([1, 0, 0, 0], 0, NAN), ([0] * 4, 255, -1)):
        messages.append(m.MAVLink_set_attitude_target_message(0, i, 1, mask, q, HUGE, NAN, -HUGE, thrust))
    for points, duration in (([[0, 0, 0]] * 5, 1.0), ([[HUGE] * 3] * 5, HUGE), ([[NAN] * 3] * 5, NAN)):
        messages += [
            message_of(stop_plan_message(i, StopPlanContent(1, number, start, descent, duration, 0.0, points)))
            for number, start in ((1, 0.0), (2, 10.0), (2**32 - 1, 20.0), (4, -30.0)) for descent in (15.0, 1e9, -1e9)
        ]  # fmt: skip
    messages += [
        m.MAVLink_set_position_target_local_ned_message(0, i, 1, 1, 0, *[HUGE] * 11),
        m.MAVLink_set_actuator_control_target_message(0, 0, i, 1, [NAN] * 8),
        m.MAVLink_manual_control_message(i, 1000, 1000, 0, 1000, 0xFFFF),
        m.MAVLink_rc_channels_override_message(i, 1, *[1000] * 8),
        m.MAVLink_param_request_list_message(i, 1),
        m.MAVLink_param_request_read_message(i, 1, b"\xff" * 16, -1),
        m.MAVLink_param_request_read_message(i, 1, b"", 32767),
        m.MAVLink_timesync_message(0, 1), m.MAVLink_timesync_message(0, -(2**63)), m.MAVLink_timesync_message(5, 6),
        m.MAVLink_ping_message(2**64 - 1, 2**32 - 1, 0, 0),
        m.MAVLink_system_time_message(2**64 - 1, 2**32 - 1),
        m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), m.MAVLink_heartbeat_message(2, 12, 0, 0, 0, 3),
        m.MAVLink_setup_signing_message(i, 1, [7] * 32, 2**64 - 1),
        m.MAVLink_mission_count_message(i, 1, 65535), m.MAVLink_mission_clear_all_message(i, 1),
        m.MAVLink_set_gps_global_origin_message(i, 0, 0, 0),
        m.MAVLink_file_transfer_protocol_message(0, i, 1, [255] * 251),
        m.MAVLink_hil_gps_message(0, 6, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1),
    ]  # fmt: skip
    return messages


def hostile_to_ground():
    """Well-formed messages with which another would pass for a vehicle."""
    m = mavlink
    return [
        *(m.MAVLink_heartbeat_message(2, 12, base_mode, mode, state, 3)
          for base_mode in (1, 129) for mode in (px4.MODE_LAND, px4.MODE_OFFBOARD, 0) for state in (3, 5)),
        *(m.MAVLink_attitude_quaternion_message(stamp, *values)
          for stamp in (0, 20_000, 2**32 - 1)
          for values in ([NAN] * 7, [HUGE] * 7, [0, 1, 0, 0, 0, 0, 0], [1, 0, 0, 0, 50, 50, 50])),
        *(m.MAVLink_local_position_ned_message(stamp, *values)
          for stamp in (0, 20_000, 2**32 - 1)
          for values in ([NAN] * 6, [HUGE] * 6, [100, 100, -100, 9, 9, 9], [0, 0, 0, 0, 0, 0])),
        *(m.MAVLink_attitude_target_message(stamp, 0, [1, 0, 0, 0], 0, 0, 0, 0.0) for stamp in (0, 20_000)),
        *(m.MAVLink_command_ack_message(number, result, 0, 0, 255, 190)
          for number in (m.MAV_CMD_COMPONENT_ARM_DISARM, m.MAV_CMD_DO_SET_MODE) for result in (0, 2, 4, 5)),
        *(m.MAVLink_param_value_message(name.encode(), value, 9, 20, 0)
          for name in (px4.PARAM_THRUST_MAX, px4.PARAM_LAND_DELAY, "\xff") for value in (0.0, NAN, HUGE)),
        m.MAVLink_timesync_message(1, 1), m.MAVLink_timesync_message(2**62, -(2**63)), m.MAVLink_timesync_message(0, 1),
        *(m.MAVLink_extended_sys_state_message(0, state) for state in range(5)),
        m.MAVLink_sys_status_message(2**32 - 1, 2**32 - 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
        m.MAVLink_statustext_message(0, b"\xff" * 50),
        m.MAVLink_obstacle_distance_message(0, 0, [1] * 72, 1, 0, 10),
        *(m.MAVLink_obstacle_distance_3d_message(20_000, 0, 12, 1, *point, 0.1, 20.0)
          for point in ((0.5, 0, 0), (NAN, NAN, NAN), (HUGE, 0, 0))),
        m.MAVLink_command_long_message(255, 190, m.MAV_CMD_COMPONENT_ARM_DISARM, 0, 0, 21196, 0, 0, 0, 0, 0),
    ]  # fmt: skip
