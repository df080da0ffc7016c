"""Run folders as they are read, and their reports: whole, cut off, damaged."""

import numpy as np
import pytest
from recorded_run import BALL, write_reference, write_truth

from gcs.errors import UnusableInput
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder, write_json
from gcs.record.tables import OBSTACLE_COLUMNS
from gcs.view.page import report
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from vehicle_sim.world.obstacle_bodies import Obstacle

PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def folder(tmp_path):
    return open_run_folder("hover", tmp_path / "run")  # the manifest is still empty


def flyby(time):
    return (Obstacle("moving, by name", Sphere(0.5), (20.0 - time, 5.0, -5.0)),)


def test_every_obstacle_has_its_place_at_every_time(folder):
    standing = [Obstacle("tree", Pole(0.4, 10.0), (3.0, 9.0, -5.0))]
    standing += [Obstacle(f"wall {k}", Wall((1.0, 2.0, 3.0), 0.5), (3.0, -9.0 - k, -5.0)) for k in range(400)]
    write_truth(folder, standing=standing, moving=flyby)
    header, *rows = (folder / "obstacles.csv").read_text().splitlines()
    assert header == ",".join(OBSTACLE_COLUMNS)
    assert len(rows) == 401 + 101  # what stands once, what moves at the times of the truth
    assert rows[401] == '0.0,"moving, by name",sphere,20.0,5.0,-5.0,0.5,0.0,0.0,0.0,0.0'
    run = read_run(folder)
    assert [(t.name, t.shape) for t in run.obstacles[:2]] == [
        ("tree", Pole(0.4, 10.0)),
        ("wall 0", Wall((1.0, 2.0, 3.0), 0.5)),
    ]
    places = np.stack([track.position for track in run.obstacles])
    assert places.shape == (402, 101, 3)
    assert (places[:401] == np.array([obstacle.position_in_world for obstacle in standing])[:, None]).all()
    assert places[401, [50, 100]].tolist() == [[15.0, 5.0, -5.0], [10.0, 5.0, -5.0]]


def test_rows_of_what_stands_at_every_time_are_read_as_well(folder):
    write_truth(folder, moving=lambda time: [BALL])  # as records of format 2 have them
    assert (read_run(folder).obstacles[0].position == BALL.position_in_world).all()


@pytest.mark.slow
def test_report_is_written_again_and_again(folder):
    write_truth(folder, standing=[BALL])
    write_reference(folder)
    limits = {name: {"value": 1.0, "limit": 0.7, "held": True} for name in ("payload_tilt_deg", "uav_separation")}
    write_json(folder / "summary.json", {"outcome": "completed", "limits": limits})
    for _ in range(2):
        assert report(read_run(folder)) == [folder / "report.html", folder / "poster.png"]
        assert (folder / "poster.png").read_bytes().startswith(PNG)
        assert "<title>run, seed None: completed</title>" in (folder / "report.html").read_text()


def test_killed_run_is_reported_to_its_last_record(folder):
    write_truth(folder, rows=30, moving=flyby)
    for name, cut in (("truth.csv", 5), ("obstacles.csv", 200)):
        content = (folder / name).read_bytes()
        (folder / name).write_bytes(content[:-cut])
    run = read_run(folder)
    assert len(run.time) == 29
    assert np.isnan(run.clearance[-1]) and np.isfinite(run.clearance[0])
    assert len(report(run)) == 2
    assert "cut off" in (folder / "report.html").read_text()


def test_folder_without_records_is_refused(tmp_path):
    with pytest.raises(UnusableInput, match="absent: is not a folder"):
        read_run(tmp_path / "absent")
    with pytest.raises(UnusableInput, match=r"is not a run folder: it holds no manifest\.json"):
        read_run(tmp_path)
    with pytest.raises(UnusableInput, match="nothing was flown"):
        report(read_run(open_run_folder("hover", tmp_path / "run")))


@pytest.mark.parametrize(
    ("file", "content", "reason"),
    [
        ("manifest.json", "{", r"manifest\.json: is not JSON"),
        ("manifest.json", "[1]", r"manifest\.json: is not a JSON object"),
        ("reference.csv", "time_s,x_m\n0.0,1.0\n", r"reference\.csv, line 1: column y_m is missing"),
        ("truth.csv", "time_s,uav1_thrust_n\n0.0,1.0\n", r"truth\.csv, line 1: column payload_x_m is missing"),
        ("obstacles.csv", f"{','.join(OBSTACLE_COLUMNS)}\n0,a,cone,0,0,0,0,0,0,0,0\n", "obstacle a: shape is 'cone'"),
        ("obstacles.csv", f"{','.join(OBSTACLE_COLUMNS)}\n0,a,mesh,0,0,0,0,0,0,0,0\n", r"obstacle_shapes\.json"),
    ],
)
def test_damaged_runs_are_refused_with_the_file(folder, file, content, reason):
    write_truth(folder)
    (folder / file).write_text(content)
    with pytest.raises(UnusableInput, match=reason):
        report(read_run(folder))
