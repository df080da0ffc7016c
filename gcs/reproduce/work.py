"""Carries out a plan on all cores: simulations in processes, flights as ``gcs fly`` with a simulated swarm each."""

import multiprocessing
import signal
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from multiprocessing.pool import Pool
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from gcs.campaign.flight_worker import POLL, FlightWorker
from gcs.campaign.process_pool import all_cores, fly_process, run_parallel
from gcs.errors import GcsError
from gcs.reproduce.plan import Plan
from gcs.reproduce.simulation import Case, Flown, simulate


@dataclass
class Results:
    """Run folders and summaries of the flights by name, and simulations by section and name."""

    folders: Mapping[str, Path] = field(default_factory=dict)
    simulations: dict[tuple[str, str], Flown] = field(default_factory=dict)
    flights: dict[str, dict[str, Any]] = field(default_factory=dict)


def run(plan: Plan, missions: Path, out: Path, jobs: int | None, done: Callable[[str], None]) -> Results:
    """Carry out ``plan`` with ``jobs`` in parallel (None: one per core); ``done`` receives each name as it ends.

    An interrupt ends all of it. Raises :class:`GcsError` for a flight that did not start; any other flight is a result.
    """
    results, jobs = Results({name: out / "flights" / name for name in plan.flights}), jobs or all_cores()

    def carry_out(task: tuple[str, str], worker: FlightWorker) -> str | None:
        section, name = task
        if task in plan.cases:
            simulated = _simulated(plan.cases[task], processes, worker.stop)
            if simulated is None:
                return None
            results.simulations[task] = simulated
        else:
            mission, controller = missions / plan.flights[name][0], plan.flights[name][1]
            flown = fly_process(mission, ("--controller", controller), results.folders[name], worker)
            if flown is None:
                return None
            if not flown.summary:
                raise GcsError(f"{mission}: {flown.reason or 'the flight did not end'}")
            results.flights[name] = flown.summary
        return f"{section} {name}"

    # The longest first, so that no core idles at the end. Spawned: a fork would inherit the progress display's threads.
    tasks = [*(("flights", name) for name in plan.flights)]
    tasks += sorted(plan.cases, key=lambda task: -plan.cases[task].duration)
    with multiprocessing.get_context("spawn").Pool(jobs, _prepare) as processes:
        run_parallel(tasks, jobs, carry_out, lambda task: None, lambda task, name: done(name))
    return results


def _simulated(case: Case, processes: Pool, stop: threading.Event) -> Flown | None:
    pending = processes.apply_async(simulate, (case,))
    while not stop.is_set():
        pending.wait(POLL)
        if pending.ready():
            return pending.get()
    return None


def _prepare() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent process
    threadpool_limits(limits=1)
