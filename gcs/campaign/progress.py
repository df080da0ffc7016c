"""The progress line while many flights go on side by side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn


class FlightResult(Protocol):
    """What came of one flight."""

    @property
    def name(self) -> str:
        """Of the flight."""

    @property
    def passed(self) -> bool:
        """Whether it was within its limits."""


R = TypeVar("R", bound=FlightResult)


class Flights(Protocol[R]):
    """What is flown side by side: a campaign, a study."""

    @property
    def results(self) -> list[R]:
        """Of those flown so far."""

    @property
    def total(self) -> int:
        """Number of flights."""

    def fly(self, started: Callable[[str], None], ended: Callable[[R], None]) -> None:
        """Fly those that have no result yet."""


def show_progress(campaign: Flights[R], console: Console, what: str, line: Callable[[R], str]) -> None:
    """Fly with a progress line at a terminal; elsewhere one ``line`` a flight."""
    failed = sum(not result.passed for result in campaign.results)
    flying: list[str] = []
    progress = Progress(
        TextColumn(what),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[failed]} failed  {task.fields[flying]}"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )
    with progress:
        task = progress.add_task(what, total=campaign.total, completed=len(campaign.results), failed=failed, flying="")

        def started(name: str) -> None:
            flying.append(name)
            progress.update(task, flying=" ".join(flying[:6]))

        def ended(result: R) -> None:
            nonlocal failed
            failed += not result.passed
            flying.remove(result.name)
            progress.update(task, advance=1, failed=failed, flying=" ".join(flying[:6]))
            if not console.is_terminal or not result.passed:
                console.print(line(result), markup=False)

        campaign.fly(started, ended)
