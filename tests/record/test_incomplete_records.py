"""A full disk: the flight is flown, its records end at a whole row, and the programs say which, when and why."""

import builtins
import contextlib
import errno
import json
import os
import resource
import subprocess
import sys
from fnmatch import fnmatch
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from flights import HOP, system_file
from mission_files import MISSIONS
from programs import ENVIRONMENT, PATIENCE
from small_campaign import SUMMARY, campaign_file, fly_nothing
from test_record_landing import flight, write_flight

import gcs.app.cli
import vehicle_sim.app.cli
from gcs.app.exit_status import ExitStatus
from gcs.app.fly import flight_result
from gcs.campaign.result import Flown
from gcs.drivers.simulator import Simulator
from gcs.flight.alarms import AlarmLog
from gcs.mission.read import read_mission
from gcs.record.append_file import AppendOnlyFile
from gcs.record.incomplete import Incomplete, IncompleteRecords, in_one_line, read_line
from gcs.record.recorder import FlightRecorder
from gcs.record.run_data import read_run
from gcs.record.run_folder import open_run_folder, write_json
from gcs.record.tables import TableWriter
from idc_controller.geometry.shapes import shape_class
from vehicle_sim.world.obstacle_bodies import Obstacle
from vehicle_sim.world.truth_log import TruthLog

FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
REASON = "No space left on device"


class SmallDisk:
    """``free`` bytes are left for what is written below ``folder``; files of no bytes fit."""

    def __init__(self, folder, free):
        self.folder, self.free = folder, free
        self._open, self._write, self._descriptors = os.open, os.write, {}

    def open(self, path, *arguments, **keywords):
        descriptor = self._open(path, *arguments, **keywords)
        if Path(path).is_relative_to(self.folder):
            self._descriptors[descriptor] = path
        else:
            self._descriptors.pop(descriptor, None)
        return descriptor

    def write(self, descriptor, data):
        if descriptor not in self._descriptors:
            return self._write(descriptor, data)
        if self.free <= 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        taken = self._write(descriptor, bytes(data)[: self.free])  # a part, as the systems have it
        self.free -= taken
        return taken


@pytest.fixture
def small_disk(tmp_path, monkeypatch):
    disk = SmallDisk(tmp_path, 0)
    monkeypatch.setattr(os, "open", disk.open)
    monkeypatch.setattr(os, "write", disk.write)
    return disk


@contextlib.contextmanager
def no_new_content(pattern):
    """Files whose names match the pattern can be made, but not written, by ``Path.write_text``."""
    real = builtins.open

    def fail(self, *_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def write_text(self, text, **keywords):
        with real(self, "w"):
            pass
        if fnmatch(self.name, pattern):
            fail(self)
        return original(self, text, **keywords)

    original = Path.write_text
    Path.write_text = write_text
    try:
        yield
    finally:
        Path.write_text = original


def test_table_ends_at_a_whole_row_and_the_time_is_noted(tmp_path, small_disk):
    small_disk.free = 25
    incomplete = IncompleteRecords()
    with TableWriter(tmp_path / "a.csv", ("time_s", "x_m"), incomplete) as table:
        for time in (0.5, 1.0, 1.5, 2.0):
            incomplete.time = time
            table.write_numbers([time, 7.25])
    assert (tmp_path / "a.csv").read_text() == "time_s,x_m\n0.5,7.25\n"
    assert incomplete.found == [Incomplete("a.csv", 1.0, REASON)]


def test_file_that_cannot_be_begun_later_ends_no_flight(tmp_path, small_disk, monkeypatch):
    incomplete = IncompleteRecords()
    file = AppendOnlyFile(tmp_path / "a", incomplete, when_needed=True)

    def full(*_):
        raise FULL

    monkeypatch.setattr(os, "open", full)
    file.append(b"x\n")
    file.append(b"y\n")
    file.close()
    assert incomplete.found == [Incomplete("a", None, REASON)]


def test_table_that_cannot_be_begun_before_the_flight_refuses_it(tmp_path, small_disk):
    with pytest.raises(Exception, match=f"truth.csv: cannot be written: {REASON}"):
        TruthLog(tmp_path, 4)
    with pytest.raises(Exception, match=f"reference.csv: cannot be written: {REASON}"):
        FlightRecorder(tmp_path, 0.0)


def test_truth_ends_together_with_the_disk_and_the_world_goes_on(tmp_path, small_disk):
    small_disk.free = 3000
    wall = shape_class("wall").from_fields({"size": [1.0, 1.0, 1.0]})
    with TruthLog(tmp_path, 1) as log:
        for k in range(50):
            state = np.full((2, 13), 0.1)
            log.write(0.02 * k, state, [1.0], 0, [Obstacle(f"wall {k}", wall, (float(k), 0.0, -1.0))])
            log.write_mode(0.02 * k, 1, f"MODE {k}", True, False)
    assert {file.name for file in log.incomplete.found} == {"truth.csv", "obstacles.csv", "modes.csv"}
    for file in log.incomplete.found:
        text = (tmp_path / file.name).read_text()
        assert text.endswith("\n") and len({line.count(",") for line in text.splitlines()}) == 1
        times = [float(line.partition(",")[0]) for line in text.splitlines()[1:]]
        assert file.end - 0.021 < max(times, default=0.0) < file.end  # the row before the first that is missing
    run = read_run(tmp_path)
    assert len(run.time) and np.isfinite(run.clearance[0])


def test_obstacles_are_left_out_when_their_shapes_cannot_be_written(tmp_path):
    mesh = shape_class("box").from_fields({"size": [1.0, 1.0, 1.0], "roll": 0.3})
    assert not mesh.in_columns
    with TruthLog(tmp_path, 1) as log, no_new_content("obstacle_shapes.json"):
        for k in range(3):
            log.write(0.02 * k, np.full((2, 13), 0.1), [1.0], 0, [Obstacle("box", mesh, (3.0, 0.0, -1.0))])
    assert log.incomplete.found == [Incomplete("obstacle_shapes.json", None, REASON)]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["truth.csv"]
    assert len(read_run(tmp_path).time) == 3


def test_json_that_cannot_be_written_leaves_no_draft(tmp_path):
    write_json(tmp_path / "a.json", {"old": 1})
    with no_new_content("a.json*"), pytest.raises(Exception, match=f"a.json: cannot be written: {REASON}"):
        write_json(tmp_path / "a.json", {"new": 2})
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    assert json.loads((tmp_path / "a.json").read_text()) == {"old": 1}


def result(tmp_path, rows, incomplete, *, interrupted=False, landed=True):
    system_file(tmp_path)
    path = tmp_path / "hop.toml"
    path.write_text(HOP)
    run = write_flight(tmp_path / "run", rows)
    failsafes = SimpleNamespace(time=1.0, interrupted=interrupted, alarms=AlarmLog())
    flown = SimpleNamespace(
        completed=landed, landed=landed, takeoff_time=0.0, reason="", failsafes=failsafes, is_redirected=False
    )
    return flight_result(run, read_mission(path), SimpleNamespace(flight=flown), 9.0, 1.0, incomplete)


def test_flight_whose_truth_ends_in_the_air_is_no_failure_but_incomplete(tmp_path):
    rows = flight()
    cut = result(tmp_path, rows[: len(rows) // 2], (Incomplete("truth.csv", 4.06, REASON),))
    assert cut.exit_code == ExitStatus.INCOMPLETE == 3
    assert cut.summary["outcome"] == "completed"  # as far as the ground knows
    assert cut.summary["landing"] is None
    assert cut.summary["incomplete_records"] == {"truth.csv": 4.06}
    assert cut.summary["payload_tilt_max_deg"]["roll"] == 0.0  # of what there is
    assert json.loads((tmp_path / "run" / "summary.json").read_text()) == cut.summary


def test_summary_that_cannot_be_written_is_still_known(tmp_path):
    with no_new_content("summary.json*"):
        flown = result(tmp_path, flight(), ())
    assert flown.exit_code == ExitStatus.INCOMPLETE
    assert flown.incomplete == (Incomplete("summary.json", None, REASON),)
    assert "missed by" in flown.summary["reason"] and flown.summary["landing"]["on_ground"]
    assert not [path for path in (tmp_path / "run").iterdir() if "summary" in path.name]


def test_interruption_wins_over_incomplete_records_and_those_over_limits(tmp_path):
    missing = (Incomplete("truth.csv", 4.06, REASON),)
    interrupted = result(tmp_path, flight(), missing, interrupted=True)
    assert interrupted.exit_code == ExitStatus.INTERRUPTED
    (tmp_path / "other").mkdir()
    assert result(tmp_path / "other", flight(), missing, landed=False).exit_code == ExitStatus.INCOMPLETE


def test_line_says_which_records_end_when_and_why():
    found = [
        Incomplete("telemetry.tlog", 3.7, REASON), Incomplete("summary.json", None, REASON),
        Incomplete("truth.csv", 4.056, "Input/output error"),
    ]  # fmt: skip
    assert in_one_line(found) == (
        f"records incomplete: telemetry.tlog ends at 3.70 s, summary.json is missing ({REASON}); "
        "truth.csv ends at 4.06 s (Input/output error)"
    )
    assert [read_line(file.line() + "\n") for file in found] == found
    assert read_line("ready\n") is None


def test_flight_whose_manifest_cannot_be_written_is_refused(tmp_path, monkeypatch, capsys):
    def refuse(*_):
        raise AssertionError("something is started")

    monkeypatch.setattr(Simulator, "__init__", refuse)
    with no_new_content("manifest.json*"):
        assert gcs.app.cli.main(["fly", str(MISSIONS / "hop.toml"), "--run-dir", str(tmp_path / "run")]) == 2
        assert vehicle_sim.app.cli.main(["--base-port", "0", "--run-dir", str(tmp_path / "run")]) == 2
    assert capsys.readouterr().err.count(f"manifest.json: cannot be written: {REASON}\n") == 2
    assert not [*tmp_path.iterdir()]


def test_simulator_exits_with_3_when_its_records_are_incomplete(tmp_path, small_disk, monkeypatch, capsys):
    class Driver:
        def __init__(self, swarm, *_):
            self._swarm = swarm

        def run(self):
            small_disk.free = 2000
            self._swarm.advance_to(1.0)

    small_disk.free = 10_000
    monkeypatch.setattr("vehicle_sim.app.launch.RealTimeDriver", Driver)
    arguments = ["--base-port", "0", "--ground-port", "0", "--run-dir", str(tmp_path / "run")]
    assert vehicle_sim.app.cli.main(arguments) == ExitStatus.INCOMPLETE
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("records incomplete: truth.csv ends at 0.") and line.endswith(f"({REASON})")


def test_campaign_ends_with_3_when_a_result_cannot_be_written(tmp_path, monkeypatch, capsys):
    def fly(plan, run_dir):
        open_run_folder("", run_dir)
        return Flown(0, SUMMARY, "", 1.0)

    fly_nothing(monkeypatch, fly)
    path = campaign_file(tmp_path)
    with no_new_content("loss*.json.part"):
        code = gcs.app.cli.main(["faults", str(path), "--out", str(tmp_path / "out")])
    assert code == ExitStatus.INCOMPLETE
    assert "cannot be written: No space left on device: the campaign ends here" in capsys.readouterr().err
    assert not [*(tmp_path / "out" / "results").iterdir()]


def test_campaign_prints_what_it_has_when_its_report_cannot_be_written(tmp_path, monkeypatch, capsys):
    def fly(plan, run_dir):
        open_run_folder("", run_dir)
        return Flown(0, SUMMARY, "", 1.0)

    def full(*_):
        raise FULL

    fly_nothing(monkeypatch, fly)
    monkeypatch.setattr("gcs.campaign.faults.plans.FaultFlights.report", full)
    path = campaign_file(tmp_path)
    code = gcs.app.cli.main(["faults", str(path), "--out", str(tmp_path / "out")])
    assert code == ExitStatus.INCOMPLETE
    output = capsys.readouterr()
    assert "6 of 6 flights within their limits" in output.out
    assert "out: cannot be written: No space left on device: the flights are kept" in output.err


def test_flight_with_incomplete_records_passes_no_campaign(tmp_path, monkeypatch, capsys):
    def fly(plan, run_dir):
        open_run_folder("", run_dir)
        return Flown(ExitStatus.INCOMPLETE, SUMMARY, "", 1.0)

    fly_nothing(monkeypatch, fly)
    text = campaign_file(tmp_path).read_text().replace("[[fault]]", 'require = "safe"\n\n[[fault]]', 1)
    (tmp_path / "campaign.toml").write_text(text)
    path = str(tmp_path / "campaign.toml")
    code = gcs.app.cli.main(["faults", path, "--out", str(tmp_path / "out"), "--keep", "none"])
    assert code == ExitStatus.OUTSIDE_LIMITS
    assert "0 of " in capsys.readouterr().out


@pytest.mark.slow
def test_flight_on_a_full_disk_is_flown_and_says_what_is_missing(tmp_path):
    limit = 100_000  # bytes a file: less than the truth and the telemetry need, more than the manifest
    command = [sys.executable, "-m", "gcs", "fly", str(MISSIONS / "hop.toml"), "--run-dir", "run", "--json"]
    done = subprocess.run(
        command, env=ENVIRONMENT, cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE,
        preexec_fn=partial(resource.setrlimit, resource.RLIMIT_FSIZE, (limit, limit)),
    )  # fmt: skip
    assert done.returncode == ExitStatus.INCOMPLETE, done.stderr
    assert "Traceback" not in done.stderr
    (line,) = [line for line in done.stderr.splitlines() if line.startswith("records incomplete: ")]
    assert "telemetry.tlog ends at " in line and "truth.csv ends at " in line and "(File too large)" in line
    summary = json.loads(done.stdout)
    assert summary.pop("run_dir") == "run" and summary["outcome"] == "completed" and summary["contacts"] == 0
    assert set(summary["incomplete_records"]) == {"telemetry.tlog", "truth.csv", "estimate.csv"}
    run = tmp_path / "run"
    assert json.loads((run / "summary.json").read_text()) == summary
    truth = read_run(run)
    assert 0.0 <= summary["incomplete_records"]["truth.csv"] - truth.time[-1] < 0.05
    assert (run / "truth.csv").read_text().endswith("\n")
    assert not [*run.glob("*.part")]
