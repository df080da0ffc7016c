"""Missions uploaded over the wire to a free vehicle, and what it then flies."""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
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


def test_every_command_that_is_taken_as_flown_is_flown() -> None:
    assert set(COMMANDS) == {*FLOWN_TO, *DONE}


def test_uploaded_mission_is_flown_and_its_progress_sent() -> None:
    with FreeBench() as bench:
        bench.run(0.5)
        assert upload(bench, *PLAN) == ACCEPTED
        download = Downloader()
        transfer(bench, download)
        assert same(download.items, PLAN)
        start(bench)
        bench.run(1.0)
        assert current(bench) == (0, m.MISSION_STATE_ACTIVE)
        assert bench.run(60.0, lambda: not bench.armed())
        bench.run(1.1)
        assert reached(bench) == [0, 1, 2, 3]
        assert current(bench)[1] == m.MISSION_STATE_COMPLETE


def test_another_mission_is_uploaded_and_an_item_chosen_in_flight() -> None:
    with FreeBench() as bench:
        bench.run(0.5)
        upload(bench, *PLAN)
        start(bench)
        assert bench.run(30.0, lambda: reached(bench) == [0])
        others = [item(WAYPOINT, 0.0, -6.0, 4.0), item(WAYPOINT, 0.0, 0.0, 8.0), item(WAYPOINT, 30.0, 0.0, 8.0)]
        assert upload(bench, *others) == ACCEPTED
        bench.run(0.5)
        assert current(bench) == (0, m.MISSION_STATE_ACTIVE)
        bench.send(m.MAVLink_mission_set_current_message(1, 1, 1))
        bench.messages.clear()
        assert bench.run(30.0, lambda: reached(bench) == [1])
        assert abs(bench.position()[2] + 8.0) < 1.5
        assert bench.command(*mode(px4.AutoMode.LOITER)) == m.MAV_RESULT_ACCEPTED
        bench.run(1.1)
        assert current(bench)[1] == m.MISSION_STATE_PAUSED


def test_mission_cleared_in_flight_leaves_the_vehicle_where_it_is() -> None:
    with FreeBench() as bench:
        bench.run(0.5)
        upload(bench, *PLAN)
        start(bench)
        assert bench.run(30.0, lambda: reached(bench) == [0])
        bench.send(m.MAVLink_mission_clear_all_message(1, 1, m.MAV_MISSION_TYPE_ALL))
        place = bench.position().copy()
        bench.run(10.0)
        assert current(bench)[1] == m.MISSION_STATE_NO_MISSION
        assert bench.armed() and abs(bench.position() - place).max() < 4.0
        assert bench.mode_of() == "AUTO.LOITER"


def test_mission_that_cannot_be_started_is_refused_at_its_start() -> None:
    with FreeBench() as bench:
        bench.run(0.5)
        assert upload(bench, item(WAYPOINT, 20_000.0, 0.0, 4.0)) == ACCEPTED
        assert bench.command(*mode(px4.AutoMode.MISSION)) != m.MAV_RESULT_ACCEPTED
        assert not bench.armed()
