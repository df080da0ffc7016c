"""What QGroundControl does with plans when it connects, and when the operator uploads one.

It reads mission, fence and rally points when it connects, the last two only with their capability bits. Each plan is
read by a manager of its own (``PlanManager.cc``), which waits for one answer at a time and repeats its request at a
timeout.
"""

from __future__ import annotations

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from connecting_clients import QGroundControl
from mission_ground import ACCEPTED, MissionBench, Uploader, corners, placeless, rally_point, same, waypoint
from vehicle_bench import Bench

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
