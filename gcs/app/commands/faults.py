"""``gcs faults``: its arguments, and what it prints."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from gcs.app.arguments import number_of_jobs
from gcs.campaign.faults.campaign import FaultCampaign, FaultCampaignOptions
from gcs.campaign.faults.campaign_file import CampaignFile, read_campaign
from gcs.campaign.faults.result import FaultResult
from gcs.campaign.faults.sweep import plain
from gcs.campaign.process_pool import KEPT
from gcs.campaign.progress import show_progress
from gcs.errors import UnusableInput
from gcs.faults.listing import kinds_list

DONE, OUTSIDE_LIMITS, INTERRUPTED = 0, 1, 130
WIDTH = 150
"""Characters of a line where there is no terminal that has its own."""

DESCRIPTION = """\
Flies a campaign of faults: faults x severities x missions x seeds, side by side, and tells how it went.

  gcs faults --kinds                               the kinds of fault with their parameters
  gcs faults missions/telemetry_faults.toml        every flight of the campaign, on all cores

Every flight is a mission file that `gcs fly` repeats. A campaign that was cut off goes on when started again; one whose
file has grown flies what is new. Writes results.csv and results.parquet (a row a flight), rates.csv and matrix.png.
Exit status: 0 all passed (by default: within their limits); 1 not all; 2 unusable input; 130 interrupted, results kept.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("campaign", nargs="?", type=Path, metavar="CAMPAIGN", help="campaign file, see docs/faults.md")
    parser.add_argument("--kinds", action="store_true", help="list the kinds of fault with their parameters")
    parser.add_argument(
        "--jobs", type=number_of_jobs, default=None, metavar="J", help="flights at a time (default: auto, the cores)"
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder (default: runs/<name of the campaign>)")
    parser.add_argument(
        "--keep", choices=KEPT, default="failures", help="whose run folders are kept (default: failures)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the command; returns the exit status."""
    console = Console(highlight=False, soft_wrap=True)
    if arguments.kinds:
        Console(highlight=False).print(kinds_list())
        return DONE
    if arguments.campaign is None:
        raise UnusableInput("gcs faults: name what to do: a campaign file, or --kinds, which lists the kinds of fault")
    with console.status("laying out the flights"):
        file = read_campaign(arguments.campaign)
        out = arguments.out or Path("runs") / plain(file.name)
        campaign = FaultCampaign(file, FaultCampaignOptions(out, arguments.jobs, arguments.keep))
    interrupted = False
    try:
        show_progress(campaign, console, "flights", _line)
    except KeyboardInterrupt:
        interrupted = True
    results = campaign.results
    if results:
        _tell(file, results, out, console)
    if interrupted:
        left = campaign.total - len(results)
        Console(stderr=True, highlight=False).print(f"interrupted with {left} flights to go: start again to go on")
        return INTERRUPTED
    return DONE if all(result.passed for result in results) else OUTSIDE_LIMITS


def _tell(file: CampaignFile, results: list[FaultResult], out: Path, console: Console) -> None:
    # Only here: pandas takes its time to be imported, and this module is imported by every `gcs fly`.
    from gcs.campaign.faults.outcome import draw_matrix, outcome_table
    from gcs.campaign.faults.tables import write_tables

    files = [*write_tables(results, out), draw_matrix(file.name, results, out)]
    if not console.is_terminal:
        console.width = WIDTH
    console.print(outcome_table(results, files, file.require))


def _line(result: FaultResult) -> str:
    figures = [
        ("clearance", result.clearance_min_m, "m"),
        ("tilt", result.tilt_max_deg, "deg"),
        ("apart", result.uav_separation_min_m, "m"),
        ("error", result.position_rmse_m, "m"),
    ]
    told = ", ".join(f"{name} {'-' if value is None else f'{value:.2f}'} {unit}" for name, value, unit in figures)
    return f"{result.name}: {told}, {result.wall_s:.0f} s: {result.outcome}"
