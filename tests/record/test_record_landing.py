"""Landing of the payload and stops of the vehicles, from records that are written by hand."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest
from flights import HOP, system_file
from truth_rows import write_state

from gcs.app.fly import flight_result
from gcs.flight.alarms import AlarmLog
from gcs.mission.read import read_mission
from gcs.record.landing import is_set_down, landing_figures
from gcs.record.modes import stops_after
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder
from idc_controller.rotations import quaternion_from_euler
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world_state import UavState, WorldState

LEVEL, REST = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
GROUND, PAD = -0.25, -0.30  # m, the centre of a payload that stands there


def write_flight(folder, rows, contacts=()):
    """One row each 0.02 s of (north, down (m), velocity north and down (m/s), roll (deg), thrust (N))."""
    with TruthLog(open_run_folder("", folder), 1) as log:
        for k, (north, down, v_x, v_z, roll, thrust) in enumerate(rows):
            attitude = tuple(quaternion_from_euler(np.deg2rad(roll), 0.0, 0.0))
            uav = UavState((north, 0.0, down - 3.4), LEVEL, REST, REST, thrust, False)
            position, velocity = (north, 0.0, down), (v_x, 0.0, v_z)
            write_state(log, WorldState(k * 0.02, position, attitude, velocity, REST, (uav,)), int(k in contacts))
    return folder


def flight(north=3.0, floor=GROUND, v_x=0.0, speed=0.5, roll=0.0, bounce=(), thrust=0.0):
    """From the pad up, aside, and down with ``speed`` to where it stays, after ``bounce``: rows of its own."""
    up = [(0.0, z, 0.0, -2.0, 0.0, 29.0) for z in np.arange(PAD, -2.0, -0.04)]
    down = [(north, z, v_x, speed, roll, 29.0) for z in np.arange(-2.0, floor, speed * 0.02)]
    return [(0.0, PAD, 0.0, 0.0, 0.0, 0.0), *up, *down, *bounce, *[(north, floor, 0.0, 0.0, roll, thrust)] * 20]


def figures(tmp_path, rows, contacts=()):
    return landing_figures(read_run(write_flight(tmp_path / "run", rows, contacts)))


def test_payload_on_pad_is_set_down(tmp_path):
    rows = flight(v_x=0.3, speed=0.4)
    found = figures(tmp_path, rows)
    assert is_set_down(found)
    assert (found["on_ground"], found["contacts_before"], found["sinking_mps"]) == (True, 0, 0.4)
    assert found["speed_mps"] == pytest.approx(0.5)
    assert found["tilt_deg"] == pytest.approx(0.0, abs=1e-6)
    assert found["touchdown_s"] == pytest.approx((len(rows) - 20) * 0.02, abs=0.07)


@pytest.mark.parametrize(
    ("rows", "contacts"),
    [
        (flight(speed=1.2), ()),
        (flight(speed=0.4, v_x=1.0), ()),
        (flight(roll=80.0, floor=-0.58), ()),  # on its side
        (flight(roll=180.0), ()),  # on its back
        (flight(floor=-0.5), ()),  # in the air
        (flight(thrust=8.0), ()),
        (flight(), (60,)),
        # Thrown up, and down once more: the first touch was the hard one.
        (flight(bounce=[(3.0, GROUND, 0.0, 1.5, 0.0, 9.0), (3.0, -0.5, 0.0, 0.3, 0.0, 9.0)]), ()),
    ],
    ids=["fast", "sideways", "side", "back", "air", "rotors", "contact", "bounce"],
)
def test_unsafe_landing_is_not_set_down(tmp_path, rows, contacts):
    assert not is_set_down(figures(tmp_path, rows, contacts))


def test_payload_that_never_left_the_pad_is_on_pad(tmp_path):
    assert figures(tmp_path / "a", flight(north=0.4, floor=PAD))["on_ground"]
    assert not figures(tmp_path / "b", flight(north=3.0, floor=PAD))["on_ground"]
    # No corner touches, but the pad's edge does: half of the payload is beside it.
    roll = np.rad2deg(np.arcsin(0.05))
    edge = flight(north=1.2, floor=PAD + 0.01, roll=0.0)
    assert figures(tmp_path / "c", [*edge[:-20], *[(1.2, PAD, 0.0, 0.0, roll, 0.0)] * 3])["on_ground"]
    stayed = figures(tmp_path / "d", [(0.0, PAD, 0.0, 0.0, 0.0, 0.0)] * 9)
    assert is_set_down(stayed) and stayed["speed_mps"] == 0.0 and stayed["touchdown_s"] is None


def test_contact_after_touchdown_is_not_counted_before(tmp_path):
    rows = flight()
    assert figures(tmp_path, rows, (len(rows) - 3,))["contacts_before"] == 0


def test_payload_beside_a_smaller_pad_is_not_set_down_at_its_height(tmp_path):
    rows = flight(north=1.2, floor=PAD)
    for name, margin in (("usual", 0.25), ("small", 0.1)):
        run = write_flight(tmp_path / name, rows)
        manifest = {"system": {"world": {"pad": {"thickness": 0.05, "margin": margin}}}}
        (run / "manifest.json").write_text(json.dumps(manifest))
    found = [landing_figures(read_run(tmp_path / name))["on_ground"] for name in ("usual", "small")]
    assert found == [True, False]


@pytest.mark.parametrize("system", [None, {"world": {"pad": {"thickness": 0.05, "colour": "red"}}, "payload": None}])
def test_run_of_another_version_is_read_with_the_default_sizes(tmp_path, system):
    run = write_flight(tmp_path / "run", flight())
    (run / "manifest.json").write_text(json.dumps({"system": system}))
    assert landing_figures(read_run(run))["on_ground"]


@pytest.mark.parametrize(
    ("rows", "landed", "completed", "outcome", "held"),
    [
        (flight(), True, True, "completed", True),
        (flight(), False, False, "aborted", True),  # beyond the telemetry of the ground
        (flight()[:120], False, False, "lost", False),  # cut off in the air
        (flight(north=3.4), True, True, "failed", True),  # beside its landing place
        (flight(speed=1.5), True, False, "failed", False),
        (flight(roll=80.0, floor=-0.58), True, True, "failed", False),
    ],
)
def test_landing_outcome_follows_from_truth(tmp_path, rows, landed, completed, outcome, held):
    system_file(tmp_path)
    path = tmp_path / "aside.toml"
    there = HOP.replace("[0.0, 0.0, -0.8]", "[3.0, 0.0, -1.9]") + "return_home = false\n"
    path.write_text(there + "\n[limits]\ntouchdown_speed = 0.9\n")
    run = write_flight(tmp_path / "run", rows)
    failsafes = SimpleNamespace(time=1.0, interrupted=False, alarms=AlarmLog())
    flown = SimpleNamespace(
        completed=completed, landed=landed, takeoff_time=0.0, reason="", failsafes=failsafes, is_redirected=False
    )
    station = SimpleNamespace(flight=flown)
    summary = flight_result(run, read_mission(path), station, 9.0, 1.0).summary
    assert (summary["outcome"], summary["completed"]) == (outcome, outcome == "completed")
    assert bool(summary["reason"]) == (outcome != "completed")
    assert summary["limits"]["touchdown_speed"]["held"] == held


def test_stop_times_of_vehicles_are_reported(tmp_path):
    assert stops_after(tmp_path, 0.0) == {}
    with TruthLog(tmp_path, 1) as log:
        for time, vehicle, mode in (
            (0.0, 1, "AUTO.LOITER"), (1.0, 1, "OFFBOARD"), (1.0, 2, "OFFBOARD"), (5.5, 2, "AUTO.LOITER"),
            (5.6, 1, "AUTO.LOITER"), (9.0, 2, "AUTO.LAND"),
        ):  # fmt: skip
            log.write_mode(time, vehicle, mode, True, False)
    assert stops_after(tmp_path, 5.0) == {2: 5.5, 1: 5.6}
