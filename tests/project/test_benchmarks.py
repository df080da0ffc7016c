"""The benchmark's anchor flies, its missions can be read, and its check reports more cost, but no scatter."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from gcs.mission.read import read_mission

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))

from benchmark import add_to_history, exponents, memory, ratios  # noqa: E402
from check import is_dearer  # noqa: E402
from growth import calls_of_a_control_step, size  # noqa: E402
from measure import FLIGHTS, ROOT, write_missions  # noqa: E402


def test_anchor_flies_its_circle():
    command = [sys.executable, str(BENCHMARKS / "anchor.py"), "--equal", "--seconds", "5"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    figures = json.loads(done.stdout.splitlines()[-1])
    assert figures["loop"] == "equal loop"
    assert 0.0 < figures["step_ms"]["p50"] <= figures["step_ms"]["p99"] <= figures["step_ms"]["max"]
    assert figures["ms_per_second"] >= 48 * figures["step_ms"]["p50"] * 0.5


def test_missions_of_the_benchmark_are_flown_clear_of_their_obstacles(tmp_path):
    missions = {name: read_mission(path) for name, path in write_missions(ROOT, tmp_path, 5.0).items()}
    assert {name: len(mission.obstacles) for name, mission in missions.items()} == dict(
        zip(FLIGHTS, (0, 2, 200), strict=True)
    )
    assert all(obstacle.known for obstacle in missions["obstacles_200"].obstacles)


@pytest.mark.parametrize(
    ("ratios", "dearer"),
    [
        ([1.12, 1.15, 1.11, 1.2, 1.13], True),
        ([1.08, 1.09, 1.02, 1.2, 1.06], False),  # 8 %: within the limit
        ([1.3, 1.2, 0.95, 1.11, 1.12], False),  # one round the other way round: scatter
    ],
)
def test_check_finds_cost_above_the_limit_and_beyond_the_spread(ratios, dearer):
    assert is_dearer(np.array(ratios).tolist()) == dearer


STEPS = {"p50": 5.0, "p99": 10.0, "max": 20.0}


@pytest.fixture
def measured(monkeypatch):
    """Flights that cost 10 ms a vehicle and 1 ms an obstacle, beside an anchor of 80 ms; 6 MB an hour."""

    def fly(tree, mission, *options):
        vehicles = int(options[1]) if "--vehicles" in options else 4
        text = Path(mission).read_text()
        memory = [[time, 100.0 + time / 600.0, 80.0] for time in range(0, 600, 10)]
        cost = 10.0 * vehicles + text.count("[[obstacle]]")
        parts = {"telemetry": STEPS, "control": STEPS}
        return {"ms_per_second": cost, "step_ms": STEPS, "parts_ms": parts, "memory_mb": memory}

    monkeypatch.setattr("benchmark.fly", fly)
    monkeypatch.setattr("benchmark.anchor", lambda: {"loop": "anchor", "ms_per_second": 80.0, "step_ms": STEPS})


def test_benchmark_gives_speed_relative_to_the_anchor(measured, tmp_path):
    row = ratios(tmp_path, 2, 5.0)
    assert (row["figure_eight_median"], row["figure_eight_min"], row["figure_eight_max"]) == (2.0, 2.0, 2.0)
    assert row["two_spheres_median"] == pytest.approx(80.0 / 42.0, abs=1e-3)
    assert (row["obstacles_200_step_p99_ms"], row["anchor_step_p50_ms"]) == (10.0, 5.0)


def test_benchmark_fits_exponents_and_memory(measured, tmp_path):
    assert exponents(tmp_path, 5.0) == {"vehicles_exponent": 1.0, "obstacles_exponent": 1.0}
    assert memory(tmp_path, 10.0) == {"memory_minutes": 10.0, "ground_mb_per_hour": 6.0, "world_mb_per_hour": 0.0}


def test_size_is_that_of_a_tree(tmp_path):
    for name, text in {
        "gcs/__init__.py": '"""The ground."""\n\n__all__ = ["fly", "Flight"]\n', "idc_controller/__init__.py": "",
        "vehicle_sim/world.py": "a = 1\n", "tests/test_a.py": "assert 1\n" * 7,
        "docs/settings.md": "| key | default |\n|---|---|\n| `a` | 1 |\n| `b` | 2 |\n",
    }.items():  # fmt: skip
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    found = size(tmp_path)
    assert found == {"product_lines": 4, "test_lines": 7, "modules": 3, "settings": 2, "public_names": 2}


@pytest.mark.slow
def test_calls_of_a_control_step_are_the_same_at_each_run():
    _, second, third = (calls_of_a_control_step("hop", 1.0, 2.0) for _ in range(3))  # the first imports
    assert second == third > 100


def test_history_keeps_earlier_rows_when_a_column_is_new(tmp_path, monkeypatch):
    monkeypatch.setattr("benchmark.HISTORY", tmp_path / "history.csv")
    monkeypatch.setattr("benchmark.ROOT", tmp_path)
    add_to_history({"date": "2026-01-01", "speed": 1.0})
    add_to_history({"date": "2026-01-02", "speed": 1.5, "memory": 3.0})
    lines = (tmp_path / "history.csv").read_text().splitlines()
    assert lines == ["date,speed,memory", "2026-01-01,1.0,", "2026-01-02,1.5,3.0"]
