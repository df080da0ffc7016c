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

from check import is_dearer  # noqa: E402
from growth import calls_of_a_control_step  # noqa: E402
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


@pytest.mark.slow
def test_calls_of_a_control_step_are_the_same_at_each_run():
    _, second, third = (calls_of_a_control_step("hop", 1.0, 2.0) for _ in range(3))  # the first imports
    assert second == third > 100
