"""The command ``vehicle-sim --free`` with a client of its own."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from programs import ENVIRONMENT, PATIENCE, swarm_process

from gcs.record.reader import read_table

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "free_lockstep.py"


def fly(folder):
    """Fly the example; returns what it prints."""
    with swarm_process(
        "--free", "--vehicles", 1, "--lockstep", "--base-port", 0, "--run-dir", folder, "--quiet"
    ) as swarm:
        ports = {}
        for line in swarm.stdout:
            if line.startswith("ready"):
                break
            name, _, address = line.partition(": ")
            ports[name] = address.strip().rpartition(":")[2]
        done = subprocess.run(
            [sys.executable, EXAMPLE, ports["vehicle 1"], ports["clock"]],
            env=ENVIRONMENT, capture_output=True, text=True, timeout=PATIENCE, check=True,
        )  # fmt: skip
        swarm.send_signal(signal.SIGTERM)
        assert swarm.wait(PATIENCE) == 0
        assert done.stderr == "" and swarm.stderr.read() == ""
    return done.stdout


@pytest.mark.slow
def test_script_in_lockstep_flies_the_same_bytes_twice(tmp_path):
    first, second = fly(tmp_path / "first"), fly(tmp_path / "second")
    assert first == second
    assert first.startswith("landed at")
    for name in ("truth.csv", "modes.csv"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()
    truth = read_table(tmp_path / "first" / "truth.csv")
    assert -truth["uav1_z_m"].min() == pytest.approx(5.0, abs=0.5)
    modes = read_table(tmp_path / "first" / "modes.csv")
    assert modes["mode"].tolist() == ["AUTO.LOITER", "OFFBOARD", "AUTO.LAND", "AUTO.LOITER"]
