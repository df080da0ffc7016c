"""Missions uploaded over the wire to a free vehicle, and what it then flies."""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from free_bench import FreeBench, item, mode
from mission_ground import ACCEPTED, Downloader, Uploader, placeless, same

from gcs.mavlink import px4
from gcs.mission.px4_items import DONE, FLOWN_TO
from vehicle_sim.mavlink.mission_steps import COMMANDS

TAKEOFF, WAYPOINT = m.MAV_CMD_NAV_TAKEOFF, m.MAV_CMD_NAV_WAYPOINT
RETURN = placeless(m.MAV_CMD_NAV_RETURN_TO_LAUNCH)
PLAN = [item(TAKEOFF, up=4.0), item(WAYPOINT, 6.0, 0.0, 4.0), item(WAYPOINT, 6.0, 6.0, 5.0), RETURN]


def transfer(bench: FreeBench, client: Any) -> None:
    """Let a client exchange its messages with vehicle 1 while time goes on."""
    bench.messages.clear()
    waiting = client.start(bench.now)
    while not client.is_done:
        for message in waiting:
            bench.send(message)
        taken, bench.messages = bench.messages, []
        waiting = [new for _, i, found in taken if i == 1 for new in client.take(found, bench.now)]
        if not waiting:
            bench.run(0.02)
            waiting = client.run(bench.now)


def upload(bench: FreeBench, *items: Any) -> int | None:
    client = Uploader(items)
    transfer(bench, client)
    return client.result


def start(bench: FreeBench) -> None:
    """Enter the mission's mode and arm."""
    assert bench.command(*mode(px4.AutoMode.MISSION)) == m.MAV_RESULT_ACCEPTED
    assert bench.command(m.MAV_CMD_COMPONENT_ARM_DISARM, 1) == m.MAV_RESULT_ACCEPTED
    bench.messages.clear()


def current(bench: FreeBench) -> tuple[int, int]:
    """Item and state of the last MISSION_CURRENT."""
    last = [found for _, i, found in bench.messages if found.get_type() == "MISSION_CURRENT"][-1]
    return last.seq, last.mission_state


def reached(bench: FreeBench) -> list[int]:
    """Items reached, in order, repetitions left out."""
    return list(dict.fromkeys(found.seq for *_, found in bench.messages if found.get_type() == "MISSION_ITEM_REACHED"))


@pytest.fixture
def on_mission(standing: FreeBench) -> FreeBench:
    """A vehicle that flies PLAN, and has taken off."""
    upload(standing, *PLAN)
    start(standing)
    assert standing.run(30.0, lambda: reached(standing) == [0])
    return standing


def test_every_command_that_is_taken_as_flown_is_flown() -> None:
    assert set(COMMANDS) == {*FLOWN_TO, *DONE}


def test_uploaded_mission_is_flown_and_its_progress_sent(standing: FreeBench) -> None:
    assert upload(standing, *PLAN) == ACCEPTED
    download = Downloader()
    transfer(standing, download)
    assert same(download.items, PLAN)
    start(standing)
    standing.run(1.0)
    assert current(standing) == (0, m.MISSION_STATE_ACTIVE)
    assert standing.run(60.0, lambda: not standing.armed())
    standing.run(1.1)
    assert reached(standing) == [0, 1, 2, 3]
    assert current(standing)[1] == m.MISSION_STATE_COMPLETE


def test_another_mission_is_uploaded_and_an_item_chosen_in_flight(on_mission: FreeBench) -> None:
    others = [item(WAYPOINT, 0.0, -6.0, 4.0), item(WAYPOINT, 0.0, 0.0, 8.0), item(WAYPOINT, 30.0, 0.0, 8.0)]
    assert upload(on_mission, *others) == ACCEPTED
    on_mission.run(0.5)
    assert current(on_mission) == (0, m.MISSION_STATE_ACTIVE)
    on_mission.send(m.MAVLink_mission_set_current_message(1, 1, 1))
    on_mission.messages.clear()
    assert on_mission.run(30.0, lambda: reached(on_mission) == [1])
    assert abs(on_mission.position()[2] + 8.0) < 1.5
    assert on_mission.command(*mode(px4.AutoMode.LOITER)) == m.MAV_RESULT_ACCEPTED
    on_mission.run(1.1)
    assert current(on_mission)[1] == m.MISSION_STATE_PAUSED


def test_mission_cleared_in_flight_leaves_the_vehicle_where_it_is(on_mission: FreeBench) -> None:
    on_mission.send(m.MAVLink_mission_clear_all_message(1, 1, m.MAV_MISSION_TYPE_ALL))
    place = on_mission.position().copy()
    on_mission.run(10.0)
    assert current(on_mission)[1] == m.MISSION_STATE_NO_MISSION
    assert on_mission.armed() and abs(on_mission.position() - place).max() < 4.0
    assert on_mission.mode_of() == "AUTO.LOITER"


def test_refused_start_of_a_mission_leaves_its_progress(on_mission: FreeBench) -> None:
    on_mission.set_parameter("GF_MAX_HOR_DIST", 3.0)
    assert on_mission.command(m.MAV_CMD_MISSION_START, 0) == m.MAV_RESULT_DENIED
    on_mission.run(1.5)
    assert current(on_mission) == (1, m.MISSION_STATE_ACTIVE)


def test_mission_that_cannot_be_started_is_refused_at_its_start(standing: FreeBench) -> None:
    assert upload(standing, item(WAYPOINT, 20_000.0, 0.0, 4.0)) == ACCEPTED
    assert standing.command(*mode(px4.AutoMode.MISSION)) != m.MAV_RESULT_ACCEPTED
    assert not standing.armed()
