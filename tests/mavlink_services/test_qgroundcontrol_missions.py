"""What QGroundControl does with plans when it connects, and when the operator uploads one.

Its states at connect (``InitialConnectStateMachine.cc``): AUTOPILOT_VERSION, modes, component information, parameters,
then mission, fence and rally points, the last two only with their capability bits. Each plan is read by a manager of
its own (``PlanManager.cc``), which waits for one answer at a time and repeats its request at a timeout.
"""

from __future__ import annotations

from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import ACCEPTED, MissionBench, Uploader, corners, placeless, rally_point, same, waypoint
from vehicle_bench import Bench, command

from gcs.mavlink.services.mission_item import PlanType

PLANS = {
    PlanType.MISSION: [
        waypoint(0, frame=3, command=m.MAV_CMD_NAV_TAKEOFF),
        placeless(m.MAV_CMD_DO_CHANGE_SPEED, 1, 5, -1),
        waypoint(1, frame=3),
        waypoint(2, frame=0, z=520.0),
        placeless(m.MAV_CMD_NAV_RETURN_TO_LAUNCH),
    ],
    PlanType.FENCE: [*corners(5001, 4), waypoint(0, frame=0, command=5004, param1=12.0)],
    PlanType.RALLY: [rally_point(3)],
}
REQUIRED = {
    PlanType.MISSION: 0,
    PlanType.FENCE: m.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE,
    PlanType.RALLY: m.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY,
}


class QGroundControl:
    """The requests of its connect states, each answered before the next: an unanswered one would be repeated."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        bench.send(m.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        bench.collect()

    def draw(self, message: Any, kind: str) -> Any:
        """Send, and return the one answer of a kind that comes at once."""
        bench = self.bench
        bench.collect()
        inbox = bench.inbox[next(iter(bench.inbox))]
        before = len(inbox)
        bench.send(message)
        bench.collect()
        [answer] = [found for found in inbox[before:] if found.get_type() == kind]
        return answer

    def connect(self) -> dict[PlanType, list[Any]]:
        """Go through the states that concern plans; return the items of each."""
        version = self.draw(command(512, m.MAVLINK_MSG_ID_AUTOPILOT_VERSION), "AUTOPILOT_VERSION")
        assert version.capabilities & m.MAV_PROTOCOL_CAPABILITY_MISSION_INT
        plans = {}
        for plan_type, capability in REQUIRED.items():
            assert version.capabilities & capability == capability, plan_type
            plans[plan_type] = self.read(plan_type)
        return plans

    def read(self, plan_type: PlanType) -> list[Any]:
        found = self.draw(m.MAVLink_mission_request_list_message(1, 1, plan_type), "MISSION_COUNT")
        assert found.mission_type == plan_type
        items = []
        for number in range(found.count):
            item = self.draw(m.MAVLink_mission_request_int_message(1, 1, number, plan_type), "MISSION_ITEM_INT")
            assert (item.seq, item.mission_type) == (number, plan_type)
            items.append(item)
        self.bench.send(m.MAVLink_mission_ack_message(1, 1, ACCEPTED, plan_type))
        return items


def test_connect_states_end_on_a_coupled_vehicle_with_empty_plans(bench: Bench) -> None:
    assert QGroundControl(bench).connect() == {plan_type: [] for plan_type in PlanType}


def test_connect_states_read_the_plans_of_a_free_vehicle() -> None:
    bench = MissionBench()
    for plan_type, items in PLANS.items():
        assert bench.plans.accept(plan_type, tuple(items), 0).is_accepted
    read = QGroundControl(bench).connect()
    for plan_type, items in PLANS.items():
        assert [(item.frame, item.command, item.x, item.y, item.z) for item in read[plan_type]] == [
            (item.frame, item.command, item.x, item.y, item.z) for item in items
        ]
    assert [item.current for item in read[PlanType.MISSION]] == [1, 0, 0, 0, 0]
    assert [item.current for item in read[PlanType.FENCE]] == [0] * 5


@pytest.mark.parametrize("lost", ["count", "request"])
def test_operator_uploads_all_plans_one_after_the_other(lost: str) -> None:
    """The three managers write in turn; a lost message of either side costs one repetition."""
    bench = MissionBench()
    QGroundControl(bench).connect()
    for plan_type, items in PLANS.items():
        ground = Uploader(items, plan_type)
        if lost == "count":
            ground.start(bench.now)
        waiting = [] if lost == "count" else bench.answers(ground.start(bench.now)[0])[:0]
        while ground.result is None:
            for message in bench.wait(0.25):
                waiting += ground.take(message, bench.now)
            waiting += ground.run(bench.now)
            while waiting:
                answers = bench.answers(waiting.pop())
                waiting += [new for found in answers for new in ground.take(found, bench.now)]
        assert ground.result == ACCEPTED
        assert same(bench.plans.items_of(plan_type), items)
        assert bench.now < 5.0
