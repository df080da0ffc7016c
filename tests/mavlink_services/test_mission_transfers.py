"""Uploads and downloads of plans, repeated requests, restarts, and two grounds at once."""

from __future__ import annotations

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
    rally_point,
    request_list,
    results,
    same,
    texts,
    waypoint,
)
from vehicle_bench import GROUND, STRANGER

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.codec import Codec
from gcs.mavlink.services import mission_download
from gcs.mavlink.services.mission_item import PlanType


@pytest.mark.parametrize(
    ("plan_type", "items"),
    [(MISSION, PLAN), (FENCE, [*corners(5001), *corners(5002, 4)]), (RALLY, [rally_point(0), rally_point(1)])],
)
def test_uploaded_plan_is_downloaded_as_it_was_sent(free: MissionBench, plan_type: PlanType, items: Any) -> None:
    assert free.upload(items, plan_type) == ACCEPTED
    assert same(free.plans.items_of(plan_type), items)
    assert same(free.download(plan_type), items)
    for other in set(PlanType) - {plan_type}:
        assert free.download(other) == []


def test_download_ends_with_the_plan_that_it_was_promised(free: MissionBench) -> None:
    free.upload(PLAN)
    [promised] = free.answers(request_list())
    free.upload([waypoint(7)], sender=STRANGER, system=254)
    items = [free.answers(m.MAVLink_mission_request_int_message(1, 1, i))[0] for i in range(promised.count)]
    assert [item.command for item in items] == [item.command for item in PLAN]
    [again] = free.answers(request_list())
    assert again.count == 1


def test_deprecated_request_is_answered_with_whole_numbers(free: MissionBench) -> None:
    free.upload(PLAN)
    [item] = free.answers(m.MAVLink_mission_request_message(1, 1, 1))
    assert item.get_type() == "MISSION_ITEM_INT" and (item.x, item.y) == PLAN[1][7:9]


def test_request_of_an_item_that_is_not_there_is_refused(free: MissionBench) -> None:
    assert results(free.answers(m.MAVLink_mission_request_int_message(1, 1, 0))) == [m.MAV_MISSION_INVALID_SEQUENCE]
    free.upload(PLAN)
    assert results(free.answers(m.MAVLink_mission_request_int_message(1, 1, 5))) == [m.MAV_MISSION_INVALID_SEQUENCE]


def test_item_in_real_numbers_is_taken_to_the_nearest_place(free: MissionBench) -> None:
    free.answers(count(1))
    item = PLAN[1]
    real = m.MAVLink_mission_item_message(
        1, 1, 0, m.MAV_FRAME_GLOBAL_RELATIVE_ALT, 16, 0, 1, 0, 0, 0, 0, 47.5, -8.25, item.z
    )
    assert results(free.answers(real)) == [ACCEPTED]
    assert free.plans.items[0][7:9] == (475000000, -82500000)


def test_ground_that_knows_no_whole_numbers_is_asked_for_real_ones(free: MissionBench) -> None:
    [request] = free.answers(count(1))
    assert request.get_type() == "MISSION_REQUEST_INT"
    [request] = free.answers(m.MAVLink_mission_ack_message(1, 1, m.MAV_MISSION_UNSUPPORTED))
    assert request.get_type() == "MISSION_REQUEST"


def test_partial_upload_replaces_a_part_when_it_is_complete(free: MissionBench) -> None:
    free.upload(PLAN)
    [request] = free.answers(m.MAVLink_mission_write_partial_list_message(1, 1, 1, 3))
    for number in (1, 2, 3):
        assert request.get_type() == "MISSION_REQUEST_INT" and request.seq == number
        assert same(free.plans.items, PLAN)
        [request] = free.answers(item_message(number, waypoint(10 + number)))
    assert request.type == ACCEPTED
    assert same(free.plans.items, [PLAN[0], waypoint(11), waypoint(12), waypoint(13), PLAN[4]])


@pytest.mark.parametrize(("first", "last"), [(3, 2), (-2, 1), (0, 5), (5, 5)])
def test_partial_lists_outside_of_the_plan_are_refused(free: MissionBench, first: int, last: int) -> None:
    free.upload(PLAN)
    for kind in (m.MAVLink_mission_write_partial_list_message, m.MAVLink_mission_request_partial_list_message):
        assert results(free.answers(kind(1, 1, first, last))) == [m.MAV_MISSION_INVALID_SEQUENCE]


def test_partial_download_sends_a_bounded_number_of_items(free: MissionBench) -> None:
    free.upload([waypoint(i) for i in range(LIMITS.partial_list_max + 1)])
    ask = m.MAVLink_mission_request_partial_list_message
    assert [item.seq for item in free.answers(ask(1, 1, 2, 4))] == [2, 3, 4]
    assert len(free.answers(ask(1, 1, 1, -1))) == LIMITS.partial_list_max
    assert results(free.answers(ask(1, 1, 0, -1))) == [m.MAV_MISSION_NO_SPACE]


def test_many_partial_downloads_in_one_datagram_build_hardly_more_items_than_are_sent(
    free: MissionBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    free.upload([waypoint(i) for i in range(LIMITS.partial_list_max)])
    built = []
    make = mission_download.item_message
    monkeypatch.setattr(mission_download, "item_message", lambda *what: built.append(what) or make(*what))
    ask = Codec(255, 190).encode(m.MAVLink_mission_request_partial_list_message(1, 1, 0, -1))
    free.vehicle.receive(1000 * ask, GROUND, free.now)
    before = len(free.received)
    free.collect()
    sent = sum(found.message.get_type() == "MISSION_ITEM_INT" for found in free.received[before:])
    assert sent == VehicleLinkSettings().replies_max <= len(built) < sent + LIMITS.partial_list_max


@pytest.mark.parametrize("plan_type", [*PlanType, m.MAV_MISSION_TYPE_ALL])
def test_clearing_clears_its_plan_only(free: MissionBench, plan_type: int) -> None:
    plans = {MISSION: PLAN, FENCE: corners(5001), RALLY: [rally_point()]}
    for kind, items in plans.items():
        assert free.upload(items, kind) == ACCEPTED
    assert results(free.answers(m.MAVLink_mission_clear_all_message(1, 1, plan_type))) == [ACCEPTED]
    kept = [kind for kind in PlanType if free.plans.items_of(kind)]
    assert kept == [kind for kind in PlanType if plan_type not in (kind, m.MAV_MISSION_TYPE_ALL)]
    assert all(free.plans.id_of(kind) == 0 for kind in set(PlanType) - set(kept))


def test_upload_of_no_items_clears(free: MissionBench) -> None:
    free.upload(PLAN)
    assert free.upload([]) == ACCEPTED and free.plans.items == ()


def test_request_is_repeated_until_the_upload_is_cancelled(free: MissionBench) -> None:
    free.upload([waypoint(5)])
    free.answers(count(2))
    free.answers(item_message(0, waypoint(0)))
    came = free.wait(LIMITS.timeout - 0.01)
    assert [found.seq for found in came] == [1] * round(LIMITS.timeout / LIMITS.retry_interval - 1)
    came = free.wait(0.02)
    assert results(came) == [m.MAV_MISSION_OPERATION_CANCELLED] and "item 1 of 2" in texts(came)
    assert same(free.plans.items, [waypoint(5)])
    assert free.wait(20.0) == []


def test_item_that_arrives_after_the_upload_was_cancelled_is_answered(free: MissionBench) -> None:
    free.answers(count(2))
    free.wait(LIMITS.timeout + 0.1)
    assert results(free.answers(item_message(0, waypoint(0)))) == [m.MAV_MISSION_OPERATION_CANCELLED]
    assert free.plans.items == ()


def test_lost_acknowledgement_is_sent_again_for_the_last_item_only(free: MissionBench) -> None:
    free.upload(PLAN)
    assert results(free.answers(item_message(4, PLAN[4]))) == [ACCEPTED]
    assert free.answers(item_message(3, PLAN[3])) == []


def test_ground_that_restarts_in_mid_transfer_begins_anew(free: MissionBench) -> None:
    free.answers(count(3))
    free.answers(item_message(0, waypoint(50)))
    assert free.upload(PLAN) == ACCEPTED
    assert same(free.plans.items, PLAN)


def test_ground_cancels_its_upload(free: MissionBench) -> None:
    free.answers(count(3))
    assert free.answers(m.MAVLink_mission_ack_message(1, 1, m.MAV_MISSION_OPERATION_CANCELLED)) == []
    assert free.wait(10.0) == []
    assert free.upload(PLAN, sender=STRANGER, system=254) == ACCEPTED


def test_second_ground_is_refused_while_the_first_uploads(free: MissionBench) -> None:
    free.answers(count(2))
    for message in (count(1), item_message(0, waypoint(9))):
        assert results(free.answers(message, STRANGER, system=254)) == [m.MAV_MISSION_ERROR]
    # The same program at another component, or another one behind the same address, is another ground.
    assert results(free.answers(count(1), component=191)) == [m.MAV_MISSION_ERROR]
    free.answers(item_message(0, PLAN[0]))
    assert results(free.answers(item_message(1, PLAN[1]))) == [ACCEPTED]
    assert free.upload([waypoint(9)], sender=STRANGER, system=254) == ACCEPTED


def test_clearing_is_refused_while_another_ground_uploads(free: MissionBench) -> None:
    free.upload(PLAN)
    free.answers(count(2))
    clear = m.MAVLink_mission_clear_all_message(1, 1, 255)
    assert results(free.answers(clear, STRANGER, system=254)) == [m.MAV_MISSION_ERROR]
    assert same(free.plans.items, PLAN)
