"""The command line of the ground: fly a mission, check one, draw what happened in a run."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich_argparse import RawDescriptionRichHelpFormatter
from threadpoolctl import threadpool_limits

from gcs.app.commands import courses, faults, reproduce, study
from gcs.app.fly import INTERRUPTED, OUTSIDE_LIMITS, UNUSABLE, FlyOptions, fly, prepare
from gcs.app.progress import FlightProgress
from gcs.campaign.process_pool import end_with_parent
from gcs.config import UnusableFile
from gcs.errors import GcsError, UnusableInput
from gcs.faults.record import fault_notes
from gcs.mavlink.address import parse_url
from gcs.mission.describe import describe
from gcs.mission.read import read_mission
from gcs.record.figures import report
from gcs.record.summary_table import summary_table
from idc_controller.errors import IdcError

_DESCRIPTION = """\
The ground station of cooplift: UAVs that carry one payload together.

  gcs check missions/delivery.plan          what will be flown, or every reason why not
  gcs fly missions/figure_eight.toml        flies it with a simulated swarm of its own
  gcs report runs/figure-eight-1            draws what happened
  gcs faults missions/telemetry_faults.toml flies a campaign of telemetry faults
  gcs courses                               flies 200 random courses and tells how it went
  gcs study margin                          flies a mission with other margins; other studies likewise
  gcs reproduce --quick                     the paper's figures and numbers, as printed and as corrected
"""
_FLY = """\
Flies a mission: a QGroundControl .plan, a QGC WPL 110 file, or the project's .toml.

Without --connect it starts a simulated swarm (vehicle-sim) for itself, in lockstep unless --realtime is given.
With --connect it flies a swarm that runs already:

  vehicle-sim --mission missions/figure_eight.toml
  gcs fly missions/figure_eight.toml --realtime --connect \\
      udp://127.0.0.1:14540 udp://127.0.0.1:14541 udp://127.0.0.1:14542 udp://127.0.0.1:14543

Ctrl-C lands the vehicles and closes the records; a second one leaves them to land on their own.
Exit status: 0 done and within limits; 1 flown but outside limits, or aborted safely; 2 unusable input;
130 interrupted, vehicles landed.
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; the exit status is design's: 0, 1, 2 or 130."""
    options = _parser().parse_args(argv)
    errors = Console(stderr=True, highlight=False, soft_wrap=True)
    try:
        with threadpool_limits(limits=1):
            return int(options.run(options))
    except UnusableFile as error:
        for reason in error.reasons:
            errors.print(reason, markup=False)
        return UNUSABLE
    except UnusableInput as error:
        errors.print(str(error), markup=False)
        return UNUSABLE
    except (GcsError, IdcError) as error:
        errors.print(f"gcs: {error}", markup=False)
        return OUTSIDE_LIMITS
    except KeyboardInterrupt:
        return INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    style = RawDescriptionRichHelpFormatter
    parser = argparse.ArgumentParser(prog="gcs", description=_DESCRIPTION, formatter_class=style)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    fly_parser = commands.add_parser("fly", help="fly a mission", description=_FLY, formatter_class=style)
    fly_parser.add_argument("mission", type=Path, metavar="MISSION", help="mission file")
    fly_parser.add_argument("--realtime", action="store_true", help="run on the wall clock instead of in lockstep")
    fly_parser.add_argument(
        "--speed", type=_positive, default=1.0, help="simulated seconds a wall second, with --realtime (default: 1)"
    )
    fly_parser.add_argument(
        "--controller", choices=("idc", "mpc", "paper"), default="idc",
        help="idc: tracking with obstacle avoidance (default); mpc: tracking alone; paper: the paper's own filter",
    )  # fmt: skip
    fly_parser.add_argument("--config", type=Path, metavar="C", help="system file in place of the mission's")
    fly_parser.add_argument(
        "--vehicles", type=int, metavar="N", help="number of vehicles in place of the system file's"
    )
    fly_parser.add_argument("--seed", type=int, metavar="S", help="seed of the noise in place of the mission's")
    fly_parser.add_argument("--run-dir", type=Path, metavar="D", help="run folder (default: runs/<mission>-<number>)")
    fly_parser.add_argument(
        "--connect", action="extend", nargs="+", default=[], metavar="URL",
        help="a running swarm: udp://HOST:PORT of every vehicle, in the order of their system ids, "
        "or udpin://HOST:PORT where the vehicles offer themselves (vehicle-sim: udpin://127.0.0.1:14550)",
    )  # fmt: skip
    fly_parser.add_argument("--json", action="store_true", help="print the summary as JSON instead of a table")
    fly_parser.add_argument("--no-pictures", action="store_true", help="draw none; gcs report does it later")
    fly_parser.add_argument("--with-parent", action="store_true", help=argparse.SUPPRESS)
    fly_parser.set_defaults(run=_fly)

    check = commands.add_parser(
        "check", help="say what will be flown, or why not",
        description="Reads a mission and says what will be flown, or every reason why not, with file and line.",
        formatter_class=style,
    )  # fmt: skip
    check.add_argument("mission", type=Path, metavar="MISSION", help="mission file")
    check.add_argument("--config", type=Path, metavar="C", help="system file in place of the mission's")
    check.set_defaults(run=_check)

    report_parser = commands.add_parser(
        "report", help="draw what happened in a run", description="Draws what happened in a run.", formatter_class=style
    )
    report_parser.add_argument("run_dir", type=Path, metavar="RUN_DIR", help="a run folder")
    report_parser.set_defaults(run=_report)

    courses_parser = commands.add_parser(
        "courses", help="fly many random courses", description=courses.DESCRIPTION, formatter_class=style
    )
    courses.add_arguments(courses_parser)

    faults_parser = commands.add_parser(
        "faults", help="list the faults that missions may have, fly campaigns of them",
        description=faults.DESCRIPTION, formatter_class=style,
    )  # fmt: skip
    faults.add_arguments(faults_parser)

    study_parser = commands.add_parser(
        "study", help="fly missions with one thing changed", description=study.DESCRIPTION, formatter_class=style
    )
    study.add_arguments(study_parser)

    reproduce_parser = commands.add_parser(
        "reproduce", help="regenerate the figures and numbers of the paper", description=reproduce.DESCRIPTION,
        formatter_class=style,
    )  # fmt: skip
    reproduce.add_arguments(reproduce_parser)
    return parser


def _fly(arguments: argparse.Namespace) -> int:
    options = FlyOptions(
        mission=arguments.mission,
        config=arguments.config,
        vehicles=arguments.vehicles,
        seed=arguments.seed,
        run_dir=arguments.run_dir,
        realtime=arguments.realtime,
        speed=arguments.speed,
        controller=arguments.controller,
        connect=tuple(parse_url(url) for url in arguments.connect),
    )
    if arguments.with_parent:
        end_with_parent()
    mission = prepare(options)
    # With --json standard output is the summary alone.
    console = Console(stderr=arguments.json, highlight=False)
    with FlightProgress(console) as progress:
        result = fly(options, mission, progress.update)
    pictures = report(result.run_dir) if result.flown and not arguments.no_pictures else []
    if arguments.json:
        print(json.dumps(result.summary, indent=2))
    else:
        console.print(summary_table(result.summary, result.run_dir, pictures))
    notes = Console(stderr=True, highlight=False, soft_wrap=True)
    for note in fault_notes(result.run_dir):
        notes.print(f"note: {note}", markup=False, style="yellow")
    if mission.faults and options.connect:
        notes.print("note: faults come from the simulator: vehicle-sim --mission", markup=False, style="yellow")
    if result.reason:
        notes.print(f"flight broken off: {result.reason}", markup=False)
    return result.exit_code


def _check(arguments: argparse.Namespace) -> int:
    Console(highlight=False).print(describe(read_mission(arguments.mission, arguments.config)))
    return 0


def _report(arguments: argparse.Namespace) -> int:
    for picture in report(arguments.run_dir):
        print(picture)
    return 0


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < 1e6:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


if __name__ == "__main__":
    sys.exit(main())
