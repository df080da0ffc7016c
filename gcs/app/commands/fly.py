"""``gcs fly``: its arguments, and what it prints."""

import argparse
import json
import sys
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path

from gcs.app.arguments import CONTROLLERS, SEED, SPEED, add_system_arguments
from gcs.app.imports import importing
from gcs.app.logs import LOG
from gcs.errors import UnusableInput
from gcs.mavlink.address import GROUND_PORT, THIS_MACHINE, VEHICLE_PORT, parse_url

DESCRIPTION = """\
Flies a mission: a QGroundControl .plan, a QGC WPL 110 file, the project's .toml, or one of the package's own by its
name (gcs missions).

Without --connect it starts a simulated swarm (vehicle-sim) for itself, in lockstep unless --realtime is given.
With --connect it flies a swarm that runs already:

  vehicle-sim --mission missions/figure_eight.toml
  gcs fly missions/figure_eight.toml --realtime --connect

Ctrl-C, SIGTERM and a closed terminal land the vehicles and close the records; a second Ctrl-C or
SIGTERM ends the ground station, and the vehicles land by their own failsafe.
Exit status: 0 done (every waypoint and the landing reached) and within limits; 1 flown but outside limits
or not arrived, or aborted safely; 2 unusable input or option, nothing started; 3 flown, but the records
are incomplete; 130 interrupted, vehicles landed.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("mission", nargs="?", metavar="MISSION", help="mission file, or a name of gcs missions")
    add("--realtime", action="store_true", help="run on the wall clock instead of in lockstep")
    add("--speed", type=SPEED, metavar="X",
        help="simulated seconds per second of wall time, with --realtime or --view (default: 1)")  # fmt: skip
    add("--controller", choices=CONTROLLERS, default="idc",
        help="idc: tracking with obstacle avoidance (default); mpc: tracking only; paper: the paper's own filter",
    )  # fmt: skip
    add_system_arguments(parser)
    add("--seed", type=SEED, metavar="S", help="seed of the noise in place of the mission's")
    add("--run-dir", type=Path, metavar="D", help="run folder (default: runs/<mission>-<number>)")
    add("--connect", action="extend", nargs="*", default=None, metavar="URL",
        help="a running swarm: udp://HOST:PORT of every vehicle, in the order of their system ids (default: "
        f"udp://{THIS_MACHINE}:{VEHICLE_PORT} and on); a single one of a router to all of them; or udpin://HOST:PORT "
        f"to which the vehicles send (vehicle-sim: udpin://{THIS_MACHINE}:{GROUND_PORT})",
    )  # fmt: skip
    add("--view", action="store_true", help="show the flight in a browser while it goes on: prints the address")
    add("--json", action="store_true", help="print the summary as JSON instead of a table")
    add("--no-pictures", action="store_true", help="write neither report.html nor poster.png; gcs report does it later")


def run(arguments: argparse.Namespace) -> int:
    with importing():
        from gcs.app.fly_options import FlyOptions, prepare

    mission_file, connect = arguments.mission, arguments.connect
    if mission_file is None and connect and "://" not in connect[-1]:
        *connect, mission_file = connect  # no URL: it only stands behind the option
    if mission_file is None:
        raise UnusableInput("gcs fly: the following arguments are required: MISSION")
    arguments.mission = Path(mission_file)
    arguments.connect = None if connect is None else tuple(parse_url(url) for url in connect)
    options = FlyOptions(**{field.name: getattr(arguments, field.name) for field in fields(FlyOptions)})
    mission = prepare(options)
    # Only now: what cannot be flown is said at once.
    with importing():
        from rich.console import Console

        from gcs.app.fly import fly
        from gcs.app.progress import FlightProgress
        from gcs.drivers.forked_program import ForkedProgram
        from gcs.drivers.simulator import PROGRAM
        from gcs.flight.feasibility import preflight
        from gcs.record.incomplete import in_one_line
        from gcs.record.summary_table import print_summary
    # With --json standard output is the summary and nothing else.
    console = Console(stderr=arguments.json, highlight=False)
    for note in (*mission.notes, *preflight(mission).lines):
        LOG.info("note: %s", note)
    with ExitStack() as started:
        # Before there are threads: those of the progress line.
        vehicle_sim = None if options.connect is not None else started.enter_context(ForkedProgram(PROGRAM))
        logged = arguments.verbose > 0 and sys.stderr.isatty()
        progress = started.enter_context(FlightProgress(console, phases_logged=logged))
        result = fly(options, mission, progress.update, vehicle_sim)
    files: list[Path] = []
    if result.flown and not arguments.no_pictures:
        with importing():
            from gcs.view.page import report

        try:
            files = report(result.records)
        except UnusableInput as error:  # a full disk, a record that has no row
            LOG.warning("note: no report: %s", error)
    if arguments.json:
        print(json.dumps({"run_dir": str(result.run_dir), **result.summary}, indent=2))
    elif result.flown:
        print_summary(console, result.summary, result.run_dir, files, details=arguments.verbose > 0)
    if mission.faults:
        from gcs.record.faults import fault_notes

        for note in fault_notes(result.run_dir):
            LOG.warning("note: %s", note)
    if mission.faults and options.connect is not None:
        LOG.warning("note: faults come from the simulator: start it with vehicle-sim --mission %s", options.mission)
    if result.reason:
        broken_off = result.summary["broken_off_s"] is not None
        LOG.error("flight %s: %s", "broken off" if broken_off else result.summary["outcome"], result.reason)
    if result.incomplete:
        LOG.error("%s; the figures are of what there is", in_one_line(result.incomplete))
    return result.exit_code
