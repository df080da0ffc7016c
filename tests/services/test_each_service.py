"""Each service switched off in turn: a client then misses just what the service is for."""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from command_checks import COMMANDS, COMMANDS_OF_TEAM, REQUESTS
from message_checks import MESSAGES, NOTHING_ON_PAYLOAD, OF_TEAM, Check
from mission_ground import PLAN
from service_client import HEIGHT, NAN, ServiceClient
from vehicle_bench import HOLD, Bench, attitude_target, command

from gcs.config import SystemConfig
from gcs.mavlink import newer_messages, px4
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.services.answer import ACCEPTED
from vehicle_sim.autopilot import modes as team_modes
from vehicle_sim.autopilot.free import modes as free_modes
from vehicle_sim.mavlink.streams import default_intervals

FREE, TEAM = "free", "on a payload"
KINDS = (FREE, TEAM)
VEHICLES = {kind: Bench(free=kind == FREE).vehicle for kind in KINDS}
SERVICES: dict[str, dict[str, dict[Any, Check]]] = {
    FREE: {"messages": dict(MESSAGES), "commands": dict(COMMANDS), "requests": dict(REQUESTS)},
    TEAM: {
        "messages": {kind: check for kind, check in {**MESSAGES, **OF_TEAM}.items() if kind not in NOTHING_ON_PAYLOAD},
        "commands": {**COMMANDS, **COMMANDS_OF_TEAM},
        "requests": dict(REQUESTS),
    },
}
"""The check of everything that a vehicle handles, by kind of vehicle and table of its dispatcher."""


def name_of(entry: Any) -> str:
    if isinstance(entry, type):
        return entry.msgname
    return m.enums["MAV_CMD"][entry].name if entry in m.enums["MAV_CMD"] else LAYOUTS[entry].kind.msgname


CASES = [
    pytest.param(kind, table, entry, id=f"{name_of(entry)}-{kind}")
    for kind in KINDS for table in ("messages", "commands", "requests")
    for entry in getattr(VEHICLES[kind].dispatcher, table)
    if not (kind == TEAM and entry in NOTHING_ON_PAYLOAD)
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_everything_that_is_handled_has_a_check(kind: str) -> None:
    for table, checks in SERVICES[kind].items():
        handled = set(getattr(VEHICLES[kind].dispatcher, table))
        assert handled - (NOTHING_ON_PAYLOAD if kind == TEAM else set()) == set(checks)


@pytest.mark.parametrize(("kind", "table", "entry"), CASES)
def test_client_finds_a_service_and_misses_it_when_it_is_switched_off(kind: str, table: str, entry: Any) -> None:
    check = SERVICES[kind][table][entry]
    assert check(ServiceClient(free=kind == FREE))
    without = ServiceClient(free=kind == FREE)
    del getattr(without.vehicle.dispatcher, table)[entry]
    assert not check(without)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("number", COMMANDS, ids=name_of)
def test_client_notices_a_command_that_is_accepted_and_not_done(kind: str, number: int) -> None:
    client = ServiceClient(free=kind == FREE)
    client.vehicle.dispatcher.commands[number] = lambda message, request: ACCEPTED
    assert not SERVICES[kind]["commands"][number](client)


# Messages: those of the streams come unasked, every one on request


def airborne(kind: str) -> ServiceClient:
    """A vehicle in the air of which there is data for every message: it holds, or has flown an item of a mission."""
    client = ServiceClient(free=kind == FREE)
    if kind == FREE:
        client.upload([PLAN[0]._replace(z=HEIGHT), *PLAN[1:]])
        client.accepts(m.MAV_CMD_MISSION_START, 0, 0)
        client.run(4.5)
    else:
        client.take_off()
        client.ask(HOLD)
    client.run(0.1)
    client.scan()
    return client


ORBITING = px4.AUTOPILOT_COMPONENT, m.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS
ITEM_REACHED = px4.AUTOPILOT_COMPONENT, m.MAVLINK_MSG_ID_MISSION_ITEM_REACHED
STREAMS = default_intervals(SystemConfig().vehicle_link.intervals, 0.02)
LONGEST = 1.0
"""Interval (s) of the streams that are waited for; of the others one comes when something changes."""


@pytest.mark.parametrize("key", sorted(VEHICLES[TEAM].telemetry.builders), ids=lambda key: name_of(key[1]))
def test_client_gets_a_message_and_misses_it_when_it_is_switched_off(key: tuple[int, int]) -> None:
    component, number = key
    client = airborne(FREE if key in (ITEM_REACHED, ORBITING) else TEAM)
    if key == ORBITING:
        client.accepts(m.MAV_CMD_DO_ORBIT, 3.0, 2.0, NAN, 0, NAN, NAN, NAN)
    system = 1 if component == px4.AUTOPILOT_COMPONENT else px4.PAYLOAD_UNIT_SYSTEM
    request = command(m.MAV_CMD_REQUEST_MESSAGE, number, system=system, component=component)
    builders = client.vehicle.telemetry.builders
    build = builders[key]
    for is_on in (True, False):
        builders[key] = build if is_on else lambda now: ()
        assert (client.result(request) == m.MAV_RESULT_ACCEPTED) is is_on
        if STREAMS.get(key, 2.0 * LONGEST) <= LONGEST:
            assert (number in client.streamed(component, LONGEST + 0.1)) is is_on


# Modes


def lists(client: ServiceClient, mode: int) -> bool:
    return client.has("AVAILABLE_MODES", command(512, newer_messages.AVAILABLE_MODES), custom_mode=mode)


def enters(client: ServiceClient, mode: int) -> bool:
    main, sub = mode >> 16 & 0xFF, mode >> 24
    return client.accepts(m.MAV_CMD_DO_SET_MODE, 1, main, sub) and client.mode == mode


@pytest.mark.parametrize(("kind", "mode"), [(kind, mode) for kind in KINDS for mode in VEHICLES[kind].aircraft.modes])
def test_client_enters_a_mode_and_misses_it_when_it_is_switched_off(
    kind: str, mode: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def client() -> ServiceClient:
        client = ServiceClient(free=kind == FREE)
        if mode in (px4.MODE_LAND, px4.MODE_RETURN):
            client.take_off()
        elif mode == px4.MODE_MISSION:
            client.upload()
        elif mode == px4.MODE_OFFBOARD:
            client.stream(attitude_target())
        return client

    usual = client()
    assert lists(usual, mode) and enters(usual, mode)
    without = client()
    without.vehicle.aircraft.modes = tuple(other for other in without.vehicle.aircraft.modes if other != mode)
    assert not lists(without, mode)
    if mode == px4.MODE_OFFBOARD:  # that of who sends set-points
        del without.vehicle.dispatcher.messages[m.MAVLink_set_attitude_target_message]
        without.run(1.0)
    else:
        monkeypatch.delitem((free_modes if kind == FREE else team_modes).ENTRY, mode)
    assert not enters(without, mode)
