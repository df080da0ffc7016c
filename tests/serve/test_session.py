"""What an operator does with the team over the wire, and what the payload truly did: one session for all tests."""

from __future__ import annotations

import gc
import itertools
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import same
from team_session import (
    ASIDE,
    CORNERS,
    PLANS,
    RALLY_POINT,
    REFUSED_IN_FLIGHT,
    REFUSED_ON_GROUND,
    Session,
)

from gcs.mavlink import px4

pytestmark = pytest.mark.slow
ACCELERATION, PLANNED = 1.5, 3.0
"""m/s2; between waypoints, and of the planner, which brakes where an order changes the path."""
NOISE = 0.2
"""m/s2; of accelerations over 0.2 s, which follow the noise of the estimate."""


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Session:
    return Session(tmp_path_factory.mktemp("session") / "run")


def test_arming_before_the_checks_is_refused_with_the_reason(flown: Session) -> None:
    result, text = flown.answers["too early"]
    assert result == m.MAV_RESULT_TEMPORARILY_REJECTED
    assert text == "Arming denied: the checks before take-off are running"


def test_arming_while_a_flight_is_ending_is_refused(flown: Session) -> None:
    assert flown.answers["arm while ending"] == (
        m.MAV_RESULT_TEMPORARILY_REJECTED, "Arming denied: the flight before is ending",
    )  # fmt: skip


@pytest.mark.parametrize("name", REFUSED_ON_GROUND)
def test_order_on_the_ground_is_refused_with_the_reason(flown: Session, name: str) -> None:
    _, result, reason = REFUSED_ON_GROUND[name]
    assert flown.answers["on ground"][name][0] == result
    assert flown.answers["on ground"][name][1].startswith(reason)


@pytest.mark.parametrize("name", REFUSED_IN_FLIGHT)
def test_order_in_flight_is_refused_with_the_reason(flown: Session, name: str) -> None:
    _, result, reason = REFUSED_IN_FLIGHT[name]
    assert flown.answers["in flight"][name][0] == result
    assert flown.answers["in flight"][name][1].startswith(reason)


def test_plan_that_cannot_be_flown_is_refused_with_item_and_reason(flown: Session) -> None:
    result, text = flown.answers["unflyable"]
    assert result == m.MAV_MISSION_ERROR
    assert text.startswith("Mission refused: item 2 (NAV_WAYPOINT): altitude: below ground")


def test_plans_come_back_as_they_were_uploaded(flown: Session) -> None:
    assert flown.answers["uploads"] == [(m.MAV_MISSION_ACCEPTED, "")] * 3
    assert all(same(flown.answers["downloads"][kind], items) for kind, items in PLANS.items())


def test_fence_and_mission_that_are_flown_are_not_replaced(flown: Session) -> None:
    assert flown.answers["fence in flight"] == (
        m.MAV_MISSION_ERROR, "Fence refused: change it on the ground, before arming",
    )  # fmt: skip
    assert flown.answers["mission in flight"] == (
        m.MAV_MISSION_ERROR, "Mission refused: the one before is being flown; hold first",
    )  # fmt: skip


def test_every_order_that_can_be_carried_out_is_accepted(flown: Session) -> None:
    orders = ("arm", "start", "pause", "go-to", "resume", "slower", "faster", "return", "arm again", "take-off",
              "reposition", "land", "arm for loss", "take-off for loss")  # fmt: skip
    assert {name: flown.answers[name] for name in orders} == dict.fromkeys(orders, (0, ""))


def test_payload_goes_where_it_is_ordered(flown: Session) -> None:
    whole = flown.truth()
    assert max(whole.nearest(*corner) for corner in CORNERS) < 0.3
    assert flown.truth("go-to").nearest(*ASIDE) < 0.1
    assert flown.truth("reposition").nearest(2.0, 3.0, 3.0) < 0.1
    assert flown.truth("take-off").nearest(*RALLY_POINT, 2.0) < 0.1
    north, east = flown.truth("return").position[-1, :2]
    assert np.hypot(north - RALLY_POINT[0], east - RALLY_POINT[1]) < 0.2, "a return lands at the nearest rally point"
    north, east = flown.truth("land").position[-1, :2]
    assert np.hypot(north - 2.0, east - 3.0) < 0.2


def test_take_off_away_from_home_holds_above_where_it_stood(flown: Session) -> None:
    away = flown.truth("take-off").position[:, :2] - RALLY_POINT
    assert np.linalg.norm(away, axis=1).max() < 0.2


def test_payload_stays_level_and_touches_nothing(flown: Session) -> None:
    whole = flown.truth()
    assert whole.tilt.max() < 5.0
    assert whole.contacts.max() == 0


def test_pause_comes_to_rest_within_the_limits(flown: Session) -> None:
    pause = flown.truth("pause")
    assert pause.speed[0] > 0.5 and pause.speed[-10:].max() < 0.1
    assert pause.acceleration.max() < ACCELERATION + NOISE


@pytest.mark.parametrize("step", ["go-to", "resume", "slower", "faster"])
def test_motion_goes_on_without_a_step(flown: Session, step: str) -> None:
    truth = flown.truth(step)
    assert truth.acceleration.max() < ACCELERATION + NOISE
    assert truth.tilt.max() < 1.0
    assert np.linalg.norm(np.diff(truth.velocity, axis=0), axis=1).max() < 0.02 * PLANNED + 0.02


def test_pause_does_not_fly_past_the_place_where_it_holds(flown: Session) -> None:
    north = flown.truth("pause").position[:, 0]
    assert north[-1] - north[0] > 1.0 and north.max() - north[-1] < 0.1


def test_another_item_brakes_within_the_limits_of_the_planner(flown: Session) -> None:
    assert flown.truth("again").acceleration.max() < PLANNED + NOISE


def test_speed_is_that_commanded(flown: Session) -> None:
    slower, faster = flown.truth("slower"), flown.truth("faster")
    assert slower.speed[-50:].max() < 0.55
    assert faster.speed.max() > 0.8


def test_items_are_reached_in_order_and_again_where_one_was_chosen(flown: Session) -> None:
    reached = [found.seq for found in flown.bench.got("MISSION_ITEM_REACHED")]
    in_order = [item for i, item in enumerate(reached) if i == 0 or item != reached[i - 1]]
    assert in_order == [0, 1, 2, 1, 2, 3]
    [current] = [found for found in flown.answers["set item"] if found.get_type() == "MISSION_CURRENT"][-1:]
    assert current.seq == 1


def test_mission_state_follows_the_orders(flown: Session) -> None:
    states = [found.mission_state for found in flown.bench.got("MISSION_CURRENT")]
    seen = [state for i, state in enumerate(states) if i == 0 or state != states[i - 1]]
    none, waits, active, paused, done = (
        m.MISSION_STATE_NO_MISSION, m.MISSION_STATE_NOT_STARTED, m.MISSION_STATE_ACTIVE, m.MISSION_STATE_PAUSED,
        m.MISSION_STATE_COMPLETE,
    )  # fmt: skip
    assert seen[:6] == [none, waits, active, paused, active, done]


def changes(flown: Session, kind: str, field: str) -> list[Any]:
    values = [getattr(found, field) for found in flown.bench.got(kind)]
    return [value for i, value in enumerate(values) if i == 0 or value != values[i - 1]]


def test_heartbeat_says_mode_and_arming(flown: Session) -> None:
    modes = changes(flown, "HEARTBEAT", "custom_mode")
    hold, mission, returns = px4.MODE_HOLD, px4.MODE_MISSION, px4.MODE_RETURN
    take_off, land = px4.MODE_TAKEOFF, px4.MODE_LAND
    assert modes == [
        hold,
        mission,
        hold,
        mission,
        returns,
        hold,
        take_off,
        hold,
        land,
        hold,
        take_off,
        hold,
        land,
        hold,
    ]
    armed = [bool(base & m.MAV_MODE_FLAG_SAFETY_ARMED) for base in changes(flown, "HEARTBEAT", "base_mode")]
    assert [armed[0], *(b for a, b in itertools.pairwise(armed) if a != b)] == [False, *[True, False] * 3]


def test_landed_state_goes_through_take_off_flight_and_landing(flown: Session) -> None:
    states = changes(flown, "EXTENDED_SYS_STATE", "landed_state")
    ground, air = m.MAV_LANDED_STATE_ON_GROUND, m.MAV_LANDED_STATE_IN_AIR
    rises, lands = m.MAV_LANDED_STATE_TAKEOFF, m.MAV_LANDED_STATE_LANDING
    assert states == [ground, *[rises, air, lands, ground] * 3]


def test_lost_telemetry_lands_the_team_says_so_and_leaves_the_next_flight_possible(flown: Session) -> None:
    bench, lost = flown.bench, flown.time("loss")
    status = changes(flown, "HEARTBEAT", "system_status")
    assert m.MAV_STATE_CRITICAL in status and status[-1] == m.MAV_STATE_STANDBY
    texts = "".join(found.text for found in bench.got("STATUSTEXT"))
    assert "vehicle 2" in texts and texts.count("Flight completed") == 2 and "Flight aborted: " in texts
    assert flown.truth("loss").position[-1, 2] > -0.35, "the payload stands on the ground"
    assert flown.time("after loss") - lost < 60.0
    assert [result.summary["outcome"] for result in bench.results] == ["completed", "completed", "aborted"]


def test_what_a_flight_has_kept_in_memory_is_freed_with_it(flown: Session) -> None:
    gc.collect()
    assert flown.first_flight() is None
