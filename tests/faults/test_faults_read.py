"""Faults in mission files: strict reading, description, listing."""

import dataclasses
from pathlib import Path

import pytest
from kinds_page import renewed
from rich.console import Console

from gcs.app.cli import main
from gcs.app.fly_options import FlyOptions, prepare
from gcs.errors import UnusableInput
from gcs.faults import KINDS, read_settings
from gcs.faults.listing import parameters
from gcs.faults.suggestions import kind_meant
from gcs.mission.describe import describe
from gcs.mission.model import Fault
from gcs.mission.read import read_mission
from gcs.record.faults import notes_of

ROOT = Path(__file__).parents[2]
BEGIN = """
[mission]
name = "faulty"

[reference]
kind = "waypoints"
points = [[1, 0, -3]]

"""
GOOD = """[[fault]]
kind = "noise"
start = 2.0
duration = 1.0
every = 3.0
times = 2
vehicles = [1, 3]
channel = "velocity"
axes = ["x", "z"]
factor = 5
"""


def mission_of(tmp_path, faults):
    path = tmp_path / "mission.toml"
    path.write_text(BEGIN + faults)
    return path


def fault(kind, *lines):
    return "\n".join(["[[fault]]", f'kind = "{kind}"', "start = 1.0", *lines]) + "\n"


def test_fault_is_read_and_described(tmp_path):
    mission = read_mission(mission_of(tmp_path, GOOD + fault("latency", "delay = 0.06")))
    noise, latency = mission.faults
    assert (noise.every, noise.times, noise.vehicles) == (3.0, 2, (1, 3))
    assert read_settings(noise.kind, noise.settings).factor == 5
    assert read_settings(latency.kind, latency.settings).delay == 0.06
    console = Console(width=200, file=(tmp_path / "out").open("w"), highlight=False)
    console.print(describe(mission))
    console.file.close()
    text = (tmp_path / "out").read_text()
    assert "fault noise from 2 s for 1 s, every 3 s 2 times, vehicles 1, 3: channel = velocity" in text
    assert "fault latency from 1 s to the end, all vehicles, both directions: delay = 0.06" in text


@pytest.mark.parametrize(
    ("faults", "at", "reason"),
    [
        (fault("packet_los"), "kind", "fault[1].kind: there is no kind 'packet_los': did you mean 'packet_loss'?"),
        (fault("xyz"), "kind", "fault[1].kind: there is no kind 'xyz': gcs faults --kinds lists them"),
        (fault("packet_loss"), "[[fault]]", "fault[1].probability: missing key"),
        (fault("packet_loss", "probability = 1.1"), "probability", "fault[1].probability: must be less than"),
        (fault("packet_loss", "probability = 0.1", "prob = 0.1"), "prob =", "fault[1].prob: unknown key"),
        (fault("bias", 'channel = "rates"', 'axes = ["w"]', "amount = 1"), "axes", "fault[1].axes[1]: "),
        (fault("bias", 'channel = "rates"', "axes = []", "amount = 1"), "axes", "fault[1].axes: "),
        (fault("partition", "vehicles = [5]"), "vehicles", "fault[1].vehicles: there is no vehicle 5: the team has 4"),
        (fault("partition", "vehicles = [1, 1]"), "vehicles", "fault[1].vehicles: names one twice"),
        (fault("partition", "vehicles = []"), "vehicles", "fault[1].vehicles: names none"),
        (fault("partition", 'direction = "up"'), "direction", "fault[1].direction: "),
        (fault("stuck", 'channel = "rates"', 'direction = "both"'), "direction", "fault[1].direction: stuck has none"),
        (fault("wind", "velocity = [1, 0, 0]", "vehicles = [1]"), "vehicles", "fault[1].vehicles: wind is not of"),
        (fault("wind", "velocity = [1000, 0, 0]"), "velocity", "fault[1].velocity: more than 100 m/s"),
        (fault("payload_mass", "change = -3.05"), "change", "fault[1].change: 0.05 kg would be left"),
        (fault("payload_mass", "change = 50"), "change", "fault[1].change: "),
        (fault("gripper_stuck", "gripper = 3"), "gripper =", "fault[1].gripper: the payload has no gripper 3, only 1"),
        (fault("stall"), "[[fault]]", "fault[1].duration: stall needs one"),
        (fault("partition", "every = 5.0"), "every", "fault[1].every: needs a duration"),
        (fault("partition", "every = 5.0", "duration = 5.0"), "every", "fault[1].every: 5 s is not more than"),
        (fault("partition", "times = 5", "duration = 5.0"), "times", "fault[1].times: goes with `every`"),
        (fault("swapped_vehicles", "other = 2"), "[[fault]]", "fault[1].vehicles: name the one vehicle"),
        (fault("swapped_vehicles", "other = 2", "vehicles = [2]"), "other", "fault[1].other: is the same vehicle"),
        (fault("swapped_vehicles", "other = 9", "vehicles = [2]"), "other", "fault[1].other: there is no vehicle 9"),
        (
            fault("bias", 'channel = "payload_position"', "amount = 1", "at_source = true", "vehicles = [1]"),
            "vehicles",
            "fault[1].vehicles: the payload has one navigation unit",
        ),
        (fault("gps_loss"), "kind", "fault[1].kind: there is no kind 'gps_loss': did you mean 'position_lost'?"),
        (fault("stuck", 'channel = "atitude"'), "channel", "found \"atitude\": did you mean 'attitude'?"),
        (fault("packet_loss", "prob = 0.1"), "prob =", "fault[1].prob: unknown key: did you mean 'probability'?"),
        (fault("latency", "latency = 0.1"), "latency =", "fault[1].latency: unknown key: did you mean 'delay'?"),
        (fault("partition", "duratoin = 5.0"), "duratoin", "fault[1].duratoin: unknown key: did you mean 'duration'?"),
        (fault("partition", "drones = [1]"), "drones", "fault[1].drones: unknown key: did you mean 'vehicles'?"),
        (fault("partition", 'direction = "uplink"'), "direction", "found \"uplink\": did you mean 'command'?"),
        (fault("bias", 'channel = "attitude"', 'axes = ["yaw"]', "amount = 1"), "axes", "did you mean 'z'?"),
        (fault("bias", 'channel = "position"', 'axes = ["North"]', "amount = 1"), "axes", "did you mean 'x'?"),
        (fault("stuck", 'channel = "gyro"'), "channel", "found \"gyro\": did you mean 'rates'?"),
        (fault("stuck", 'channel = "positon"'), "channel", "did you mean 'position'?"),
    ],
)  # fmt: skip
def test_impossible_fault_is_refused_with_its_line(tmp_path, capsys, faults, at, reason):
    path = mission_of(tmp_path, faults)
    line = BEGIN.count("\n") + faults[: faults.rindex(at)].count("\n") + 1
    assert main(["check", str(path)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.startswith(f"{path}: line {line}: fault[")
    assert reason in said
    assert main(["fly", str(path), "--run-dir", str(tmp_path / "run")]) == 2
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("gps_loss gnss_denied gps_failure gnss_outage no_gps position_loss gps_los GPS-Lost", "position_lost"),
        ("gps_glitch gnss_jump position_glich", "position_glitch"),
        ("gps_spoofing gps_drift", "position_drift"),
        ("imu_failure compass_loss attitude_lost_", "attitude_lost"),
        ("gyro_failure", "rates_lost"),
        ("lidar_failure camera_lost rangefinder_fault", "obstacle_sensing_lost"),
        ("comm_loss link_loss datalink_lost rc_loss telemetry_dropout disconnect", "partition"),
        ("drop packet_drop packetloss message_loss loss", "packet_loss"),
        ("delay lag network_delay latncy", "latency"),
        ("clock_drift", "clock_skew"),
        ("clock_offset time_jump", "clock_step"),
        ("gps_noise white_noise", "noise"),
        ("gust turbulence wnd", "wind"),
        ("mass load_change payload_release", "payload_mass"),
        ("gripper_jammed winch_failure cargo_stuck", "gripper_stuck"),
        ("nan", "not_a_number"),
        ("bandwidth throttle", "bandwidth_cap"),
    ],
)
def test_other_names_of_a_kind_are_understood(words, kind):
    assert {word: kind_meant(word) for word in words.split()} == dict.fromkeys(words.split(), kind)


@pytest.mark.parametrize("word", ["motor_failure", "rotor_loss", "battery_low", "xyz", "servo", "", "_", "engine"])
def test_what_is_no_kind_by_any_name_is_not_mistaken_for_one(word):
    assert kind_meant(word) is None


def test_every_alias_names_one_kind_and_every_kind_itself():
    taken = {}
    for kind in KINDS.values():
        assert kind_meant(kind.name) == kind.name
        for alias in kind.aliases:
            assert taken.setdefault(alias, kind.name) == kind.name, alias


def test_faults_are_checked_again_for_the_team_that_flies(tmp_path):
    path = mission_of(tmp_path, fault("partition", "vehicles = [4]"))
    assert prepare(FlyOptions(path)).faults
    with pytest.raises(UnusableInput, match="there is no vehicle 4: the team has 3"):
        prepare(FlyOptions(path, vehicles=3))


def test_faults_from_python_are_read_as_strictly():
    with pytest.raises(UnusableInput, match="probability"):
        read_settings("packet_loss", {"probability": 2.0})
    with pytest.raises(UnusableInput, match="there is no kind 'x'"):
        read_settings("x", {})
    assert read_settings("packet_loss", {"probability": 1}).probability == 1.0
    assert dataclasses.asdict(Fault("stall", 1.0))["settings"] == {}


def test_every_kind_is_listed_with_its_parameters(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    assert main(["faults", "--kinds"]) == 0
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 80
    assert "\n  Datagrams are lost, each independently of the others. Direction: both, if none" in said
    for kind in KINDS.values():
        assert kind.name in said
        for parameter in parameters(kind):
            assert parameter.name in said
            assert parameter.description, (kind.name, parameter.name)


def test_documentation_holds_the_table_of_kinds():
    page = (ROOT / "docs" / "faults.md").read_text(encoding="utf-8")
    assert page == renewed(page), "run make docs"
    assert renewed(page.replace("| `payload_mass` | The", "| `mass` | A")) == page


def test_fault_that_never_began_is_noted():
    entry = {
        "number": 1, "kind": "stall", "line": 7, "start": 9.0, "occurrences": 0, "seen": 0, "disturbed": 0,
    }  # fmt: skip
    (note,) = notes_of({"take_off_s": 1.0, "end_s": 6.0, "faults": [entry]})
    assert note.startswith("fault 1, stall (line 7 of the mission), never came: it was to start 9 s after take-off")
    assert note.endswith("the end was at 5.0 s")
    (note,) = notes_of({"take_off_s": None, "end_s": 6.0, "faults": [entry]})
    assert "nothing took off" in note
    (note,) = notes_of({"take_off_s": 1.0, "end_s": 16.0, "faults": [entry | {"occurrences": 1}]})
    assert "disturbed nothing" in note
    assert not notes_of({"take_off_s": 1.0, "end_s": 16.0, "faults": [entry | {"occurrences": 1, "disturbed": 3}]})
