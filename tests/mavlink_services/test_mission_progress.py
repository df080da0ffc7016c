"""Opaque ids, the current item, MISSION_CURRENT and MISSION_ITEM_REACHED."""

from __future__ import annotations

import math
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import (
    ACCEPTED,
    FENCE,
    MISSION,
    PLAN,
    RALLY,
    MissionBench,
    corners,
    count,
    ids_in,
    item_message,
    rally_point,
    request_list,
    texts,
    waypoint,
)
from vehicle_bench import GROUND, command

from gcs.mavlink.services.mission_item import opaque_id


def test_ids_change_with_the_plan_and_are_those_of_px4(free: MissionBench) -> None:
    free.upload(PLAN)
    identity = opaque_id(PLAN)
    assert free.plans.id_of(MISSION) == identity != 0
    assert ids_in([r for r in free.received if r.message_id == m.MAVLINK_MSG_ID_MISSION_ACK][-1]) == (identity,)
    free.answers(request_list())
    assert ids_in([r for r in free.received if r.message_id == m.MAVLINK_MSG_ID_MISSION_COUNT][-1]) == (identity,)
    free.upload(corners(5001), FENCE)
    free.upload([rally_point()], RALLY)
    free.wait(1.0)
    ids = ids_in([r for r in free.received if r.message_id == m.MAVLINK_MSG_ID_MISSION_CURRENT][-1])
    assert ids == (identity, opaque_id(corners(5001)), opaque_id([rally_point()])) and len(set(ids)) == 3
    # The CRC of MAVLink FTP over one item: computed bit by bit.
    expected = 0
    for byte in b"\x06\x10\x00\x01" + bytes(12) + b"\x00\x00\xc0\x7f\x4c\x52\x40\x1c\x44\xf4\x17\x05\x00\x00\x20\x41":
        expected ^= byte
        for _ in range(8):
            expected = expected >> 1 ^ (0xEDB88320 if expected & 1 else 0)
    assert opaque_id([waypoint()]) == expected
    assert opaque_id([]) == 0 and opaque_id(PLAN[::-1]) != identity


def currents(free: MissionBench) -> list[tuple[int, int, int, int]]:
    return [(c.seq, c.total, c.mission_state, c.mission_mode) for c in free.inbox[GROUND] if c.id == 42]


def test_current_item_is_streamed_and_sent_on_change(free: MissionBench) -> None:
    free.collect()
    assert currents(free) == [(0, 0xFFFF, m.MISSION_STATE_NO_MISSION, 2)]
    free.wait(2.05)
    assert len(currents(free)) == 3
    free.upload(PLAN)
    assert currents(free)[-1] == (0, 5, m.MISSION_STATE_NOT_STARTED, 2)
    free.flight.mission_active = True
    free.flight.current_item = 1
    free.collect()
    assert currents(free)[-1] == (1, 5, m.MISSION_STATE_ACTIVE, 1)
    free.flight.mission_active = False
    free.collect()
    assert currents(free)[-1] == (1, 5, m.MISSION_STATE_PAUSED, 2)
    free.flight.mission_finished = True
    free.collect()
    assert currents(free)[-1] == (1, 5, m.MISSION_STATE_COMPLETE, 2)


def test_ground_chooses_the_current_item(free: MissionBench) -> None:
    free.upload(PLAN)
    free.send(m.MAVLink_mission_set_current_message(1, 1, 3))
    free.collect()
    assert currents(free)[-1][0] == free.flight.current_item == 3
    free.send(m.MAVLink_mission_set_current_message(1, 1, 5))
    free.collect()
    assert currents(free)[-1][0] == free.plans.current == 3 and "5 of 5" in texts(free.inbox[GROUND])


@pytest.mark.parametrize(
    ("parameters", "result", "current", "missions"),
    [
        ((1, 0), 0, 1, 1),
        ((4, 1), 0, 4, 2),
        ((-1, 1), 0, 2, 2),
        ((5, 0), 2, 2, 1),
        ((math.nan,), 2, 2, 1),
        ((1.5,), 2, 2, 1),
    ],
)
def test_current_item_is_chosen_by_command(
    free: MissionBench, parameters: Any, result: int, current: int, missions: int
) -> None:
    free.upload(PLAN)
    free.flight.current_item = 2
    answers = free.answers(command(m.MAV_CMD_DO_SET_MISSION_CURRENT, *parameters))
    assert [found.result for found in answers if found.get_type() == "COMMAND_ACK"] == [result]
    assert (free.plans.current, free.flight.taken) == (current, missions)  # anew: jumps are counted again


def test_item_marked_as_current_is_flown_to_first(free: MissionBench) -> None:
    free.answers(count(2))
    free.answers(item_message(0, waypoint(0)))
    free.answers(item_message(1, waypoint(1), current=1))
    assert free.plans.current == 1
    free.upload([waypoint(4)])
    assert free.plans.current == 0


def test_same_plan_once_more_does_not_begin_the_mission_anew(free: MissionBench) -> None:
    free.upload(PLAN)
    free.flight.current_item = 3
    assert free.upload(PLAN) == ACCEPTED
    assert (free.plans.current, free.flight.taken) == (3, 1)


def test_reached_items_are_sent_at_once_and_repeated(free: MissionBench) -> None:
    free.upload(PLAN)
    free.flight.on_reached(0)
    free.flight.on_reached(1)
    assert [found.seq for found in free.wait(0.01)] == [0, 1]
    again = [found.seq for found in free.wait(30.0)]
    assert again == [1] * 10
    free.upload([waypoint(9)])
    assert free.wait(5.0) == []


def test_progress_is_sent_on_request(free: MissionBench) -> None:
    free.upload(PLAN)
    before = len(currents(free))
    answers = free.answers(command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_MISSION_CURRENT))
    assert [found.result for found in answers if found.get_type() == "COMMAND_ACK"] == [0]
    assert currents(free)[before:] == [(0, 5, m.MISSION_STATE_NOT_STARTED, 2)]
