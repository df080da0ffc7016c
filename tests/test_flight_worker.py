"""Warm processes of a campaign: flights in forks are what they are in programs of their own, and end as these do."""

import contextlib
import json
import os
import signal
import struct
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from file_events import wait_for_ends, wait_for_file
from flights import HOP, system_file
from programs import ENVIRONMENT, gcs_fly

from gcs.campaign.flight_worker import FlightWorker
from gcs.campaign.process_pool import fly_process, run_parallel
from gcs.record.reader import read_table

pytestmark = pytest.mark.slow

TIMES = {"real_time_factor", "step_time_ms", "step_parts_ms", "solver"}
"""Figures of a summary that are compute times."""


@pytest.fixture(scope="module")
def hop(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mission")
    system_file(folder)
    path = folder / "hop.toml"
    path.write_text(HOP)
    return path


def records(folder):
    """Content of a run folder by file, without times of the machine and the command line."""
    content = {path.name: path.read_bytes() for path in folder.iterdir()}
    for name, left_out in (("manifest.json", {"command", "start"}), ("summary.json", TIMES)):
        table = json.loads(content[name])
        content[name] = {key: value for key, value in table.items() if key not in left_out}
    steps = read_table(folder / "steps.csv")
    content["steps.csv"] = [steps[name].tolist() for name in steps.dtype.names if "_ms" not in name]
    content["telemetry.tlog"] = messages(content["telemetry.tlog"])
    return content


def messages(log):
    """Frames of MAVLink 2 without the times of their reception."""
    frames, at = [], 0
    while at < len(log):
        begin = at + struct.calcsize(">Q")
        at = begin + 12 + log[begin + 1] + (13 if log[begin + 2] & 1 else 0)
        frames.append(log[begin:at])
    return frames


def marked(mark):
    """Processes with ``mark`` in the environment that they, or the process that forked them, began with."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if mark.encode() in (process / "environ").read_bytes().split(b"\0"):
                found.append(int(process.name))
    return found


@pytest.fixture
def mark(monkeypatch, request):
    monkeypatch.setenv("FLIGHT_WORKER_TEST", f"{request.node.name}-{os.getpid()}")
    return f"FLIGHT_WORKER_TEST={request.node.name}-{os.getpid()}"


def test_warm_flights_record_what_a_cold_flight_records(hop, tmp_path):
    with FlightWorker() as worker:
        first, second = (fly_process(hop, (), tmp_path / name, worker) for name in ("first", "second"))
    code, summary = gcs_fly(hop, tmp_path / "cold", "--no-pictures")
    assert (first.exit_code, second.exit_code, code) == (0, 0, 0)
    assert summary.pop("run_dir") == str(tmp_path / "cold")
    assert {key: first.summary[key] for key in summary if key not in TIMES} == {
        key: summary[key] for key in summary if key not in TIMES
    }
    cold = records(tmp_path / "cold")
    assert {"truth.csv", "estimate.csv", "telemetry.tlog"} <= set(cold)
    assert records(tmp_path / "first") == cold
    assert records(tmp_path / "second") == cold


def test_refused_or_killed_flight_leaves_the_next_undisturbed(hop, tmp_path, mark):
    with FlightWorker() as worker:
        refused = fly_process(tmp_path / "none.toml", (), tmp_path / "refused", worker)
        assert refused.exit_code == 2 and "none.toml" in refused.reason and refused.summary == {}
        [warm] = marked(mark)

        def kill():
            wait_for_file(tmp_path, ".killed-*/truth.csv")
            [flight] = map(int, Path(f"/proc/{warm}/task/{warm}/children").read_text().split())
            os.kill(flight, signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        assert fly_process(hop, (), tmp_path / "killed", worker).exit_code == -signal.SIGKILL
        killer.join()
        wait_for_ends(lambda: [process for process in marked(mark) if process != warm])  # the simulator, too
        flown = fly_process(hop, (), tmp_path / "flown", worker)
        assert flown.exit_code == 0 and flown.summary["completed"]
        os.kill(warm, signal.SIGKILL)
        assert fly_process(hop, (), tmp_path / "lost", worker).exit_code == -signal.SIGKILL
        assert fly_process(hop, (), tmp_path / "again", worker).exit_code == 0
    assert marked(mark) == []


def test_flight_that_takes_too_long_is_ended(hop, tmp_path, mark):
    with FlightWorker() as worker:
        code, output, messages = worker.run(["fly", str(hop), "--run-dir", str(tmp_path / "run"), "--with-parent"], 0.0)
        assert (code, output, messages) == (-signal.SIGKILL, "", "")
    wait_for_ends(lambda: marked(mark))


def test_interrupted_flights_end_and_leave_nothing(hop, tmp_path, mark):
    def begun(_):
        wait_for_file(tmp_path, ".flight-*/truth.csv")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_parallel(
            [1, 2], 2, lambda n, worker: fly_process(hop, (), tmp_path / f"flight-{n}", worker), begun, lambda *_: None
        )
    wait_for_ends(lambda: marked(mark))
    assert list(tmp_path.iterdir()) == []


def test_flights_end_with_the_process_that_started_them(hop, tmp_path, mark):
    program = (
        "import sys; from pathlib import Path; from gcs.campaign.process_pool import fly_process\n"
        "from gcs.campaign.flight_worker import FlightWorker\n"
        "fly_process(Path(sys.argv[1]), (), Path(sys.argv[2]), FlightWorker())"
    )
    environment = ENVIRONMENT | {"FLIGHT_WORKER_TEST": mark.partition("=")[2]}
    with subprocess.Popen([sys.executable, "-c", program, hop, tmp_path / "run"], env=environment) as campaign:
        wait_for_file(tmp_path, ".run-*/truth.csv")
        campaign.kill()
    wait_for_ends(lambda: marked(mark))
