"""``gcs report``: pictures of a run."""

import argparse
from pathlib import Path

from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing

DESCRIPTION = "Draws what happened in a run, and prints the names of the pictures."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run_dir", type=Path, metavar="RUN_DIR", help="a run folder")


def run(arguments: argparse.Namespace) -> int:
    """Run the command, and return its exit status."""
    with importing():
        from gcs.record.figures import report
        from gcs.record.run_data import read_run

    for picture in report(read_run(arguments.run_dir)):
        print(picture)
    return ExitStatus.DONE
