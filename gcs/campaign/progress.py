"""The progress display of a campaign."""

from collections.abc import Sequence
from concurrent.futures import Executor

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from gcs.campaign.engine import Campaign
from gcs.campaign.flight import FlightPlan
from gcs.campaign.result import Result


def fly_with_progress(
    campaign: Campaign, executor: Executor, console: Console, plans: Sequence[FlightPlan] | None = None
) -> None:
    """Fly with a progress bar at a terminal and a line for each flight that fails; elsewhere a line for each flight.

    ``plans``: those to be flown; None: all.
    """
    what = campaign.generator.what
    failed = sum(not result.passed for result in campaign.results)
    progress = Progress(
        TextColumn(what),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[failed]} failed"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )
    with progress:
        done = len(campaign.results)
        total = len(campaign.plans) if plans is None else done + len(plans)
        task = progress.add_task(what, total=total, completed=done, failed=failed)

        def ended(result: Result) -> None:
            nonlocal failed
            failed += not result.passed
            progress.update(task, advance=1, failed=failed)
            if not console.is_terminal or not result.passed:
                console.print(flight_line(campaign, result), markup=False)

        campaign.fly(executor, ended, plans)


def flight_line(campaign: Campaign, result: Result) -> str:
    """Return a flight on one line."""
    figures = []
    for title, column, unit in campaign.generator.shown:
        value = result.figure(column)
        figures.append(f"{title} {'-' if value is None else f'{value:.2f}'} {unit}")
    verdict = "passed" if result.passed else f"FAILED: {result.outcome}"
    failures = f" ({result.failures})" if result.failures else ""
    return f"{result.name}: {', '.join(figures)}, {result.wall_s:.0f} s: {verdict}{failures}"
