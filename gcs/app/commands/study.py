"""``gcs study``: its arguments, and what it prints."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from gcs.app.arguments import number_of_jobs, whole_number
from gcs.app.commands.courses import DONE, INTERRUPTED, OUTSIDE_LIMITS, fly_with_progress
from gcs.campaign.process_pool import KEPT
from gcs.campaign.studies.figures import draw_study, study_table
from gcs.campaign.studies.study import STUDIES, StudyFlights, StudyOptions

WIDTH = 130
"""Characters of a line where there is no terminal that has its own."""

DESCRIPTION = """\
Flies the same missions again with one thing changed at a time, and tells what depends on it:

{studies}

  gcs study margin --seeds 5 --jobs 4
  gcs study speed --quick                   two courses a speed in place of twenty

Writes NAME.csv (a row a flight) and NAME.png, and prints a table and the command that repeats each flight outside its
limits. A study that was cut off goes on when started again, and studies share their flights: after a change of the
program name another folder. Exit status: 0 all within their limits; 1 not all; 2 unusable input; 130 interrupted.
""".format(studies="\n".join(f"  {study.name:<12} {study.about}" for study in STUDIES.values()))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("name", choices=tuple(STUDIES), metavar="NAME", help="one of those above")
    parser.add_argument("--quick", action="store_true", help="few flights: one seed, or two random courses")
    parser.add_argument(
        "--seeds", type=_seeds, metavar="N",
        help="seeds of the noise, 1 .. N, or random courses 1 .. N (default: the study's, 3 or 20)",
    )  # fmt: skip
    parser.add_argument(
        "--jobs", type=number_of_jobs, default=None, metavar="J", help="flights at a time (default: auto, the cores)"
    )
    parser.add_argument("--out", type=Path, default=Path("runs/studies"), metavar="DIR", help="default: runs/studies")
    parser.add_argument(
        "--missions", type=Path, default=Path("missions"), metavar="DIR", help="folder of the mission files"
    )
    parser.add_argument("--keep", choices=KEPT, default="failures", help="whose run folders are kept")


def run(arguments: argparse.Namespace) -> int:
    """Run the command; returns the exit status."""
    study, out = STUDIES[arguments.name], arguments.out
    console = Console(highlight=False, soft_wrap=True)
    if not console.is_terminal:
        console.width = WIDTH
    with console.status("laying out the flights"):
        flights = StudyFlights(
            StudyOptions(
                study, out, arguments.seeds, arguments.quick, arguments.jobs, arguments.missions, arguments.keep
            )
        )
    interrupted = False
    try:
        fly_with_progress(flights, console, study.name)
    except KeyboardInterrupt:
        interrupted = True
    rows, table = flights.rows, flights.write_rows()
    if rows:
        picture = draw_study(study, rows, out / f"{study.name}.png")
        console.print(study_table(study, rows))
        console.print(f"Results   {table}  {picture}", markup=False)
    if interrupted:
        left = flights.total - len(rows)
        Console(stderr=True, highlight=False).print(f"interrupted with {left} flights to go: start again to go on")
        return INTERRUPTED
    return DONE if all(row.result.passed for row in rows) else OUTSIDE_LIMITS


def _seeds(text: str) -> int:
    return whole_number(text, 1, 9999)
