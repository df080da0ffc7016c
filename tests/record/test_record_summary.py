"""Summary of synthetic runs whose figures can be written down by hand."""

import json
import re

import numpy as np
import pytest
from recorded_run import (
    BALL,
    CORNERS,
    LEVEL,
    world_state,
    write_flight,
    write_plan,
    write_reference,
    write_steps,
    write_truth,
)
from rich.console import Console
from truth_rows import write_state

from gcs.record import summary as summaries
from gcs.record.outcome import Outcome
from gcs.record.run_data import read_run
from gcs.record.run_folder import FORMAT, SUMMARY, open_run_folder, write_json, write_manifest
from gcs.record.summary import within_limits
from gcs.record.summary_table import print_summary
from gcs.record.tables import ESTIMATE_COLUMNS, TableWriter
from gcs.record.verdict import Verdict
from idc_controller.rotations import quaternion_from_euler
from vehicle_sim.world.truth_log import TruthLog

FLOWN = {"duration_s": 10.0, "real_time_factor": 5.5}
COMPLETED = Verdict(Outcome.COMPLETED, "", None)


def summarise(folder, ended=COMPLETED, **options):
    return summaries.summarise(read_run(folder), ended, **FLOWN | options)


def entry(value, limit, held):
    return {"value": value, "limit": limit, "held": held}


def printed(summary, folder, pictures=(), details=False):
    console = Console(width=80, record=True, file=open("/dev/null", "w"))  # noqa: PTH123, SIM115
    print_summary(console, summary, folder, pictures, details=details)
    return console.export_text()


@pytest.fixture
def folder(tmp_path):
    return open_run_folder("hover", tmp_path / "run")


@pytest.fixture
def run(folder):
    write_truth(folder)
    write_reference(folder)
    write_steps(folder)
    return folder


def test_summary_agrees_with_values_computed_by_hand(run):
    summary = summarise(run, limits={"settle": 2.0})
    parts = summary.pop("step_parts_ms")
    assert {row["name"]: row["value"] for row in summary.pop("result")} == {
        "clearance": None, "position_rmse": 0.05, "payload_tilt_deg": 3.0, "arrival": None, "uav_separation": 0.75,
        "touchdown_speed": None, "contacts": 3,
    }  # fmt: skip
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
        "solver": {"mpc_p50_ms": 5.0, "planner_p50_ms": 0.5, "infeasible_steps": 2},
        "safety": None,
        "limits": {},
    }  # fmt: skip
    assert {part: figures["p50"] for part, figures in parts.items()} == {
        "telemetry": 2.0, "estimation": 0.1, "perception": 5.0, "planning": 0.5, "control": 0.3, "stop_plan": 0.4,
        "monitoring": 0.6, "recording": 0.7, "setpoints": 0.8,
    }  # fmt: skip
    assert parts["perception"]["p99"] == 9.9


def test_error_counts_from_settle_on_and_within_the_reference_only(folder):
    # 5 m off before the reference, 1 m in its first two seconds, then 0.1 m, and 9 m after its end.
    k = np.arange(101)
    off = np.select([k < 20, k < 40, k <= 80], [5.0, 1.0, 0.1], 9.0)
    write_flight(folder, np.column_stack([k / 10.0 + off, 0.0 * k, 0.0 * k - 5.0]))
    write_reference(folder, 2.0, 8.0)
    assert summarise(folder, limits={"settle": 2.0})["position_rmse_m"]["x"] == pytest.approx(0.1)
    # 20 rows 1 m off, 41 rows 0.1 m off.
    expected = np.sqrt((20 * 1.0 + 41 * 0.01) / 61)
    assert summarise(folder, limits={"settle": 0.0})["position_rmse_m"]["total"] == pytest.approx(expected, abs=1e-6)
    nothing_left = summarise(folder, limits={"settle": 6.5, "position_rmse": 1.0})
    assert nothing_left["position_rmse_m"] == {"x": None, "y": None, "z": None, "total": None}
    assert nothing_left["limits"]["position_rmse"] == entry(None, 1.0, False)


def test_summary_lists_violated_limits(run):
    limits = {"position_rmse": 0.06, "payload_tilt_deg": 2.9, "clearance": 0.3, "uav_separation": 0.7}
    assert summarise(run, limits=dict.fromkeys(limits))["limits"] == {}
    summary = summarise(run, limits={"settle": 2.0, **limits})
    assert summary["limits"] == {
        "position_rmse": entry(0.05, 0.06, True),
        "payload_tilt_deg": entry(3.0, 2.9, False),
        "clearance": entry(None, 0.3, True),
        "uav_separation": entry(0.75, 0.7, True),
    }
    assert [tuple(row.values()) for row in summary["result"]] == [
        ("clearance", "least clearance", None, "m", "at least", 0.3, True),
        ("position_rmse", "position error, RMS", 0.05, "m", "at most", 0.06, True),
        ("payload_tilt_deg", "largest payload angle", 3.0, "deg", "at most", 2.9, False),
        ("arrival", "waypoints missed by", None, "m", "at most", None, None),
        ("uav_separation", "least distance of two UAVs", 0.75, "m", "at least", 0.7, True),
        ("touchdown_speed", "touchdown speed", None, "m/s", "at most", None, None),
        ("contacts", "contacts", 3, "", "at most", None, None),
    ]
    assert not within_limits(summary)
    assert within_limits(summarise(run, limits={"settle": 2.0, "position_rmse": 0.06}))
    # A mission with obstacles of which the records know nothing does not hold its clearance.
    assert summarise(run, limits=limits, obstacles=True)["limits"]["clearance"] == entry(None, 0.3, False)
    with pytest.raises(ValueError, match="limit 'tilt'"):
        summarise(run, limits={"tilt": 1.0})
    text = printed(summary, run, [run / "poster.png"])
    assert "Flight completed, OUTSIDE its limits: 10.0 s, 5.5 times real time" in text
    rows = {line.strip().split("  ")[0]: line.split() for line in text.splitlines() if line}
    assert rows["position error, RMS"][-7:] == ["0.050", "m", "at", "most", "0.06", "m", "held"]
    assert rows["largest payload angle"][-8:] == ["3.0", "deg", "at", "most", "2.9", "deg", "NOT", "HELD"]
    assert rows["least distance of two UAVs"][-7:] == ["0.750", "m", "at", "least", "0.7", "m", "held"]
    assert rows["contacts"][-1] == "3"
    assert not {"least clearance", "waypoints missed by", "touchdown speed"} & rows.keys()
    assert "poster.png" in text and str(run) in text and len(text.splitlines()) <= 10
    details = printed(summary, run, details=True)
    assert set(text.splitlines()[:-1]) <= set(details.splitlines())
    assert re.search(r"payload angle, roll / pitch / yaw +\S+ / \S+ / \S+ deg", details)
    assert re.search(r"control step, median / p99 / max +\S+ / \S+ / \S+ ms", details)


@pytest.mark.parametrize("system", [None, {"uav": {"disc_radius": 0.2}}])
def test_clearance_is_taken_to_the_true_surface(folder, system):
    if system:
        (folder / "manifest.json").unlink()
        write_manifest(folder, command=[], seed=1, mission={}, system=system, start="then")
    write_truth(folder, standing=[BALL])
    # Last row: the front right UAV stands at (10.5, 0.53, -6.21), the ball's surface begins at 13.5.
    summary = summarise(folder, limits={"clearance": 2.8})
    clearance = 13.5 - 10.5 - (0.2 if system else 0.3)
    assert summary["clearance_min_m"] == pytest.approx(clearance, abs=1e-3)
    assert summary["limits"]["clearance"]["held"] is bool(system)


def test_tilt_counts_between_take_off_and_landing(folder):
    with TruthLog(folder, 4) as log:
        for k, (thrust, roll) in enumerate([(0.0, 9.0), (3.0, 1.0), (0.0, -2.0), (3.0, 1.5), (0.0, 8.0)]):
            quaternion = quaternion_from_euler(np.deg2rad(roll), 0.0, 0.0)
            write_state(log, world_state(k, (0.0, 0.0, 0.0), quaternion, CORNERS, [thrust, 0.0, 0.0, 0.0]), 0)
    assert summarise(folder)["payload_tilt_max_deg"]["roll"] == pytest.approx(2.0)


def test_summary_uses_estimate_without_truth(folder):
    with TableWriter(folder / "estimate.csv", ESTIMATE_COLUMNS) as table:
        for k in range(101):
            table.write([k / 10.0, k / 10.0, 0.1, -5.0, *LEVEL, *[0.0] * 6, 0.0, 0.0, 0.3, *[0.01] * 15, 3.1])
    write_reference(folder)
    summary = summarise(folder, limits={"settle": 1.0})
    assert summary["source"] == "estimate"
    assert summary["position_rmse_m"] == {"x": 0.0, "y": 0.1, "z": 0.0, "total": 0.1}
    assert summary["uav_separation_min_m"] is None and summary["contacts"] is None
    assert summary["step_time_ms"] == {"p50": None, "p99": None, "max": None} and summary["step_parts_ms"] is None


def test_flight_without_take_off_has_a_summary(folder):
    failed = Verdict(Outcome.FAILED, "", None)
    summary = summarise(folder, failed, real_time_factor=None, limits={"payload_tilt_deg": 5.0})
    assert summary["payload_tilt_max_deg"] == {"roll": None, "pitch": None, "yaw": None}
    assert not within_limits(summary)
    write_json(folder / SUMMARY, summary)
    assert "failed" in printed(summary, folder)


def test_summary_is_strict_json(run):
    path = write_json(run / SUMMARY, summarise(run, real_time_factor=float("nan"), limits={"clearance": 0.3}))
    assert path.name == "summary.json"
    content = json.loads(path.read_text(), parse_constant=pytest.fail)
    assert content["real_time_factor"] is None
    assert content["limits"] == {"clearance": entry(None, 0.3, True)}


def test_void_guarantee_stands_in_the_first_line_and_does_not_change_the_outcome(run):
    write_plan(run, slack=1.371, off=0.05)
    summary = summarise(run)
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
    summary = summarise(run)
    assert summary["safety"]["exceeded"]["payload_deviation"]["value"] == pytest.approx(0.19, abs=1e-3)
    assert "plan_clearance" not in summary["safety"]["exceeded"] and summary["completed"]
    assert "payload off the plan 0.19 m (bound 0.10 m)" in printed(summary, run).splitlines()[0]


def test_deviation_counts_only_clear_of_the_ground(folder):
    # On the pad until 8 s, 0.5 m below its plan, then 0.05 m.
    k = np.arange(101)
    write_flight(folder, np.column_stack([k / 10.0, 0.0 * k + 0.03, np.where(k < 80, -0.3, -4.91)]))
    write_plan(folder, slack=0.0, off=0.0)
    assert summarise(folder)["safety"]["payload_tracking_max_m"] == pytest.approx(0.05, abs=1e-3)
