"""Faults that start in a phase of the flight: how the simulator knows the phase, and when they then act."""

import dataclasses
import io
import json
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from fault_injection import SYSTEM
from mission_files import TAKE_OFF, read, row, wpl
from rich.console import Console

from gcs.app.cli import main
from gcs.app.in_process import FlightInProcess
from gcs.errors import UnusableInput
from gcs.flight.phase import Phase
from gcs.mission.describe import describe
from gcs.mission.model import Fault, StartPhase
from gcs.mission.read import read_mission
from gcs.record.faults import notes_of
from vehicle_sim.app.cli import main as vehicle_sim
from vehicle_sim.faults.fault_injector import FaultInjector, faults_record
from vehicle_sim.faults.phases import PhaseObserver, VehicleState

HOP_NORTH = Path(__file__).parents[2] / "missions" / "hop_north.toml"
NAMES = get_args(StartPhase)
OFF, ON, IDLE, ALONE = (
    VehicleState(False, False, False), VehicleState(True, True, False), VehicleState(True, False, False),
    VehicleState(True, True, True),
)  # fmt: skip
PAD = np.array([0.0, 0.0, -0.3])
UP = np.array([0.0, 0.0, -0.8])


def partition(phase, offset=None, **more):
    return Fault("partition", start_phase=phase, start_offset=offset, **more)


def test_phases_are_words_of_the_flight():
    assert {name.upper() for name in NAMES} <= {phase.name for phase in Phase}


def test_phases_follow_from_vehicles_ground_contact_and_the_mission():
    observer = PhaseObserver(read_mission(HOP_NORTH), NAMES)
    assert observer.observe(1.0, [OFF, OFF], PAD, standing=True) == {}
    assert observer.observe(1.1, [OFF, IDLE], PAD, standing=True) == {"arm": 1.1}
    assert observer.observe(1.2, [IDLE, ON], PAD, standing=True) == {"spool_up": 1.2}
    assert observer.observe(3.6, [ON, ON], PAD, standing=True) == {}
    spooled_up = 1.2 + SYSTEM.flight.takeoff_landing.spool_up_time
    assert observer.observe(spooled_up, [ON, ON], PAD, standing=False) == {"climb": spooled_up}
    assert observer.observe(4.0, [ON, ON], PAD, standing=True) == {}, "a payload that has not risen has not landed"
    times = {}
    for time in np.arange(4.0, 16.0, 0.02).tolist():
        times |= observer.observe(time, [ON, ON], UP, standing=False)
    assert [*times] == ["hold", "fly", "land"]
    assert observer.pending == {"autonomous_landing", "spool_down", "disarm", "on_ground"}
    assert observer.observe(17.0, [ON, ALONE], UP, standing=False) == {"autonomous_landing": 17.0}
    assert observer.observe(18.0, [ON, ON], PAD, standing=True) == {"spool_down": 18.0}
    assert observer.observe(19.0, [ON, OFF], PAD, standing=False) == {}
    assert observer.observe(19.1, [ON, ON], PAD, standing=True) == {}
    assert observer.observe(20.0, [ON, IDLE], PAD, standing=True) == {"disarm": 20.0}
    assert observer.observe(21.0, [OFF, OFF], PAD, standing=True) == {"on_ground": 21.0}
    assert not observer.pending


def test_phases_of_the_second_flight_have_its_number(tmp_path):
    mission = read(tmp_path, wpl(TAKE_OFF, row(21, alt=0), row(93, 5), TAKE_OFF, row(21, alt=0)))
    names = "arm", "land", "on_ground", "arm 2", "spool_up 2", "climb 2", "land 2", "on_ground 2"
    observer, found = PhaseObserver(mission, names), {}

    def observe(begin, end, states, payload, *, standing):
        for time in np.arange(begin, end, 0.02).tolist():
            found.update(observer.observe(time, states, payload, standing=standing))

    for start in (0.0, 40.0):
        observe(start, start + 1.0, [IDLE], PAD, standing=True)
        observe(start + 1.0, start + 3.5, [ON], PAD, standing=True)
        observe(start + 3.5, start + 20.0, [ON], UP, standing=False)
        observe(start + 20.0, start + 21.0, [ON], PAD, standing=True)
        observe(start + 21.0, start + 22.0, [IDLE], PAD, standing=True)
        observe(start + 22.0, start + 24.0, [OFF], PAD, standing=True)
    assert [*found] == [*names]
    times = {name: round(time, 1) for name, time in found.items()}
    assert times["on_ground"] == 22.0 and times["spool_up 2"] == 41.0 and times["on_ground 2"] == 62.0
    assert times["climb 2"] == 41.0 + SYSTEM.flight.takeoff_landing.spool_up_time
    assert 43.5 < times["land 2"] < 60.0


def test_fault_of_the_second_flight_starts_in_it():
    fault = partition("climb", 0.5, start_flight=2)
    assert fault.start_key == "climb 2" and partition("climb", start_flight=1).start_key == "climb"
    injector = FaultInjector([fault], 1, SYSTEM, read_mission(HOP_NORTH))
    assert injector.phases.pending == {"climb 2"}


def test_rotors_that_stop_before_lift_off_end_the_flight_without_a_landing():
    observer = PhaseObserver(read_mission(HOP_NORTH), ("spool_down", "disarm"))
    for time, state in ((1.0, ON), (2.0, ON), (3.0, IDLE)):
        entered = observer.observe(time, [state], PAD, standing=True)
    assert entered == {"disarm": 3.0}


def test_fault_acts_from_its_offset_into_the_phase_and_is_recorded_by_take_off():
    mission = read_mission(HOP_NORTH)
    injector = FaultInjector([partition("spool_up", 0.5, duration=1.0), partition("fly")], 1, SYSTEM, mission)
    for fault in injector.faults:
        fault.schedule.origin = 2.0 if fault.fault.start_phase == "spool_up" else None
    passed = [t for t in (2.4, 2.6, 3.4, 3.6) if injector.from_vehicle(1, [(b"x", "a")], t)]
    assert passed == [2.4, 3.6]
    injector.took_off(3.0)
    record = faults_record(injector, 5.0)
    assert record["faults"][0]["activations"] == [(-0.5, 0.5)]
    assert record["faults"][0]["start_phase"] == "spool_up" and record["faults"][0]["start"] == 0.5
    assert (record["faults"][1]["occurrences"], record["faults"][1]["activations"]) == (0, [])
    [note] = notes_of(record)
    assert "never came: it was to start 0 s into fly, which was not entered" in note


def test_fault_in_a_phase_needs_the_mission():
    with pytest.raises(UnusableInput, match="need the mission"):
        FaultInjector([partition("climb")], 1, SYSTEM)


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ("", "fault[1].start: missing key (or start_phase)"),
        ('start = 1.0\nstart_phase = "climb"', "fault[1].start_phase: goes without start"),
        ("start = 1.0\nstart_offset = 2.0", "fault[1].start_offset: goes with start_phase"),
        ('start_phase = "climb"\nstart_offset = -1.0', "fault[1].start_offset: must be greater than or equal to 0"),
        ('start_phase = "landing"', "found \"landing\": did you mean 'land'?"),
        ('start_phase = "spool up"', "found \"spool up\": did you mean 'spool_up'?"),
        ('start_phase = "ended"', "fault[1].start_phase: must be 'arm', 'spool_up'"),
        ('phase = "climb"\nstart = 1.0', "fault[1].phase: unknown key: did you mean 'start_phase'?"),
    ],
)
def test_wrong_start_is_refused_in_one_line(tmp_path, capsys, keys, reason):
    path = tmp_path / "mission.toml"
    path.write_text(f'[mission]\nname = "m"\n[reference]\nkind = "waypoints"\npoints = [[1, 0, -3]]\n'
                    f'[[fault]]\nkind = "partition"\n{keys}\n')  # fmt: skip
    assert main(["fly", str(path), "--run-dir", str(tmp_path / "run")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and said.startswith(f"{path}: line ") and reason in said
    assert not (tmp_path / "run").exists()


def test_phase_is_described_and_refused_for_free_vehicles(tmp_path, capsys):
    mission = dataclasses.replace(read_mission(HOP_NORTH), faults=(partition("spool_down", 0.3), partition("fly")))
    console = Console(width=200, file=io.StringIO(), highlight=False)
    console.print(describe(mission))
    lines = [line.strip() for line in console.file.getvalue().splitlines() if "fault " in line]
    assert lines[0].startswith("fault partition from 0.3 s after the start of spool down to the end")
    assert lines[1].startswith("fault partition from the start of fly to the end")
    path = tmp_path / "mission.toml"
    path.write_text('[mission]\nname = "m"\n[reference]\nkind = "waypoints"\npoints = [[1, 0, -3]]\n'
                    '[[fault]]\nkind = "partition"\nstart_phase = "climb"\n')  # fmt: skip
    assert vehicle_sim(["--mission", str(path), "--free"]) == 2
    said = capsys.readouterr().err
    assert "line 6: fault partition: start_phase: with --free" in said and said.count("\n") == 1


@pytest.mark.slow
def test_phases_of_the_simulator_are_those_of_the_ground_within_two_control_steps(tmp_path):
    calm = {"velocity": [0.0, 0.0, 0.0]}
    awaited = [name for name in NAMES if name != "autonomous_landing"]
    faults = tuple(Fault("wind", start_phase=name, start_offset=0.1, settings=calm) for name in awaited)
    mission = dataclasses.replace(read_mission(HOP_NORTH), faults=faults)
    entered = {}
    (tmp_path / "run").mkdir()
    with FlightInProcess(mission, tmp_path / "run") as flight:
        flight.fly(lambda: entered.setdefault(flight.flight.phase.name.lower(), flight.now))
        assert flight.result().summary["completed"]
    record = json.loads((tmp_path / "run" / "faults.json").read_text())
    assert record["phases_s"].keys() == {*awaited}
    entered["on_ground"] = entered["ended"]  # after the last flight
    for name, time in record["phases_s"].items():
        if name != "arm":  # the ground's phase begins with set-points, before the first vehicle is armed
            assert time == pytest.approx(entered[name], abs=0.1), name
    assert entered["arm"] < record["phases_s"]["arm"] < entered["spool_up"]
    for fault in record["faults"][:-2]:  # the last begin when the flight ends
        begin = fault["activations"][0][0] + record["take_off_s"]
        assert begin == pytest.approx(record["phases_s"][fault["start_phase"]] + 0.1, abs=1e-6)
