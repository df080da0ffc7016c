"""What a client finds of the commands of a vehicle: that each is done, or refused with the reason.

For the checks see :mod:`message_checks`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
from message_checks import OTHER, Check, chooses_item, is_refused, reads_parameter, says, set_message, sets_mode, upload
from service_client import ARM, FRAME, HEIGHT, NAN, TAKEOFF, ServiceClient
from vehicle_bench import ACCEPTED, command

from gcs.mavlink import newer_messages, px4


def is_in_mode(client: ServiceClient, mode: int, *message: float) -> bool:
    client.take_off()
    return client.accepts(*message) and client.mode == mode  # type: ignore[arg-type]


def takes_off(client: ServiceClient) -> bool:
    if not (client.accepts(TAKEOFF, 0, 0, 0, NAN, NAN, NAN, NAN) and client.accepts(ARM, 1)):
        return False
    client.run(4.5)
    return bool(client.place[2] < 0.3 - HEIGHT)


def terminates(client: ServiceClient) -> bool:
    client.take_off()
    return client.accepts(m.MAV_CMD_DO_FLIGHTTERMINATION, 1) and not client.armed


def arms_and_disarms(client: ServiceClient) -> bool:
    armed = client.accepts(ARM, 1) and client.armed
    return armed and client.accepts(ARM, 0) and not client.armed


def goes_to(client: ServiceClient, north: float = 4.0) -> bool:
    client.take_off()
    latitude, longitude, altitude = FRAME.geodetic(north, 0.0, -HEIGHT)
    if not client.accepts(m.MAV_CMD_DO_REPOSITION, -1, 1, 0, NAN, latitude, longitude, altitude):
        return False
    client.run(5.0)
    return abs(client.place[0] - 4.0) < 0.3


def turns(client: ServiceClient) -> bool:
    client.take_off()
    accepted = client.accepts(m.MAV_CMD_CONDITION_YAW, 90.0, 0, 1, 0)
    client.run(6.0)
    return accepted and abs(client.last("ATTITUDE").yaw - math.radians(90.0)) < 0.1


def circles(client: ServiceClient) -> bool:
    client.take_off()
    north, east, *_ = client.place
    latitude, longitude, altitude = FRAME.geodetic(north + 3.0, east, -HEIGHT)
    accepted = client.accepts(m.MAV_CMD_DO_ORBIT, 3.0, 2.0, NAN, 0, latitude, longitude, altitude)
    client.run(6.0)
    away = math.hypot(client.place[0] - north - 3.0, client.place[1] - east)
    return accepted and abs(away - 3.0) < 0.5 and client.speed > 1.0


def sets_home(client: ServiceClient) -> bool:
    latitude, longitude, altitude = FRAME.geodetic(3.0, 0.0, 0.0)
    home = m.MAVLink_command_int_message(
        1, 1, m.MAV_FRAME_GLOBAL, m.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, 0, 0,
        round(latitude * 1e7), round(longitude * 1e7), altitude,
    )  # fmt: skip
    client.ask(home)
    client.ask(command(m.MAV_CMD_GET_HOME_POSITION))
    return abs(client.last("HOME_POSITION").latitude - latitude * 1e7) < 5


def flies_slower(client: ServiceClient) -> bool:
    client.take_off()
    latitude, longitude, altitude = FRAME.geodetic(40.0, 0.0, -HEIGHT)
    client.accepts(m.MAV_CMD_DO_REPOSITION, -1, 1, 0, NAN, latitude, longitude, altitude)
    client.run(4.0)
    was = client.speed
    accepted = client.accepts(m.MAV_CMD_DO_CHANGE_SPEED, 1, 1.5, -1)
    client.run(4.0)
    return accepted and was > 2.5 and abs(client.speed - 1.5) < 0.3


def starts_mission(client: ServiceClient) -> bool:
    upload(client)
    return client.accepts(m.MAV_CMD_MISSION_START, 0, 0) and client.armed and client.mode == px4.MODE_MISSION


def pauses_and_continues(client: ServiceClient) -> bool:
    upload(client)
    client.accepts(m.MAV_CMD_MISSION_START, 0, 0)
    client.run(3.0)
    paused = client.accepts(m.MAV_CMD_DO_PAUSE_CONTINUE, 0) and client.mode == px4.MODE_HOLD
    return paused and client.accepts(m.MAV_CMD_DO_PAUSE_CONTINUE, 1) and client.mode == px4.MODE_MISSION


def is_sent(client: ServiceClient, kind: str, message: Any) -> bool:
    answers = client.ask(message)
    kinds = [found.get_type() for found in answers]
    return kind in kinds and any(found.get_type() == "COMMAND_ACK" and found.result == ACCEPTED for found in answers)


def sets_interval(client: ServiceClient) -> bool:
    if not client.accepts(m.MAV_CMD_SET_MESSAGE_INTERVAL, m.MAVLINK_MSG_ID_VFR_HUD, 1e5):
        return False
    before = len(client.got("VFR_HUD"))
    client.run(1.0)
    return 9 <= len(client.got("VFR_HUD")) - before <= 11


def stores_parameters(client: ServiceClient) -> bool:
    client.ask(set_message(OTHER))
    reset = client.accepts(m.MAV_CMD_PREFLIGHT_STORAGE, 2)
    return reset and reads_parameter(client)


COMMANDS: Mapping[int, Check] = {
    m.MAV_CMD_DO_SET_MISSION_CURRENT: partial(chooses_item, message=command(m.MAV_CMD_DO_SET_MISSION_CURRENT, 2)),
    ARM: arms_and_disarms,
    m.MAV_CMD_DO_FLIGHTTERMINATION: terminates,
    TAKEOFF: takes_off,
    m.MAV_CMD_NAV_LAND: lambda c: is_in_mode(c, px4.MODE_LAND, m.MAV_CMD_NAV_LAND),
    m.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda c: is_in_mode(c, px4.MODE_RETURN, m.MAV_CMD_NAV_RETURN_TO_LAUNCH),
    m.MAV_CMD_DO_REPOSITION: goes_to,
    m.MAV_CMD_DO_CHANGE_SPEED: flies_slower,
    m.MAV_CMD_MISSION_START: starts_mission,
    m.MAV_CMD_DO_PAUSE_CONTINUE: pauses_and_continues,
    m.MAV_CMD_DO_SET_MODE: partial(sets_mode, message=command(176, 1, px4.MainMode.POSCTL)),
    m.MAV_CMD_DO_SET_STANDARD_MODE: partial(sets_mode, message=command(262, m.MAV_STANDARD_MODE_POSITION_HOLD)),
    m.MAV_CMD_GET_HOME_POSITION: partial(is_sent, kind="HOME_POSITION", message=command(410)),
    m.MAV_CMD_REQUEST_PROTOCOL_VERSION: partial(is_sent, kind="PROTOCOL_VERSION", message=command(519, 1)),
    m.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: partial(is_sent, kind="AUTOPILOT_VERSION", message=command(520, 1)),
    m.MAV_CMD_RUN_PREARM_CHECKS: partial(says, message=command(401), text="Preflight OK"),
    m.MAV_CMD_PREFLIGHT_STORAGE: stores_parameters,
    m.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: partial(is_refused, message=command(246, 1), text="vehicle-sim anew"),
    m.MAV_CMD_DO_SET_HOME: sets_home,
    m.MAV_CMD_CONDITION_YAW: turns,
    m.MAV_CMD_DO_ORBIT: circles,
    m.MAV_CMD_REQUEST_MESSAGE: partial(is_sent, kind="ALTITUDE", message=command(512, m.MAVLINK_MSG_ID_ALTITUDE)),
    m.MAV_CMD_SET_MESSAGE_INTERVAL: sets_interval,
    m.MAV_CMD_GET_MESSAGE_INTERVAL: partial(
        is_sent, kind="MESSAGE_INTERVAL", message=command(510, m.MAVLINK_MSG_ID_ALTITUDE)
    ),
}
"""Of a vehicle that flies by itself, by MAV_CMD."""

COMMANDS_OF_TEAM: Mapping[int, Check] = {
    m.MAV_CMD_DO_SET_HOME: partial(is_refused, message=command(179, 1), text="--mission sets it"),
    **{
        number: partial(is_refused, message=command(number, *parameters))
        for number, *parameters in (
            (m.MAV_CMD_DO_SET_MISSION_CURRENT, 2),
            (TAKEOFF, 0, 0, 0, NAN, NAN, NAN, NAN),
            (m.MAV_CMD_NAV_RETURN_TO_LAUNCH,),
            (m.MAV_CMD_DO_REPOSITION, -1, 1, 0, NAN, NAN, NAN, NAN),
            (m.MAV_CMD_DO_CHANGE_SPEED, 1, 1.5, -1),
            (m.MAV_CMD_CONDITION_YAW, 90.0, 0, 1, 0),
            (m.MAV_CMD_DO_ORBIT, 3.0, 2.0, NAN, 0, NAN, NAN, NAN),
            (m.MAV_CMD_MISSION_START, 0, 0),
            (m.MAV_CMD_DO_PAUSE_CONTINUE, 0),
        )
    },
}
"""What differs on a payload."""


REQUESTS: Mapping[int, Check] = {
    newer_messages.AVAILABLE_MODES: partial(
        is_sent, kind="AVAILABLE_MODES", message=command(512, newer_messages.AVAILABLE_MODES)
    ),
}
"""Messages whose request has parameters, by id."""
