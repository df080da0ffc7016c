"""Carries out a plan on all cores: simulations and flights, each in a process."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import gcs
from gcs.campaign.executors import WorkerProcesses, carry_out
from gcs.campaign.folder import remove_folder
from gcs.errors import GcsError
from gcs.reproduce.plan import Plan
from gcs.reproduce.simulation import Flown, simulate

FLIGHTS = "flights"
"""Their section."""


@dataclass
class Results:
    """Run folders of the flights by name, and simulations by section and name."""

    folders: Mapping[str, Path] = field(default_factory=dict)
    simulations: dict[tuple[str, str], Flown] = field(default_factory=dict)


def run(plan: Plan, missions: Path, out: Path, jobs: int | None, done: Callable[[str], None]) -> Results:
    """Carry out ``plan`` with ``jobs`` in parallel (None: one per core); ``done`` receives each name as it ends.

    An interrupt ends all of it. Raises :class:`GcsError` for a flight that was not flown, and when a process is killed.
    """
    results = Results({name: out / "flights" / name for name in plan.flights})
    # The longest first, so that no core idles at the end.
    tasks: dict[tuple[str, str], Callable[[], Any]] = {
        (FLIGHTS, name): partial(_fly, missions / mission, controller, results.folders[name])
        for name, (mission, controller) in plan.flights.items()
    }
    cases = sorted(plan.cases.items(), key=lambda item: -item[1].duration)
    tasks |= {task: partial(simulate, case) for task, case in cases}

    def ended(item: tuple[tuple[str, str], Callable[[], Any]], result: Any) -> None:
        (section, name), _ = item
        if result is None:
            raise GcsError(f"{section} {name}: its process was killed")
        if section != FLIGHTS:
            results.simulations[section, name] = result
        done(f"{section} {name}")

    with WorkerProcesses(jobs) as executor:
        carry_out(executor, _carry_out, tasks.items(), ended)
    return results


def _carry_out(item: tuple[tuple[str, str], Callable[[], Any]]) -> Any:
    _, call = item
    return call()


def _fly(mission: Path, controller: str, run_dir: Path) -> str:
    remove_folder(run_dir)  # of a process that was killed
    return gcs.fly(mission, controller=controller, run_dir=run_dir).outcome
