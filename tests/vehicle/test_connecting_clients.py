"""What clients send when they connect, request by request: each is answered at once, so that none waits."""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from vehicle_bench import ACCEPTED, UNSUPPORTED, Bench, command

from gcs.mavlink import newer_messages, px4

COMPONENT_METADATA, COMPONENT_INFORMATION, EVENT_SEQUENCE = 397, 395, 411


def request_of(number: int, *parameters: float, component: int = 1) -> Any:
    return command(512, number, *parameters, component=component)


QGROUNDCONTROL: list[tuple[Any, int, str]] = [
    (request_of(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION), ACCEPTED, "AUTOPILOT_VERSION"),
    (request_of(newer_messages.PROTOCOL_VERSION), ACCEPTED, "PROTOCOL_VERSION"),
    (request_of(newer_messages.AVAILABLE_MODES, 1), ACCEPTED, "AVAILABLE_MODES"),
    (request_of(COMPONENT_METADATA), UNSUPPORTED, ""),
    (request_of(COMPONENT_INFORMATION), UNSUPPORTED, ""),
    (request_of(mavlink.MAVLINK_MSG_ID_HOME_POSITION), ACCEPTED, "HOME_POSITION"),
    (request_of(mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN), ACCEPTED, "GPS_GLOBAL_ORIGIN"),
    (request_of(mavlink.MAVLINK_MSG_ID_CAMERA_INFORMATION, component=100), UNSUPPORTED, ""),
    (request_of(mavlink.MAVLINK_MSG_ID_GIMBAL_MANAGER_INFORMATION, component=154), UNSUPPORTED, ""),
]
MAVSDK: list[tuple[Any, int, str]] = [
    (request_of(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION), ACCEPTED, "AUTOPILOT_VERSION"),
    (request_of(newer_messages.AVAILABLE_MODES, 0), ACCEPTED, "AVAILABLE_MODES"),
    (request_of(mavlink.MAVLINK_MSG_ID_ALTITUDE), ACCEPTED, "ALTITUDE"),
    (command(511, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, 1e6), ACCEPTED, ""),
    (command(511, mavlink.MAVLINK_MSG_ID_ODOMETRY, 1e5), ACCEPTED, "ODOMETRY"),
    (command(510, mavlink.MAVLINK_MSG_ID_ODOMETRY), ACCEPTED, "MESSAGE_INTERVAL"),
    (request_of(EVENT_SEQUENCE), UNSUPPORTED, ""),
]
MAVROS: list[tuple[Any, int, str]] = [
    (request_of(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION, component=0), ACCEPTED, "AUTOPILOT_VERSION"),
    (command(520, 1), ACCEPTED, "AUTOPILOT_VERSION"),
    (command(519, 1), ACCEPTED, "PROTOCOL_VERSION"),
    (command(410), ACCEPTED, "HOME_POSITION"),
    (command(511, mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, 2e4), ACCEPTED, "HIGHRES_IMU"),
]


@pytest.mark.parametrize(
    ("sequence", "system", "component"),
    [(QGROUNDCONTROL, 255, 190), (MAVSDK, 245, 190), (MAVROS, 1, 191)],
    ids=["QGroundControl", "MAVSDK", "MAVROS"],
)
def test_every_command_of_the_connection_is_answered_at_once(
    bench: Bench, sequence: list[tuple[Any, int, str]], system: int, component: int
) -> None:
    address = ("10.0.0.9", 14550)
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), address, system, component)
    bench.run(0.2)
    for message, result, kind in sequence:
        answers = bench.request(message, address, system, component)
        [ack] = [m for m in answers if m.get_type() == "COMMAND_ACK"]
        assert (ack.command, ack.result) == (message.command, result)
        assert (ack.target_system, ack.target_component) == (system, component)
        assert not kind or kind in [m.get_type() for m in answers]


def test_parameters_are_complete_with_their_hash_and_set_again(bench: Bench) -> None:
    bench.request(mavlink.MAVLink_param_request_list_message(1, 1))
    check, *values = bench.got("PARAM_VALUE")
    assert check.param_id == "_HASH_CHECK" and len(values) == check.param_count
    for value in values:
        kept = mavlink.MAVLink_param_set_message(1, 1, value.param_id.encode(), value.param_value, value.param_type)
        answers = bench.request(kept)
        assert [m.param_value for m in answers if m.get_type() == "PARAM_VALUE"] == [value.param_value]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("NAV_RCL_ACT", 0), ("NAV_DLL_ACT", 0), ("COM_RCL_EXCEPT", 4), ("COM_OBL_RC_ACT", 5), ("COM_RC_IN_MODE", 4),
        ("COM_DL_LOSS_T", 30),
    ],
)  # fmt: skip
def test_parameter_that_clients_set_before_they_fly_is_kept(bench: Bench, name: str, value: int) -> None:
    kind = mavlink.MAV_PARAM_TYPE_INT32
    wire = px4.parameter_to_wire(value, kind)
    [answer] = bench.request(mavlink.MAVLink_param_set_message(1, 1, name.encode(), wire, kind))
    assert (answer.get_type(), answer.param_value) == ("PARAM_VALUE", wire) and bench.vehicle.parameters[name] == value
