"""Runs a plan on all cores: simulations in processes, flights as ``gcs fly`` with a simulated swarm of their own."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from multiprocessing.pool import Pool
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from gcs.campaign.process_pool import all_cores
from gcs.errors import GcsError
from gcs.reproduce.plan import Plan
from gcs.reproduce.simulation import Case, Flown, simulate

LONGEST_FLIGHT = 900.0
"""s of wall time after which a flight is given up."""
POLL = 0.2  # s


@dataclass
class Results:
    """Simulations by section and name, and summaries and run folders of the flights by name."""

    simulations: dict[tuple[str, str], Flown] = field(default_factory=dict)
    flights: dict[str, dict[str, Any]] = field(default_factory=dict)
    folders: dict[str, Path] = field(default_factory=dict)


def run(plan: Plan, missions: Path, out: Path, jobs: int | None, done: Callable[[str], None]) -> Results:
    """Run everything of ``plan``; ``done`` is called with each name as it ends. ``jobs`` at a time, None: one a core.

    An interrupt ends all of it. Raises :class:`GcsError` for a flight that did not even start; one that ends badly
    is a result.
    """
    results, stop, jobs = Results(), threading.Event(), jobs or all_cores()
    # Fresh processes: forked ones would inherit the threads of the progress display.
    with multiprocessing.get_context("spawn").Pool(jobs, _prepare) as processes, ThreadPoolExecutor(jobs) as threads:
        try:
            pending: dict[Future[Any], tuple[str, str]] = {}
            for name, (mission, controller) in plan.flights.items():
                results.folders[name] = out / "flights" / name
                flight = threads.submit(fly, missions / mission, controller, results.folders[name], stop)
                pending[flight] = ("flights", name)
            # The longest first, so that all cores have something to do until the end.
            for key, case in sorted(plan.cases.items(), key=lambda item: -item[1].duration):
                pending[threads.submit(_simulated, case, processes, stop)] = key
            for future in as_completed(pending):
                section, name = pending[future]
                if section == "flights":
                    results.flights[name] = future.result()
                else:
                    results.simulations[section, name] = future.result()
                done(f"{section} {name}")
        finally:
            stop.set()
            threads.shutdown(cancel_futures=True)
    return results


def fly(mission: Path, controller: str, folder: Path, stop: threading.Event) -> dict[str, Any]:
    """The summary of ``gcs fly``, in PyBullet through MAVLink, in lockstep; empty once ``stop`` is set."""
    command = [
        sys.executable, "-m", "gcs", "fly", str(mission), "--controller", controller, "--run-dir", str(folder),
        "--json", "--no-pictures",
    ]  # fmt: skip
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # Ctrl-C is for this program, which ends its flights itself
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
    )
    deadline = time.monotonic() + LONGEST_FLIGHT
    while True:
        try:
            said, errors = process.communicate(timeout=POLL)
            break
        except subprocess.TimeoutExpired:
            if stop.is_set() or time.monotonic() > deadline:
                process.kill()  # the simulator ends with it: it reads the end of its standard input
    if stop.is_set():
        return {}
    try:
        return dict(json.loads(said))
    except ValueError:
        lines = errors.strip().splitlines()
        raise GcsError(f"{mission}: {lines[-1] if lines else 'the flight did not end'}") from None


def _simulated(case: Case, processes: Pool, stop: threading.Event) -> Flown | None:
    pending = processes.apply_async(simulate, (case,))
    while not stop.is_set():
        pending.wait(POLL)
        if pending.ready():
            return pending.get()
    return None


def _prepare() -> None:
    # Ctrl-C is for the program itself.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(limits=1)
