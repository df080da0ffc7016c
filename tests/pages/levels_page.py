"""The table of ``docs/courses.md`` of both levels of evidence, flown and written by one command.

``python tests/pages/levels_page.py docs/courses.md``
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from page_tables import commit_of, made_by, markdown_table, renewed
from rich.console import Console

from gcs.campaign.engine import Campaign
from gcs.campaign.executors import WorkerProcesses
from gcs.campaign.result import Result
from gcs.campaign.scenarios.generator import APPROACHING, KINDS
from gcs.campaign.scenarios.levels import cost, differences, fly_levels
from gcs.campaign.scenarios.plans import Scenarios
from gcs.campaign.tables import extreme

PLACE = "table of levels"
COURSES = Scenarios(count=30, seed=3107, kinds=tuple(kind for kind in KINDS if kind != APPROACHING))


def main(arguments: Sequence[str]) -> int:
    """Fly what has not been flown yet on both levels, and write the table."""
    parser = argparse.ArgumentParser(description="Write the table of both levels of evidence into a page.")
    parser.add_argument("page", type=Path, metavar="PAGE")
    parser.add_argument("--jobs", type=int, help="parallel flights (default: one per core)")
    parser.add_argument("--out", type=Path, default=Path("runs/levels"), help="folder (default: runs/levels)")
    options = parser.parse_args(arguments)
    page, commit = options.page.read_text(encoding="utf-8"), commit_of(Path(__file__).parents[1])
    full = Campaign(COURSES, options.out)
    planning = Campaign(replace(COURSES, planning=True), options.out / "planning")
    with WorkerProcesses(options.jobs) as executor:
        fly_levels(planning, full, None, executor, Console(highlight=False, soft_wrap=True))
    command = f"python tests/pages/levels_page.py {options.page}"
    table = markdown_table(rows(planning.results, full.results))
    notes = "".join(f"\n- {line}" for line in differences(planning.results, full.results))
    page = renewed(page, PLACE, made_by(command, commit, table + notes))
    options.page.write_text(page, encoding="utf-8")
    return 0


def rows(planned: Sequence[Result], full: Sequence[Result]) -> list[dict[str, str]]:
    """Return a row of each kind and one of all, of courses that were flown on both levels, cells by title."""
    flown = {result.name: result for result in full}
    pairs = [(result, flown[result.name]) for result in planned]
    return [_row(kind, [pair for pair in pairs if pair[0].kind == kind]) for kind in COURSES.kinds] + [
        _row("all", pairs)
    ]


def _row(kind: str, pairs: Sequence[tuple[Result, Result]]) -> dict[str, str]:
    planned, full = zip(*pairs, strict=True)
    apart = [
        abs(plan.clearance_min_m - flight.clearance_min_m)
        for plan, flight in pairs
        if plan.clearance_min_m is not None and flight.clearance_min_m is not None
    ]
    return {
        "kind": kind,
        "courses": str(len(pairs)),
        "same verdict": str(sum(plan.passed == flight.passed for plan, flight in pairs)),
        "passed: planning": str(sum(plan.passed for plan in planned)),
        "full": str(sum(flight.passed for flight in full)),
        "least clearance: planning": extreme(planned, "clearance_min_m", min, 2, "m"),
        "in full": extreme(full, "clearance_min_m", min, 2, "m"),
        "apart by up to": f"{max(apart):.2f} m" if apart else "",
        "CPU: planning": f"{sum(map(cost, planned)):.0f} s",
        "of full flights": f"{sum(map(cost, full)):.0f} s",
    }


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
