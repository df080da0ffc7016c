"""The two tables of ``docs/faults.md``, flown and written by one command.

``python -m gcs.campaign.faults.tables_page docs/faults.md missions/detection.toml missions/false_alarms.toml``
"""

import argparse
import resource
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from gcs.campaign.engine import Campaign
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.detection_table import Detections, detections_markdown
from gcs.campaign.faults.false_alarms import false_alarms, false_alarms_markdown
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.folder import digest, plain
from gcs.campaign.progress import fly_with_progress
from gcs.campaign.result import Result
from gcs.errors import GcsError, UnusableInput

DETECTION, FALSE_ALARMS = "table of detection", "table of false alarms"
"""Names of the places in the page."""
FLOWN = ("gcs", "idc_controller", "vehicle_sim", "missions", "pyproject.toml")
"""What decides how a flight ends."""


def main(arguments: Sequence[str]) -> int:
    """Fly what has not been flown yet, and write the tables; return 1 if a row is not within its limits, 2 for no page.

    Flights are kept by commit; what was interrupted (130) goes on when started again.
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
            out = options.out / plain(f"{flights.file.name} at {commit}")
            before = cpu_minutes()
            campaign = Campaign(flights, out, options.jobs)
            fly_with_progress(campaign, console)
            console.print(f"{flights.file.name}: {cpu_minutes() - before:.1f} minutes of CPU", markup=False)
            rows += flights.detections(campaign.results)
            results += campaign.results
            problems += flights.problems(campaign.results)
            flights.report(campaign.results, out)
        files = " ".join(map(_shown, (options.page, *options.campaigns)))
        command = f"python -m gcs.campaign.faults.tables_page {files}"
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


def renewed(page: str, name: str, text: str) -> str:
    """Return the page with ``text`` between the comments that begin and end the place ``name``.

    Raises :class:`UnusableInput` for a page without them.
    """
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    if page.count(begin) != 1 or page.count(end) != 1 or page.index(begin) > page.index(end):
        raise UnusableInput(f"the page has no place for the {name}: needs a line {begin.strip()} and a line {end}")
    head, rest = page.split(begin)
    return f"{head}{begin}{text}{end}{rest.split(end)[1]}"


def made_by(command: str, commit: str, table: str) -> str:
    """Return a table below the command that made it."""
    return f"\nMade by `{command}` at {commit}:\n\n{table}\n"


def _shown(path: Path) -> str:
    """Return a file as it is named in the project's folder: the page has no path of a machine."""
    here = Path.cwd()
    return str(path.absolute().relative_to(here)) if path.absolute().is_relative_to(here) else path.name


def commit_of(folder: Path) -> str:
    """Return the last commit that changed what is flown, and a digest of the changes since."""
    try:
        commit, changes = (
            subprocess.run(["git", *arguments, "--", *FLOWN], cwd=folder.parent, check=True, capture_output=True,
                text=True).stdout
            for arguments in (("log", "-1", "--format=%h"), ("diff", "HEAD"))
        )  # fmt: skip
    except (OSError, subprocess.CalledProcessError):
        return "an unknown commit"
    return f"commit {commit.strip()}" + (f" with changes {digest(changes)}" if changes else "")


def cpu_minutes() -> float:
    """Return the CPU time of this process and of those that it has waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used) / 60.0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
