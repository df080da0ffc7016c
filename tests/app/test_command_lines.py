"""Command lines that cannot be carried out: exit status 2 at once, in one line, and nothing is started or left."""

import os
from importlib import metadata

import pytest
from mission_files import MISSIONS

import gcs.app.cli
import gcs.app.fly
import vehicle_sim.app.cli
from gcs.campaign.engine import Campaign
from gcs.drivers.forked_program import ForkedProgram
from gcs.drivers.simulator import VEHICLES_MAX
from vehicle_sim.world.multibody import MAX_VEHICLES

HOP = MISSIONS / "hop.toml"

NOT_FLOWN = [
    ("", "the following arguments are required: COMMAND"),
    ("flie", "invalid choice: 'flie'"),
    ("-v fly {hop}", "-v goes behind the command"),
    ("fly", "the following arguments are required: MISSION"),
    ("fly --realtime --connect udp://127.0.0.1:14580", "the following arguments are required: MISSION"),
    ("fly --realtime --connect missions/nothing.toml", "missions/nothing.toml: "),
    ("fly none.toml", "none.toml: cannot be read: No such file"),
    ("fly .", ".: is a folder, not a file"),
    ("fly empty.toml", "empty.toml: the file is empty"),
    ("fly campaign.toml", "gcs faults flies it"),
    ("fly {hop} --vehicles 2", "--vehicles: '2' is not a whole number from 3"),
    ("fly {hop} --vehicles 99", "99 vehicles: vehicle-sim simulates 15 at most: see --vehicles"),
    ("fly {hop} --vehicles four", "--vehicles: 'four' is not a whole number"),
    ("fly {hop} --vehicles 100", "--vehicles: '100' is not a whole number from 3 to 99"),
    ("fly {hop} --seed -1", "--seed: '-1' is not a whole number from 0"),
    ("fly {hop} --seed 1.5", "--seed: '1.5'"),
    ("fly {hop} --seed 9223372036854775808", "--seed: '9223372036854775808'"),
    ("fly {hop} --speed 3", "add --realtime"),
    ("fly {hop} --realtime --speed 0", "--speed: '0' is not a number from 0.001"),
    ("fly {hop} --realtime --speed inf", "--speed: 'inf'"),
    ("fly {hop} --realtime --speed fast", "--speed: 'fast'"),
    ("fly {hop} --run-dir full", "full: the run folder is not empty: name another with --run-dir"),
    ("fly {hop} --run-dir empty.toml", "empty.toml: is a file"),
    ("fly {hop} --run-dir empty.toml/run", "empty.toml: is a file"),
    ("fly {hop} --run-dir {long}", "File name too long"),
    ("fly {hop} --controller pid", "--controller: invalid choice: 'pid'"),
    ("fly {hop} --config none.toml", "none.toml: cannot be read"),
    ("fly {hop} --config {hop}", "this is a mission, no system file"),
    ("fly {hop} --config heavy.toml", "heavy.toml: line 2: payload.mass: hover needs 7609.6 N of one UAV"),
    ("fly {hop} --config thin.toml", "thin.toml: line 2: payload.inertia: [1.0, 1.0, 9.0]: no rigid body has"),
    ("fly thin.toml", "this is a system file, no mission"),
    ("fly digits.plan", "not valid JSON: a number has too many digits"),
    ("fly digits.toml", "not valid TOML: a number has too many digits"),
    ("fly {hop} --sped 3", "did you mean --speed?"),
    ("fly {hop} --real", "did you mean --realtime?"),
    ("fly {hop} --json=yes", "--json: ignored explicit argument 'yes'"),
    ("fly {hop} {hop}", "unrecognized arguments: "),
    ("fly {hop} --log-file none/log", "none/log: cannot be written: No such file"),
    ("fly {hop} --connect 14540", "--connect 14540: expected udp://HOST:PORT"),
    ("fly {hop} --connect {a}:1", "a router's, in real time only; add --realtime"),
    ("fly {hop} --connect {a}:8 {a}:9", "2 of the team's vehicles, which are 3 or more"),
    ("fly {hop} --connect {a}:8 {a}:9 --vehicles 4", "4 does not agree with 2"),
    ("fly {hop} --connect {a}:8 {a}:8 {a}:9", "named twice"),
    ("fly {hop} --connect {a}:2 {a}:3 {a}:4", "127.0.0.1:1; for one in real time add --realtime"),
    ("fly {hop} --connect {a}:14540 {a}:14541", "use --connect udp://127.0.0.1:14580"),
    ("fly {hop} --realtime --connect udp://10.0.0.7:14541", "use --connect udp://10.0.0.7:14581"),
    ("fly {hop} --connect udpin://127.0.0.1:14550", "--realtime"),
    ("fly {hop} --realtime --connect udpin://127.0.0.1:14550 {a}:1", "no other"),
    ("check", "the following arguments are required: MISSION"),
    ("check none.plan", "none.plan: cannot be read"),
    ("check {hop} --vehicles 2", "--vehicles: '2'"),
    ("check {hop} --config full", "full: is a folder"),
    ("check {hop} --picture x.png", "unrecognized arguments: --picture x.png"),
    ("check {hop} --plot x.txt", "--plot x.txt: images of kind 'txt' are not written"),
    ("report", "the following arguments are required: RUN_DIR"),
    ("report none", "none: is not a folder"),
    ("report full", "full: is not a run folder"),
    ("report empty.toml", "empty.toml: is not a folder"),
    ("export", "the following arguments are required: RUN_DIR"),
    ("export full", "no format: --ulog, --tlog, or both"),
    ("export none --ulog", "none: is not a folder"),
    ("export full --tlog", "full: is not a run folder"),
    ("faults", "no campaign file"),
    ("faults none.toml", "none.toml: cannot be read"),
    ("faults {hop}", "this is a mission, no campaign: gcs fly flies it"),
    ("faults campaign.toml --jobs 0", "--jobs: '0' is not a whole number from 1"),
    ("faults campaign.toml --jobs many", "--jobs: 'many'"),
    ("faults campaign.toml --keep some", "--keep: invalid choice: 'some'"),
    ("faults good.toml --out empty.toml", "empty.toml: is a file"),
    ("faults campaign.toml", "there is no file none.toml"),
    ("faults --kinds campaign.toml", "--kinds lists the kinds of fault and flies nothing"),
    ("courses --count 0", "--count: '0' is not a whole number from 1"),
    ("courses --seed -1", "--seed: '-1'"),
    ("courses --kinds trees", "--kinds: invalid choice: 'trees'"),
    ("courses --config none.toml", "none.toml: cannot be read"),
    ("courses --speed 3", "--speed goes with --suite"),
    ("courses --obstacle-speed 0", "--obstacle-speed: '0'"),
    ("courses --suite none.yaml", "none.yaml: cannot be read"),
    ("courses --suite {hop} --count 3", "--count is for random scenarios"),
    ("courses --suite {hop} --config none.toml", "none.toml: cannot be read"),
    ("courses --suite {hop} --kinds boxes", "--kinds is for random scenarios"),
    ("courses --suite {hop} --obstacle-speed 3", "--obstacle-speed is for random scenarios"),
    ("courses --budget 1m", "--budget goes with --level both"),
    ("courses --level half", "--level: invalid choice: 'half'"),
    ("courses --level both --budget 30", "--budget: '30' is not a time"),
    ("courses --level both --budget xm", "--budget: 'x' is not a number"),
    ("courses --level planning --controller mpc", "the controller mpc plans nothing"),
    ("courses --out full", "full: is neither empty nor the folder of a campaign: name another with --out"),
    ("courses --set avoidance.margin", "'avoidance.margin' is not PATH=VALUE"),
    ("courses --set avoidance.margn=0.4", "there is no 'avoidance.margn'"),
    ("courses --set avoidance.margin=0.4,-0.5", "must be greater than 0, found -0.5"),
    ("reproduce --out full --quick", "full: the folder is not empty: name another with --out"),
    ("reproduce --quick --out empty.toml", "empty.toml: is a file"),
    ("reproduce --missions none", "none/pole_course.toml: cannot be read"),
    ("reproduce --quick --missions .", "--quick flies no missions"),
    ("reproduce --jobs -1", "--jobs: "),
]


@pytest.fixture(autouse=True)
def somewhere_else(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "something").touch()
    (tmp_path / "empty.toml").touch()
    (tmp_path / "heavy.toml").write_text("[payload]\nmass = 3100\n")
    (tmp_path / "thin.toml").write_text("[payload]\ninertia = [1.0, 1.0, 9.0]\n")
    (tmp_path / "digits.plan").write_text('{"a": ' + "9" * 5000 + "}")
    (tmp_path / "digits.toml").write_text("a = " + "9" * 5000 + "\n")
    for name, mission in ("campaign.toml", "none.toml"), ("good.toml", HOP):
        text = f'[campaign]\nname = "a"\nmissions = ["{mission}"]\nseed_count = 1\nclean = true\n'
        (tmp_path / name).write_text(text)


@pytest.fixture
def nothing_starts(monkeypatch):
    def refuse(*_):
        raise AssertionError("something is started")

    monkeypatch.setattr(ForkedProgram, "__init__", refuse)
    monkeypatch.setattr(Campaign, "fly", refuse)
    monkeypatch.setattr("gcs.reproduce.work.run", refuse)


@pytest.mark.usefixtures("nothing_starts")
@pytest.mark.parametrize(("line", "reason"), NOT_FLOWN)
def test_command_line_that_cannot_be_carried_out_is_refused_in_one_line(line, reason, tmp_path, capfd):
    before = sorted(tmp_path.rglob("*"))
    assert gcs.app.cli.main([word.format(hop=HOP, long="x" * 300, a="udp://127.0.0.1") for word in line.split()]) == 2
    output = capfd.readouterr()
    assert output.out == ""
    assert reason in output.err
    assert output.err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.usefixtures("nothing_starts")
@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_folder_that_may_not_be_written_is_refused(tmp_path, capfd):
    tmp_path.chmod(0o500)
    assert gcs.app.cli.main(["fly", str(HOP)]) == 2
    assert "runs: the run folder cannot be written: Permission denied" in capfd.readouterr().err


def test_more_vehicles_than_the_physics_engine_takes_are_refused_by_both_programs():
    assert VEHICLES_MAX == MAX_VEHICLES


@pytest.mark.slow
def test_run_folder_is_removed_when_the_simulator_refuses_to_start(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr("gcs.app.fly_options.VEHICLES_MAX", 254)  # as if only the simulator knew
    before = sorted(tmp_path.rglob("*"))
    assert gcs.app.cli.main(["fly", str(HOP), "--vehicles", "16"]) == 2
    assert "vehicle-sim: 16 vehicles: the physics engine is wrong beyond 15" in capfd.readouterr().err
    assert sorted(tmp_path.rglob("*")) == before
    (tmp_path / "run").mkdir()
    assert gcs.app.cli.main(["fly", str(HOP), "--vehicles", "16", "--run-dir", "run"]) == 2
    assert [*(tmp_path / "run").iterdir()] == []


@pytest.mark.parametrize(("program", "main"), [("gcs", gcs.app.cli.main), ("vehicle-sim", vehicle_sim.app.cli.main)])
def test_version_is_printed_with_the_name(program, main, capfd):
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capfd.readouterr().out == f"{program} {metadata.version('cooplift')} (cooplift)\n"


@pytest.mark.parametrize(("command", "extra"), [("faults", "cooplift[parquet]"), ("export", "cooplift[ulog]")])
def test_help_names_the_extra_that_is_needed(command, extra, capfd):
    with pytest.raises(SystemExit):
        gcs.app.cli.main([command, "--help"])
    assert extra in capfd.readouterr().out


def test_check_reads_a_mission_for_another_number_of_vehicles(capfd):
    assert gcs.app.cli.main(["check", str(HOP), "--vehicles", "6"]) == 0
    assert "6 vehicles" in capfd.readouterr().out
