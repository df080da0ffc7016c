"""Commands that fly campaigns: their common arguments, the run, and the report that is printed."""

import argparse
from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from pathlib import Path

from rich.console import Console, Group

from gcs.app.arguments import number_of_jobs
from gcs.app.exit_status import ExitStatus
from gcs.app.logs import LOG
from gcs.campaign.engine import KEEP, Campaign, PlanGenerator
from gcs.campaign.executors import WorkerProcesses
from gcs.campaign.progress import fly_with_progress
from gcs.campaign.result import Result
from gcs.campaign.scenarios.levels import fly_levels, levels_report, undecided
from gcs.campaign.tables import failed_flights, headline
from gcs.errors import UnusableInput
from gcs.extras import extra

WIDTH = 150
"""Characters of a line where standard output is no terminal."""


def add_campaign_arguments(parser: argparse.ArgumentParser, out: str) -> None:
    """Add ``--jobs``, ``--scheduler``, ``--out`` (whose default is ``out``) and ``--keep``."""
    add = parser.add_argument
    add("--jobs", type=number_of_jobs, metavar="J", help="parallel flights (default: auto, one per core)")
    add("--scheduler", metavar="ADDRESS",
        help="fly on the Dask cluster of this scheduler, such as tcp://10.0.0.1:8786; its workers must share the file "
        "system of this machine")  # fmt: skip
    add("--out", type=Path, metavar="DIR", help=f"folder (default: {out})")
    add("--keep", choices=KEEP, default="failures", help="the flights whose run folders are kept (default: failures)")


def campaign_console() -> Console:
    """Return the console of a campaign: a line for each flight where it is no terminal."""
    console = Console(highlight=False, soft_wrap=True)
    if not console.is_terminal:
        console.width = WIDTH
    return console


def run_campaign(
    generator: PlanGenerator, out: Path, arguments: argparse.Namespace, planning: PlanGenerator | None = None
) -> ExitStatus:
    """Fly a campaign in the folder ``out``, and print its report.

    ``planning``: the same flights on the planning level, in a folder within, which decides what is flown in full.
    """
    console, interrupted = campaign_console(), False
    with executor_of(arguments) as executor:
        with console.status("writing the missions"):
            campaign = Campaign(generator, out, arguments.keep)
            planned = None if planning is None else Campaign(planning, out / "planning", arguments.keep)
        try:
            if planned is None:
                fly_with_progress(campaign, executor, console)
            else:
                fly_levels(planned, campaign, arguments.budget, executor, console)
        except KeyboardInterrupt:
            interrupted = True
    results = judged = campaign.results
    problems = generator.problems(results)
    reported = not results or report(generator, results, problems, out, console)
    if planned is not None:
        console.print(Group(*levels_report(planned.results, results)))
        judged = [*results, *undecided(planned.results, results)]
    if interrupted:
        left = f" with {len(campaign.plans) - len(results)} flights to go" if planned is None else ""
        LOG.error("interrupted%s: start the command again to resume", left)
        return ExitStatus.INTERRUPTED
    if not reported:
        return ExitStatus.INCOMPLETE
    return ExitStatus.OUTSIDE_LIMITS if problems or not all(result.passed for result in judged) else ExitStatus.DONE


def executor_of(arguments: argparse.Namespace) -> AbstractContextManager[Executor]:
    """Return what carries out the flights: processes of this machine, or a cluster."""
    if arguments.scheduler is None:
        return WorkerProcesses(arguments.jobs)
    if arguments.jobs is not None:
        raise UnusableInput(f"--jobs {arguments.jobs} is for this machine: the scheduler knows its workers")
    with extra("cluster", "--scheduler"):
        from gcs.campaign.cluster import cluster
    return cluster(arguments.scheduler)


def report(
    generator: PlanGenerator, results: Sequence[Result], problems: Sequence[str], out: Path, console: Console
) -> bool:
    """Write and print the report of a campaign; return whether it could be written."""
    first, failed = headline(results, generator.what, generator.passed_means), failed_flights(results)
    try:
        parts, files = generator.report(results, out)
    except (OSError, UnusableInput) as error:
        console.print(Group(first, *failed))
        reason = str(error)
        if isinstance(error, OSError):
            reason = f"{error.filename or out}: cannot be written: {error.strerror}"
        LOG.error("%s: the flights are kept; start the command again for its report", reason)
        return False
    console.print(Group(first, *parts, *failed))
    for problem in problems:
        console.print(problem, style="red", markup=False)
    console.print(f"Results   {'  '.join(map(str, files))}", markup=False)
    return True
