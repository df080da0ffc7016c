"""Truth log, summary and pictures on synthetic runs whose figures can be written down by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from truth_rows import write_state

from gcs.errors import UnusableInput
from gcs.record import figures
from gcs.record import summary as summaries
from gcs.record.run_data import read_run
from gcs.record.run_folder import FORMAT, open_run_folder, write_json, write_manifest
from gcs.record.summary import within_limits, write_summary
from gcs.record.summary_table import print_summary
from gcs.record.tables import (
    ESTIMATE_COLUMNS,
    PLAN_COLUMNS,
    REFERENCE_COLUMNS,
    STEP_COLUMNS,
    STEP_PART_COLUMNS,
    TableWriter,
)
from idc_controller.geometry.box import Wall
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.sphere import Sphere
from idc_controller.rotations import quaternion_from_euler
from vehicle_sim.world.obstacle_bodies import Obstacle
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world_state import UavState, WorldState

LEVEL = (1.0, 0.0, 0.0, 0.0)
REST = (0.0, 0.0, 0.0)
CORNERS = np.array([[x, y, -1.25] for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
PNG = b"\x89PNG\r\n\x1a\n"


def summarise(folder: Path, **options) -> dict:
    return summaries.summarise(read_run(folder), **options)


def entry(value: float | None, limit: float, held: bool) -> dict:
    return {"value": value, "limit": limit, "held": held}


def report(folder: Path) -> list[Path]:
    return figures.report(read_run(folder))


def world_state(time, position, quaternion, uavs, thrust) -> WorldState:
    """A state with level UAVs at ``uavs`` (N, 3), each with its ``thrust`` (N,)."""
    states = (UavState(tuple(p), LEVEL, REST, REST, f, False) for p, f in zip(uavs, thrust, strict=True))
    return WorldState(time, tuple(position), tuple(quaternion), REST, REST, tuple(states))


def write_truth(folder: Path, rows: int = 101, obstacles=lambda time: ()) -> None:
    """Ten seconds at 10 Hz: the payload flies north at 1 m/s, 0.03 m east and 0.04 m below its reference."""
    with TruthLog(folder, 4) as log:
        for k in range(rows):
            time = k / 10.0
            position = np.array([time, 0.03, -4.96])
            roll, pitch, yaw = np.deg2rad([2.0 if k == 50 else 0.0, -3.0 if k == 51 else 0.0, 1.0])
            uavs = position + CORNERS
            if k == 60:
                uavs[0, 0] += 0.25  # towards its neighbour ahead
            state = world_state(time, position, quaternion_from_euler(roll, pitch, yaw), uavs, [14.5] * 4)
            write_state(log, state, {70: 1, 71: 2, 72: 2, 80: 1}.get(k, 0), obstacles(time))


def write_reference(folder: Path, start: float = 0.0, end: float = 10.0) -> None:
    with TableWriter(folder / "reference.csv", REFERENCE_COLUMNS) as table:
        for time in np.linspace(start, end, 33):  # at times that are not those of the truth
            table.write([time, time, 0.0, -5.0, 1.0, 0.0, 0.0])


def write_steps(folder: Path) -> None:
    with TableWriter(folder / "steps.csv", STEP_COLUMNS) as table:
        for k in range(101):
            table.write([k / 20.0, 0.1, 0.5, k / 10.0, k / 10.0 + 1.0, 7, k in (3, 4)])


def sphere_ahead(time: float):
    return (Obstacle("ball", Sphere(0.5), (14.0, 0.53, -6.21)),)


FLOWN = {"completed": True, "outcome": "completed", "duration_s": 10.0, "real_time_factor": 5.5}


@pytest.fixture
def run(tmp_path) -> Path:
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(folder)
    write_reference(folder)
    write_steps(folder)
    return folder


def test_summary_agrees_with_values_computed_by_hand(run) -> None:
    summary = summarise(run, **FLOWN, limits={"settle": 2.0})
    assert summary == {
        "format": FORMAT,
        "completed": True,
        "outcome": "completed",
        "reason": "",
        "source": "truth",
        "duration_s": 10.0,
        "real_time_factor": 5.5,
        "position_rmse_m": {"x": 0.0, "y": 0.03, "z": 0.04, "total": 0.05},
        "payload_tilt_max_deg": {"roll": 2.0, "pitch": 3.0, "yaw": 1.0},
        "clearance_min_m": None,
        "uav_separation_min_m": 0.75,
        "contacts": 3,
        "landing": {
            "on_ground": False, "tilt_deg": 0.0, "touchdown_s": None, "speed_mps": None, "sinking_mps": None,
            "contacts_before": 3,
        },
        "step_time_ms": {"p50": 6.0, "p99": 10.9, "max": 11.0},
        "step_parts_ms": None,
        "solver": {"mpc_p50_ms": 5.0, "planner_p50_ms": 0.5, "infeasible_steps": 2},
        "safety": None,
        "limits": {},
    }  # fmt: skip


def test_summary_has_the_parts_of_the_control_step(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(folder)
    with TableWriter(folder / "steps.csv", (*STEP_COLUMNS, *STEP_PART_COLUMNS)) as table:
        for k in range(101):
            table.write([k / 20.0, 1.0, 0.5, 0.1, 10.0 + k, 0, 0, 2.0, k / 10.0, 0.3, 0.4, 0.6, 0.7, 0.8])
    summary = summarise(folder, **FLOWN)
    assert summary["step_time_ms"] == {"p50": 60.0, "p99": 109.0, "max": 110.0}
    medians = {part: figures["p50"] for part, figures in summary["step_parts_ms"].items()}
    assert medians == {
        "telemetry": 2.0, "estimation": 1.0, "perception": 5.0, "planning": 0.5, "control": 0.3, "stop_plan": 0.4,
        "monitoring": 0.6, "recording": 0.7, "setpoints": 0.8,
    }  # fmt: skip
    assert summary["step_parts_ms"]["perception"]["p99"] == 9.9
    assert "2.0 / 1.0 / 5.0 ms" in printed(summary, folder)


def test_error_counts_from_settle_on_and_within_the_reference_only(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    with TruthLog(folder, 4) as log:
        for k in range(101):
            # 5 m off before the reference, 1 m in its first two seconds, then 0.1 m, and 9 m after its end.
            off = 5.0 if k < 20 else 1.0 if k < 40 else 0.1 if k <= 80 else 9.0
            position = np.array([k / 10.0 + off, 0.0, -5.0])
            write_state(log, world_state(k / 10.0, position, LEVEL, position + CORNERS, [1.0] * 4), 0)
    write_reference(folder, 2.0, 8.0)
    assert summarise(folder, **FLOWN, limits={"settle": 2.0})["position_rmse_m"]["x"] == pytest.approx(0.1)
    # 20 rows 1 m off, 41 rows 0.1 m off.
    expected = np.sqrt((20 * 1.0 + 41 * 0.01) / 61)
    unsettled = summarise(folder, **FLOWN, limits={"settle": 0.0})
    assert unsettled["position_rmse_m"]["total"] == pytest.approx(expected, abs=1e-6)
    nothing_left = summarise(folder, **FLOWN, limits={"settle": 6.5, "position_rmse": 1.0})
    assert nothing_left["position_rmse_m"] == {"x": None, "y": None, "z": None, "total": None}
    assert nothing_left["limits"]["position_rmse"] == entry(None, 1.0, False)


def test_summary_lists_violated_limits(run) -> None:
    limits = {"position_rmse": 0.06, "payload_tilt_deg": 2.9, "clearance": 0.3, "uav_separation": 0.7}
    assert summarise(run, **FLOWN, limits=dict.fromkeys(limits))["limits"] == {}
    summary = summarise(run, **FLOWN, limits={"settle": 2.0, **limits})
    assert summary["limits"] == {
        "position_rmse": entry(0.05, 0.06, True),
        "payload_tilt_deg": entry(3.0, 2.9, False),
        "clearance": entry(None, 0.3, True),
        "uav_separation": entry(0.75, 0.7, True),
    }
    assert not within_limits(summary)
    assert within_limits(summarise(run, **FLOWN, limits={"settle": 2.0, "position_rmse": 0.06}))
    # A mission with obstacles of which the records know nothing does not hold its clearance.
    assert summarise(run, **FLOWN, limits=limits, obstacles=True)["limits"]["clearance"] == entry(None, 0.3, False)
    with pytest.raises(ValueError, match="limit 'tilt'"):
        summarise(run, **FLOWN, limits={"tilt": 1.0})
    with pytest.raises(ValueError, match="outcome 'fine'"):
        summarise(run, **{**FLOWN, "outcome": "fine"})


def test_clearance_is_taken_to_the_true_surface(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(folder, obstacles=sphere_ahead)
    # Last row: the front right UAV stands at (10.5, 0.53, -6.21), its rim 0.3 m ahead; the surface at 13.5.
    summary = summarise(folder, **FLOWN, limits={"clearance": 2.8})
    assert summary["clearance_min_m"] == pytest.approx(13.5 - 10.8, abs=1e-3)
    assert summary["limits"]["clearance"]["held"] is False


@pytest.mark.parametrize("payload", [{}, {"payload": {"size": [1.0, 1.0, 0.5]}}])
def test_summary_takes_sizes_from_the_manifest(tmp_path, payload) -> None:
    system = {"uav": {"disc_radius": 0.2}, **payload}
    folder = open_run_folder("hover", tmp_path / "run")
    write_manifest(folder, command=[], seed=1, mission={}, system=system, start="then")
    write_truth(folder, obstacles=sphere_ahead)
    assert summarise(folder, **FLOWN)["clearance_min_m"] == pytest.approx(13.5 - 10.7, abs=1e-3)


def test_every_obstacle_keeps_its_own_track(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    write_truth(
        folder,
        obstacles=lambda time: (
            Obstacle("moving, by name", Sphere(0.5), (20.0 - time, 5.0, -5.0)),
            Obstacle("tree", Pole(0.4, 10.0), (3.0, 9.0, -5.0)),
            Obstacle("tree", Wall((1.0, 2.0, 3.0), 0.5), (3.0, -9.0, -5.0)),
        ),
    )
    header, first, *_ = (folder / "obstacles.csv").read_text().splitlines()
    assert header == "time_s,name,shape,x_m,y_m,z_m,radius_m,size_x_m,size_y_m,size_z_m,yaw_rad"
    assert first == '0.0,"moving, by name",sphere,20.0,5.0,-5.0,0.5,0.0,0.0,0.0,0.0'
    tracks = read_run(folder).obstacles
    assert [(t.name, t.shape) for t in tracks] == [
        ("moving, by name", Sphere(0.5)),
        ("tree", Pole(0.4, 10.0)),
        ("tree", Wall((1.0, 2.0, 3.0), 0.5)),
    ]
    assert tracks[0].position[50].tolist() == [15.0, 5.0, -5.0]


def test_tilt_counts_between_take_off_and_landing(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    with TruthLog(folder, 4) as log:
        for k, (thrust, roll) in enumerate([(0.0, 9.0), (3.0, 1.0), (0.0, -2.0), (3.0, 1.5), (0.0, 8.0)]):
            quaternion = quaternion_from_euler(np.deg2rad(roll), 0.0, 0.0)
            write_state(log, world_state(k, (0.0, 0.0, 0.0), quaternion, CORNERS, [thrust, 0.0, 0.0, 0.0]), 0)
    assert summarise(folder, **FLOWN)["payload_tilt_max_deg"]["roll"] == pytest.approx(2.0)


def test_summary_uses_estimate_without_truth(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    with TableWriter(folder / "estimate.csv", ESTIMATE_COLUMNS) as table:
        for k in range(101):
            table.write([k / 10.0, k / 10.0, 0.1, -5.0, *LEVEL, *[0.0] * 6, 0.0, 0.0, 0.3])
    write_reference(folder)
    summary = summarise(folder, **FLOWN, limits={"settle": 1.0})
    assert summary["source"] == "estimate"
    assert summary["position_rmse_m"] == {"x": 0.0, "y": 0.1, "z": 0.0, "total": 0.1}
    assert summary["uav_separation_min_m"] is None
    assert summary["contacts"] is None
    assert summary["step_time_ms"] == {"p50": None, "p99": None, "max": None}
    assert {path.name for path in report(folder)} == {"position.png", "payload_angles.png", "top_view.png"}


def test_flight_without_take_off_has_a_summary(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")
    failed = {**FLOWN, "completed": False, "outcome": "failed", "real_time_factor": None}
    summary = summarise(folder, **failed, limits={"payload_tilt_deg": 5.0})
    assert summary["payload_tilt_max_deg"] == {"roll": None, "pitch": None, "yaw": None}
    assert not within_limits(summary)
    write_summary(folder, summary)
    assert "failed" in printed(summary, folder)


def test_summary_is_strict_json(run) -> None:
    summary = summarise(run, **{**FLOWN, "real_time_factor": float("nan")}, limits={"clearance": 0.3})
    path = write_summary(run, summary)
    assert path.name == "summary.json"
    content = json.loads(path.read_text(), parse_constant=pytest.fail)
    assert content["real_time_factor"] is None
    assert content["limits"] == {"clearance": entry(None, 0.3, True)}


def printed(summary, folder, pictures=()) -> str:
    console = Console(width=80, record=True, file=open("/dev/null", "w"))  # noqa: PTH123, SIM115
    print_summary(console, summary, folder, pictures)
    return console.export_text()


def test_table_lists_limits_and_folder_of_records(run) -> None:
    limits = {"position_rmse": 0.06, "payload_tilt_deg": 2.9}
    text = printed(summarise(run, **FLOWN, limits={"settle": 2.0, **limits}), run, [run / "top_view.png"])
    assert "Flight completed, OUTSIDE its limits: 10.0 s, 5.5 times real time" in text
    rows = {line.strip().split("  ")[0]: line.split() for line in text.splitlines() if line}
    assert rows["position error, RMS"][-6:] == ["0.050", "m", "<=", "0.06", "m", "held"]
    assert rows["payload angle, largest"][-7:] == ["3.0", "deg", "<=", "2.9", "deg", "NOT", "HELD"]
    assert "top_view.png" in text
    assert "run" in text


def write_plan(folder: Path, slack: float, off: float) -> None:
    """A plan 0.05 s apart that the payload is ``off`` (m) beside of, with one step of ``slack`` (m) at 5 s."""
    with TableWriter(folder / "plan.csv", PLAN_COLUMNS) as table:
        for k in range(201):
            time = k / 20.0
            check = [0.5 - slack * (k == 100), int(not (slack and k == 100)), 1]
            table.write(
                [time, time, 0.03 - off, -4.96, 0, 0, 0, slack * (k == 100), 0, 1, 0, 0.1, 0.12, 1, 9, 0, *check]
            )


def test_void_guarantee_stands_in_the_first_line_and_does_not_change_the_outcome(run) -> None:
    write_plan(run, slack=1.371, off=0.05)
    summary = summarise(run, **FLOWN)
    assert summary["safety"]["exceeded"]["plan_clearance"] == {"value": -0.871, "limit": 0.0, "time_s": 5.0}
    assert "payload_deviation" not in summary["safety"]["exceeded"]
    assert (summary["safety"]["steps"], summary["safety"]["verified_steps"]) == (201, 200)
    reason = "at 5.0 s the plan comes within -0.87 m of an obstacle (margin 0.50 m)"
    assert summary["safety"]["unverified_reason"] == reason
    expected = (
        "Flight completed, but the safety guarantee was void: planned clearance -0.87 m (at least 0.00 m) at 5.0 s"
    )
    assert printed(summary, run).splitlines()[0].startswith(expected)
    (run / "plan.csv").unlink()
    write_plan(run, slack=0.49, off=0.19)
    summary = summarise(run, **FLOWN)
    assert summary["safety"]["exceeded"]["payload_deviation"]["value"] == pytest.approx(0.19, abs=1e-3)
    assert "plan_clearance" not in summary["safety"]["exceeded"] and summary["completed"]
    assert "payload off the plan 0.19 m (bound 0.10 m)" in printed(summary, run).splitlines()[0]


def test_deviation_counts_only_clear_of_the_ground(tmp_path) -> None:
    folder = open_run_folder("pad", tmp_path / "run")
    with TruthLog(folder, 4) as log:
        for k in range(101):
            # On the pad until 8 s, 0.5 m below its plan, then 0.05 m.
            position = np.array([k / 10.0, 0.03, -0.3 if k < 80 else -4.91])
            write_state(log, world_state(k / 10.0, position, LEVEL, position + CORNERS, [1.0] * 4), 0)
    write_plan(folder, slack=0.0, off=0.0)
    assert summarise(folder, **FLOWN)["safety"]["payload_tracking_max_m"] == pytest.approx(0.05, abs=1e-3)


# --- truth log ----------------------------------------------------------------------------------------------------


def test_equal_states_give_equal_bytes(tmp_path) -> None:
    for name in ("a", "b"):
        write_truth(tmp_path / name, obstacles=sphere_ahead)
    for name in ("truth.csv", "obstacles.csv"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_truth_columns_are_in_order_of_the_contract(tmp_path) -> None:
    with TruthLog(tmp_path / "new", 2) as log:
        uavs = (
            UavState((10, 11, 12), (0, 1, 0, 0), (0, 0, 0), (0, 0, 0), 16, True),
            UavState((13, 14, 15), (0, 0, 1, 0), (0, 0, 0), (0, 0, 0), 17, False),
        )
        write_state(log, WorldState(0.02, (1, 2, 3), (1, 0, 0, 0), (4, 5, 6), (7, 8, 9), uavs), 3)
        log.close()
    header, row = (tmp_path / "new" / "truth.csv").read_text().splitlines()
    assert dict(zip(header.split(","), map(float, row.split(",")), strict=True)) == {
        "time_s": 0.02, "payload_x_m": 1, "payload_y_m": 2, "payload_z_m": 3,
        "payload_qw": 1, "payload_qx": 0, "payload_qy": 0, "payload_qz": 0,
        "payload_vx_mps": 4, "payload_vy_mps": 5, "payload_vz_mps": 6,
        "payload_wx_radps": 7, "payload_wy_radps": 8, "payload_wz_radps": 9,
        "uav1_x_m": 10, "uav1_y_m": 11, "uav1_z_m": 12,
        "uav1_qw": 0, "uav1_qx": 1, "uav1_qy": 0, "uav1_qz": 0, "uav1_thrust_n": 16,
        "uav2_x_m": 13, "uav2_y_m": 14, "uav2_z_m": 15,
        "uav2_qw": 0, "uav2_qx": 0, "uav2_qy": 1, "uav2_qz": 0, "uav2_thrust_n": 17, "contacts": 3,
    }  # fmt: skip
    assert row.endswith(",3")
    assert not (tmp_path / "new" / "obstacles.csv").exists()


def test_truth_of_another_flight_is_not_overwritten(tmp_path) -> None:
    write_truth(tmp_path)
    with pytest.raises(UnusableInput, match=r"truth\.csv: there is a record of another flight"):
        TruthLog(tmp_path, 4)


def test_state_of_another_number_of_uavs_is_an_error(tmp_path) -> None:
    with TruthLog(tmp_path, 3) as log, pytest.raises(ValueError, match="47 values for 39 columns"):
        write_state(log, world_state(0.0, (0.0, 0.0, 0.0), LEVEL, CORNERS, [0.0] * 4), 0)


# --- pictures -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_report_draws_every_picture_again_and_again(run) -> None:
    write_summary(run, summarise(run, **FLOWN, limits={"payload_tilt_deg": 5.0, "uav_separation": 0.7}))
    for _ in range(2):
        pictures = report(run)
        assert [path.name for path in pictures] == [
            "position.png", "payload_angles.png", "top_view.png", "thrust.png", "separation.png",
        ]  # fmt: skip
        assert all(path.parent == run and path.read_bytes().startswith(PNG) for path in pictures)


def test_killed_run_is_drawn_to_its_last_record(tmp_path) -> None:
    folder = open_run_folder("hover", tmp_path / "run")  # the manifest is still empty
    write_truth(folder, rows=30, obstacles=lambda time: (Obstacle("b", Sphere(0.5), (time, 9.0, -5.0)),))
    for name, cut in (("truth.csv", 5), ("obstacles.csv", 200)):
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[:-cut])
    run = read_run(folder)
    assert len(run.time) == 29
    assert np.isnan(run.clearance[-1, 0])
    assert len(report(folder)) == 5


def test_folder_without_records_is_refused(tmp_path) -> None:
    with pytest.raises(UnusableInput, match="absent: is not a folder"):
        report(tmp_path / "absent")
    with pytest.raises(UnusableInput, match=r"is not a run folder: it holds no manifest\.json"):
        report(tmp_path)
    with pytest.raises(UnusableInput, match="nothing was flown"):
        report(open_run_folder("hover", tmp_path / "run"))


def test_damaged_runs_are_refused_with_the_file(run) -> None:
    (run / "manifest.json").write_text("{")
    with pytest.raises(UnusableInput, match=r"manifest\.json: is not JSON"):
        report(run)
    (run / "manifest.json").unlink()
    write_json(run / "manifest.json", [1])
    with pytest.raises(UnusableInput, match=r"manifest\.json: is not a JSON object"):
        report(run)
    write_json(run / "manifest.json", {})
    (run / "reference.csv").write_text("time_s,x_m\n0.0,1.0\n")
    with pytest.raises(UnusableInput, match=r"reference\.csv, line 1: column y_m is missing"):
        report(run)
