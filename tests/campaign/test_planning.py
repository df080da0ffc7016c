"""Flights on the planning level: what they pass, that they repeat, and that faults of the planner are found by them."""

import dataclasses

import numpy as np
import pytest

from gcs.campaign.flight import FlightPlan
from gcs.campaign.scenarios.passage import Passage
from gcs.campaign.scenarios.plans import fly_planning
from gcs.config.overrides import with_settings
from gcs.mission.model import Limits
from gcs.mission.read import read_mission
from gcs.planning.flight import PlanningFlight, planned
from gcs.planning.scanned_map import open_sensors
from gcs.planning.schedule import Schedule

PATH = """
[mission]
name = "course"
seed = 3

[reference]
kind = "waypoints"
points = [[12.0, 0.0, -1.5]]
speed = 1.5
return_home = false
"""
SPHERES = """
[[obstacle]]
name = "standing"
shape = "sphere"
position = [4.0, 0.3, -2.5]
radius = 0.4
known = true

[[obstacle]]
name = "moving"
shape = "sphere"
position = [17.0, 0.2, -2.5]
radius = 0.4
known = false
motion = { kind = "linear", velocity = [-0.9, 0.0, 0.0] }
"""
WALL = """
[[obstacle]]
name = "closed"
shape = "wall"
position = [6.0, 0.0, -20.0]
size = [0.3, 300.0, 40.0]
"""
TILTED = """
[mission]
name = "tilted shapes"
seed = 2

[reference]
kind = "lissajous"
amplitude = [6.0, 3.0]
angular_frequency = 0.5
altitude = 5.0
duration = 14.0

[[obstacle]]
name = "beam"
shape = "box"
size = [0.4, 3.0, 0.4]
position = [-6.0, 0.0, -5.5]
roll_deg = 35.0
yaw_deg = 20.0
known = true

[[obstacle]]
name = "drum"
shape = "capsule"
radius = 0.35
length = 1.2
position = [6.0, 0.0, -5.5]
roll_deg = 60.0
yaw_deg = 40.0
known = false
motion = { kind = "harmonic", amplitude = [0.0, 1.0, 0.0], angular_frequency = 0.6 }
"""

FEW_RAYS = {"range_sensor.rays": 500}
HELD_TO = 0.3  # m of clearance


def course(folder, obstacles, **settings):
    (folder / "course.toml").write_text(PATH + obstacles)
    return read_mission(folder / "course.toml", settings=FEW_RAYS | settings)


@pytest.fixture
def mission(tmp_path):
    """A mission among a sphere on the map, and one that meets the payload."""
    return course(tmp_path, SPHERES)


def flown(mission, steps=None):
    flight = PlanningFlight(mission, Schedule(mission).start)
    if steps is None:
        flight.fly()
    for _ in range(steps or 0):
        flight.step()
    return flight


def test_course_is_flown_with_the_margin_kept(mission):
    run = planned(flown(mission))
    assert run.summary["completed"] and run.summary["contacts"] == 0
    assert run.summary["clearance_min_m"] > mission.system.avoidance.margin
    assert run.summary["payload_tilt_max_deg"] == {"roll": 0.0, "pitch": 0.0, "yaw": 0.0}
    # The motion has no steps, from the pad to the landing place.
    moved = np.diff(run.payload_position, axis=0) / np.diff(run.time)[:, None]
    np.testing.assert_allclose(moved, run.payload_velocity[:-1], atol=0.05)
    np.testing.assert_allclose(run.payload_position[-1, :2], [12.0, 0.0], atol=0.3)


@pytest.mark.slow
def test_tilted_bodies_are_avoided(tmp_path):
    (tmp_path / "tilted.toml").write_text(TILTED)
    summary = planned(flown(read_mission(tmp_path / "tilted.toml", settings=FEW_RAYS))).summary
    assert summary["completed"], summary["reason"]
    assert summary["clearance_min_m"] >= 0.4 and summary["uav_separation_min_m"] >= 0.75


def test_course_without_a_margin_is_flown_too_near(mission):
    near = dataclasses.replace(mission, system=with_settings(mission.system, {"avoidance.margin": 1e-3}))
    assert planned(flown(near)).summary["clearance_min_m"] < HELD_TO


def test_flight_repeats_and_its_seed_counts(mission):
    once, again = flown(mission, 250), flown(mission, 250)
    np.testing.assert_array_equal(once.states, again.states)
    assert not np.array_equal(once.states, flown(dataclasses.replace(mission, seed=4), 250).states)


def test_flight_without_a_way_is_broken_off_and_lands(tmp_path):
    run = planned(flown(course(tmp_path, WALL, **{"guidance.navigator.give_up": 2.0})))
    assert run.summary["outcome"] == "aborted" and "closed" in run.summary["reason"]
    assert run.payload_position[-1, 2] > -0.3 and run.summary["clearance_min_m"] > HELD_TO


def test_reason_and_the_gap_that_it_names_are_in_the_result(tmp_path):
    (tmp_path / "course.toml").write_text(PATH + WALL)
    settings = FEW_RAYS | {"guidance.navigator.give_up": 2.0}
    plan = FlightPlan(1, "course", tmp_path / "course.toml", dict, settings=settings)
    result = fly_planning(Limits(), Passage("impassable", None), plan)
    assert result.outcome == "aborted" and "closed" in result.reason and result.failures == "gap"


def test_failure_of_planning_is_a_result(tmp_path, monkeypatch):
    monkeypatch.setattr(PlanningFlight, "step", lambda flight: 1 // 0)
    (tmp_path / "course.toml").write_text(PATH)
    result = fly_planning(Limits(), None, FlightPlan(1, "course", tmp_path / "course.toml", dict))
    assert (result.outcome, result.exit_code) == ("failed", 1) and "ZeroDivisionError" in result.reason


def test_sensors_see_the_obstacles_where_they_have_moved_to(mission):
    mission = dataclasses.replace(mission, system=with_settings(mission.system, {"range_sensor.noise": 0.0}))
    state = np.zeros((mission.system.team.vehicles, 13))
    state[:, 0], state[:, 2], state[:, 6] = 3.0 + np.arange(len(state)), -4.0, 1.0
    for motion_time, north in ((-1.0, 17.0), (5.0, 12.5)):
        scans = open_sensors(mission).scan(8.0, motion_time, state)
        for vehicle, (measured, points) in zip(state, scans, strict=True):
            np.testing.assert_allclose(measured, vehicle, atol=0.2)
            centres = np.array([(4.0, 0.3, -2.5), (north, 0.2, -2.5)])
            away = np.linalg.norm(points + vehicle[:3] - centres[:, None], axis=2).min(axis=0)
            assert len(points) and np.abs(away - 0.4).max() < 1e-6
