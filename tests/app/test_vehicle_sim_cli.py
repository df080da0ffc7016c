"""The command vehicle-sim: refused arguments, output, end of the process."""

import json
import signal
import socket

import pytest
from mission_files import MISSIONS
from programs import PATIENCE, process

from gcs.record.reader import read_table
from vehicle_sim.app.cli import main

MISSION = """\
[mission]
name = "an obstacle"
seed = 11

[reference]
kind = "lissajous"
amplitude = [1.0, 1.0]
angular_frequency = 0.5
altitude = 5.0
duration = 10.0

[[obstacle]]
name = "pole"
shape = "pole"
position = [8.0, 1.0]
radius = 0.3
height = 6.0
"""


@pytest.fixture(autouse=True)
def somewhere_else(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    (tmp_path / "mission.toml").write_text(MISSION)
    (tmp_path / "load.toml").write_text(MISSION + '[[fault]]\nkind = "payload_mass"\nstart = 1.0\nchange = 0.2\n')
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "something").touch()
    (tmp_path / "bad.toml").write_text((MISSIONS / "system.toml").read_text().replace("mass = 3.1", "mass = -3.1"))
    (tmp_path / "odd.toml").write_text(MISSION.replace("radius = 0.3", "radius = 0.3\ncolour = 'red'"))


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ("--vehicles 16", "16 vehicles: the physics engine is wrong beyond 15"),
        ("--vehicles 200", "--vehicles: '200' is not a whole number from 3 to 99"),
        ("--free --vehicles 0", "--vehicles: '0' is not a whole number from 1 to 99"),
        ("--free --view", "--view: shows a team with its payload; not with --free"),
        ("--free --mission load.toml", "load.toml: line 18: fault payload_mass: with --free there is no payload"),
        ("--mission none.toml", "none.toml: cannot be read"),
        ("--mission odd.toml", "odd.toml: line 17: obstacle[1].colour: unknown key"),
        ("--config bad.toml", "payload.mass: "),
        ("--mission mission.toml --config bad.toml", "payload.mass: "),
        ("--seed -1", "--seed: '-1'"),
        ("--speed 0", "--speed: '0'"),
        ("--lockstep --speed 2", "--speed: lockstep has no speed"),
        ("--lockstep --realtime", "not allowed with"),
        ("--lockstep --ground-port 14550", "--ground-port: in lockstep"),
        ("--lockstep --sdk-port 14540", "--sdk-port: in lockstep"),
        ("--lockstep --ground-host 127.0.0.1", "--ground-host: in lockstep"),
        ("--base-port 14540", "4 vehicles from --base-port 14540 on: port 14540 is a client's; choose another"),
        ("--base-port 14538", "--base-port 14538 on: port 14540 is a client's"),
        ("--base-port 14547 --sdk-port 0", "port 14550 is a client's"),
        ("--sdk-port 65533", "--sdk-port 65533: port 65536 of vehicle 4"),
        (
            "--ground-host 192.0.2.1 --host 127.0.0.1",
            "--host 127.0.0.1: from there nothing can be sent to --ground-host",
        ),
        ("--ground-host a..b", "--ground-host a..b: "),
        ("--base-port 65534", "needs the ports 65534 .. 65537, and there are 1 .. 65535"),
        ("--base-port 1 --lockstep", "needs the ports 0 .. 4, and there are"),
        ("--host 192.0.2.1 --base-port 0", "cannot listen on udp://192.0.2.1:0"),
        ("--base-port 0 --run-dir full", "full: the run folder is not empty"),
        ("--base-port 0 --run-dir mission.toml", "mission.toml: is a file"),
        ("--gui", "there is no display"),
        ("--faster", "unrecognized arguments: --faster"),
    ],
)
def test_unusable_argument_is_refused_in_one_line(arguments, reason, tmp_path, capfd):
    before = sorted(path.name for path in tmp_path.rglob("*"))
    assert main(arguments.split()) == 2
    output = capfd.readouterr()
    assert output.out == ""
    assert output.err.startswith("vehicle-sim: ")
    assert output.err.count("\n") == 1
    assert reason in output.err
    assert sorted(path.name for path in tmp_path.rglob("*")) == before


def test_occupied_port_is_refused_before_start(tmp_path, capfd):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        port = other.getsockname()[1]
        assert main(["--base-port", str(port - 1), "--run-dir", "run"]) == 2
    assert f"cannot listen on udp://127.0.0.1:{port}: Address already in use" in capfd.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "status", "pace"),
    [
        (signal.SIGINT, 130, "--lockstep"),
        (signal.SIGTERM, 0, "--realtime"),
        pytest.param(signal.SIGTERM, 0, "--lockstep", marks=pytest.mark.long),
        pytest.param(signal.SIGINT, 130, "--realtime", marks=pytest.mark.long),
    ],
)
def test_signal_ends_simulation_with_closed_records(tmp_path, number, status, pace):
    arguments = ("--mission", "mission.toml", "--base-port", 0, "--run-dir", "run", pace)
    with process(*arguments, *(("--ground-port", 0, "--sdk-port", 0) if pace == "--realtime" else ())) as (
        running,
        clock,
        vehicles,
    ):
        assert (clock is not None) == (pace == "--lockstep")
        assert len(vehicles) == 4
        running.send_signal(number)
        assert running.wait(PATIENCE) == status
        assert running.stderr.read() == ""
    assert read_table(tmp_path / "run" / "truth.csv")["time_s"][0] == 0.0
    assert read_table(tmp_path / "run" / "obstacles.csv")["name"].tolist() == ["pole"]
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert manifest["seed"] == 11
    assert manifest["mission"]["name"] == "an obstacle"
    assert manifest["system"]["team"]["vehicles"] == 4
    assert manifest["command"][:3] == ["vehicle-sim", "--mission", "mission.toml"]


@pytest.mark.slow
def test_run_folder_of_a_parent_keeps_its_manifest(tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "manifest.json").write_text("the parent's")
    with process("--base-port", 0, "--lockstep", "--with-parent", "--run-dir", "run") as (running, _, _):
        running.stdin.close()
        assert running.wait(PATIENCE) == 0
    assert (tmp_path / "run" / "manifest.json").read_text() == "the parent's"
    assert (tmp_path / "run" / "truth.csv").exists()


@pytest.mark.slow
def test_ctrl_c_at_the_terminal_is_handled_by_the_parent(tmp_path):
    with process("--base-port", 0, "--lockstep", "--with-parent") as (running, _, _):
        running.send_signal(signal.SIGINT)
        running.stdin.close()
        assert running.wait(PATIENCE) == 0
