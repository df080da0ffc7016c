"""How fast it is: printed as tables and written to ``benchmark.json`` in the current folder. No clock fails a test.

``make benchmark``. Figures mean something on a machine that does nothing else.
"""

import json
import os
import platform
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from flight_in_process import MISSIONS  # noqa: E402
from flying import AIRFRAME, Body  # noqa: E402
from test_mpc import DEFAULT, STAGES, error_of  # noqa: E402

from gcs.config import read_system  # noqa: E402
from gcs.mavlink.codec import Codec, gather  # noqa: E402
from gcs.mavlink.setpoints import attitude_target  # noqa: E402
from vehicle_sim.autopilot.autopilot import Autopilot  # noqa: E402
from vehicle_sim.autopilot.parameter_table import vehicle_parameters  # noqa: E402
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint  # noqa: E402
from vehicle_sim.world.world import World  # noqa: E402

RESULTS: dict[str, object] = {}


@pytest.fixture(scope="module", autouse=True)
def report():
    """Writes what was measured, whatever happened."""
    yield
    machine = {"python": platform.python_version(), "machine": platform.machine(), "cores": os.cpu_count()}
    Path("benchmark.json").write_text(json.dumps({"machine": machine, **RESULTS}, indent=2) + "\n")


def show(title, columns, rows):
    table = Table(*columns, title=title)
    for row in rows:
        table.add_row(*(f"{value:.3g}" if isinstance(value, float) else str(value) for value in row))
    Console(width=100).print(table)


def pinned(cores):
    """The flight's processes on so many cores."""
    available = sorted(os.sched_getaffinity(0))[:cores]
    return lambda: os.sched_setaffinity(0, available)


@pytest.mark.parametrize("cores", [1, 2])
def test_a_whole_flight_in_lockstep(tmp_path, cores):
    """World, four vehicles, MAVLink bytes, estimator, controller and records: the figure eight from pad to pad."""
    command = [sys.executable, "-m", "gcs", "fly", str(MISSIONS / "figure_eight.toml"), "--seed", "1", "--json"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [*command, "--run-dir", str(tmp_path / "run")], env=environment, capture_output=True, text=True,
        preexec_fn=pinned(cores),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    step = summary["step_time_ms"]
    RESULTS[f"flight_on_{cores}_cores"] = {
        "real_time_factor": summary["real_time_factor"], "step_time_ms": step, "solver": summary["solver"]
    }  # fmt: skip
    rows = [
        ("real-time factor", summary["real_time_factor"], "aim: 5 on one core"),
        ("control step, median (ms)", step["p50"], ""),
        ("control step, p99 (ms)", step["p99"], "aim: below 10"),
        ("control step, greatest (ms)", step["max"], ""),
    ]
    show(f"figure eight in lockstep, four vehicles, {cores} core(s)", ("", "measured", ""), rows)


def seconds_of(function, repetitions):
    """Median time of one call (s)."""
    times = []
    for _ in range(repetitions):
        begin = time.perf_counter()
        function()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def test_steps_in_parallel():
    """What a part costs against a yardstick of the same machine: ratios travel between machines, times do not."""
    A = np.random.default_rng(1).standard_normal((60, 60))
    yardstick = seconds_of(lambda: np.linalg.solve(A, A), 300)

    small = error_of(r_0=(0.01, 0.0, 0.0))
    active = error_of(Theta=(np.radians(4.5), 0.0, 0.0), omega=(0.4, 0.0, 0.0))
    codec, reader = Codec(255, 190), Codec(1, 1)
    message = attitude_target(1, 1.0, (0.0, 0.0, -1.0), 14.0, 30.0)
    position = mavlink.MAVLink_local_position_ned_message(1, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    datagram = gather([codec.encode(position)] * 4)[0]
    assert DEFAULT.track(small, STAGES).iterations == 0
    assert DEFAULT.track(active, STAGES).iterations > 0
    parts = {
        "solve of 60 x 60, the yardstick": yardstick,
        "MPC, no constraint active": seconds_of(lambda: DEFAULT.track(small, STAGES), 300),
        "MPC, constraints active (ProxQP)": seconds_of(lambda: DEFAULT.track(active, STAGES), 100),
        "encode one set-point": seconds_of(lambda: codec.encode(message), 2000),
        "decode a datagram of four messages": seconds_of(lambda: reader.decode(datagram), 2000),
        "onboard loop, one vehicle": _onboard(),
        "physics step, four vehicles": _physics(),
    }
    RESULTS["parts_us"] = {name: value * 1e6 for name, value in parts.items()}
    rows = [(name, value * 1e6, value / yardstick) for name, value in parts.items()]
    show("parts", ("", "us", "yardsticks"), rows)


def _onboard():
    body = Body()
    autopilot = Autopilot(AIRFRAME, vehicle_parameters(AIRFRAME, 1, 250))
    measured = body.measure()
    setpoint = AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5, 0)
    autopilot.step(measured, 0.0)
    autopilot.enter_offboard(setpoint, 0.0, 0.0)
    autopilot.arm(0.0)
    now = iter((np.arange(1, 100_000) * 0.004).tolist())

    def step():
        time = next(now)
        autopilot.follow(setpoint, time)
        return autopilot.step(measured, time)

    assert min(step()) > 0.0  # its rotors turn
    return seconds_of(step, 2000)


def _physics():
    system = read_system(MISSIONS / "system.toml").parameters()
    with World(system) as world:
        thrusts, torques = [14.0] * 4, [(0.0, 0.0, 0.0)] * 4
        return seconds_of(lambda: world.step(thrusts, torques), 2000)
