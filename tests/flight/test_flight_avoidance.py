"""Obstacles avoided in whole flights: simulator, vehicles, MAVLink bytes and ground in lockstep, with noise."""

from dataclasses import replace

import pytest
from flights import InProcessFlight, system_file
from mission_files import MISSIONS

from gcs.app.exit_status import ExitStatus
from gcs.mission.read import read_mission

pytestmark = pytest.mark.slow

FIGURE = """
[mission]
name = "short figure with two spheres"
system = "system.toml"
seed = 3

[reference]
kind = "lissajous"
amplitude = [6.0, 3.0]
angular_frequency = 0.5
altitude = 3.0
duration = 9.0

[[obstacle]]
name = "static"
shape = "sphere"
position = [-6.0, 0.0, -3.0]
radius = 0.5
known = true

[[obstacle]]
name = "moving"
shape = "sphere"
position = [5.5, -1.0, -3.0]
radius = 0.5
known = false
motion = { kind = "harmonic", amplitude = [0.0, 1.2, 0.0], angular_frequency = 0.8, phase = 0.5 }
"""

STRAIGHT = """
[mission]
name = "pole"
system = "system.toml"
seed = 4

[reference]
kind = "waypoints"
points = [[13.0, 0.0, -3.0]]
speed = 1.5
return_home = false

[[obstacle]]
name = "mast"
shape = "pole"
position = [7.0, 0.0]
radius = 0.3
height = 12.0
known = true
"""

LIMITS = """
[limits]
clearance = 0.4
payload_tilt_deg = 6.0
"""


def flown(folder, text):
    """Return the result of a flight of the mission ``text``; its records lie in folder/run."""
    system_file(folder)
    mission = folder / "mission.toml"
    mission.write_text(text + LIMITS)
    with InProcessFlight(mission, folder / "run", obstacles=read_mission(mission).obstacles) as flight:
        flight.fly()
        return flight.result()


def check_safe(summary):
    assert summary["contacts"] == 0
    assert summary["clearance_min_m"] >= 0.4
    assert max(summary["payload_tilt_max_deg"].values()) <= 6.0
    assert summary["uav_separation_min_m"] >= 0.75


def test_figure_keeps_clear_of_mapped_sphere_and_of_detected_sphere(tmp_path):
    result = flown(tmp_path, FIGURE)
    check_safe(result.summary)
    assert result.exit_code == ExitStatus.DONE, result.reason
    # Both were on the path: the mission's own path leads within the margin of them.
    assert result.summary["position_rmse_m"]["total"] > 0.1


@pytest.mark.parametrize(
    "fault", ['kind = "drift"\nrate = 0.1', pytest.param('kind = "stuck"', marks=pytest.mark.long)]
)
def test_flight_ends_safely_when_all_range_sensors_fail_alike(tmp_path, fault):
    """Returns that drift lie beside the known rays: they are as impossible as those that repeat to the digit."""
    wrong = f'\n[[fault]]\nchannel = "obstacles"\nstart = 6.0\n{fault}\n'
    result = flown(tmp_path, STRAIGHT + wrong)
    check_safe(result.summary)
    assert result.exit_code == ExitStatus.OUTSIDE_LIMITS and result.summary["outcome"] == "aborted"
    assert "is impossible" in result.reason
    assert result.summary["landing"]["on_ground"]


@pytest.mark.parametrize("points", [1, pytest.param(3, marks=pytest.mark.long)], ids=["gate", "course"])
def test_l_shaped_payload_is_flown_between_obstacles_within_the_limits_of_the_box(points, tmp_path):
    """Its centre of mass is 0.1 m off its middle."""
    mission = read_mission(MISSIONS / "l_payload_course.toml")
    steps = mission.reference.steps
    mission = replace(mission, reference=replace(mission.reference, steps=(*steps[:points], steps[-1])))
    with InProcessFlight(mission, tmp_path / "run", seed=4, obstacles=mission.obstacles) as flight:
        flight.fly()
        result = flight.result()
    summary = result.summary
    assert result.exit_code == ExitStatus.DONE, result.reason
    assert summary["completed"] and summary["contacts"] == 0
    assert summary["position_rmse_m"]["total"] <= 0.05
    assert max(summary["payload_tilt_max_deg"].values()) <= 5.0
    assert summary["clearance_min_m"] >= 0.5
    assert summary["landing"]["on_ground"] and summary["landing"]["tilt_deg"] < 1.0
