"""Orders in every state of the team: none ends the program, and no state is left only by the end of it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import placeless
from team_bench import TeamBench, Truth, reposition, set_mode, team_command
from team_session import ARM, DISARM, MISSION, START, at, change_speed, take_off

from gcs.flight.failsafe import Failsafe
from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.services.mission_item import PlanType
from gcs.mission.read import read_mission

UP = MISSION[0]._replace(z=1.5)
GRIPPER = placeless(m.MAV_CMD_DO_GRIPPER)._replace(param1=1.0, param2=0.0)
HOME = placeless(m.MAV_CMD_NAV_RETURN_TO_LAUNCH)
LANDING = placeless(m.MAV_CMD_NAV_LAND)._replace(frame=m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)
REJECTED, DENIED = m.MAV_RESULT_TEMPORARILY_REJECTED, m.MAV_RESULT_DENIED


@pytest.fixture
def team(tmp_path: Path) -> Iterator[TeamBench]:
    with TeamBench(read_mission("hover", None, {"team.vehicles": 3}), tmp_path) as team:
        team.ready()
        yield team


def until_phase(team: TeamBench, *phases: Phase) -> None:
    end = team.now + 60.0
    while team.server.session.flight.phase not in phases:
        assert team.now < end, f"{phases}: never, still {team.server.session.flight.phase}"
        team.run(0.1)


def choose(item: int) -> object:
    return team_command(m.MAV_CMD_DO_SET_MISSION_CURRENT, item)


def upload(team: TeamBench, *items: object) -> None:
    assert team.upload(items, PlanType.MISSION) == (m.MAV_MISSION_ACCEPTED, "")


def test_disarmed_team_stays_disarmed_and_can_be_armed_again(team: TeamBench) -> None:
    team.order(ARM)
    until_phase(team, Phase.ARM)
    team.run(1.0)
    team.order(DISARM)
    assert team.answer(ARM) == (REJECTED, "Arming denied: the flight before is ending")
    team.disarmed()
    seen = len(team.got("HEARTBEAT"))
    team.run(5.0)
    assert not any(found.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED for found in team.got("HEARTBEAT")[seen:])
    team.order(ARM)


def test_flight_that_is_disarmed_before_its_checks_ends(team: TeamBench) -> None:
    team.order(ARM)
    assert team.answer(DISARM)[0] == m.MAV_RESULT_ACCEPTED
    team.run(0.5)
    assert not team.server.session.is_armed


def test_mission_that_begins_on_the_ground_is_begun_when_armed(team: TeamBench) -> None:
    upload(team, GRIPPER, UP, at(1.0, 0.0, 1.5))
    team.order(ARM)
    until_phase(team, Phase.ARM)
    team.run(1.0)
    team.order(START)
    until_phase(team, Phase.ON_GROUND)
    until_phase(team, Phase.CLIMB)


def test_item_that_cannot_be_the_first_is_refused_with_the_reason(team: TeamBench) -> None:
    upload(team, UP, at(1.0, 0.0, 1.5), HOME)
    team.order(choose(2))
    team.order(set_mode(px4.MODE_MISSION))
    result, text = team.answer(ARM)
    assert result == DENIED
    assert text.startswith("Mission denied: item 3 (NAV_RETURN_TO_LAUNCH): altitude: the payload is still on the pad")


@pytest.mark.parametrize("phase", [Phase.CONNECT, Phase.ARM])
def test_item_that_is_chosen_before_the_take_off_is_the_first(team: TeamBench, phase: Phase) -> None:
    upload(team, UP, at(1.0, 0.0, 1.5), at(1.0, 1.0, 2.0), HOME)
    team.order(START)
    until_phase(team, phase)
    team.order(choose(2))
    flight = team.server.session.flight
    assert flight.next_source == "item 3 (NAV_WAYPOINT)" and team.server.aircraft.current_item == 2
    assert team.answer(choose(3))[1].startswith("Mission item denied: item 4 (NAV_RETURN_TO_LAUNCH): altitude: ")
    until_phase(team, Phase.SPOOL_UP)
    assert flight.next_source == "item 3 (NAV_WAYPOINT)"


@pytest.mark.slow
def test_item_behind_the_fence_is_flown_to_round_it(team: TeamBench) -> None:
    corners = [(4.5, -3.0), (5.5, -3.0), (5.5, 3.0), (4.5, 3.0)]
    number, frame = m.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION, m.MAV_FRAME_GLOBAL
    fence = [at(*corner, 0.0, number, frame=frame, param1=4, param4=0.0) for corner in corners]
    assert team.upload(fence, PlanType.FENCE) == (m.MAV_MISSION_ACCEPTED, "")
    upload(team, UP, at(0.0, 7.0, 2.0), at(10.0, 7.0, 2.0), at(10.0, 0.0, 2.0))
    team.order(START)
    until_phase(team, Phase.FLY)
    team.order(choose(3))
    team.settled(10.0, 0.0, 2.0)
    path = Truth(team.folder).position[:, :2]
    assert not np.any((np.abs(path[:, 0] - 5.0) < 0.5) & (np.abs(path[:, 1]) < 3.0))


POLE = """
[mission]
name = "pole"
seed = 1
[reference]
kind = "waypoints"
speed = 1.5
points = [[14.0, 0.0, -4.0]]
[[obstacle]]
name = "pole"
shape = "pole"
position = [8.0, 0.4]
radius = 0.3
height = 10.0
"""


@pytest.mark.slow
def test_pause_before_an_obstacle_holds_clear_of_it_and_goes_on_round_it(tmp_path: Path) -> None:
    (tmp_path / "pole.toml").write_text(POLE)
    (tmp_path / "run").mkdir()
    world = read_mission(tmp_path / "pole.toml", None, {"team.vehicles": 3})
    with TeamBench(world, tmp_path / "run") as team:
        team.ready()
        upload(team, UP._replace(z=4.0), at(14.0, 0.0, 4.0)._replace(param1=4.0), HOME)
        team.order(START)
        team.until("LOCAL_POSITION_NED", lambda found: found.x > 5.0)
        began = team.now
        team.order(set_mode(px4.MODE_HOLD))
        team.at_rest()
        paused = Truth(tmp_path / "run", began)
        heading = paused.velocity[0] / paused.speed[0]
        along = (paused.position - paused.position[-1]) @ heading
        assert along[0] < -1.0 and along.max() < 0.1, "it does not fly past the place where it holds"
        assert np.hypot(*(paused.position[-1, :2] - (8.0, 0.4))) > 1.5
        team.order(set_mode(px4.MODE_MISSION))
        team.until("MISSION_ITEM_REACHED", lambda found: found.seq == 1)
        team.order(set_mode(px4.MODE_HOLD))
        team.run(1.0)
        team.order(set_mode(px4.MODE_MISSION))
        team.until("LOCAL_POSITION_NED", lambda found: found.x < 13.0)
        assert [found.seq for found in team.got("MISSION_ITEM_REACHED")] == [0, 1], "paused in its hold, reported once"
        team.order(set_mode(px4.MODE_LAND))
        team.disarmed()
        [result] = team.results
        assert result.summary["outcome"] == "completed" and result.summary["clearance_min_m"] > 0.5


@pytest.mark.slow
def test_unloading_that_is_chosen_in_the_air_is_refused(team: TeamBench) -> None:
    upload(team, UP, at(1.0, 0.0, 1.5), LANDING, GRIPPER, UP, at(0.0, 0.0, 1.5))
    team.order(START)
    until_phase(team, Phase.CLIMB)
    result, text = team.answer(choose(3))
    assert result == DENIED
    assert text.startswith("Mission item denied: item 4 (DO_GRIPPER): command: unloading in the air")


@pytest.mark.slow
def test_team_is_disarmed_between_two_flights_of_a_mission(team: TeamBench) -> None:
    wait = placeless(m.MAV_CMD_NAV_DELAY)._replace(param1=30.0, param2=-1.0, param3=-1.0, param4=-1.0)
    upload(team, UP._replace(z=1.0), LANDING, wait, UP)
    team.order(START)
    until_phase(team, Phase.SPOOL_DOWN)
    until_phase(team, Phase.ON_GROUND)
    assert team.upload([UP], PlanType.MISSION)[0] == m.MAV_MISSION_ERROR
    assert team.answer(DISARM)[0] == m.MAV_RESULT_ACCEPTED
    team.run(5.0)
    assert not team.server.session.is_armed and len(team.results) == 1


@pytest.mark.slow
def test_failsafe_lands_a_payload_that_is_paused(team: TeamBench) -> None:
    team.order(ARM)
    team.order(take_off(1.5))
    until_phase(team, Phase.HOLD)
    team.order(reposition(5.0, 0.0, 1.5))
    team.run(2.5)
    team.order(set_mode(px4.MODE_HOLD))
    team.run(2.0)
    team.server.raise_failsafe(team.now, Failsafe.INTERRUPTED, "closed")
    end = team.now + 40.0
    while not team.server.ended:
        assert team.now < end, "it hangs in the air"
        team._step()


@pytest.mark.slow
def test_return_ordered_in_the_climb_rises_before_it_flies(team: TeamBench) -> None:
    team.order(ARM)
    team.order(take_off(2.0))
    until_phase(team, Phase.CLIMB)
    began = team.now
    team.order(reposition(3.0, 0.0, 1.5))
    team.settled(3.0, 0.0, 1.5)
    truth, lowest = Truth(team.folder, began), team.server.session.orders.lowest
    away = truth.position[:, 0] > 0.3
    assert away.any() and -truth.position[away, 2].max() > lowest - 0.1
    assert truth.contacts.max() == 0


@pytest.mark.parametrize("speed", [1e-6, 9.0])
def test_speed_that_would_not_arrive_is_refused(team: TeamBench, speed: float) -> None:
    assert team.answer(change_speed(speed)) == (DENIED, f"Speed change denied: {speed:g} m/s is outside 0.1 .. 3 m/s")
