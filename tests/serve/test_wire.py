"""The team on the wire in short sessions: same bytes, connecting clients, hostile traffic, parameters."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from connecting_clients import QGroundControl
from hostile_messages import hostile_to_ground, hostile_to_vehicle
from team_bench import TEAM_SYSTEM, TeamBench, Truth, set_mode
from team_session import ARM, FENCE, LAND, MISSION, PLANS, RALLY, START, at, change_speed, take_off
from vehicle_bench import STRANGER

from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from gcs.mavlink.services.mission_item import PlanType
from gcs.mission.read import read_mission

SHORT = [MISSION[0]._replace(z=1.5), at(2.0, 0.0, 1.5)]
INSTRUMENTS = {
    "HEARTBEAT": 1, "SYS_STATUS": 1, "EXTENDED_SYS_STATE": 5, "GPS_RAW_INT": 1, "VFR_HUD": 2, "ATTITUDE": 10,
    "ATTITUDE_QUATERNION": 15, "LOCAL_POSITION_NED": 15, "GLOBAL_POSITION_INT": 5, "ALTITUDE": 1, "HOME_POSITION": 0.5,
    "SYSTEM_TIME": 1, "CURRENT_MODE": 0.5, "MISSION_CURRENT": 1, "ESTIMATOR_STATUS": 0.5,
}  # fmt: skip
"""What displays are made of, and how often (Hz) it comes at least."""


def bench(folder: Path, **settings: Any) -> TeamBench:
    """Three vehicles: the fewest, and the cheapest."""
    folder.mkdir(exist_ok=True)
    return TeamBench(read_mission("hover", None, {"team.vehicles": 3, **settings}), folder)


@pytest.fixture
def team(tmp_path: Path) -> Iterator[TeamBench]:
    with bench(tmp_path / "run") as team:
        yield team


def short_session(team: TeamBench) -> None:
    """Fly a mission with a pause, and land."""
    team.ready()
    team.upload(SHORT, PlanType.MISSION)
    team.order(START)
    team.until("LOCAL_POSITION_NED", lambda found: found.x > 0.5)
    team.order(set_mode(px4.MODE_HOLD))
    team.run(1.0)
    team.order(LAND)
    team.disarmed()


def disturbance(seed: int) -> Any:
    """Random bytes, messages for other systems and messages of would-be vehicles, from strangers all the time."""
    rng = random.Random(seed)
    codecs = [Codec(255, 190), Codec(2, 1), Codec(TEAM_SYSTEM, 1), Codec(200, 1)]
    hostile = [*hostile_to_ground(), *(one for one in hostile_to_vehicle(3) if getattr(one, "target_system", 3) == 3)]

    def disturb(now: float) -> Iterator[tuple[bytes, Any]]:
        if rng.random() < 0.3:
            yield rng.randbytes(rng.randrange(300)), STRANGER
            yield codecs[rng.randrange(4)].encode(rng.choice(hostile)), (STRANGER[0], rng.randrange(40000, 60000))

    return disturb


@pytest.mark.slow
def test_same_session_gives_the_same_bytes_and_strangers_change_nothing_of_the_flight(tmp_path: Path) -> None:
    sent, truth = [], []
    for number, disturb in enumerate([None, None, disturbance(7)]):
        with bench(tmp_path / str(number)) as team:
            team.disturb = disturb or team.disturb
            short_session(team)
            sent.append(team.sent.digest())
            assert team.results[0].summary["outcome"] == "completed"
        truth.append(Truth(tmp_path / str(number)))
    assert sent[0] == sent[1]
    assert (tmp_path / "0/truth.csv").read_bytes() == (tmp_path / "1/truth.csv").read_bytes()
    disturbed = truth[2]
    assert disturbed.contacts.max() == 0 and disturbed.tilt.max() < 5.0
    assert np.abs(disturbed.position[-1, :2] - truth[0].position[-1, :2]).max() < 0.1


def test_no_message_of_a_client_stops_the_team(team: TeamBench) -> None:
    team.ready()
    for message in hostile_to_vehicle(TEAM_SYSTEM):
        team.send(message, STRANGER)
        team.collect()
    team.run(2.0)
    assert team.last("HEARTBEAT").autopilot == m.MAV_AUTOPILOT_PX4


def test_qgroundcontrol_connects_without_a_retry(team: TeamBench) -> None:
    team.ready()
    for kind, items in PLANS.items():
        assert team.upload(items, kind)[0] == m.MAV_MISSION_ACCEPTED
    client = QGroundControl(team)  # type: ignore[arg-type]
    assert client.has_heard_heartbeat()
    start = team.now
    plans = client.connect()
    assert [len(plans[kind]) for kind in PLANS] == [len(MISSION), len(FENCE), len(RALLY)]
    assert team.now - start < 5.0
    assert len(client.requests) == 5 + 3 + sum(map(len, PLANS.values()))
    assert [mode.custom_mode for mode in client.modes] == list(team.server.aircraft.modes)
    assert len(client.values) == len(team.server.parameters) + 1
    before = len(client.inbox)
    team.run(10.0)
    got = Counter(found.get_type() for found in client.inbox[before:])
    assert {kind: got[kind] for kind, rate in INSTRUMENTS.items() if got[kind] < max(1.0, 10.0 * rate - 1.0)} == {}


def test_armed_team_that_does_not_take_off_disarms(team: TeamBench) -> None:
    team.ready()
    team.order(ARM)
    team.until("HEARTBEAT", lambda found: found.base_mode & 128)
    armed = team.now
    team.disarmed()
    assert 9.0 < team.now - armed < 12.0
    assert "Disarmed: no take-off for 10 s" in [found.text for found in team.got("STATUSTEXT")]
    sent = len(team.got("HEARTBEAT"))
    team.ready()
    team.run(2.0)
    assert not any(found.base_mode & 128 for found in team.got("HEARTBEAT")[sent:])


def test_parameter_outside_its_range_or_against_another_is_refused(tmp_path: Path) -> None:
    with bench(tmp_path, **{"motion.speed_max": 2.0}) as team:
        assert team.set_parameter("CLFT_MARGIN", 9.0) == (0.5, "CLFT_MARGIN: 9 is outside 0.2 .. 2")
        value, text = team.set_parameter("MPC_XY_CRUISE", 2.5)
        assert (value, text) == (1.5, "MPC_XY_CRUISE: motion.speed: 2.5 is more than speed_max, 2.0")
        assert team.server.aircraft.base.system.motion.speed == 1.5


@pytest.mark.slow
def test_parameters_act_in_flight(team: TeamBench) -> None:
    team.ready()
    mission = [SHORT[0], at(12.0, 0.0, 1.5)]
    assert team.upload(mission, PlanType.MISSION)[0] == m.MAV_MISSION_ACCEPTED
    team.order(START)
    team.until("LOCAL_POSITION_NED", lambda found: found.x > 2.0)
    assert team.set_parameter("CLFT_MARGIN", 0.8)[1] == ""
    flight = team.server.session.flight
    safety, navigator = flight.control.controller.safety, flight.system.guidance.navigator  # type: ignore[attr-defined]
    assert safety.settings.margin == safety.planner.barrier.settings.margin == pytest.approx(0.8)  # type: ignore[attr-defined]
    assert navigator.settings.margin == flight.control.brake.settings.margin == pytest.approx(0.8)  # type: ignore[attr-defined]
    began = team.now
    assert team.set_parameter("MPC_XY_CRUISE", 0.5)[1] == ""
    team.run(5.0)
    slow = Truth(team.folder, team.now - 1.0)
    assert slow.speed.max() < 0.6 and Truth(team.folder, began - 0.5, began).speed.max() > 1.2
    team.order(change_speed(1.0))  # what was ordered for this flight counts before the parameter
    team.set_parameter("MPC_XY_CRUISE", 0.4)
    team.run(4.0)
    assert Truth(team.folder, team.now - 1.0).speed.max() > 0.8
    team.set_parameter(px4.PARAM_LAND_SPEED, 0.15)
    team.order(LAND)
    team.disarmed()
    touchdown = team.results[0].summary["landing"]["sinking_mps"]
    assert touchdown < 0.2, "a landing that is ordered later is as slow as the parameter says"


@pytest.mark.slow
def test_take_off_climbs_to_the_height_of_the_parameter(team: TeamBench) -> None:
    team.ready()
    team.set_parameter(px4.PARAM_TAKEOFF_ALTITUDE, 1.2)
    team.order(ARM)
    team.order(take_off(float("nan")))
    team.settled(0.0, 0.0, 1.2)
