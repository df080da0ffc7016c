"""A delivery over the mission protocol: two flights with an unloading between them, and orders at the stop."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from mission_ground import placeless
from team_bench import TeamBench, Truth, reposition, set_mode, team_command
from team_session import ARM, DISARM, LAND, RETURN, START, at, change_speed, take_off
from vehicle_bench import GROUND

from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mission.read import read_mission
from gcs.record.reader import read_table

STOP = (3.0, 0.0)
"""m; north and east."""
UP = placeless(m.MAV_CMD_NAV_TAKEOFF)._replace(frame=m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, param4=float("nan"), z=1.0)
RELEASE = placeless(m.MAV_CMD_DO_GRIPPER, 1, m.GRIPPER_ACTION_RELEASE)
DELIVERY = [
    UP,
    at(*STOP, 0.0, m.MAV_CMD_NAV_LAND),
    RELEASE,
    placeless(m.MAV_CMD_NAV_DELAY, 1),
    UP,
    at(2.0, 1.0, 1.0),
    placeless(m.MAV_CMD_NAV_RETURN_TO_LAUNCH),
]
HOP = [UP, at(2.0, 0.0, 0.0, m.MAV_CMD_NAV_LAND), placeless(m.MAV_CMD_NAV_DELAY, 30), UP, DELIVERY[-1]]
NOW, DENIED = m.MAV_RESULT_TEMPORARILY_REJECTED, m.MAV_RESULT_DENIED
REFUSED_AT_STOP = {
    "go-to": (reposition(1.0, 1.0, 2.0), NOW, "Reposition denied: the mission stands on the ground"),
    "take-off": (take_off(2.0), NOW, "Takeoff denied: the mission takes off by itself"),
    "speed": (change_speed(0.5), NOW, "Speed change denied: the mission stands on the ground"),
    "item": (team_command(m.MAV_CMD_DO_SET_MISSION_CURRENT, 5), NOW, "Mission item denied: the mission stands on the"),
}
"""Orders, each with the result and the beginning of the reason."""

pytestmark = pytest.mark.slow


def bench(folder: Path) -> TeamBench:
    folder.mkdir()
    return TeamBench(read_mission("hover", None, {"team.vehicles": 3}), folder)


def at_stop(team: TeamBench) -> None:
    team.until("HEARTBEAT", lambda found: found.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)
    team.until("HEARTBEAT", lambda found: not found.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)


def changes(team: TeamBench, kind: str, value: Any) -> list[Any]:
    values = [value(found) for found in team.got(kind)]
    return [one for i, one in enumerate(values) if i == 0 or one != values[i - 1]]


class Delivery:
    """Flies at once."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        with bench(folder) as self.team:
            team = self.team
            team.ready()
            self.uploaded = team.upload(DELIVERY, PlanType.MISSION)
            team.order(ARM)
            team.order(START)
            at_stop(team)
            self.stood = team.now
            self.answers = {name: team.answer(order) for name, (order, *_) in REFUSED_AT_STOP.items()}
            self.upload_at_stop = team.upload(HOP, PlanType.MISSION)
            self.continued = team.answer(set_mode(px4.MODE_MISSION))
            team.until("MISSION_CURRENT", lambda found: found.mission_state == m.MISSION_STATE_COMPLETE)
            team.disarmed()
            self.results = team.results


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Delivery:
    return Delivery(tmp_path_factory.mktemp("delivery") / "run")


def test_payload_is_set_down_at_the_stop_unloaded_and_flown_home(flown: Delivery) -> None:
    assert flown.uploaded == (m.MAV_MISSION_ACCEPTED, "")
    cargo = read_table(flown.folder / "cargo.csv")
    assert (cargo["gripper"].tolist(), cargo["mass_kg"].tolist()) == ([1], [pytest.approx(0.5)])
    [released] = cargo["time_s"]
    down = Truth(flown.folder, released - 0.2, released + 1.0)
    assert np.linalg.norm(down.position[:, :2] - STOP, axis=1).max() < 0.3
    assert down.speed.max() < 0.05 and down.contacts.max() == 0
    whole = Truth(flown.folder)
    assert Truth(flown.folder, released + 1.0).nearest(2.0, 1.0, 1.0) < 0.3
    assert np.linalg.norm(whole.position[-1, :2]) < 0.3 and whole.position[-1, 2] > -0.35
    [result] = flown.results
    assert result.summary["outcome"] == "completed" and len(result.summary["stops"]) == 2


def test_items_are_reached_and_current_in_order_also_on_the_ground(flown: Delivery) -> None:
    assert changes(flown.team, "MISSION_ITEM_REACHED", lambda found: found.seq) == [*range(len(DELIVERY))]
    assert changes(flown.team, "MISSION_CURRENT", lambda found: found.seq) == [*range(len(DELIVERY))]


def test_landing_is_reached_at_touchdown(flown: Delivery) -> None:
    inbox = flown.team.inbox[GROUND]
    reached = [found.get_type() == "MISSION_ITEM_REACHED" and found.seq == 1 for found in inbox].index(True)
    height = [-found.z for found in inbox[:reached] if found.get_type() == "LOCAL_POSITION_NED"][-1]
    assert height < 0.35, "the height above the place is 1 m"


def test_team_is_disarmed_and_on_the_ground_at_the_stop(flown: Delivery) -> None:
    armed = changes(flown.team, "HEARTBEAT", lambda found: bool(found.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED))
    assert armed == [False, True, False, True, False]
    ground, rises = m.MAV_LANDED_STATE_ON_GROUND, m.MAV_LANDED_STATE_TAKEOFF
    air, lands = m.MAV_LANDED_STATE_IN_AIR, m.MAV_LANDED_STATE_LANDING
    states = changes(flown.team, "EXTENDED_SYS_STATE", lambda found: found.landed_state)
    assert states == [ground, *[rises, air, lands, ground] * 2]


@pytest.mark.parametrize("name", REFUSED_AT_STOP)
def test_order_at_the_stop_is_refused_with_the_reason(flown: Delivery, name: str) -> None:
    _, result, reason = REFUSED_AT_STOP[name]
    assert flown.answers[name][0] == result and flown.answers[name][1].startswith(reason)


def test_mission_is_not_replaced_at_the_stop_and_may_be_resumed(flown: Delivery) -> None:
    refusal = "Mission refused: the one before is being flown; hold first"
    assert flown.upload_at_stop == (m.MAV_MISSION_ERROR, refusal)
    assert flown.continued == (m.MAV_RESULT_ACCEPTED, "")


@pytest.mark.parametrize("order", [DISARM, set_mode(px4.MODE_HOLD), LAND, RETURN])
def test_mission_is_ended_at_the_stop(standing: TeamBench, order: Any) -> None:
    team = standing
    team.ready()
    team.upload(HOP, PlanType.MISSION)
    team.order(START)
    at_stop(team)
    team.run(1.0)
    assert team.server.session.flight.phase is Phase.ON_GROUND
    before = len(team.results)
    assert team.answer(order) == (m.MAV_RESULT_ACCEPTED, "Mission ended on the ground")
    team.ready()
    assert len(team.results) == before + 1 and team.server.session.flight.landings == 0
    assert team.last("MISSION_CURRENT").mission_state != m.MISSION_STATE_COMPLETE
    sent = len(team.got("HEARTBEAT"))
    team.run(5.0)
    assert not any(found.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED for found in team.got("HEARTBEAT")[sent:])


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Any:
    with bench(tmp_path_factory.mktemp("ended") / "run") as team:
        yield team


def test_mission_that_begins_on_the_ground_disarms_the_team_first(tmp_path: Path) -> None:
    unloads: list[MissionItem] = [RELEASE, UP, DELIVERY[-1]]
    with bench(tmp_path / "run") as team:
        team.ready()
        assert team.upload(unloads, PlanType.MISSION) == (m.MAV_MISSION_ACCEPTED, "")
        team.order(ARM)
        team.until("HEARTBEAT", lambda found: found.base_mode & m.MAV_MODE_FLAG_SAFETY_ARMED)
        team.order(START)
        team.disarmed()
        team.until("LOCAL_POSITION_NED", lambda found: found.z < -0.8)
        result, text = team.answer(team_command(m.MAV_CMD_DO_SET_MISSION_CURRENT, 0))
        assert result == DENIED
        assert text.startswith("Mission item denied: item 1 (DO_GRIPPER): command: unloading in the air")
    assert read_table(tmp_path / "run" / "cargo.csv")["gripper"].tolist() == [1]
