"""On the ground between two flights: links that are lost and come back, a vehicle that stays lost, an interrupt."""

import pytest
from flights import InProcessFlight, system_file
from mission_files import row, wpl

from gcs.flight.failsafe import Failsafe
from gcs.record.reader import read_table

MISSION = """
[mission]
name = "three hops"
system = "system.toml"

[reference]
kind = "waypoints"
file = "hops.waypoints"

[[fault]]
kind = "partition"
start_phase = "on_ground"
start_offset = 0.5
duration = 4.0

[[fault]]
kind = "partition"
vehicles = [2]
start_phase = "on_ground"
start_offset = 0.5
start_flight = 2
"""
HOP = row(22, alt=0.7), row(21, alt=0)

pytestmark = pytest.mark.slow


@pytest.fixture
def mission(tmp_path):
    system_file(tmp_path)
    stand = row(93, 5.0, frame=2)
    (tmp_path / "hops.waypoints").write_text(wpl(*HOP, stand, *HOP, stand, *HOP))
    path = tmp_path / "mission.toml"
    path.write_text(MISSION)
    return path


def test_lost_ground_changes_nothing_and_lost_vehicle_ends_the_mission_on_the_ground(mission, tmp_path):
    with InProcessFlight(mission, tmp_path / "run") as flight:
        flight.fly()
        flown, summary = flight.flight, flight.summary()
    assert flown.landings == 2 and flown.landed and flown.failsafes.raised == {Failsafe.CONNECT_TIMEOUT}
    assert "3 of 4 vehicles connected: vehicle 2 does not answer" in flown.reason
    assert summary["outcome"] == "aborted" and summary["contacts"] == 0 and len(summary["stops"]) == 2
    modes, phases = read_table(tmp_path / "run" / "modes.csv"), read_table(tmp_path / "run" / "phases.csv")
    assert not any(modes[modes["vehicle"] == i]["armed"][-1] == 1.0 for i in (1, 2, 3, 4))
    ground = phases["time_s"][phases["phase"] == "on ground"]
    assert phases["phase"].tolist()[-2:] == ["on ground", "ended"]
    stood = 5.0 + flown.mission.system.flight.failsafe.connect_timeout
    assert phases["time_s"][-1] - ground[-1] == pytest.approx(stood, abs=0.2)
    alarms = read_table(tmp_path / "run" / "alarms.csv")
    assert not any(ground[0] - 1.0 < time < ground[-1] for time in alarms["time_s"])
