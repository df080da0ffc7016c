"""``gcs check``: what a mission file says."""

import argparse
from dataclasses import replace
from pathlib import Path

from gcs.app.arguments import VEHICLES
from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing

DESCRIPTION = "Reads a mission and says what will be flown, or every reason why not, with file and line."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("mission", type=Path, metavar="MISSION", help="mission file")
    parser.add_argument(
        "--vehicles", type=VEHICLES, metavar="N", help="number of vehicles in place of the system file's"
    )
    parser.add_argument("--config", type=Path, metavar="C", help="system file in place of the mission's")


def run(arguments: argparse.Namespace) -> int:
    """Run the command, and return its exit status."""
    with importing():
        from rich.console import Console

        from gcs.app.fly_options import read_mission_for
        from gcs.mission.describe import describe

    mission = read_mission_for(arguments.mission, arguments.config, arguments.vehicles)
    with importing():
        from gcs.app.preflight import preflight

    found = preflight(mission)
    mission = replace(mission, notes=(*mission.notes, *found.ways, *found.notes))
    Console(highlight=False).print(describe(mission))
    return ExitStatus.DONE
