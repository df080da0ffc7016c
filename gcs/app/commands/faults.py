"""``gcs faults``: the kinds of fault, and campaigns of them."""

import argparse
from pathlib import Path

from rich.console import Console

from gcs.app.campaigns import add_campaign_arguments, run_campaign
from gcs.app.exit_status import ExitStatus
from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.folder import plain
from gcs.errors import UnusableInput
from gcs.faults.listing import kinds_list

DESCRIPTION = """\
Flies a campaign of faults: faults x severities x missions x seeds, in parallel, and reports the rates of success.

  gcs faults --kinds                               the kinds of fault with their parameters
  gcs faults missions/telemetry_faults.toml        every flight of the campaign, on all cores

Every flight is a mission file that `gcs fly` repeats. A campaign that was interrupted resumes when started again; one
whose file has grown flies what is new. Writes results.csv (a row a flight), rates.csv, matrix.png.
Exit status: 0 all passed (by default: within their limits); 1 not all; 2 unusable input; 3 results cannot be written;
130 interrupted, results kept.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "campaign", nargs="?", type=Path, metavar="CAMPAIGN",
        help="campaign file (docs/faults.md), or a name of gcs missions",
    )  # fmt: skip
    parser.add_argument("--kinds", action="store_true", help="list the kinds of fault with their parameters")
    parser.add_argument("--parquet", action="store_true", help="write results.parquet, too (extra: cooplift[parquet])")
    add_campaign_arguments(parser, "runs/<name of the campaign>")


def run(arguments: argparse.Namespace) -> int:
    if arguments.kinds and arguments.campaign is not None:
        raise UnusableInput(
            f"gcs faults: --kinds lists the kinds of fault and flies nothing: leave {arguments.campaign} out"
        )
    if arguments.kinds:
        Console(highlight=False).print(kinds_list())
        return ExitStatus.DONE
    if arguments.campaign is None:
        raise UnusableInput("gcs faults: no campaign file: name one, or list the kinds of fault with --kinds")
    file = read_campaign(arguments.campaign)
    flights = FaultFlights(file, parquet=arguments.parquet)
    return run_campaign(flights, arguments.out or Path("runs") / plain(file.name), arguments)
