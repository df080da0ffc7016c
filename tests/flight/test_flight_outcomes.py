"""Outcomes of whole flights: a goal that cannot be reached, a payload that does not rise, a pad that is not clear."""

from dataclasses import replace

import pytest
from flights import HOP, InProcessFlight, system_file

from gcs.app.exit_status import ExitStatus
from gcs.mission.read import read_mission
from gcs.record.landing import is_set_down
from gcs.record.reader import read_table
from gcs.record.tables import ALARMS

pytestmark = pytest.mark.slow

POLE = """
[[obstacle]]
name = "mast"
shape = "pole"
position = [{north}, 0.2]
radius = 0.3
height = 8.0
known = {known}
"""


def mission_in(folder, north, known, point="[2.5, 0.0, -1.5]"):
    system_file(folder)
    path = folder / "there.toml"
    there = HOP.replace("[0.0, 0.0, -0.8]", point) + "return_home = false\n"
    path.write_text(there + POLE.format(north=north, known=str(known).lower()))
    return read_mission(path)


def flown(mission, folder, **options):
    with InProcessFlight(mission, folder, obstacles=mission.obstacles, **options) as flight:
        flight.fly()
        return flight.result()


def test_last_waypoint_that_an_unknown_pole_keeps_from_is_missed(tmp_path):
    result = flown(mission_in(tmp_path, 3.7, known=False), tmp_path / "run")
    summary = result.summary
    assert result.exit_code == ExitStatus.OUTSIDE_LIMITS
    assert (summary["outcome"], summary["contacts"]) == ("failed", 0)
    assert is_set_down(summary["landing"])
    missed = summary["limits"]["arrival"]
    assert 0.3 < missed["value"] < 1.5 and not missed["held"]
    assert result.reason.startswith("waypoint 1 missed by ") and "mast is " in result.reason


def test_payload_that_is_too_heavy_to_rise_stays_on_the_ground(tmp_path):
    system_file(tmp_path)
    path = tmp_path / "hop.toml"
    path.write_text(HOP.replace("-0.8", "-3.0"))
    mission = read_mission(path)
    heavy = replace(mission.system, payload=replace(mission.system.payload, mass=9.0))
    with InProcessFlight(mission, tmp_path / "run", world=heavy) as flight:
        flight.fly()
        result = flight.result()
    assert result.exit_code == ExitStatus.OUTSIDE_LIMITS and result.summary["outcome"] == "aborted"
    assert result.reason == "the payload does not rise: it is 0.6 m below its plan (limit 0.6 m)"
    assert is_set_down(result.summary["landing"])
    # Within the time that its plan takes for that: a second and a half at 1 m/s.
    alarms = read_table(tmp_path / "run" / ALARMS)
    assert alarms["time_s"][alarms["code"] == "climb_stalled"][0] < flight.flight.takeoff_time + 5.0


def test_take_off_within_an_obstacle_is_refused(tmp_path):
    mission = mission_in(tmp_path, 0.9, known=True)
    with InProcessFlight(mission, tmp_path / "run") as flight:  # on the map alone: nothing touches
        flight.fly()
        result = flight.result()
    assert not result.flown and result.exit_code == ExitStatus.OUTSIDE_LIMITS
    assert result.summary["outcome"] == "aborted"
    assert result.reason.startswith("on the pad, mast reaches ")


def test_contact_ends_the_flight(tmp_path):
    """A controller that does not avoid flies into a pole; what is left of the mission is not flown."""
    mission = mission_in(tmp_path, 1.8, known=True)
    result = flown(mission, tmp_path / "run", controller="mpc")
    assert result.exit_code == ExitStatus.OUTSIDE_LIMITS and result.summary["outcome"] == "collided"
    assert "an impact: the accelerometer of" in result.reason
    alarms = read_table(tmp_path / "run" / ALARMS)
    assert alarms["code"].tolist().count("impact") == 1
