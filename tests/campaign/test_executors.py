"""Executors of a campaign: whoever carries its flights out, and whatever dies, the results are the same."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
from concurrent.futures import BrokenExecutor, Future
from pathlib import Path

import distributed
import pytest
from calls import go_on, kill_this_process, process_of
from file_events import wait_for_ends, wait_for_file
from flights import HOP
from programs import ENVIRONMENT
from small_campaign import SUMMARY, InThisThread, campaign_file, flown_in, fly_nothing

from gcs import numerics
from gcs.app.cli import main
from gcs.campaign.engine import Campaign
from gcs.campaign.executors import WorkerProcesses, carry_out
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.result import Flown
from gcs.errors import GcsError

# Calls and what becomes of them


class Scripted(InThisThread):
    """Each call ends as the next of its script says: with an exception, or by itself."""

    def __init__(self, **script):
        self.script, self.calls, self.abandoned = script, [], False

    def submit(self, call, /, task):
        name = getattr(task, "name", task)
        self.calls.append(name)
        future = Future()
        end = self.script[name].pop(0) if self.script.get(name) else None
        if end is None:
            future.set_result(call(task))
        elif end is not Ellipsis:  # which goes on
            future.set_exception(end)
        return future

    def shutdown(self, wait=True, *, cancel_futures=False):
        self.abandoned = not wait


class KilledWorker(Exception):
    """As Dask's."""


def carried_out(executor, tasks="abc"):
    found = []
    carry_out(executor, str.upper, tasks, lambda task, result: found.append((task, result)))
    return found


def test_call_whose_process_was_killed_is_repeated_once():
    executor = Scripted(a=[BrokenExecutor()], b=[BrokenExecutor(), BrokenExecutor()])
    assert sorted(carried_out(executor)) == [("a", "A"), ("b", None), ("c", "C")]
    assert sorted(executor.calls) == ["a", "a", "b", "b", "c"] and not executor.abandoned


def test_call_that_dask_has_given_up_is_not_repeated():
    executor = Scripted(a=[KilledWorker()])
    assert carried_out(executor) == [("a", None), ("b", "B"), ("c", "C")]
    assert executor.calls == ["a", "b", "c"]


def test_executor_holds_a_bounded_number_of_calls(monkeypatch):
    monkeypatch.setattr("gcs.campaign.executors.WINDOW", 2)
    executor, held = Scripted(), []
    carry_out(executor, str.upper, iter("abcd"), lambda task, _: held.append((task, list(executor.calls))))
    assert held == [("a", ["a", "b"]), ("b", ["a", "b", "c"]), ("c", ["a", "b", "c", "d"]), ("d", ["a", "b", "c", "d"])]


@pytest.mark.parametrize("error", [ZeroDivisionError(), KeyboardInterrupt()])
def test_any_other_exception_abandons_the_calls_under_way(error):
    executor = Scripted(a=[error], c=[...])
    with pytest.raises(type(error)):
        carried_out(executor)
    assert executor.abandoned


def test_calls_that_the_scheduler_drops_are_an_error():
    executor = Scripted(a=[...])
    submit = executor.submit

    def dropped(call, /, task):
        future = submit(call, task)
        future.cancel()
        future.set_running_or_notify_cancel()
        return future

    executor.submit = dropped
    with pytest.raises(GcsError, match="start again to resume"):
        carried_out(executor, "a")


def test_flight_whose_process_is_killed_twice_is_reported(tmp_path, monkeypatch):
    fly_nothing(monkeypatch, lambda plan, run_dir: Flown(0, SUMMARY, "", 1.0))
    campaign = Campaign(FaultFlights(read_campaign(campaign_file(tmp_path))), tmp_path / "out")
    campaign.fly(Scripted(**{campaign.plans[1].name: [BrokenExecutor(), BrokenExecutor()]}), lambda result: None)
    assert [result.passed for result in campaign.results] == [True, False, True, True, True, True]
    killed = campaign.results[1]
    assert (killed.outcome, killed.reason) == ("failed", "its process was killed 2 times")


# Processes of this machine


def test_process_serves_many_calls_and_a_killed_one_fails_its_own_only():
    with WorkerProcesses(1) as executor:
        killed = executor.submit(kill_this_process)
        first, second = (executor.submit(process_of).result() for _ in range(2))
        with pytest.raises(BrokenExecutor):
            killed.result()
        with pytest.raises(ZeroDivisionError):
            executor.submit(divmod, 1, 0).result()
        assert executor.submit(process_of).result() == first == second != os.getpid()
    wait_for_ends(lambda: [first] if Path(f"/proc/{first}").exists() else [])


def test_calls_under_way_end_with_the_executor(tmp_path):
    executor = WorkerProcesses(1)
    future = executor.submit(go_on, tmp_path)
    wait_for_file(tmp_path, "*")
    executor.shutdown(wait=False)
    assert isinstance(future.exception(), BrokenExecutor)


def test_processes_end_with_the_one_that_started_them(tmp_path):
    program = (
        "import pathlib, sys; sys.path.insert(0, 'tests/support')\n"
        "from calls import go_on\nfrom gcs.campaign.executors import WorkerProcesses\n"
        "if __name__ == '__main__': WorkerProcesses(1).submit(go_on, pathlib.Path(sys.argv[1])).result()"
    )
    command = [sys.executable, "-c", program, tmp_path]
    with subprocess.Popen(command, env=ENVIRONMENT, cwd=Path(__file__).parents[2]) as parent:
        wait_for_file(tmp_path, "*")
        parent.kill()
    [process] = [int(path.name) for path in tmp_path.iterdir()]
    wait_for_ends(lambda: [process] if Path(f"/proc/{process}").exists() else [])


# Flights

REAL = """
[campaign]
name = "real"
missions = ["hop.toml"]
seeds = [1, 2]

[[fault]]
name = "loss"
kind = "packet_loss"
start = 1.0
probability = 0.1
"""


def kill_a_flight(out):
    """Kill the process of a flight that records."""
    wait_for_file(out / "flights", ".*/truth.csv")
    os.kill(int(next((out / "flights").glob(".*/truth.csv")).parent.name.split("-")[-2]), signal.SIGKILL)


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A campaign file, and the table of its flights one after the other in this process, the last first."""
    folder = tmp_path_factory.mktemp("alone")
    path = campaign_file(folder, REAL)
    (folder / "hop.toml").write_text(HOP)
    campaign = Campaign(FaultFlights(read_campaign(path)), folder / "out")
    campaign.plans.reverse()
    flown_in(campaign)
    campaign.plans.reverse()
    campaign.generator.report(campaign.results, campaign.out)
    return path, (folder / "out" / "results.csv").read_bytes()


@contextlib.contextmanager
def dask(*arguments):
    """A program of Dask, started as a user starts it: without the numeric code that this project chooses."""
    environment = {name: value for name, value in ENVIRONMENT.items() if name not in numerics._KERNELS}
    with subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments, "--no-dashboard"], env=environment, stderr=subprocess.DEVNULL
    ) as program:
        try:
            yield
        finally:
            program.terminate()


@pytest.fixture
def scheduler(tmp_path):
    """Address of a Dask scheduler with two workers."""
    file = tmp_path / "scheduler.json"
    with (
        dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)),
        dask("worker", "--scheduler-file", str(file), "--nworkers", "2", "--nthreads", "1"),
    ):
        wait_for_file(tmp_path, file.name)
        # The file is there before it is written, for which the client waits.
        with distributed.Client(scheduler_file=str(file)) as client:
            client.wait_for_workers(2)
            address = client.scheduler.address
        yield address


@pytest.mark.slow
@pytest.mark.parametrize(
    "cluster", [pytest.param(False, marks=pytest.mark.long), True], ids=["processes", "cluster"]
)  # processes of this machine, killed as well: tests/campaign/test_fault_campaign.py
def test_results_are_the_same_bytes_whoever_flies_and_whatever_is_killed(alone, tmp_path, cluster, request):
    path, expected = alone
    out = tmp_path / "out"
    (out / "flights").mkdir(parents=True)
    (out / "campaign.json").write_text('{"faults": "real"}')
    where = ["--scheduler", request.getfixturevalue("scheduler")] if cluster else ["--jobs", "2"]
    killer = threading.Thread(target=kill_a_flight, args=(out,))
    killer.start()
    code = main(["faults", str(path), "--out", str(out), *where])
    killer.join()
    assert code == 0 and (out / "results.csv").read_bytes() == expected
    assert not [*(out / "flights").iterdir()]
