"""The cost of parts of a flight: printed as a table and written to ``benchmark.json`` in the current folder.

``make benchmark-parts``. Figures are CPU times in yardsticks; none of them fails a test.
"""

import json
import os
import platform
import sys
from pathlib import Path

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from flights import MISSIONS  # noqa: E402
from flying import AIRFRAME, Body  # noqa: E402
from onboard import step_alone  # noqa: E402
from test_mpc import DEFAULT, STAGES, error_of  # noqa: E402
from test_range_sensor import LEVEL, estimate_at, random_shape  # noqa: E402
from yardstick import in_yardsticks  # noqa: E402

from gcs.config import RangeSensorConfig, read_system  # noqa: E402
from gcs.mavlink.codec import Codec, gather  # noqa: E402
from gcs.mavlink.setpoints import attitude_target  # noqa: E402
from idc_controller.geometry.pole import Pole  # noqa: E402
from vehicle_sim.autopilot.autopilot import Autopilot  # noqa: E402
from vehicle_sim.autopilot.parameter_table import vehicle_parameters  # noqa: E402
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint  # noqa: E402
from vehicle_sim.world.range_sensor import RangeSensor  # noqa: E402
from vehicle_sim.world.ray_bodies import RayBodies  # noqa: E402
from vehicle_sim.world.world import World  # noqa: E402

RESULTS: dict[str, object] = {}


@pytest.fixture(scope="module", autouse=True)
def report():
    """Writes what was measured, whatever happened."""
    yield
    machine = {"python": platform.python_version(), "machine": platform.machine(), "cores": os.cpu_count()}
    Path("benchmark.json").write_text(json.dumps({"machine": machine, **RESULTS}, indent=2) + "\n")


def show(title, rows):
    table = Table("", "yardsticks", title=title)
    for name, value in rows.items():
        table.add_row(name, f"{value:.3g}")
    Console(width=100).print(table)


def test_cost_of_parts():
    small = error_of(r_0=(0.01, 0.0, 0.0))
    active = error_of(Theta=(np.radians(4.5), 0.0, 0.0), omega=(0.4, 0.0, 0.0))
    codec, reader = Codec(255, 190), Codec(1, 1)
    message = attitude_target(1, 1.0, (0.0, 0.0, -1.0), 14.0, 30.0)
    position = mavlink.MAVLink_local_position_ned_message(1, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    datagram = gather([codec.encode(position)] * 4)[0]
    assert DEFAULT.track(small, STAGES).iterations == 0
    assert DEFAULT.track(active, STAGES).iterations > 0
    parts = {
        "MPC, no constraint active": in_yardsticks(lambda: DEFAULT.track(small, STAGES), 300),
        "MPC, constraints active (ProxQP)": in_yardsticks(lambda: DEFAULT.track(active, STAGES), 100),
        "encode one set-point": in_yardsticks(lambda: codec.frame(message), 2000),
        "decode a datagram of four messages": in_yardsticks(lambda: reader.decode(datagram), 2000),
        "onboard loop, one vehicle": onboard(),
        "physics step, four vehicles": physics(),
        "one scan, 3 obstacles in reach": scan(3),
        "one scan, 200 obstacles in reach": scan(200),
    }
    RESULTS["parts_yardsticks"] = parts
    show("parts", parts)


def onboard():
    body = Body()
    autopilot = Autopilot(AIRFRAME, vehicle_parameters(AIRFRAME, 1, 250))
    measured = body.measure()
    setpoint = AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5, 0)
    step_alone(autopilot, measured, 0.0)
    autopilot.enter_offboard(setpoint, 0.0, 0.0)
    autopilot.arm(0.0)
    now = iter((np.arange(1, 100_000) * 0.004).tolist())

    def step():
        time = next(now)
        autopilot.follow(setpoint, time)
        return step_alone(autopilot, measured, time)

    assert min(step()) > 0.0  # its rotors turn
    return in_yardsticks(step, 2000)


def scan(count):
    rng = np.random.default_rng(1)
    places = rng.uniform(-9.0, 9.0, (count, 2))
    bodies = RayBodies.of(
        [(Pole(0.2, 15.0) if k % 2 else random_shape(rng, k % 6), (x, y, -7.5)) for k, (x, y) in enumerate(places)]
    )
    sensor, place = RangeSensor(RangeSensorConfig(), 1, 1), (0.1, 0.2, -9.0)
    return in_yardsticks(lambda: sensor.scan(0.0, 0, place, LEVEL, estimate_at(place), bodies), 400)


def physics():
    system = read_system(MISSIONS / "system.toml").parameters()
    with World(system) as world:
        thrusts, torques = [14.0] * 4, [(0.0, 0.0, 0.0)] * 4
        return in_yardsticks(lambda: world.step(thrusts, torques), 2000)
