"""``gcs courses``: its arguments, its progress display, and what it prints at the end."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console

from gcs.app.arguments import number, number_of_jobs, whole_number
from gcs.campaign.courses.campaign import Campaign, CampaignOptions
from gcs.campaign.courses.flights import Result
from gcs.campaign.courses.generator import KINDS
from gcs.campaign.courses.outcome import draw_distribution, outcome_table
from gcs.campaign.process_pool import KEPT
from gcs.campaign.progress import Flights, show_progress

DONE, OUTSIDE_LIMITS, INTERRUPTED = 0, 1, 130

DESCRIPTION = """\
Flies many random courses side by side and tells how clearance, tilt and delay are distributed.

  gcs courses                                200 courses of seed 1 on all cores
  gcs courses --count 20 --kinds moving      obstacles that come the payload's way
  gcs courses --count 1000 --out runs/courses-seed1    goes on with more of the same

Every course is a mission file that `gcs fly` repeats. A campaign that was cut off goes on when started again.
A course is passed without contact, with 0.3 m of clearance, payload angles up to 6 deg, UAVs 0.75 m apart, and
arrival at the goal. Exit status: 0 all passed; 1 not all; 2 unusable input; 130 interrupted, results kept.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("--count", type=_count, default=200, metavar="N", help="number of courses (default: 200)")
    parser.add_argument("--seed", type=_seed, default=1, metavar="S", help="seed of the courses (default: 1)")
    parser.add_argument(
        "--kinds", nargs="+", choices=KINDS, default=list(KINDS), metavar="KIND",
        help=f"kinds of courses, taken in turn: {', '.join(KINDS)} (default: all)",
    )  # fmt: skip
    parser.add_argument(
        "--jobs", type=number_of_jobs, default=None, metavar="J", help="flights at a time (default: auto, the cores)"
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder (default: runs/courses-seed<S>)")
    parser.add_argument(
        "--controller", choices=("idc", "mpc", "paper"), default="idc", help="as for gcs fly (default: idc)"
    )
    parser.add_argument("--config", type=Path, metavar="C", help="system file in place of the packaged one")
    parser.add_argument(
        "--obstacle-speed", type=_speed, default=2.0, metavar="V",
        help="highest speed of moving obstacles in m/s (default: 2)",
    )  # fmt: skip
    parser.add_argument(
        "--keep", choices=KEPT, default="failures", help="whose run folders are kept (default: failures)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the command; returns the exit status."""
    options = CampaignOptions(
        count=arguments.count,
        seed=arguments.seed,
        out=arguments.out or Path("runs") / f"courses-seed{arguments.seed}",
        kinds=tuple(arguments.kinds),
        jobs=arguments.jobs,
        controller=arguments.controller,
        config=arguments.config,
        fastest=arguments.obstacle_speed,
        keep=arguments.keep,
    )
    console = Console(highlight=False, soft_wrap=True)
    with console.status("laying out the courses"):
        campaign = Campaign(options)
    status = DONE
    try:
        fly_with_progress(campaign, console)
    except KeyboardInterrupt:
        status = INTERRUPTED
    campaign.write_results()
    if campaign.results:
        draw_distribution(campaign.results, options.out)
        console.print(outcome_table(campaign.results, options.out))
    if status == INTERRUPTED:
        left = campaign.total - len(campaign.results)
        Console(stderr=True, highlight=False).print(f"interrupted with {left} courses to go: start again to go on")
        return status
    return DONE if all(result.passed for result in campaign.results) else OUTSIDE_LIMITS


def fly_with_progress(campaign: Flights[Result], console: Console, what: str = "courses") -> None:
    """Fly with a progress line at a terminal; elsewhere one line a flight."""
    show_progress(campaign, console, what, _line)


def _line(result: Result) -> str:
    figures = [
        ("clearance", result.clearance_min_m, "m"),
        ("angle", result.tilt_max_deg, "deg"),
        ("apart", result.uav_separation_min_m, "m"),
        ("delay", result.delay_s, "s"),
    ]
    told = ", ".join(f"{name} {'-' if value is None else f'{value:.2f}'} {unit}" for name, value, unit in figures)
    verdict = "passed" if result.passed else f"FAILED ({result.failures})"
    return f"{result.name:<14} {told}, {result.wall_s:.0f} s: {verdict}"


def _count(text: str) -> int:
    return whole_number(text, 1, 9999)


def _seed(text: str) -> int:
    return whole_number(text, 0, 2**63 - 1)


def _speed(text: str) -> float:
    return number(text, 0.5, 20.0)
