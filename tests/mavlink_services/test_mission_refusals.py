"""What a vehicle by itself refuses of an uploaded plan, with which answer, and what it takes."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import (
    ACCEPTED,
    FENCE,
    LIMITS,
    MISSION,
    PLAN,
    RALLY,
    MissionBench,
    corners,
    count,
    item_message,
    placeless,
    rally_point,
    request_list,
    results,
    same,
    texts,
    waypoint,
)
from vehicle_bench import GROUND

from gcs.mavlink.services.mission_item import UNKNOWN, PlanType
from gcs.mission import px4_items
from gcs.mission.commands import LEFT_OUT, Command, Frame, command_name
from gcs.mission.items import ItemError
from gcs.mission.items import MissionItem as FileItem


def test_items_beyond_the_announced_number_end_the_upload(free: MissionBench) -> None:
    free.answers(count(2))
    assert results(free.answers(item_message(2, waypoint()))) == [m.MAV_MISSION_INVALID_SEQUENCE]
    assert free.wait(10.0) == [] and free.plans.items == ()


def test_items_out_of_order_wait_for_the_next_request(free: MissionBench) -> None:
    free.answers(count(3))
    assert free.answers(item_message(1, waypoint(1))) == []
    assert [found.seq for found in free.wait(0.3)] == [0]
    assert free.upload(PLAN) == ACCEPTED


@pytest.mark.parametrize(
    ("plan_type", "limit"),
    [(MISSION, LIMITS.mission_items_max), (FENCE, LIMITS.fence_items_max), (RALLY, LIMITS.rally_points_max)],
)
def test_more_items_than_there_is_space_for_are_refused(free: MissionBench, plan_type: PlanType, limit: int) -> None:
    for number in (limit + 1, 65535):
        answers = free.answers(count(number, plan_type))
        assert results(answers) == [m.MAV_MISSION_NO_SPACE] and str(limit) in texts(answers)
    assert [found.get_type() for found in free.answers(count(limit, plan_type))] == ["MISSION_REQUEST_INT"]


def test_unknown_plan_types_are_refused_at_once(free: MissionBench) -> None:
    for message in (
        count(1, 7), count(0, 255), request_list(3), request_list(255), m.MAVLink_mission_clear_all_message(1, 1, 9),
        m.MAVLink_mission_request_int_message(1, 1, 0, 77), m.MAVLink_mission_write_partial_list_message(1, 1, 0, 0, 5),
    ):  # fmt: skip
        assert results(free.answers(message)) == [m.MAV_MISSION_UNSUPPORTED]


@pytest.mark.parametrize("target", [0, 2])
def test_messages_to_all_or_to_others_are_not_heeded(free: MissionBench, target: int) -> None:
    free.upload(PLAN)
    for message in (
        count(1, MISSION, target), m.MAVLink_mission_clear_all_message(target, 1, 0),
        m.MAVLink_mission_request_list_message(target, 1), m.MAVLink_mission_set_current_message(target, 1, 2),
        item_message(0, waypoint(), target=target),
    ):  # fmt: skip
        assert free.answers(message) == []
    assert same(free.plans.items, PLAN) and free.plans.current == 0


PARAM = m.MAV_MISSION_INVALID_PARAM1 - 1
REFUSED = [
    (waypoint(frame=m.MAV_FRAME_LOCAL_NED), m.MAV_MISSION_UNSUPPORTED_FRAME),
    (waypoint(frame=m.MAV_FRAME_GLOBAL_TERRAIN_ALT), m.MAV_MISSION_UNSUPPORTED_FRAME),
    (waypoint(frame=99), m.MAV_MISSION_UNSUPPORTED_FRAME),
    (waypoint(command=0), m.MAV_MISSION_UNSUPPORTED),
    (waypoint(command=m.MAV_CMD_NAV_SPLINE_WAYPOINT), m.MAV_MISSION_UNSUPPORTED),
    (waypoint(command=m.MAV_CMD_NAV_VTOL_TAKEOFF), m.MAV_MISSION_UNSUPPORTED),
    (waypoint(command=m.MAV_CMD_COMPONENT_ARM_DISARM), m.MAV_MISSION_UNSUPPORTED),
    (waypoint(command=m.MAV_CMD_NAV_RETURN_TO_LAUNCH), m.MAV_MISSION_UNSUPPORTED),
    (waypoint(command=5001, param1=3.0), m.MAV_MISSION_UNSUPPORTED),
    (waypoint(param1=math.inf), PARAM + 1),
    (waypoint(param1=-1.0), PARAM + 1),
    (waypoint(param2=math.inf), PARAM + 2),
    (waypoint(param3=-math.inf), PARAM + 3),
    (waypoint(x=910000000), PARAM + 5),
    (waypoint(x=UNKNOWN), PARAM + 5),
    (waypoint(y=-1810000000), PARAM + 6),
    (waypoint(z=math.inf), PARAM + 7),
    (waypoint(command=m.MAV_CMD_NAV_TAKEOFF, z=math.nan), PARAM + 7),
    (placeless(m.MAV_CMD_NAV_WAYPOINT), m.MAV_MISSION_UNSUPPORTED),
    (placeless(m.MAV_CMD_DO_SET_SERVO, 1, 1500), m.MAV_MISSION_UNSUPPORTED),
    (placeless(m.MAV_CMD_DO_CHANGE_SPEED, 7, 3), PARAM + 1),
    (placeless(m.MAV_CMD_DO_CHANGE_SPEED, 1, 0), PARAM + 2),
    (placeless(m.MAV_CMD_NAV_DELAY, math.nan), PARAM + 1),
    (placeless(m.MAV_CMD_DO_JUMP, 0.5, 1), PARAM + 1),
    (placeless(m.MAV_CMD_DO_JUMP, 0, -2), PARAM + 2),
    (placeless(m.MAV_CMD_DO_JUMP, 9, 1), PARAM + 1),
    (placeless(m.MAV_CMD_DO_JUMP, 1, 1), PARAM + 1),
]  # fmt: skip


@pytest.mark.parametrize(("item", "result"), REFUSED)
def test_item_that_cannot_be_flown_is_refused_with_its_field_and_the_old_plan_stays(
    free: MissionBench, item: Any, result: int
) -> None:
    free.upload(PLAN)
    free.answers(count(2))
    free.answers(item_message(0, waypoint(3)))
    answers = free.answers(item_message(1, item))
    assert results(answers) == [result] and "refused" in texts(answers)
    assert same(free.plans.items, PLAN)
    assert results(free.answers(item_message(1, item))) == [result]  # the answer may have been lost


def test_documented_commands_and_frames_are_those_that_are_taken() -> None:
    text = (Path(__file__).parents[2] / "docs" / "clients.md").read_text(encoding="utf-8")
    table = text.split("| commands | frames |\n")[1].split("\n\n")[0].splitlines()[1:]
    documented: dict[int, set[int]] = {frame: set() for frame in px4_items.PLACED_FRAMES | {Frame.MISSION}}
    for row in table:
        commands, frames = row.strip("| ").split(" | ")
        names = re.findall(r"\b[A-Z][A-Z_]{5,}\b", commands)
        numbers = {Command[name] if name in Command.__members__ else LEFT_OUT_NUMBERS[name] for name in names}
        if commands.startswith("other"):
            numbers |= px4_items.LEFT_OUT_HERE - {80, 195, 201}
        for frame in re.findall(r"\d+", frames.split(":")[0]):
            documented[int(frame)] |= numbers
    for frame, numbers in documented.items():
        assert numbers == {number for number in range(65536) if is_taken(frame, number)}, frame


def is_taken(frame: int, number: int) -> bool:
    """Whether a command is one that is known in a frame, whatever its parameters."""
    item = FileItem("item 0", 0, frame, number, (1.0, 1.0, 0.0, 0.0, 47.0, 8.0, 10.0))
    try:
        px4_items.check_mission_item(item)
    except ItemError as error:
        assert error.field == "command"
        return False
    return True


LEFT_OUT_NUMBERS = {command_name(number): number for number in LEFT_OUT}

TAKEN = [
    *(waypoint(frame=frame) for frame in (0, 3, 5, 6)),
    waypoint(command=m.MAV_CMD_NAV_LOITER_UNLIM), waypoint(command=m.MAV_CMD_NAV_LOITER_TIME, param1=3.0),
    waypoint(command=m.MAV_CMD_NAV_LOITER_TO_ALT), waypoint(command=m.MAV_CMD_NAV_LAND, x=0, y=0),
    waypoint(z=math.nan), waypoint(x=UNKNOWN, y=UNKNOWN), waypoint(command=m.MAV_CMD_DO_SET_ROI_LOCATION),
    placeless(m.MAV_CMD_DO_SET_CAM_TRIGG_DIST, 5), placeless(m.MAV_CMD_IMAGE_START_CAPTURE),
    placeless(m.MAV_CMD_DO_LAND_START), placeless(m.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, math.nan, math.nan),
    placeless(m.MAV_CMD_NAV_DELAY, 2), placeless(m.MAV_CMD_DO_JUMP, 0, -1), placeless(m.MAV_CMD_DO_CHANGE_SPEED, 1, -1),
]  # fmt: skip


@pytest.mark.parametrize("item", TAKEN)
def test_item_that_px4_takes_is_taken(free: MissionBench, item: Any) -> None:
    assert free.upload([waypoint(3), item]) == ACCEPTED
    assert same(free.download(), [waypoint(3), item]) and free.plans.problem is None


@pytest.mark.parametrize(
    "jumps",
    [
        [placeless(m.MAV_CMD_DO_JUMP, 1, 2)],
        [
            placeless(m.MAV_CMD_DO_CHANGE_SPEED, 1, 3),
            placeless(m.MAV_CMD_NAV_DELAY, 1),
            placeless(m.MAV_CMD_DO_JUMP, 1, -1),
        ],
        [placeless(m.MAV_CMD_DO_JUMP, 2, 1), placeless(m.MAV_CMD_DO_JUMP, 1, 1)],
        [placeless(m.MAV_CMD_DO_JUMP, 1 + (i + 1) % 1900, 1) for i in range(1900)],
    ],
)
def test_loop_without_a_waypoint_is_refused(free: MissionBench, jumps: Any) -> None:
    assert free.upload([waypoint(), *jumps]) == PARAM + 1
    assert "never end" in texts(free.inbox[GROUND])


@pytest.mark.parametrize("item", [placeless(m.MAV_CMD_DO_JUMP, 0, -1), placeless(m.MAV_CMD_DO_JUMP, 1, 0)])
def test_loop_with_a_waypoint_and_a_jump_that_is_never_taken_are_accepted(free: MissionBench, item: Any) -> None:
    assert free.upload([waypoint(), item]) == ACCEPTED


@pytest.mark.parametrize(
    ("items", "result"),
    [
        (corners(5001)[:2], PARAM + 1),
        ([*corners(5001)[:2], corners(5002)[0]], PARAM + 1),
        (corners(5001, 2), PARAM + 1),
        ([waypoint(command=5003, param1=0.0)], PARAM + 1),
        ([waypoint()], m.MAV_MISSION_UNSUPPORTED),
        ([waypoint(frame=2, command=5003, param1=9.0)], m.MAV_MISSION_UNSUPPORTED_FRAME),
        ([waypoint(command=5003, param1=9.0, x=UNKNOWN, y=UNKNOWN)], PARAM + 5),
    ],
)
def test_fence_that_encloses_nothing_is_refused(free: MissionBench, items: Any, result: int) -> None:
    free.upload(corners(5002), FENCE)
    assert free.upload(items, FENCE) == result
    assert same(free.plans.fence, corners(5002))


def test_rally_points_are_nothing_else(free: MissionBench) -> None:
    assert free.upload([waypoint()], RALLY) == m.MAV_MISSION_UNSUPPORTED
    assert free.upload([rally_point()._replace(z=math.nan)], RALLY) == PARAM + 7
    assert free.upload([rally_point()], RALLY) == ACCEPTED


def test_mission_far_from_home_is_taken_and_cannot_be_started(free: MissionBench) -> None:
    assert free.upload([waypoint(x=-353632620, y=1491652370)]) == ACCEPTED
    assert free.plans.problem is not None and "km from home" in free.plans.problem
    assert "cannot be started" in texts(free.inbox[GROUND])
    assert free.plans.progress().state == m.MISSION_STATE_NO_MISSION and free.flight.items == ()
    assert "km from home" in free.plans.set_current(0, 0.0).text
    free.upload(PLAN)
    assert same(free.flight.items, PLAN)
    assert free.plans.problem is None and free.plans.progress().state == m.MISSION_STATE_NOT_STARTED
