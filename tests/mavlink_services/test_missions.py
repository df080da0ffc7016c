"""The mission protocol of a vehicle by itself: transfers, refusals, the current item, ids, timers."""

from __future__ import annotations

import math
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import (
    ACCEPTED,
    FreeBench,
    corners,
    ids_in,
    item_message,
    placeless,
    rally_point,
    same,
    waypoint,
)
from vehicle_bench import GROUND, STRANGER, command

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.services.mission_item import UNKNOWN, PlanType, opaque_id

MISSION, FENCE, RALLY = PlanType
LIMITS = VehicleLinkSettings().missions
PLAN = [
    waypoint(0, command=m.MAV_CMD_NAV_TAKEOFF),
    waypoint(1),
    placeless(m.MAV_CMD_DO_CHANGE_SPEED, 1, 4.0),
    waypoint(2),
    placeless(m.MAV_CMD_NAV_RETURN_TO_LAUNCH),
]


@pytest.fixture
def free() -> FreeBench:
    bench = FreeBench()
    bench.send(m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    return bench


def count(number: int, plan_type: int = MISSION, target: int = 1) -> Any:
    return m.MAVLink_mission_count_message(target, 1, number, plan_type)


def request_list(plan_type: int = MISSION) -> Any:
    return m.MAVLink_mission_request_list_message(1, 1, plan_type)


def results(messages: list[Any]) -> list[int]:
    return [found.type for found in messages if found.get_type() == "MISSION_ACK"]


def texts(messages: list[Any]) -> str:
    return "".join(found.text for found in messages if found.get_type() == "STATUSTEXT")


# Transfers


@pytest.mark.parametrize(
    ("plan_type", "items"),
    [(MISSION, PLAN), (FENCE, [*corners(5001), *corners(5002, 4)]), (RALLY, [rally_point(0), rally_point(1)])],
)
def test_uploaded_plan_is_downloaded_as_it_was_sent(free: FreeBench, plan_type: PlanType, items: Any) -> None:
    assert free.upload(items, plan_type) == ACCEPTED
    assert same(free.plans.items_of(plan_type), items)
    assert same(free.download(plan_type), items)
    for other in set(PlanType) - {plan_type}:
        assert free.download(other) == []


def test_download_ends_with_the_plan_that_it_was_promised(free: FreeBench) -> None:
    free.upload(PLAN)
    [promised] = free.answers(request_list())
    free.upload([waypoint(7)], sender=STRANGER, system=254)
    items = [free.answers(m.MAVLink_mission_request_int_message(1, 1, i))[0] for i in range(promised.count)]
    assert [item.command for item in items] == [item.command for item in PLAN]
    [again] = free.answers(request_list())
    assert again.count == 1


def test_deprecated_request_is_answered_with_whole_numbers(free: FreeBench) -> None:
    free.upload(PLAN)
    [item] = free.answers(m.MAVLink_mission_request_message(1, 1, 1))
    assert item.get_type() == "MISSION_ITEM_INT" and (item.x, item.y) == PLAN[1][7:9]


def test_request_of_an_item_that_is_not_there_is_refused(free: FreeBench) -> None:
    assert results(free.answers(m.MAVLink_mission_request_int_message(1, 1, 0))) == [m.MAV_MISSION_INVALID_SEQUENCE]
    free.upload(PLAN)
    assert results(free.answers(m.MAVLink_mission_request_int_message(1, 1, 5))) == [m.MAV_MISSION_INVALID_SEQUENCE]


def test_item_in_real_numbers_is_taken_to_the_nearest_place(free: FreeBench) -> None:
    free.answers(count(1))
    item = PLAN[1]
    real = m.MAVLink_mission_item_message(
        1, 1, 0, m.MAV_FRAME_GLOBAL_RELATIVE_ALT, 16, 0, 1, 0, 0, 0, 0, 47.5, -8.25, item.z
    )
    assert results(free.answers(real)) == [ACCEPTED]
    assert free.plans.items[0][7:9] == (475000000, -82500000)


def test_ground_that_knows_no_whole_numbers_is_asked_for_real_ones(free: FreeBench) -> None:
    [request] = free.answers(count(1))
    assert request.get_type() == "MISSION_REQUEST_INT"
    [request] = free.answers(m.MAVLink_mission_ack_message(1, 1, m.MAV_MISSION_UNSUPPORTED))
    assert request.get_type() == "MISSION_REQUEST"


def test_partial_upload_replaces_a_part_when_it_is_complete(free: FreeBench) -> None:
    free.upload(PLAN)
    [request] = free.answers(m.MAVLink_mission_write_partial_list_message(1, 1, 1, 3))
    for number in (1, 2, 3):
        assert request.get_type() == "MISSION_REQUEST_INT" and request.seq == number
        assert same(free.plans.items, PLAN)
        [request] = free.answers(item_message(number, waypoint(10 + number)))
    assert request.type == ACCEPTED
    assert same(free.plans.items, [PLAN[0], waypoint(11), waypoint(12), waypoint(13), PLAN[4]])


@pytest.mark.parametrize(("first", "last"), [(3, 2), (-2, 1), (0, 5), (5, 5)])
def test_partial_lists_outside_of_the_plan_are_refused(free: FreeBench, first: int, last: int) -> None:
    free.upload(PLAN)
    for kind in (m.MAVLink_mission_write_partial_list_message, m.MAVLink_mission_request_partial_list_message):
        assert results(free.answers(kind(1, 1, first, last))) == [m.MAV_MISSION_INVALID_SEQUENCE]


def test_partial_download_sends_a_bounded_number_of_items(free: FreeBench) -> None:
    free.upload([waypoint(i) for i in range(LIMITS.partial_list_max + 1)])
    ask = m.MAVLink_mission_request_partial_list_message
    assert [item.seq for item in free.answers(ask(1, 1, 2, 4))] == [2, 3, 4]
    assert len(free.answers(ask(1, 1, 1, -1))) == LIMITS.partial_list_max
    assert results(free.answers(ask(1, 1, 0, -1))) == [m.MAV_MISSION_NO_SPACE]


@pytest.mark.parametrize("plan_type", [*PlanType, m.MAV_MISSION_TYPE_ALL])
def test_clearing_clears_its_plan_only(free: FreeBench, plan_type: int) -> None:
    plans = {MISSION: PLAN, FENCE: corners(5001), RALLY: [rally_point()]}
    for kind, items in plans.items():
        assert free.upload(items, kind) == ACCEPTED
    assert results(free.answers(m.MAVLink_mission_clear_all_message(1, 1, plan_type))) == [ACCEPTED]
    kept = [kind for kind in PlanType if free.plans.items_of(kind)]
    assert kept == [kind for kind in PlanType if plan_type not in (kind, m.MAV_MISSION_TYPE_ALL)]
    assert all(free.plans.id_of(kind) == 0 for kind in set(PlanType) - set(kept))


def test_upload_of_no_items_clears(free: FreeBench) -> None:
    free.upload(PLAN)
    assert free.upload([]) == ACCEPTED and free.plans.items == ()


# Loss and restart


def test_request_is_repeated_until_the_upload_is_cancelled(free: FreeBench) -> None:
    free.upload([waypoint(5)])
    free.answers(count(2))
    free.answers(item_message(0, waypoint(0)))
    came = free.wait(LIMITS.timeout - 0.01)
    assert [found.seq for found in came] == [1] * round(LIMITS.timeout / LIMITS.retry_interval - 1)
    came = free.wait(0.02)
    assert results(came) == [m.MAV_MISSION_OPERATION_CANCELLED] and "item 1 of 2" in texts(came)
    assert same(free.plans.items, [waypoint(5)])
    assert free.wait(20.0) == []


def test_item_that_arrives_after_the_upload_was_cancelled_is_answered(free: FreeBench) -> None:
    free.answers(count(2))
    free.wait(LIMITS.timeout + 0.1)
    assert results(free.answers(item_message(0, waypoint(0)))) == [m.MAV_MISSION_OPERATION_CANCELLED]
    assert free.plans.items == ()


def test_lost_acknowledgement_is_sent_again_for_the_last_item_only(free: FreeBench) -> None:
    free.upload(PLAN)
    assert results(free.answers(item_message(4, PLAN[4]))) == [ACCEPTED]
    assert free.answers(item_message(3, PLAN[3])) == []


def test_ground_that_restarts_in_mid_transfer_begins_anew(free: FreeBench) -> None:
    free.answers(count(3))
    free.answers(item_message(0, waypoint(50)))
    assert free.upload(PLAN) == ACCEPTED
    assert same(free.plans.items, PLAN)


def test_ground_cancels_its_upload(free: FreeBench) -> None:
    free.answers(count(3))
    assert free.answers(m.MAVLink_mission_ack_message(1, 1, m.MAV_MISSION_OPERATION_CANCELLED)) == []
    assert free.wait(10.0) == []
    assert free.upload(PLAN, sender=STRANGER, system=254) == ACCEPTED


def test_second_ground_is_refused_while_the_first_uploads(free: FreeBench) -> None:
    free.answers(count(2))
    for message in (count(1), item_message(0, waypoint(9))):
        assert results(free.answers(message, STRANGER, system=254)) == [m.MAV_MISSION_ERROR]
    # The same program at another component, or another one behind the same address, is another ground.
    assert results(free.answers(count(1), component=191)) == [m.MAV_MISSION_ERROR]
    free.answers(item_message(0, PLAN[0]))
    assert results(free.answers(item_message(1, PLAN[1]))) == [ACCEPTED]
    assert free.upload([waypoint(9)], sender=STRANGER, system=254) == ACCEPTED


def test_clearing_is_refused_while_another_ground_uploads(free: FreeBench) -> None:
    free.upload(PLAN)
    free.answers(count(2))
    clear = m.MAVLink_mission_clear_all_message(1, 1, 255)
    assert results(free.answers(clear, STRANGER, system=254)) == [m.MAV_MISSION_ERROR]
    assert same(free.plans.items, PLAN)


# Refusals


def test_items_beyond_the_announced_number_end_the_upload(free: FreeBench) -> None:
    free.answers(count(2))
    assert results(free.answers(item_message(2, waypoint()))) == [m.MAV_MISSION_INVALID_SEQUENCE]
    assert free.wait(10.0) == [] and free.plans.items == ()


def test_items_out_of_order_wait_for_the_next_request(free: FreeBench) -> None:
    free.answers(count(3))
    assert free.answers(item_message(1, waypoint(1))) == []
    assert [found.seq for found in free.wait(0.3)] == [0]
    assert free.upload(PLAN) == ACCEPTED


@pytest.mark.parametrize(
    ("plan_type", "limit"),
    [(MISSION, LIMITS.mission_items_max), (FENCE, LIMITS.fence_items_max), (RALLY, LIMITS.rally_points_max)],
)
def test_more_items_than_there_is_space_for_are_refused(free: FreeBench, plan_type: PlanType, limit: int) -> None:
    for number in (limit + 1, 65535):
        answers = free.answers(count(number, plan_type))
        assert results(answers) == [m.MAV_MISSION_NO_SPACE] and str(limit) in texts(answers)
    assert [found.get_type() for found in free.answers(count(limit, plan_type))] == ["MISSION_REQUEST_INT"]


def test_unknown_plan_types_are_refused_at_once(free: FreeBench) -> None:
    for message in (
        count(1, 7), count(0, 255), request_list(3), request_list(255), m.MAVLink_mission_clear_all_message(1, 1, 9),
        m.MAVLink_mission_request_int_message(1, 1, 0, 77), m.MAVLink_mission_write_partial_list_message(1, 1, 0, 0, 5),
    ):  # fmt: skip
        assert results(free.answers(message)) == [m.MAV_MISSION_UNSUPPORTED]


@pytest.mark.parametrize("target", [0, 2])
def test_messages_to_all_or_to_others_are_not_heeded(free: FreeBench, target: int) -> None:
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
    free: FreeBench, item: Any, result: int
) -> None:
    free.upload(PLAN)
    free.answers(count(2))
    free.answers(item_message(0, waypoint(3)))
    answers = free.answers(item_message(1, item))
    assert results(answers) == [result] and "refused" in texts(answers)
    assert same(free.plans.items, PLAN)
    assert results(free.answers(item_message(1, item))) == [result]  # the answer may have been lost


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
def test_item_that_px4_takes_is_taken(free: FreeBench, item: Any) -> None:
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
def test_loop_without_a_waypoint_is_refused(free: FreeBench, jumps: Any) -> None:
    assert free.upload([waypoint(), *jumps]) == PARAM + 1
    assert "never end" in texts(free.inbox[GROUND])


@pytest.mark.parametrize("item", [placeless(m.MAV_CMD_DO_JUMP, 0, -1), placeless(m.MAV_CMD_DO_JUMP, 1, 0)])
def test_loop_with_a_waypoint_and_a_jump_that_is_never_taken_are_accepted(free: FreeBench, item: Any) -> None:
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
def test_fence_that_encloses_nothing_is_refused(free: FreeBench, items: Any, result: int) -> None:
    free.upload(corners(5002), FENCE)
    assert free.upload(items, FENCE) == result
    assert same(free.plans.fence, corners(5002))


def test_rally_points_are_nothing_else(free: FreeBench) -> None:
    assert free.upload([waypoint()], RALLY) == m.MAV_MISSION_UNSUPPORTED
    assert free.upload([rally_point()._replace(z=math.nan)], RALLY) == PARAM + 7
    assert free.upload([rally_point()], RALLY) == ACCEPTED


def test_mission_far_from_home_is_taken_and_cannot_be_started(free: FreeBench) -> None:
    assert free.upload([waypoint(x=-353632620, y=1491652370)]) == ACCEPTED
    assert free.plans.problem is not None and "km from home" in free.plans.problem
    assert "cannot be started" in texts(free.inbox[GROUND])
    assert free.plans.progress().state == m.MISSION_STATE_NO_MISSION and free.flight.items == ()
    assert "km from home" in free.plans.set_current(0, 0.0).text
    free.upload(PLAN)
    assert same(free.flight.items, PLAN)
    assert free.plans.problem is None and free.plans.progress().state == m.MISSION_STATE_NOT_STARTED


# Ids, the current item, progress


def test_ids_change_with_the_plan_and_are_those_of_px4(free: FreeBench) -> None:
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


def currents(free: FreeBench) -> list[tuple[int, int, int, int]]:
    return [(c.seq, c.total, c.mission_state, c.mission_mode) for c in free.inbox[GROUND] if c.id == 42]


def test_current_item_is_streamed_and_sent_on_change(free: FreeBench) -> None:
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


def test_ground_chooses_the_current_item(free: FreeBench) -> None:
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
    free: FreeBench, parameters: Any, result: int, current: int, missions: int
) -> None:
    free.upload(PLAN)
    free.flight.current_item = 2
    answers = free.answers(command(m.MAV_CMD_DO_SET_MISSION_CURRENT, *parameters))
    assert [found.result for found in answers if found.get_type() == "COMMAND_ACK"] == [result]
    assert (free.plans.current, free.flight.taken) == (current, missions)  # anew: jumps are counted again


def test_item_marked_as_current_is_flown_to_first(free: FreeBench) -> None:
    free.answers(count(2))
    free.answers(item_message(0, waypoint(0)))
    free.answers(item_message(1, waypoint(1), current=1))
    assert free.plans.current == 1
    free.upload([waypoint(4)])
    assert free.plans.current == 0


def test_same_plan_once_more_does_not_begin_the_mission_anew(free: FreeBench) -> None:
    free.upload(PLAN)
    free.flight.current_item = 3
    assert free.upload(PLAN) == ACCEPTED
    assert (free.plans.current, free.flight.taken) == (3, 1)


def test_reached_items_are_sent_at_once_and_repeated(free: FreeBench) -> None:
    free.upload(PLAN)
    free.flight.on_reached(0)
    free.flight.on_reached(1)
    assert [found.seq for found in free.wait(0.01)] == [0, 1]
    again = [found.seq for found in free.wait(30.0)]
    assert again == [1] * 10
    free.upload([waypoint(9)])
    assert free.wait(5.0) == []


def test_progress_is_sent_on_request(free: FreeBench) -> None:
    free.upload(PLAN)
    before = len(currents(free))
    answers = free.answers(command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_MISSION_CURRENT))
    assert [found.result for found in answers if found.get_type() == "COMMAND_ACK"] == [0]
    assert currents(free)[before:] == [(0, 5, m.MISSION_STATE_NOT_STARTED, 2)]
