"""The two tables of ``docs/faults.md``, flown and written by one command.

``python tests/pages/fault_tables_page.py docs/faults.md missions/detection.toml missions/false_alarms.toml``
"""

import argparse
import resource
import sys
from collections.abc import Sequence
from pathlib import Path

from page_tables import commit_of, made_by, markdown_table, renewed
from rich.console import Console

from gcs.campaign.engine import Campaign
from gcs.campaign.executors import WorkerProcesses
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.detection_table import Detections, seconds
from gcs.campaign.faults.false_alarms import CONFIDENCE, FalseAlarms, false_alarms
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.faults.sources import ISOLATIONS
from gcs.campaign.folder import plain
from gcs.campaign.progress import fly_with_progress
from gcs.campaign.result import Result
from gcs.errors import GcsError

DETECTION, FALSE_ALARMS = "table of detection", "table of false alarms"
"""Names of the places in the page."""


def main(arguments: Sequence[str]) -> int:
    """Fly what has not been flown yet, and write the tables; return 1 if a row is not within its limits, 2 for no page.

    What was interrupted (130) goes on when started again.
    """
    parser = argparse.ArgumentParser(description="Write the tables of detection and of false alarms into a page.")
    parser.add_argument("page", type=Path, metavar="PAGE")
    parser.add_argument(
        "campaigns", type=Path, nargs="+", metavar="CAMPAIGN", help="campaign files, see docs/faults.md"
    )
    parser.add_argument("--jobs", type=int, help="parallel flights (default: one per core)")
    parser.add_argument("--out", type=Path, default=Path("runs"), help="folder of the flights (default: runs)")
    options = parser.parse_args(arguments)
    console = Console(highlight=False, soft_wrap=True)
    try:
        page = options.page.read_text(encoding="utf-8")
        commit = commit_of(options.campaigns[0].absolute().parent)
        rows: list[Detections] = []
        results: list[Result] = []
        problems: list[str] = []
        for path in options.campaigns:
            flights = FaultFlights(read_campaign(path))
            out = options.out / plain(flights.file.name)
            before = cpu_minutes()
            campaign = Campaign(flights, out)
            with WorkerProcesses(options.jobs) as executor:
                fly_with_progress(campaign, executor, console)
            console.print(f"{flights.file.name}: {cpu_minutes() - before:.1f} minutes of CPU", markup=False)
            rows += flights.detections(campaign.results)
            results += campaign.results
            problems += flights.problems(campaign.results)
            flights.report(campaign.results, out)
        files = " ".join(map(_shown, (options.page, *options.campaigns)))
        command = f"python tests/pages/fault_tables_page.py {files}"
        page = renewed(page, DETECTION, made_by(command, commit, detections_markdown(rows)))
        page = renewed(page, FALSE_ALARMS, made_by(command, commit, false_alarms_markdown(false_alarms(results))))
        options.page.write_text(page, encoding="utf-8")
    except KeyboardInterrupt:
        return 130
    except (GcsError, OSError) as error:
        console.print(str(error), style="red", markup=False)
        return 2
    for problem in problems:
        console.print(problem, style="red", markup=False)
    return 1 if problems else 0


def detections_markdown(rows: Sequence[Detections]) -> str:
    """Return the rows as a table in Markdown."""
    return markdown_table([
        {
            "fault": row.fault,
            "true source": row.true_source,
            "flights": str(row.flights),
            **{verdict: str(getattr(row, verdict) or "") for verdict in ISOLATIONS},
            "first alarm": ", ".join(f"`{code}`" for code in row.first_alarms.split(", ") if code),
            "median": _delay(row.median_s),
            "worst": _delay(row.worst_s),
            "latest": _delay(row.latest_s),
            "named in its place": row.named_wrongly,
        }
        for row in rows
    ])  # fmt: skip


def _delay(time: float | None) -> str:
    return "" if time is None else f"{seconds(time)} s"


def false_alarms_markdown(rows: Sequence[FalseAlarms]) -> str:
    """Return the rows as a table in Markdown."""
    bound = f"upper {CONFIDENCE:.0%} bound".replace("%", " %")
    return markdown_table([
        {
            "without a fault": row.mission,
            "flights": str(row.flights) + (f" ({row.not_counted} without a record)" if row.not_counted else ""),
            "hours": f"{row.hours:.3f}",
            "false alarms": str(row.alarms),
            "in flights": str(row.flights_with_alarms),
            "per hour": f"{row.per_hour:.1f}",
            bound: f"{row.per_hour_bound:.1f}",
            "codes": row.codes,
        }
        for row in rows
    ])  # fmt: skip


def _shown(path: Path) -> str:
    """Return a file as it is named in the project's folder: the page has no path of a machine."""
    here = Path.cwd()
    return str(path.absolute().relative_to(here)) if path.absolute().is_relative_to(here) else path.name


def cpu_minutes() -> float:
    """Return the CPU time of this process and of those that it has waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used) / 60.0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
