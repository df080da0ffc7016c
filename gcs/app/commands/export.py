"""``gcs export``: a run in the formats of other tools."""

import argparse
from pathlib import Path

from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing
from gcs.errors import UnusableInput

DESCRIPTION = """\
Writes a run in the formats of other tools, one file for each vehicle (vehicle_1.ulg) and one for the payload
(payload.ulg), into the run folder, and prints their names. PlotJuggler, Flight Review and pyulog (pip install
'cooplift[ulog]') read the one, mavlogdump.py, MAVExplorer and QGroundControl the other.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("run_dir", type=Path, metavar="RUN_DIR", help="a run folder")
    parser.add_argument("--ulog", action="store_true", help="ULog files with PX4's topics")
    parser.add_argument("--tlog", action="store_true", help="telemetry logs of each system")


def run(arguments: argparse.Namespace) -> int:
    if not (arguments.ulog or arguments.tlog):
        raise UnusableInput("gcs export: no format: --ulog, --tlog, or both")
    with importing():
        from gcs.record.run_data import read_run
        from gcs.view.export.export_ulog import export_ulog
        from gcs.view.export.split_tlog import export_tlog

    records = read_run(arguments.run_dir)
    written = [
        *(export_ulog(records) if arguments.ulog else ()),
        *(export_tlog(records.folder) if arguments.tlog else ()),
    ]
    for path in written:
        print(path)
    return ExitStatus.DONE
