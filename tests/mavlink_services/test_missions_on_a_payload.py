"""The mission protocol of a vehicle on a payload: empty plans, at once; uploads are refused with the reason."""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import MissionBench, item_message, waypoint
from vehicle_bench import ARM, GROUND, OFFBOARD, STRANGER, Bench, attitude_target, command

from gcs.mavlink import px4
from gcs.mavlink.services.mission_item import PlanType
from vehicle_sim.mavlink.mission_plans import CoupledPlans


def answers(bench: Bench, message: Any, sender: Any = GROUND) -> list[Any]:
    """What a message draws at once, without streams."""
    bench.collect()
    before = len(bench.inbox.setdefault(sender, []))
    bench.send(message, sender)
    bench.collect()
    streamed = ("HEARTBEAT", "EXTENDED_SYS_STATE", "ATTITUDE_QUATERNION")
    return [found for found in bench.inbox[sender][before:] if found.get_type() not in streamed]


@pytest.fixture
def coupled(bench: Bench) -> Bench:
    bench.send(m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    bench.collect()
    return bench


@pytest.mark.parametrize("plan_type", list(PlanType))
def test_lists_are_empty_at_once(coupled: Bench, plan_type: PlanType) -> None:
    [found] = answers(coupled, m.MAVLink_mission_request_list_message(1, 1, plan_type))
    assert (found.get_type(), found.count, found.mission_type) == ("MISSION_COUNT", 0, plan_type)
    assert (found.target_system, found.target_component) == (255, 190)


@pytest.mark.parametrize("plan_type", list(PlanType))
def test_upload_is_denied_at_once_with_the_reason(coupled: Bench, plan_type: PlanType) -> None:
    *texts, ack = answers(coupled, m.MAVLink_mission_count_message(1, 1, 3, plan_type))
    assert (ack.get_type(), ack.type, ack.mission_type) == ("MISSION_ACK", m.MAV_MISSION_DENIED, plan_type)
    assert "tip the payload" in "".join(text.text for text in texts)
    assert coupled.vehicle.next_timer() != 0.25
    [*_, ack] = answers(coupled, item_message(0, waypoint(), plan_type))
    assert ack.type == m.MAV_MISSION_ERROR


@pytest.mark.parametrize("plan_type", [*PlanType, m.MAV_MISSION_TYPE_ALL])
def test_nothing_is_cleared_without_a_refusal(coupled: Bench, plan_type: int) -> None:
    [ack] = answers(coupled, m.MAVLink_mission_clear_all_message(1, 1, plan_type))
    assert (ack.type, ack.mission_type) == (m.MAV_MISSION_ACCEPTED, plan_type)


def test_current_item_cannot_be_chosen(coupled: Bench) -> None:
    *texts, current = answers(coupled, m.MAVLink_mission_set_current_message(1, 1, 0))
    assert "tip the payload" in "".join(text.text for text in texts)
    assert (current.get_type(), current.total, current.mission_state) == ("MISSION_CURRENT", 65535, 1)
    *_, ack = answers(coupled, command(m.MAV_CMD_DO_SET_MISSION_CURRENT, 0, 0))
    assert ack.result == m.MAV_RESULT_DENIED


def test_current_item_is_streamed_every_second(coupled: Bench) -> None:
    before = len(coupled.got("MISSION_CURRENT"))
    coupled.run(3.0)
    assert len(coupled.got("MISSION_CURRENT")) - before == 3
    assert not coupled.got("MISSION_ITEM_REACHED")


def test_store_refuses_whatever_the_server_hands_to_it() -> None:
    store = CoupledPlans()
    for plan_type in PlanType:
        assert store.check(plan_type, waypoint(), 0).result == m.MAV_MISSION_DENIED
        assert store.accept(plan_type, (waypoint(),), 0).result == m.MAV_MISSION_DENIED
        assert store.items_of(plan_type) == () and store.id_of(plan_type) == 0
    assert store.take_reached() == () and store.reached_again() is None


def test_capabilities_say_that_missions_fences_and_rally_points_may_be_requested(coupled: Bench) -> None:
    for bench in (coupled, MissionBench()):
        found = answers(bench, command(m.MAV_CMD_REQUEST_MESSAGE, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION))
        [version] = [message for message in found if message.get_type() == "AUTOPILOT_VERSION"]
        for name in ("MISSION_INT", "MISSION_FENCE", "MISSION_RALLY", "COMMAND_INT"):
            assert version.capabilities & getattr(m, f"MAV_PROTOCOL_CAPABILITY_{name}"), name


def test_only_the_ground_in_control_changes_plans() -> None:
    """A ground that flies a free vehicle in OFFBOARD keeps others from its plans; they may read them."""
    bench = Bench(plans=MissionBench().plans)
    bench.streaming[GROUND, 255] = attitude_target()
    bench.run(0.2)
    bench.send(m.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), STRANGER)
    assert answers(bench, m.MAVLink_mission_count_message(1, 1, 1), STRANGER)[-1].get_type() == "MISSION_REQUEST_INT"
    assert bench.result(OFFBOARD) == bench.result(ARM) == m.MAV_RESULT_ACCEPTED
    assert answers(bench, item_message(0, waypoint()), STRANGER)[-1].type == m.MAV_MISSION_DENIED
    for message in (
        m.MAVLink_mission_count_message(1, 1, 2), m.MAVLink_mission_write_partial_list_message(1, 1, 0, 0),
    ):  # fmt: skip
        *texts, ack = answers(bench, message, STRANGER)
        assert ack.type == m.MAV_MISSION_DENIED and "in control" in "".join(text.text for text in texts)
    *texts, _ = answers(bench, m.MAVLink_mission_set_current_message(1, 1, 0), STRANGER)
    assert "in control" in "".join(text.text for text in texts)
    [found] = answers(bench, m.MAVLink_mission_request_list_message(1, 1), STRANGER)
    assert found.count == 0
    assert answers(bench, m.MAVLink_mission_count_message(1, 1, 2))[-1].get_type() == "MISSION_REQUEST_INT"
    assert bench.vehicle.autopilot.mode == px4.MODE_OFFBOARD
