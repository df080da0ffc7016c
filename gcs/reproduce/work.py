"""Runs a plan on all cores: simulations in processes, flights as ``gcs fly`` with a simulated swarm of their own."""

from __future__ import annotations

import json
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from gcs.errors import GcsError
from gcs.reproduce.plan import Plan
from gcs.reproduce.simulation import Case, Flown, simulate

LONGEST_FLIGHT = 900.0
"""s of wall time after which a flight is given up."""


@dataclass
class Results:
    """Simulations by section and name, and summaries of the flights by name."""

    simulations: dict[tuple[str, str], Flown] = field(default_factory=dict)
    flights: dict[str, dict[str, Any]] = field(default_factory=dict)
    folders: dict[str, Path] = field(default_factory=dict)


def run(plan: Plan, missions: Path, out: Path, jobs: int | None, done: Callable[[str], None]) -> Results:
    """Everything of ``plan``; ``done`` is told each name as it ends. ``jobs`` at a time, None: one a core.

    Raises :class:`GcsError` for a flight that did not even start; one that ends badly is a result.
    """
    results = Results()
    workers = jobs or len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else jobs or os.cpu_count() or 1
    # Fresh processes: a forked one would inherit the threads of the progress display.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, context, initializer=_prepare)
    try:
        pending: dict[Future[Any], tuple[str, str]] = {}
        for name, (mission, controller) in plan.flights.items():
            results.folders[name] = out / "flights" / name
            pending[pool.submit(fly, missions / mission, controller, results.folders[name])] = ("flights", name)
        for key, case in sorted(plan.cases.items(), key=lambda item: -item[1].duration):
            pending[pool.submit(_simulated, case)] = key
        for future in as_completed(pending):
            section, name = pending[future]
            if section == "flights":
                results.flights[name] = future.result()
            else:
                results.simulations[section, name] = future.result()
            done(f"{section} {name}")
    finally:
        pool.shutdown(cancel_futures=True)
    return results


def fly(mission: Path, controller: str, folder: Path) -> dict[str, Any]:
    """The summary of ``gcs fly``, in PyBullet through MAVLink, in lockstep."""
    command = [
        sys.executable, "-m", "gcs", "fly", str(mission), "--controller", controller, "--run-dir", str(folder),
        "--json", "--no-pictures",
    ]  # fmt: skip
    try:
        ended = subprocess.run(
            command, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=LONGEST_FLIGHT, check=False
        )
    except subprocess.TimeoutExpired:
        raise GcsError(f"{mission}: the flight took longer than {LONGEST_FLIGHT:g} s") from None
    try:
        summary = json.loads(ended.stdout)
    except json.JSONDecodeError:
        said = ended.stderr.strip().splitlines()
        raise GcsError(f"{mission}: {said[-1] if said else f'gcs fly ended with {ended.returncode}'}") from None
    return dict(summary)


def _prepare() -> None:
    threadpool_limits(limits=1)


def _simulated(case: Case) -> Flown:
    return simulate(case)
