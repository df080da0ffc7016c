"""``gcs reproduce``: the command as a whole on a plan of seconds, and docs/paper.md against its numbers."""

import csv
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from small_campaign import InThisThread

from gcs.app.cli import main
from gcs.app.commands import reproduce as command
from gcs.record.clearance import ObstacleTrack
from gcs.record.run_data import RunData, RunTables
from gcs.reproduce import figures
from gcs.reproduce.numbers import flight_numbers, model_numbers
from gcs.reproduce.page import ABSENT, paper_text, rounded
from gcs.reproduce.plan import plan
from gcs.reproduce.simulation import Flown, simulate
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.rotations import quaternion_from_euler

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def quoted():
    """The numbers of the full run that docs/paper.md quotes."""
    return json.loads((DOCS / "paper_numbers.json").read_text(encoding="utf-8"))


def test_document_quotes_the_numbers_of_a_full_run(quoted):
    assert not quoted["quick"]
    assert (DOCS / "paper.md").read_text(encoding="utf-8") == paper_text(quoted)
    assert ABSENT not in re.sub(r"`[^`]*`", "", paper_text(quoted))


def compare(got, expected, path=""):
    if isinstance(expected, dict):
        assert got.keys() == expected.keys(), path
        for name in expected:
            compare(got[name], expected[name], f"{path}.{name}")
    elif isinstance(expected, float):
        # Rounding errors themselves differ from machine to machine.
        assert got == pytest.approx(expected, rel=0.02, abs=1e-6), path
    else:
        assert got == expected, path


def test_quoted_numbers_of_model_agree_with_model(quoted):
    compare(rounded(model_numbers()), quoted["model"])


@pytest.mark.parametrize(
    ("section", "name"),
    [
        pytest.param("tracking", "outputs", marks=pytest.mark.long),
        pytest.param("mass", "printed_2.7", marks=pytest.mark.long),
        ("margin", "printed_1"),
    ],
)
def test_quoted_numbers_of_simulations_agree_with_simulations(quoted, section, name):
    case = plan(quick=False).cases[section, name]
    got = simulate(case).numbers()
    got.pop("effort_change_percent", None)
    expected = {key: value for key, value in quoted[section][name].items() if key != "effort_change_percent"}
    compare(rounded(got), expected)


def test_full_plan_has_all_quoted_numbers(quoted):
    whole = plan(quick=False)
    for section, name in whole.cases:
        assert name in quoted[section], (section, name)
    assert set(whole.flights) == set(quoted["flights"])
    quick = plan(quick=True)
    assert not quick.flights
    assert set(quick.cases) < set(whole.cases)
    # Cases of the studies are the same in both: their numbers can be compared.
    for key in quick.cases:
        if key[0] in ("mass", "margin", "noise"):
            assert quick.cases[key] == whole.cases[key]


def test_missing_number_in_text_is_reported():
    text = paper_text({"model": {"state": 60}})
    assert "= 60 for N = 4" in text
    assert ABSENT in text


def short_plan(quick):
    whole = plan(quick)
    kept = {}
    for key, case in whole.cases.items():
        if key[0] in ("tracking", "avoidance"):
            kept[key] = replace(case, duration=0.2)
        elif key[1] in ("printed_2.7", "printed_3", "printed_0.25", "printed_0.008_1"):
            kept[key] = replace(case, duration=0.1)
    return replace(whole, cases=kept, frames=2)


def test_command_fills_a_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(command, "plan", short_plan)
    monkeypatch.setattr("gcs.reproduce.work.WorkerProcesses", InThisThread)
    out = tmp_path / "deep" / "out"
    assert main(["reproduce", "--quick", "--out", str(out), "--jobs", "1"]) == 0
    said = capsys.readouterr().out
    assert "index.html" in said
    assert "tracking project" in said
    page = (out / "index.html").read_text(encoding="utf-8")
    assert "Quick run" in page
    pictures = re.findall(r'img src="([^"]+)"', page)
    assert {"trackxyz.png", "attrpy.png", "trackObsxyz.png", "attObsrpy.png", "anim3d.png", "animObs3d.png",
            "sigmavsdev.png", "mass.png", "margin.png", "anim3d.gif", "animObs3d.gif"} == set(pictures)  # fmt: skip
    for name in pictures:
        with Image.open(out / name) as image:
            assert image.size[0] > 300
            assert getattr(image, "n_frames", 1) == (2 if name.endswith(".gif") else 1)
    found = json.loads((out / "numbers.json").read_text(encoding="utf-8"))
    assert found["tracking"]["project"]["lost_at_s"] is None
    text = (out / "paper.md").read_text(encoding="utf-8")
    assert text == paper_text(found, links=False) and "](" not in text and "](" in paper_text(found)
    with (out / "matrices" / "A.csv").open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert len(rows) == len(rows[0]) == 61
    assert rows[0][1:4] == ["r_0_x", "r_0_y", "r_0_z"]
    assert np.array([row[1:] for row in rows[1:]], dtype=float)[0, 3] == pytest.approx(0.05)


def test_simulations_repeat():
    case = replace(plan(quick=True).cases["noise", "printed_0.008_1"], duration=1.0)
    first, second = simulate(case), simulate(case)
    # Within one process sums may differ in the last digit, with where arrays happen to lie in memory.
    np.testing.assert_allclose(first.position, second.position, rtol=0.0, atol=1e-9)
    assert np.abs(simulate(replace(case, seed=2)).position - first.position).max() > 1e-6


def recorded(folder, tilt_deg, contacts):
    """A flight north at 1 m/s past a pole and a sphere, that tips over when ``tilt_deg`` (T,) says."""
    T = len(tilt_deg)
    time = 0.1 * np.arange(T)
    position = np.column_stack([time, np.zeros(T), np.full(T, -5.0)])
    quaternion = np.array([quaternion_from_euler(np.radians(a), 0.0, 0.0) for a in tilt_deg])
    level = np.tile([1.0, 0.0, 0.0, 0.0], (T, 4, 1))
    uavs = position[:, None] + np.array([[0.5, 0.5, -3.4], [0.5, -0.5, -3.4], [-0.5, -0.5, -3.4], [-0.5, 0.5, -3.4]])
    obstacles = (
        ObstacleTrack("pole", Pole(0.3, 10.0), np.tile([3.0, 2.0, -5.0], (T, 1))),
        ObstacleTrack("wall", Wall((4.0, 0.3, 10.0)), np.tile([3.0, 4.0, -5.0], (T, 1))),
        ObstacleTrack("ball", Sphere(0.5), np.tile([6.0, 0.0, -5.0], (T, 1))),
    )
    summary = {
        "outcome": "collided", "clearance_min_m": 0.0, "contacts": 3, "uav_separation_min_m": 1.0, "duration_s": 6.0,
        "payload_tilt_max_deg": {"roll": 80.0, "pitch": 0.0, "yaw": 0.0}, "position_rmse_m": {"total": 1.0},
    }  # fmt: skip
    return RunData(
        folder, "truth", time, position, quaternion, np.zeros((T, 3)), uavs, level, np.full((T, 4), 14.0),
        np.array(contacts), obstacles, RunTables(folder), {}, summary,
    )  # fmt: skip


def test_flight_numbers_cover_time_to_first_contact(tmp_path):
    tilt, contacts = np.zeros(60), np.zeros(60)
    tilt[20], tilt[57:], contacts[56:] = 7.0, 80.0, 1
    run = recorded(tmp_path, tilt, contacts)
    quoted_values = flight_numbers(run)
    assert quoted_values["first_contact_s"] == pytest.approx(5.6)
    assert quoted_values["touched_first"] == "ball"
    assert quoted_values["tilt_max_before_contact_deg"] == pytest.approx(7.0)
    contacts[10] = 1  # far from everything
    early = flight_numbers(recorded(tmp_path, tilt, contacts))
    assert early["touched_first"] == "one UAV another"
    none = flight_numbers(recorded(tmp_path, np.zeros(60), np.zeros(60)))
    assert none["first_contact_s"] is None
    runs = {"idc": recorded(tmp_path, np.zeros(60), np.zeros(60)), "paper": run}
    for draw in (figures.draw_course, figures.draw_course_position):
        draw(runs, tmp_path / "picture.png")
        with Image.open(tmp_path / "picture.png") as image:
            assert image.size[0] > 300


def test_avoidance_intervals_close_short_gaps():
    avoiding = np.zeros(100, dtype=bool)
    avoiding[[10, 11, 15, 60]] = True
    rest = np.zeros((100, 3))
    flown = Flown((), 0.0, 0.0, np.arange(100) * 0.05, rest, rest, rest, rest, rest, rest, avoiding, rest)
    np.testing.assert_allclose(flown.avoidance_intervals(), [(0.5, 0.8), (3.0, 3.05)])
