"""``gcs report``: the report page of a run."""

import argparse
from pathlib import Path

from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing

DESCRIPTION = """\
Writes what happened in a run as one page, report.html in its folder, which any browser shows without a network, and a
still of the least clearance, poster.png; prints their paths. Of two runs it writes one page that compares them, into
the first one's folder; of a campaign's folder one of all its flights, the worst first.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("run_dir", type=Path, metavar="RUN_DIR", help="the folder of a run, or of a campaign")
    parser.add_argument("other", type=Path, nargs="?", metavar="OTHER", help="a second one, which is compared with it")


def run(arguments: argparse.Namespace) -> int:
    with importing():
        from gcs.record.run_data import read_run
        from gcs.view.campaign_page import is_campaign, write_campaign
        from gcs.view.page import report, write_report

    if arguments.other is None and is_campaign(arguments.run_dir):
        print(write_campaign(arguments.run_dir))
        return ExitStatus.DONE
    run = read_run(arguments.run_dir)
    files = report(run) if arguments.other is None else [write_report(run, read_run(arguments.other))]
    for file in files:
        print(file)
    return ExitStatus.DONE
