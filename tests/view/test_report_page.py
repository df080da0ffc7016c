"""The data of the report page: what it decodes to is what is on record, its witness points have the least clearance."""

import base64
import hashlib
import json
import re
import zlib
from pathlib import Path

import numpy as np
import pytest
from decoded_page import Decoded, values_of
from pymavlink.dialects.v20 import common as mavlink
from recorded_run import BALL, write_flight, write_plan, write_reference, write_steps, write_truth

import gcs.view.page as page_module
from gcs.record.landing import in_air
from gcs.record.link_figures import link_figures
from gcs.record.outcome import Outcome
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder, write_json
from gcs.record.summary import summarise
from gcs.record.tables import ALARM_COLUMNS, ESTIMATE_COLUMNS, PHASE_COLUMNS, TableWriter
from gcs.record.tlog import TelemetryLog
from gcs.record.verdict import Verdict
from gcs.record.witness import least_clearance
from gcs.view.page import write_report
from gcs.view.page_data import QUANTUM, Blob, PageData, command
from gcs.view.page_events import events
from gcs.view.poster import outline, write_poster
from idc_controller.geometry.shapes import Sphere, Wall
from vehicle_sim.world.obstacle_bodies import Obstacle


@pytest.fixture
def folder(tmp_path):
    return open_run_folder("hover", tmp_path / "run")


def page_of(path):
    """The header and the decoded run of a page that was written."""
    text = path.read_text(encoding="utf-8")
    found = re.findall(r'<script type="application/\S+" class="run-\w+">(.*?)</script>', text, re.DOTALL)
    return [Decoded(json.loads(header), blob) for header, blob in zip(found[::2], found[1::2], strict=True)]


def test_page_decodes_to_the_truth_within_its_quantum(folder):
    write_truth(folder, standing=[BALL], moving=lambda t: [Obstacle("moving", Sphere(0.5), (20.0 - t, 5.0, -5.0))])
    write_reference(folder)
    run = read_run(folder)
    (decoded,) = page_of(write_report(run))
    for name, values, unit in (
        ("truth.payload.position", run.payload_position, "m"),
        ("truth.payload.attitude", run.payload_quaternion, ""),
        ("truth.uav3.position", run.uav_position[:, 2], "m"),
        ("truth.thrust", run.thrust, "N"),
        ("clearance.nearest", run.clearance[:, None], "m"),
        ("reference.position", run.reference_position, "m"),
        ("obstacle.moving", run.obstacles[1].position, "m"),
    ):
        time, found = decoded.channel(name)
        at = run.reference["time_s"] if name.startswith("reference") else run.time
        assert np.abs(time - at).max() <= 1e-6, name
        assert found.shape == values.shape, name
        assert np.abs(found - values).max() <= QUANTUM[unit] / 2.0, name
    ball, moving = decoded.header["obstacles"]
    assert (ball["position"], ball["radius"], ball["channel"]) == ([14.0, 0.53, -6.21], 0.5, None)
    assert moving["channel"] == "obstacle.moving"


def test_unknown_values_and_wide_ranges_are_kept():
    values = np.column_stack([np.linspace(0.0, 1.0, 40), np.linspace(-1.0, 0.5, 40)])
    values[7, 0] = np.nan
    wide, constant = values * 1e6, np.full((40, 1), 3.25)
    blob = Blob()
    references = [blob.add(each, "m") for each in (values, wide, constant)]
    assert [reference["dtype"] for reference in references] == ["int16", "float32", "int16"]
    data = zlib.decompress(base64.b64decode(blob.encoded()))
    for reference, each in zip(references, (values, wide, constant), strict=True):
        found = values_of(data, reference)
        assert np.array_equal(np.isnan(found), np.isnan(each))
        assert np.nanmax(np.abs(found - each) / np.nanmax(np.abs(each))) <= 1e-4


def test_long_flight_is_thinned_to_25_rows_a_second(folder):
    write_flight(folder, np.column_stack([np.zeros(1500), np.zeros(1500), np.full(1500, -5.0)]))
    run = read_run(folder)  # 10 rows a second: nothing to thin
    assert len(Decoded(*PageData(run).document()).channel("truth.payload.position")[0]) == 1500
    fast = folder.parent / "fast"
    fast.mkdir()
    rows = (folder / "truth.csv").read_text().splitlines()
    cells = [rows[0]] + [f"{k / 100.0},{rows[1].partition(',')[2]}" for k in range(13000)]
    (fast / "truth.csv").write_text("\n".join([*cells, ""]))
    time, _ = Decoded(*PageData(read_run(fast)).document()).channel("truth.payload.position")
    assert len(time) == 3250 and time[1] == pytest.approx(0.04)


PATHS = {"over": -8.0, "into": -6.0}
"""Altitudes (NED, m) of two flights past :data:`BALL`, whose top is at 6.71 m: above it and into it."""


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("shape", [Sphere(0.5), Wall((0.4, 1.0, 0.8), 0.6)], ids=["sphere", "wall"])
def test_witness_points_are_as_far_apart_as_the_summary_says(folder, path, shape):
    way = np.linspace([0.0, 0.0, PATHS[path]], [28.0, 1.0, PATHS[path]], 120)
    write_flight(folder, way)
    state = Obstacle("ball", shape, BALL.position_in_world)
    write_truth_of_obstacle(folder, state)
    run = read_run(folder)
    summary = summarise(run, Verdict(Outcome.COMPLETED, "", None), duration_s=12.0, real_time_factor=None)
    write_json(folder / "summary.json", summary)
    (decoded,) = page_of(write_report(run))
    found = decoded.header["clearance"]
    length = np.linalg.norm(np.subtract(found["point_hull"], found["point_obstacle"]))
    assert length == pytest.approx(summary["clearance_min_m"], abs=1e-3)
    assert found["min"] == pytest.approx(summary["clearance_min_m"], abs=1e-3)
    assert found["obstacle"] == "ball"
    assert (summary["clearance_min_m"] > 0.5) == (path == "over")
    # On the surfaces: no nearer to the obstacle's centre, nor farther below the payload, than these reach.
    row = int(np.argmin(np.abs(run.time - found["time"])))
    from_centre = np.array(found["point_obstacle"]) - BALL.position_in_world
    if path == "over":
        normal = np.subtract(found["point_hull"], found["point_obstacle"]) / length
        assert from_centre @ normal == pytest.approx(float(shape.support(normal[None])[0]), abs=1e-4)
        assert found["point_hull"][2] == pytest.approx(run.payload_position[row, 2] + 0.25, abs=1e-3)
    else:
        assert found["point_hull"] == found["point_obstacle"]


def write_truth_of_obstacle(folder, obstacle):
    """``obstacles.csv`` of one that stands."""
    scratch = folder.parent / "scratch"
    scratch.mkdir()
    write_truth(scratch, rows=1, standing=[obstacle])
    (folder / "obstacles.csv").write_bytes((scratch / "obstacles.csv").read_bytes())


def test_clearance_is_that_of_the_time_in_the_air(folder):
    """On the ground the formation stands beside a wall that is nearer than anything in flight."""
    pad, ground = np.full(10, -0.3), np.full(10, -0.25)  # the payload's centre on both
    up = np.linspace(-0.25, -6.0, 40)
    down = np.concatenate([pad, ground, up, up[::-1], ground])
    write_flight(folder, np.column_stack([np.where(np.arange(len(down)) < 10, 0.0, 3.0), np.zeros(len(down)), down]))
    write_truth_of_obstacle(folder, Obstacle("wall", Wall((0.2, 4.0, 9.0), 0.0), (-1.2, 0.0, -4.5)))
    run = read_run(folder)
    found = least_clearance(run)
    assert found.row in range(len(run.time))[in_air(run)]
    assert found.distance == pytest.approx(np.nanmin(run.clearance[in_air(run)]), abs=1e-3)
    assert found.distance > np.nanmin(run.clearance) + 0.1


def test_run_without_truth_is_shown_by_the_estimate(folder):
    with TableWriter(folder / "estimate.csv", ESTIMATE_COLUMNS) as table:
        for k in range(20):
            table.write([k / 20.0, k / 20.0, 0.0, -5.0, 1, 0, 0, 0, *[0.0] * 6, 0.1, 0.2, 0.3, *[0.01] * 15, 3.1])
    (decoded,) = page_of(write_report(read_run(folder)))
    assert decoded.header["meta"]["source"] == "estimate"
    assert "truth.payload.position" not in decoded.header["channels"]
    assert decoded.channel("estimate.payload.position")[1][-1] == pytest.approx([0.95, 0.0, -5.0], abs=1e-3)
    assert decoded.channel("estimate.payload.position_sd")[1][-1] == pytest.approx([0.01] * 3, abs=1e-3)
    assert decoded.header["clearance"] is None


def test_two_runs_are_in_one_page_and_text_cannot_end_a_script(folder, tmp_path):
    other = open_run_folder("hover", tmp_path / "other")
    for each in (folder, other):
        write_truth(each)
        write_json(
            each / "manifest.json", {"mission": {"name": "</script><b>"}, "seed": 3, "command": ["x/gcs", "fly"]}
        )
    path = write_report(read_run(folder), read_run(other))
    assert path == folder / "report-other.html"
    assert [each.header["meta"]["mission"] for each in page_of(path)] == ["</script><b>"] * 2
    assert "&lt;/script&gt;&lt;b&gt;, seed 3: cut off, compared with" in path.read_text()


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        (["/v/bin/gcs", "fly", "a b.toml", "--seed", "3", "--run-dir", "out"], "gcs fly 'a b.toml' --seed 3"),
        (["gcs", "fly", "hop", "--run-dir=out", "--json"], "gcs fly hop --json"),
        (["gcs.fly('hop', seed=1)"], "gcs.fly('hop', seed=1)"),
        ([], ""),
    ],
)
def test_command_flies_again_into_a_folder_of_its_own(words, shown):
    assert command(words) == shown


def test_events_tell_faults_alarms_and_isolated_channels(folder):
    write_truth(folder)
    given = [{"settings": {"channel": "position", "amount": 0.5}}]
    write_json(folder / "manifest.json", {"mission": {"faults": given}})
    fault = {"number": 1, "kind": "bias", "vehicles": [1], "direction": None, "activations": [[2.0, 4.0]]}
    write_json(folder / "faults.json", {"take_off_s": 1.5, "faults": [fault]})
    with TableWriter(folder / "alarms.csv", ALARM_COLUMNS) as table:
        table.write([3.6, "vehicle 1", "measurements_rejected", "warning", "position"])
        table.write([3.95, "vehicle 1", "channel_isolated", "error", "position"])
    with TableWriter(folder / "phases.csv", PHASE_COLUMNS) as table:
        table.write([0.0, "connect"])
        table.write([1.0, "climb"])
    with TableWriter(folder / "modes.csv", ("time_s", "vehicle", "mode", "armed", "failsafe")) as table:
        table.write([0.0, 2, "OFFBOARD", 1, 0])
        table.write([8.0, 2, "AUTO.LAND", 1, 1])
    found = [(e["kind"], e["start"], e["end"], e["source"], e["text"]) for e in events(read_run(folder))]
    assert found == [
        ("phase", 0.0, 1.0, "team", "connect"),
        ("phase", 1.0, 10.0, "team", "climb"),
        ("fault", 3.5, 5.5, "vehicle 1", "bias (channel position, amount 0.5)"),
        ("alarm", 3.6, None, "vehicle 1", "measurements rejected: position"),
        ("alarm", 3.95, None, "vehicle 1", "channel isolated: position"),
        ("isolation", 3.95, None, "vehicle 1", "position"),
        ("contact", 7.0, None, "team", "something touches"),
        ("mode", 8.0, 10.0, "vehicle 2", "AUTO.LAND by a failsafe"),
        ("contact", 8.0, None, "team", "something touches"),
    ]
    # With the innovation tests on record, these tell from when to when.
    with TableWriter(folder / "innovations.csv", ("time_s", "source", "channel", "test_ratio", "state")) as table:
        for k in range(50):
            table.write([k / 10.0, "vehicle 1", "position", 0.2, "isolated" if 35 <= k < 45 else "ok"])
    isolated = [(e["start"], e["end"]) for e in events(read_run(folder)) if e["kind"] == "isolation"]
    assert isolated == [(3.5, 4.5)]


def test_waypoints_are_events_where_the_payload_was_nearest(folder):
    write_truth(folder)  # north at 1 m/s, 0.03 m east and 4.96 m high
    steps = [
        {"source": "item 2", "place": {"horizontal": [4.0, 0.03], "altitude": 4.96}, "hold": 0.0, "spline": False},
        {"source": "item 3", "speed": 2.0},
        {"source": "item 4", "place": {"horizontal": [8.0, 0.03], "altitude": 5.06}, "hold": 0.0, "spline": False},
    ]
    write_json(folder / "manifest.json", {"mission": {"reference": {"steps": steps}, "limits": {"arrival": 0.3}}})
    found = [(e["start"], e["text"]) for e in events(read_run(folder)) if e["kind"] == "waypoint"]
    assert [text for _, text in found] == [
        "waypoint 1, item 2: nearest, 0.00 m from it",
        "waypoint 2, item 4: nearest, 0.10 m from it",
    ]
    assert [time for time, _ in found] == pytest.approx([4.0, 8.0], abs=0.11)


def test_link_figures_count_lost_and_late_messages(tmp_path):
    sender = mavlink.MAVLink(None, srcSystem=2, srcComponent=1)
    with TelemetryLog(tmp_path / "telemetry.tlog", start_epoch=1.7e9) as log:
        for k in range(200):  # 50 a second for 4 s
            message = mavlink.MAVLink_attitude_message(1000 + k * 20, 0.1, -0.2, 0.3, 0.0, 0.0, 0.0)
            frame = message.pack(sender)
            sender.seq = (sender.seq + 1) % 256
            late = 0.03 if 100 <= k < 150 else 0.0
            if not (50 <= k < 100 and k % 5 == 0):
                log.write(k * 0.02 + 0.001 + late, frame)
    time, names, figures = link_figures(tmp_path / "telemetry.tlog")
    assert names == ["vehicle 2"]
    assert time.tolist() == [1.5, 2.5, 3.5]  # of the sender's clock; the last second is not a whole one
    assert figures["rate"][:, 0].tolist()[:2] == [50.0, 40.0]
    assert figures["loss"][:, 0] == pytest.approx([0.0, 20.0, 0.0], abs=2.1)
    assert figures["latency"][:, 0] == pytest.approx([0.0, 0.0, 30.0], abs=1.0)
    assert link_figures(tmp_path / "absent.tlog")[1] == []


def test_tables_of_the_safety_filter_and_the_steps_are_shown(folder):
    write_truth(folder)
    write_plan(folder, slack=0.2, off=0.05)
    write_steps(folder)
    decoded = Decoded(*PageData(read_run(folder)).document())
    time, verified = decoded.channel("plan.verified")
    assert time[verified[:, 0] < 0.5].tolist() == [5.0]
    assert decoded.channel("plan.slack")[1].max() == pytest.approx(0.2, abs=QUANTUM["m"])
    assert decoded.channel("steps.time")[1][:, 0].max() == pytest.approx(11.0, abs=QUANTUM["ms"])
    assert not {"horizon.plan", "truth.tension"} & set(decoded.header["channels"])


def test_horizons_are_paths_with_as_many_steps_as_each_has(folder):
    write_truth(folder)
    with TableWriter(folder / "horizon.csv", ("time_s", "kind", "step", "x_m", "y_m", "z_m")) as table:
        for time in (1.0, 1.2):
            for step in range(3 if time < 1.1 else 2):
                table.write([time, "plan", step, time + step, 0.0, -5.0])
    time, paths = Decoded(*PageData(read_run(folder)).document()).channel("horizon.plan")
    assert time.tolist() == [1.0, 1.2] and paths.shape == (2, 3, 3)
    assert paths[0, :, 0] == pytest.approx([1.0, 2.0, 3.0], abs=1e-3)
    assert np.isnan(paths[1, 2]).all()


def test_bundle_is_that_of_the_sources():
    """``make page`` makes it anew."""
    view = Path(page_module.__file__).parent
    sources = sorted((path for path in (view / "page").rglob("*") if path.suffix in (".js", ".css")), key=str)
    lock = Path(__file__).parents[1] / "packaging" / "page" / "package-lock.json"
    content = b"".join(path.read_bytes() for path in (*sources, lock))
    bundle = (view / "page.bundle.js").read_text(encoding="utf-8")
    assert bundle.startswith(f"/* sources sha256 {hashlib.sha256(content).hexdigest()}\n")
    for package in ("three 0.", "uplot 1.", "three.js authors", "Leon Sorokin", "Permission is hereby granted"):
        assert package in bundle[:5000]


@pytest.mark.slow
def test_poster_shows_hull_and_obstacle_from_above_and_from_the_side(folder, pictures):
    write_flight(folder, np.linspace([0.0, 0.0, -8.0], [28.0, 1.0, -8.0], 120))
    write_truth_of_obstacle(folder, BALL)
    write_reference(folder)
    run = read_run(folder)
    assert write_poster(run) == folder / "poster.png"
    texts = pictures["poster.png"]
    assert {"altitude (m)", "north (m)", "formation's hull", "ball"} <= {*texts}
    assert f"least clearance {np.nanmin(run.clearance):.2f} m, ball" in texts


def test_outline_of_a_turned_wall_has_its_corners():
    corners = outline(Wall((2.0, 1.0, 4.0), 0.3), np.eye(3)[:2])
    along = np.array([np.cos(0.3), np.sin(0.3)])
    assert np.abs(corners @ along).max() == pytest.approx(1.0, abs=0.02)
    assert np.abs(corners @ [-along[1], along[0]]).max() == pytest.approx(0.5, abs=0.02)
