"""``gcs check``: what a mission file says."""

import argparse
from pathlib import Path

from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing

DESCRIPTION = "Reads a mission and says what will be flown, or every reason why not, with file and line."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("mission", type=Path, metavar="MISSION", help="mission file")
    parser.add_argument("--config", type=Path, metavar="C", help="system file in place of the mission's")


def run(arguments: argparse.Namespace) -> int:
    """Run the command, and return its exit status."""
    with importing():
        from rich.console import Console

        from gcs.mission.describe import describe
        from gcs.mission.read import read_mission

    Console(highlight=False).print(describe(read_mission(arguments.mission, arguments.config)))
    return ExitStatus.DONE
