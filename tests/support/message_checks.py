"""What a client finds of the services of a vehicle: one check for every message that is handled.

A check gets a vehicle that stands; it returns True if the service did what it is for, as far as the wire shows it.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
from mission_ground import MISSION, PLAN, item_message, waypoint
from packed_messages import message_of
from service_client import ARM, FRAME, NAN, ServiceClient, text_of
from vehicle_bench import ACCEPTED, OFFBOARD, attitude_target

from gcs.mavlink import px4
from gcs.mavlink.newer_messages import COMMAND_CANCEL, NEWER
from gcs.mavlink.stop_plan import StopPlanContent, stop_plan_message

Check = Callable[[ServiceClient], bool]

INT32, CUSTOM = m.MAV_PARAM_TYPE_INT32, m.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
SETTING, DEFAULT, OTHER = b"COM_DL_LOSS_T", 10, 30


def upload(client: ServiceClient) -> bool:
    return client.upload()


# Set-points


def flies_attitude(client: ServiceClient) -> bool:
    client.stream(attitude_target(thrust=0.9))
    if client.result(OFFBOARD) != ACCEPTED or not client.accepts(ARM, 1):
        return False
    client.run(0.5)
    return bool(client.place[2] < -0.1)


def flies_stop_plan(client: ServiceClient) -> bool:
    client.take_off()
    x, y, z = client.place
    points = [(x + 3.0 * k / 4, y, z) for k in (0, 1, 4, 4, 4)]
    descent = client.now + 60.0
    client.send(message_of(stop_plan_message(1, StopPlanContent(1, 1, client.now, descent, 4.0, 0.0, points))))
    client.streaming.clear()
    client.run(5.0)
    return abs(client.place[0] - x - 3.0) < 0.5


def flies_position(client: ServiceClient, setpoint: Any) -> bool:
    client.stream(setpoint)
    if client.result(OFFBOARD) != ACCEPTED or not client.accepts(ARM, 1):
        return False
    client.run(4.0)
    return abs(client.place[2] + 3.0) < 0.5


def places(kind: Any, frame: int, *place: float) -> Any:
    only_position = 0b0000_1001_1111_1000
    return kind(0, 1, 1, frame, only_position, *place, *[0.0] * 8)


LOCAL_TARGET = places(m.MAVLink_set_position_target_local_ned_message, m.MAV_FRAME_LOCAL_NED, 0.0, 0.0, -3.0)
GLOBAL_TARGET = places(
    m.MAVLink_set_position_target_global_int_message, m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, *FRAME.origin[:2], 3.0
)


def says(client: ServiceClient, message: Any, text: str) -> bool:
    return text in client.texts(message)


# Missions


def downloads(client: ServiceClient, kind: Any) -> bool:
    upload(client)
    asked = [client.ask(kind(1, 1, number, MISSION)) for number in range(len(PLAN))]
    names = ("MISSION_ITEM_INT", "MISSION_ITEM")
    found = [(x.seq, x.command) for answers in asked for x in answers if x.get_type() in names]
    return found == [(number, item.command) for number, item in enumerate(PLAN)]


def downloads_a_part(client: ServiceClient) -> bool:
    upload(client)
    answers = client.ask(m.MAVLink_mission_request_partial_list_message(1, 1, 1, 3, MISSION))
    return [x.seq for x in answers if x.get_type().startswith("MISSION_ITEM")] == [1, 2, 3]


def is_asked_for_items(client: ServiceClient) -> bool:
    return client.has("MISSION_REQUEST_INT", m.MAVLink_mission_count_message(1, 1, 2, MISSION), seq=0)


def overwrites_a_part(client: ServiceClient) -> bool:
    upload(client)
    client.ask(m.MAVLink_mission_write_partial_list_message(1, 1, 1, 1, MISSION))
    client.ask(item_message(1, waypoint(9)))
    return client.has("MISSION_ITEM_INT", m.MAVLink_mission_request_int_message(1, 1, 1, MISSION), z=waypoint(9).z)


def uploads_real_numbers(client: ServiceClient) -> bool:
    client.ask(m.MAVLink_mission_count_message(1, 1, 1, MISSION))
    item = m.MAVLink_mission_item_message(
        1, 1, 0, m.MAV_FRAME_GLOBAL_RELATIVE_ALT, m.MAV_CMD_NAV_WAYPOINT, 1, 1, 0, 0, 0, NAN, 47.3977, 8.5456, 9
    )
    return client.has("MISSION_ACK", item, type=m.MAV_MISSION_ACCEPTED)


def ends_download(client: ServiceClient) -> bool:
    """With MISSION_ACK the client gives up the plan that it was promised, and is sent the one in effect."""
    upload(client)
    client.ask(m.MAVLink_mission_request_list_message(1, 1, MISSION))
    client.ask(m.MAVLink_mission_ack_message(1, 1, m.MAV_MISSION_ACCEPTED, MISSION))
    client.upload(PLAN[:2])
    return client.has("MISSION_ACK", m.MAVLink_mission_request_int_message(1, 1, 4, MISSION))


def clears(client: ServiceClient) -> bool:
    upload(client)
    client.ask(m.MAVLink_mission_clear_all_message(1, 1, MISSION))
    return client.has("MISSION_COUNT", m.MAVLink_mission_request_list_message(1, 1, MISSION), count=0)


def chooses_item(client: ServiceClient, message: Any) -> bool:
    upload(client)
    client.ask(message)
    client.run(0.1)
    return bool(client.last("MISSION_CURRENT").seq == 2)


def counts_items(client: ServiceClient) -> bool:
    upload(client)
    return client.has("MISSION_COUNT", m.MAVLink_mission_request_list_message(1, 1, MISSION), count=len(PLAN))


# Commands, modes, parameters and what else there is


def command_int_is_answered(client: ServiceClient) -> bool:
    arm = m.MAVLink_command_int_message(1, 1, m.MAV_FRAME_GLOBAL, ARM, 0, 0, 1, 0, 0, 0, 0, 0, 0)
    return client.result(arm) == ACCEPTED and client.armed


def is_told_the_last_result(client: ServiceClient) -> bool:
    client.accepts(ARM, 1)
    return client.has("COMMAND_ACK", NEWER[COMMAND_CANCEL](1, 1, ARM), command=ARM, result=ACCEPTED)


def sets_mode(client: ServiceClient, message: Any) -> bool:
    client.ask(message)
    return client.mode == px4.MODE_POSCTL


def reads_parameter(client: ServiceClient) -> bool:
    message = m.MAVLink_param_request_read_message(1, 1, SETTING, -1)
    return client.has("PARAM_VALUE", message, param_value=px4.parameter_to_wire(DEFAULT, INT32))


def lists_parameters(client: ServiceClient) -> bool:
    answers = client.ask(m.MAVLink_param_request_list_message(1, 1))
    values = [found for found in answers if found.get_type() == "PARAM_VALUE"]
    return len(values) > 20 and {found.param_index for found in values} >= set(range(values[0].param_count))


def set_message(value: int) -> Any:
    return m.MAVLink_param_set_message(1, 1, SETTING, px4.parameter_to_wire(value, INT32), INT32)


def sets_parameter(client: ServiceClient) -> bool:
    value = px4.parameter_to_wire(OTHER, INT32)
    client.ask(set_message(OTHER))
    return client.has("PARAM_VALUE", m.MAVLink_param_request_read_message(1, 1, SETTING, -1), param_value=value)


def is_refused_a_file(client: ServiceClient) -> bool:
    payload = struct.pack("<HBBBBBBI", 41, 0, 4, 1, 0, 0, 0, 0) + b"x"
    message = m.MAVLink_file_transfer_protocol_message(0, 1, 1, list(payload.ljust(251, b"\0")))
    return client.has("FILE_TRANSFER_PROTOCOL", message)


def is_heard_as_a_ground(client: ServiceClient) -> bool:
    """With NAV_DLL_ACT it is armed only while a ground station is heard."""
    for name, value in ((b"NAV_DLL_ACT", 1), (SETTING, 5)):
        client.ask(m.MAVLink_param_set_message(1, 1, name, px4.parameter_to_wire(value, INT32), INT32))
    client.run(6.0)
    client.ask(m.MAVLink_heartbeat_message(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3))
    return client.accepts(ARM, 1)


MESSAGES: Mapping[Any, Check] = {
    m.MAVLink_heartbeat_message: is_heard_as_a_ground,
    m.MAVLink_set_attitude_target_message: flies_attitude,
    m.MAVLink_set_position_target_local_ned_message: partial(flies_position, setpoint=LOCAL_TARGET),
    m.MAVLink_set_position_target_global_int_message: partial(flies_position, setpoint=GLOBAL_TARGET),
    m.MAVLink_timesync_message: lambda c: c.has("TIMESYNC", m.MAVLink_timesync_message(0, 77), ts1=77),
    m.MAVLink_ping_message: lambda c: c.has("PING", m.MAVLink_ping_message(5, 66, 0, 0), seq=66, target_system=255),
    m.MAVLink_mission_request_list_message: counts_items,
    m.MAVLink_mission_request_int_message: partial(downloads, kind=m.MAVLink_mission_request_int_message),
    m.MAVLink_mission_request_message: partial(downloads, kind=m.MAVLink_mission_request_message),
    m.MAVLink_mission_request_partial_list_message: downloads_a_part,
    m.MAVLink_mission_count_message: is_asked_for_items,
    m.MAVLink_mission_write_partial_list_message: overwrites_a_part,
    m.MAVLink_mission_item_int_message: upload,
    m.MAVLink_mission_item_message: uploads_real_numbers,
    m.MAVLink_mission_ack_message: ends_download,
    m.MAVLink_mission_clear_all_message: clears,
    m.MAVLink_mission_set_current_message: partial(
        chooses_item, message=m.MAVLink_mission_set_current_message(1, 1, 2)
    ),
    m.MAVLink_command_long_message: lambda c: c.accepts(ARM, 1) and c.armed,
    m.MAVLink_command_int_message: command_int_is_answered,
    NEWER[COMMAND_CANCEL]: is_told_the_last_result,
    m.MAVLink_set_mode_message: partial(sets_mode, message=m.MAVLink_set_mode_message(1, CUSTOM, px4.MODE_POSCTL)),
    m.MAVLink_param_request_read_message: reads_parameter,
    m.MAVLink_param_request_list_message: lists_parameters,
    m.MAVLink_param_set_message: sets_parameter,
    m.MAVLink_file_transfer_protocol_message: is_refused_a_file,
    m.MAVLink_log_request_list_message: lambda c: c.has(
        "LOG_ENTRY", m.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF), num_logs=0
    ),
    m.MAVLink_manual_control_message: lambda c: says(
        c, m.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0), "sticks are not read"
    ),
    m.MAVLink_rc_channels_override_message: lambda c: says(
        c, m.MAVLink_rc_channels_override_message(1, 1, *[1500] * 8), "sticks are not read"
    ),
}
"""Of a vehicle that flies by itself, by the class of the message."""


def is_refused(client: ServiceClient, message: Any, text: str = "tip the payload") -> bool:
    """Not done, and the client is told why."""
    answers = client.ask(message)
    results = [found.result for found in answers if found.get_type() == "COMMAND_ACK"]
    refused = [found.type for found in answers if found.get_type() == "MISSION_ACK"]
    return text in text_of(answers) and m.MAV_RESULT_ACCEPTED not in results and m.MAV_MISSION_ACCEPTED not in refused


def has_no_mission(client: ServiceClient, message: Any) -> bool:
    """A download finds nothing, an upload draws a refusal."""
    kinds = ("MISSION_COUNT", "MISSION_ACK", "MISSION_CURRENT")
    return any(found.get_type() in kinds for found in client.ask(message))


OF_TEAM: Mapping[Any, Check] = {
    m.MAVLink_tunnel_message: flies_stop_plan,
    **{
        type(target): partial(says, message=target, text="SET_ATTITUDE_TARGET")
        for target in (LOCAL_TARGET, GLOBAL_TARGET)
    },
    **{
        type(message): partial(has_no_mission, message=message)
        for message in (
            m.MAVLink_mission_request_list_message(1, 1, MISSION),
            m.MAVLink_mission_request_int_message(1, 1, 0, MISSION),
            m.MAVLink_mission_request_message(1, 1, 0, MISSION),
            m.MAVLink_mission_request_partial_list_message(1, 1, 0, 1, MISSION),
            m.MAVLink_mission_count_message(1, 1, 2, MISSION),
            m.MAVLink_mission_write_partial_list_message(1, 1, 0, 1, MISSION),
            m.MAVLink_mission_clear_all_message(1, 1, MISSION),
            m.MAVLink_mission_set_current_message(1, 1, 2),
            item_message(0, waypoint(0)),
            m.MAVLink_mission_item_message(1, 1, 0, 3, m.MAV_CMD_NAV_WAYPOINT, 1, 1, 0, 0, 0, NAN, 47.3977, 8.5456, 9),
        )
    },
}
"""What differs on a payload."""
NOTHING_ON_PAYLOAD = frozenset([m.MAVLink_mission_ack_message, m.MAVLink_heartbeat_message])
"""Messages that do nothing on a payload: there is no transfer that MISSION_ACK could end, and any message is a ground's
sign of life."""
