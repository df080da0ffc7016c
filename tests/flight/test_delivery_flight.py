"""A delivery of two stops: unloaded at the first; at the second the gripper acknowledges, and holds its cargo."""

from pathlib import Path

import numpy as np
import pytest
from flights import InProcessFlight, system_file
from mission_files import row, wpl

from gcs.flight.phase import Phase
from gcs.record.reader import read_json, read_table

UP = row(22, alt=1.2)
MISSION = """
[mission]
name = "two stops"
system = "system.toml"

[reference]
kind = "waypoints"
file = "two_stops.waypoints"

[[fault]]
kind = "gripper_stuck"
gripper = 2
start = 0.0
"""
STOPS = (1.0, 2.0)  # m north

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    made = tmp_path_factory.mktemp("delivery")
    system_file(made)
    items = [UP]
    for gripper, north in enumerate(STOPS, start=1):
        items += [row(21, north=north, alt=0), row(211, gripper, 0, frame=2), row(93, 1.0, frame=2), UP]
    (made / "two_stops.waypoints").write_text(wpl(*items, row(20, frame=2)))
    (made / "mission.toml").write_text(MISSION)
    with InProcessFlight(made / "mission.toml", made / "run") as flight:
        flight.fly()
        assert flight.flight.completed and flight.flight.landings == 3
        assert flight.summary()["completed"]
    return made / "run"


def test_every_landing_is_gentle_and_at_its_place(folder):
    summary = read_json(folder / "summary.json")
    assert [round(stop["north_m"], 1) for stop in summary["stops"]] == [*STOPS, 0.0]
    for stop in summary["stops"]:
        assert stop["speed_mps"] < 0.5 and stop["tilt_deg"] < 5.0
    assert summary["contacts"] == 0 and max(summary["payload_tilt_max_deg"].values()) < 5.0


def test_phases_of_every_flight_are_on_record(folder):
    phases = read_table(folder / "phases.csv")["phase"].tolist()
    flight = ["check", "arm", "spool up", "climb", "fly", "land", "spool down", "disarm"]
    passed = [phase for phase in phases if phase != Phase.HOLD.value]
    assert passed == ["connect", *flight, "on ground", *flight, "on ground", *flight, "ended"]


def test_cargo_that_was_not_unloaded_is_named(folder):
    cargo = read_table(folder / "cargo.csv")
    assert cargo["gripper"].tolist()[0] == 1 and cargo["payload_mass_kg"][-1] == pytest.approx(2.6)
    alarms = read_table(folder / "alarms.csv")
    failed = alarms[alarms["code"] == "unloading_failed"]
    assert [text.split(", ")[1] for text in failed["text"]] == ["expected 2.1 kg: gripper 2 did not release"]
    assert failed["text"][0].startswith("stop 2: the payload weighs 2.6 kg")
    climbs = read_table(folder / "phases.csv")
    last = climbs["time_s"][climbs["phase"] == "climb"][-1]
    assert 5.0 <= failed["time_s"][0] - last < 5.1


def test_reference_is_on_the_ground_at_the_stops(folder):
    reference, phases = read_table(folder / "reference.csv"), read_table(folder / "phases.csv")
    for k in np.flatnonzero(phases["phase"] == "on ground").tolist():
        begin, end = phases["time_s"][k], phases["time_s"][k + 1]
        stands = reference[(reference["time_s"] > begin) & (reference["time_s"] < end)]
        assert len(stands) > 10 and np.abs(stands["z_m"] + 0.25).max() < 0.02
        assert not np.any([stands[f"v{axis}_mps"] for axis in "xyz"])
