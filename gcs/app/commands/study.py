"""``gcs study``: campaigns with one parameter changed at a time."""

import argparse
from functools import partial
from pathlib import Path

from gcs.app.arguments import whole_number
from gcs.app.campaigns import add_campaign_arguments, run_campaign
from gcs.campaign.studies.plans import StudyFlights
from gcs.campaign.studies.study import STUDIES
from gcs.errors import UnusableInput
from gcs.mission.own import own_folder

DESCRIPTION = """\
Flies the same missions again with one parameter changed at a time, and reports what depends on it:

{studies}

  gcs study margin --seeds 5 --jobs 4
  gcs study speed --quick                   two scenarios a speed in place of twenty

Writes NAME.csv (a row a flight) and NAME.png, and prints a table and the command that repeats each flight outside its
limits. A study that was interrupted resumes when started again, and studies in one folder share their flights: after a
change of the program name another folder. Exit status: 0 all within their limits; 1 not all; 2 unusable input; 3
results cannot be written; 130 interrupted.
""".format(studies="\n".join(f"  {study.name:<12} {study.about}" for study in STUDIES.values()))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("name", choices=tuple(STUDIES), metavar="NAME", help="one of those above")
    add("--quick", action="store_true", help="few flights: one seed, or two random scenarios")
    add("--seeds", type=partial(whole_number, least=1, most=9999), metavar="N",
        help="seeds of the noise, 1 .. N, or random scenarios 1 .. N (default: the study's, 3 or 20)")  # fmt: skip
    add("--missions", type=Path, metavar="DIR",
        help="folder of the mission files (default: the package's own)")  # fmt: skip
    add_campaign_arguments(parser, "runs/studies")


def run(arguments: argparse.Namespace) -> int:
    """Run the command, and return its exit status."""
    if arguments.quick and arguments.seeds is not None:
        raise UnusableInput(f"gcs study: --quick and --seeds {arguments.seeds} both say how many: leave one out")
    flights = StudyFlights(
        STUDIES[arguments.name], arguments.seeds, arguments.quick, arguments.missions or own_folder()
    )
    return run_campaign(flights, arguments.out or Path("runs/studies"), arguments)
