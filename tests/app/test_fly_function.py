"""``gcs.fly``: a flight within this process. It has the bytes of ``gcs fly``, and leaves nothing behind."""

import gc
import json
import os
import re
import runpy
import shutil
import signal
import subprocess
import sys
import weakref
from dataclasses import replace
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from programs import ENVIRONMENT, gcs_fly

import gcs
from gcs import extras
from gcs.app import in_process
from gcs.app.imports import importing
from gcs.app.in_process import FlightInProcess
from gcs.errors import GcsError, UnusableInput
from gcs.faults.link import PacketLoss
from gcs.mission.model import Fault, Limits, Mission
from gcs.mission.read import read_mission
from gcs.mission.toml_mission import route_through
from gcs.record.landing import in_air
from gcs.record.run_data import read_run
from gcs.record.run_folder import write_manifest
from gcs.record.tables import (
    ESTIMATE_COLUMNS,
    HORIZON_COLUMNS,
    INNOVATION_COLUMNS,
    OBSTACLE_COLUMNS,
    PLAN_COLUMNS,
    REFERENCE_COLUMNS,
    force_columns,
    truth_columns,
)

ROOT = Path(__file__).parents[2]
HOP = ROOT / "missions" / "hop.toml"
LOW_HOP = """
[mission]
name = "low hop"
seed = 3

[reference]
kind = "waypoints"
points = [[0.0, 0.0, -0.5]]

[[obstacle]]
name = "ball"
shape = "sphere"
position = [5.0, 1.0, -3.5]
radius = 0.5
known = false

[[fault]]
kind = "packet_loss"
start = 1.0
probability = 0.2

[[fault]]
kind = "latency"
start = 0.0
delay = 0.02
vehicles = [2]
"""
SAME = (
    "truth.csv", "forces.csv", "estimate.csv", "innovations.csv", "plan.csv", "horizon.csv", "reference.csv",
    "alarms.csv", "modes.csv", "phases.csv",
)  # fmt: skip


def same_bytes(first, second, names=SAME):
    return all((first / name).read_bytes() == (second / name).read_bytes() for name in names)


# What is refused


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"seed": -1}, "seed -1 is not a whole number from 0"),
        ({"seed": 1.5}, "seed 1.5 is not a whole number"),
        ({"config": "nothing.toml"}, "nothing.toml: cannot be read"),
        ({"settings": {"avoidance.margn": 0.3}}, "there is no 'avoidance.margn': did you mean 'avoidance.margin'?"),
        ({"settings": {"payload_mass_factor": 1.1}}, "did you mean 'world.payload_mass_factor'?"),
        ({"settings": {"avoidance.margin": -0.3}}, "settings: avoidance.margin: must be greater than 0, found -0.3"),
        ({"settings": {"motion.speed": 99.0}}, "settings: motion.speed: 99.0 is more than speed_max"),
        ({"settings": {"team.vehicles": 40}}, "40 vehicles"),
        ({"controller": "pid"}, "controller 'pid' is none of idc, mpc, paper"),
        ({"faults": [{"kind": "paket_loss", "start": 0.0}]}, "fault[1].kind: there is no kind 'paket_loss'"),
        ({"faults": [PacketLoss(probability=0.1), {"kind": "packet_loss", "start": 0.0, "probability": 0.1,
                                                   "vehicles": [9]}]}, "fault[2].vehicles: there is no vehicle 9"),
        ({"faults": ["wind"]}, "faults: 'wind' are not the parameters of a kind"),
        ({"limits": {"rmse": 0.1}}, "limits: rmse: unknown key"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, dict) else "",
)  # fmt: skip
def test_what_cannot_be_flown_is_refused(tmp_path, options, reason):
    with pytest.raises(UnusableInput, match=re.escape(reason)):
        gcs.fly(HOP, run_dir=tmp_path / "run", **options)
    assert not (tmp_path / "run").exists()


def test_missing_mission_and_used_run_folder_are_refused(tmp_path):
    with pytest.raises(UnusableInput, match="cannot be read"):
        gcs.fly(tmp_path / "hop.toml")
    (tmp_path / "notes.txt").touch()
    with pytest.raises(UnusableInput, match="the run folder is not empty"):
        gcs.fly(HOP, run_dir=tmp_path)


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        (Fault("paket_loss", 0.0), "mission: fault[1].kind: there is no kind 'paket_loss'"),
        (Fault("packet_loss", 0.0, vehicles=(9,), settings={"probability": 0.1}), "there is no vehicle 9"),
    ],
)
def test_mission_built_with_an_unusable_fault_is_refused(fault, reason):
    with pytest.raises(UnusableInput, match=re.escape(reason)):
        gcs.fly(replace(read_mission(HOP), faults=(fault,)))


def test_installation_without_a_world_is_an_error(tmp_path, monkeypatch):
    monkeypatch.setattr(extras, "entry_points", lambda group: ())
    with pytest.raises(GcsError, match=r"no simulated world is installed \(entry points cooplift.world\)"):
        gcs.fly(HOP)


def test_world_is_that_of_an_entry_point(monkeypatch):
    def world(mission, run_dir):
        raise UnusableInput(f"no {mission.name} in this world")

    monkeypatch.setitem(sys.modules, "another_engine", SimpleNamespace(world=world))
    entry = EntryPoint("another", "another_engine:world", in_process.WORLDS)
    monkeypatch.setattr(extras, "entry_points", lambda group: EntryPoints([entry]))
    with pytest.raises(UnusableInput, match="no hop in this world"):
        gcs.fly(HOP)


def test_unknown_attribute_of_the_package_is_one():
    with pytest.raises(AttributeError, match="module 'gcs' has no attribute 'land'"):
        gcs.land


def test_import_of_the_package_loads_nothing_and_sets_nothing():
    code = (
        "import os, sys; before = dict(os.environ); import gcs; assert dict(os.environ) == before; "
        "print([name for name in sys.modules if name.split('.')[0] in ('numpy', 'scipy', 'pydantic', 'pybullet')])"
    )
    done = subprocess.run([sys.executable, "-c", code], env=ENVIRONMENT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("collects", [True, False])
def test_import_of_nothing_new_leaves_the_collection_of_garbage_as_it_was(collects):
    frozen = gc.get_freeze_count()
    if not collects:
        gc.disable()
    try:
        with importing():
            assert not gc.isenabled()
        assert gc.isenabled() is collects and gc.get_freeze_count() <= frozen  # what was frozen may end
    finally:
        gc.enable()


# What is flown


@pytest.mark.slow
def test_flight_has_its_records_and_leaves_no_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    flight = gcs.fly(HOP, seed=2, limits={"position_rmse": 0.1, "settle": 0.0})
    assert not [*tmp_path.iterdir()] and flight.run_dir is None

    assert (flight.outcome, flight.reason, flight.completed, flight.within_limits) == ("completed", "", True, True)
    assert flight.figures["limits"]["position_rmse"]["limit"] == 0.1
    assert repr(flight) == "<flight hop: completed>"
    assert eval(flight.replay.replace("gcs.fly", "dict").replace("(", "(mission=", 1)) == {
        "mission": str(HOP), "seed": 2, "limits": {"position_rmse": 0.1, "settle": 0.0},
    }  # fmt: skip
    assert flight.truth.dtype.names == truth_columns(4)
    assert flight.reference.dtype.names == REFERENCE_COLUMNS
    assert flight.estimate.dtype.names == ESTIMATE_COLUMNS
    assert flight.plan.dtype.names == PLAN_COLUMNS
    assert flight.forces.dtype.names == force_columns(4)
    assert flight.innovations.dtype.names == INNOVATION_COLUMNS
    assert flight.horizon.dtype.names == HORIZON_COLUMNS
    assert flight.obstacles.dtype.names == OBSTACLE_COLUMNS and len(flight.obstacles) == 0
    assert len(flight.alarms) == 0 and flight.faults == ()
    assert -flight.truth["payload_z_m"].min() == pytest.approx(0.8, abs=0.05)
    assert np.interp(9.0, flight.estimate["time_s"], flight.estimate["payload_z_m"]) == pytest.approx(
        np.interp(9.0, flight.truth["time_s"], flight.truth["payload_z_m"]), abs=0.02
    )

    # In hover the links carry the payload; the estimate's errors are as large as it says.
    hover = slice(*np.searchsorted(flight.forces["time_s"], [7.0, 9.0]))
    tension = sum(flight.forces[f"link{i}_n"][hover] for i in range(1, 5))
    assert tension.mean() == pytest.approx(3.1 * 9.81, rel=0.003)
    assert flight.forces["time_s"][hover].tolist() == pytest.approx(np.arange(7.0, 9.0, 0.02))
    estimate = flight.estimate[np.searchsorted(flight.estimate["time_s"], 5.0) :]
    for name in ("payload_x_m", "payload_vy_mps", "payload_wz_radps"):
        error = estimate[name] - np.interp(estimate["time_s"], flight.truth["time_s"], flight.truth[name])
        assert 0.4 < np.sqrt(np.mean((error[:100] / estimate[f"{name}_sd"][:100]) ** 2)) < 1.6
    innovations = flight.innovations[flight.innovations["time_s"] > 5.0]
    assert len({*zip(innovations["source"], innovations["channel"], strict=True)}) == 20
    assert np.median(innovations["test_ratio"]) < 0.5 and {*innovations["state"].tolist()} <= {"ok", "rejected"}
    planned = flight.horizon[(flight.horizon["kind"] == "plan") & (flight.horizon["step"] == 0)]
    z = np.interp(planned["time_s"], flight.plan["time_s"], flight.plan["z_m"])
    assert len(planned) > 40 and planned["z_m"] == pytest.approx(z, abs=1e-3)

    setpoints = flight.setpoints
    assert {*setpoints["vehicle"].tolist()} == {1, 2, 3, 4} and np.all(np.diff(setpoints["time_s"]) >= 0.0)
    norm = sum(setpoints[name] ** 2 for name in ("qw", "qx", "qy", "qz"))
    assert norm == pytest.approx(np.ones(len(setpoints)), abs=1e-6)
    first = setpoints[setpoints["vehicle"] == 1]
    assert np.diff(first["time_s"]).min() > 0.04  # no copies: one a control step

    frame = flight.frame("truth")
    assert tuple(frame.columns) == truth_columns(4) and len(frame) == len(flight.truth)
    with pytest.raises(ValueError, match="'steps' is no record: truth, forces, reference"):
        flight.frame("steps")


@pytest.fixture(scope="module")
def commanded(tmp_path_factory):
    """A mission with a flight by the command: (mission's file, run folder, figures)."""
    folder = tmp_path_factory.mktemp("commanded")
    path = folder / "low_hop.toml"
    path.write_text(LOW_HOP)
    _, figures = gcs_fly(path, folder / path.stem, "--seed", 5, "--no-pictures")
    return path, folder / path.stem, figures


@pytest.fixture(scope="module")
def alone(commanded, tmp_path_factory):
    """Two missions, each with a flight by itself: (mission's file, run folder)."""
    folder = tmp_path_factory.mktemp("alone") / HOP.stem
    gcs.fly(HOP, seed=5, run_dir=folder)
    return [(HOP, folder), commanded[:2]]


@pytest.mark.slow
def test_flight_has_the_bytes_of_the_command(tmp_path, commanded):
    path, folder, figures = commanded
    flight = gcs.fly(path, seed=5, run_dir=tmp_path / "call")
    assert {entry.name for entry in flight.run_dir.iterdir()} == {entry.name for entry in folder.iterdir()}
    assert same_bytes(flight.run_dir, folder, (*SAME, "obstacles.csv"))
    assert flight.figures.keys() == figures.keys() - {"run_dir"}
    assert flight.figures["position_rmse_m"] == figures["position_rmse_m"]
    assert [fault["kind"] for fault in flight.faults] == ["packet_loss", "latency"]
    assert all(fault["disturbed"] for fault in flight.faults)
    assert flight.obstacles[["time_s", "name"]].tolist() == [(0.0, "ball")]  # it stands
    run = read_run(flight.run_dir)
    assert flight.figures["clearance_min_m"] == pytest.approx(run.clearance[in_air(run)].min(), abs=1e-6)
    assert len(flight.frame("alarms")) == len(flight.alarms)


@pytest.mark.slow
def test_mission_built_in_python_is_flown_with_settings_and_faults(tmp_path):
    base = read_mission(HOP)
    route = route_through([(0.0, 0.0, -0.6)], 1.0, base.system)
    mission = Mission("built", tmp_path / "built.toml", 4, base.system, route, limits=Limits(position_rmse=1e-4))
    settings, loss = {"world.payload_mass_factor": np.float64(1.1)}, PacketLoss(probability=0.2)
    flight = gcs.fly(mission, settings=settings, faults=[loss], controller="mpc")
    assert flight.completed and not flight.within_limits
    assert repr(flight) == "<flight built: completed, outside its limits (position_rmse None (limit 0.0001))>"
    assert flight.replay.startswith(
        "gcs.fly(mission, settings={'world.payload_mass_factor': 1.1}, controller='mpc', faults=[{'kind': 'packet_loss'"
    )
    [fault] = flight.faults
    assert fault["kind"] == "packet_loss" and fault["disturbed"] > 0
    p, high = base.system.parameters(), flight.truth[flight.truth["payload_z_m"] < -0.5]
    carried = np.mean(sum(high[f"uav{i}_thrust_n"] for i in range(1, 5)))
    assert carried == pytest.approx((1.1 * p.m_0 + p.m.sum()) * p.g, rel=0.02)


def in_folder(mission, folder):
    folder.mkdir()
    write_manifest(folder, command=[], seed=mission.seed, mission=mission, system=mission.system, start="")
    return FlightInProcess(mission, folder)


@pytest.mark.slow
def test_flights_that_take_turns_have_the_bytes_of_flights_alone(tmp_path, alone):
    missions = [replace(read_mission(path), seed=5) for path, _ in alone]
    with in_folder(missions[1], tmp_path / "turns1") as second, in_folder(missions[0], tmp_path / "turns0") as first:
        flights = [first, second]
        while going := [flight for flight in flights if not flight.ended]:
            for flight in going:
                flight.step()
        for flight in flights:
            assert flight.result().summary["outcome"] == "completed"
    for number, (_, folder) in enumerate(alone):
        assert same_bytes(folder, tmp_path / f"turns{number}")


def resident_mb():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


@pytest.mark.slow
@pytest.mark.long
def test_fifty_flights_in_any_order_have_the_bytes_of_flights_alone_and_take_no_memory(tmp_path, alone):
    memory = []
    for number in np.random.default_rng(38).integers(len(alone), size=50).tolist():
        path, folder = alone[number]
        assert gcs.fly(path, seed=5, run_dir=tmp_path / "flown").completed
        assert same_bytes(tmp_path / "flown", folder)
        shutil.rmtree(tmp_path / "flown")
        memory.append(resident_mb())
    # The allocator keeps some pages; what a flight has on record is 20 MB and more.
    assert max(memory[40:]) < max(memory[:10]) + 10.0, memory


def test_flight_that_is_over_takes_no_memory_when_the_next_begins(tmp_path):
    with in_folder(read_mission(HOP), tmp_path / "first") as flight:
        station = weakref.ref(flight.station)
    del flight
    with in_folder(read_mission(HOP), tmp_path / "second"):
        assert station() is None


@pytest.mark.slow
def test_interrupt_lands_the_vehicles_closes_the_records_and_is_raised(tmp_path, monkeypatch):
    step, before = FlightInProcess.step, signal.getsignal(signal.SIGINT)

    def interrupted(self, exchanged):
        if self.now > 4.0 and not self.flight.failsafes.interrupted:
            os.kill(os.getpid(), signal.SIGINT)
        step(self, exchanged)

    monkeypatch.setattr(FlightInProcess, "step", interrupted)
    with pytest.raises(KeyboardInterrupt):
        gcs.fly(HOP, run_dir=tmp_path / "run")
    assert signal.getsignal(signal.SIGINT) == before
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["outcome"] == "interrupted" and summary["landing"]["on_ground"] and summary["contacts"] == 0
    assert (tmp_path / "run" / "truth.csv").read_text().endswith("\n")


@pytest.mark.slow
def test_second_interrupt_ends_the_flight_at_once(tmp_path, monkeypatch):
    def interrupted(self, exchanged):
        for _ in range(2):
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(FlightInProcess, "step", interrupted)
    with pytest.raises(KeyboardInterrupt):
        gcs.fly(HOP, run_dir=tmp_path / "run")
    assert (tmp_path / "run" / "truth.csv").exists() and not (tmp_path / "run" / "summary.json").exists()


@pytest.mark.slow
def test_example_flies(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    runpy.run_path("docs/examples/fly_from_python.py", run_name="__main__")
    printed = capsys.readouterr()
    assert [line.split()[:2] for line in printed.out.splitlines()] == [
        ["0.9:", "completed,"], ["1.0:", "completed,"], ["1.1:", "completed,"],
    ]  # fmt: skip
    assert printed.err == ""
