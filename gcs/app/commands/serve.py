"""``gcs serve``: its arguments, and what it prints."""

import argparse
from contextlib import ExitStack
from pathlib import Path

from gcs.app.arguments import SEED, SPEED, add_system_arguments
from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing
from gcs.errors import UnusableInput
from gcs.mavlink.address import GROUND_PORT, TEAM_PORT, THIS_MACHINE, VEHICLE_PORT, parse_address, parse_url

WORLD = "hover"
"""Of the package's missions, that whose system the team has where none is named: a world without obstacles."""
DESCRIPTION = f"""\
Presents the UAVs and their load as one MAVLink aircraft, which QGroundControl, MAVSDK, MAVProxy or any other ground
station flies: upload a mission with fence and rally points, arm, take off, start, pause, go to, return, land.

  gcs serve --sim                       starts a simulated swarm, too: one command to a team on a map
  gcs serve --connect                   serves a swarm that runs already (vehicle-sim --mission M)

It sends to udp://{THIS_MACHINE}:{GROUND_PORT}, where ground stations listen, and answers who calls in at
udp://{THIS_MACHINE}:{TEAM_PORT}. Anyone who reaches these may command the team: other hosts only by --listen and
--client. Every flight, from arming to disarming, has a run folder of its own.

Ctrl-C and SIGTERM land the payload, close the records and end it.
Exit status: 0 ended on the ground; 2 unusable input or option, nothing started; 130 interrupted in flight, landed.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--sim", action="store_true", help="start a simulated swarm (vehicle-sim)")
    add("--connect", action="extend", nargs="*", default=None, metavar="URL",
        help="a running swarm, in real time: udp://HOST:PORT of every vehicle, in the order of their system ids "
        f"(default: udp://{THIS_MACHINE}:{VEHICLE_PORT} and on), or as of gcs fly",
    )  # fmt: skip
    add("--mission", type=Path, default=Path(WORLD), metavar="M",
        help="a mission file, or a name of gcs missions, whose system, home and obstacles the team has; what is flown "
        f"is uploaded (default: {WORLD})",
    )  # fmt: skip
    add("--listen", default=f"{THIS_MACHINE}:{TEAM_PORT}", metavar="HOST:PORT",
        help=f"where ground stations call in (default: {THIS_MACHINE}:{TEAM_PORT})")  # fmt: skip
    add("--client", action="append", default=None, dest="clients", metavar="HOST:PORT",
        help=f"where to send from the start; may be repeated (default: {THIS_MACHINE}:{GROUND_PORT})")  # fmt: skip
    add_system_arguments(parser)
    add("--seed", type=SEED, metavar="S", help="seed of the simulated noise in place of the mission's")
    add("--speed", type=SPEED, metavar="X", help="simulated seconds per second of wall time (default: 1)")
    add("--run-dir", type=Path, metavar="D", help="folder of the records (default: runs/serve-<number>)")


def run(arguments: argparse.Namespace) -> int:
    if arguments.sim and arguments.connect is not None:
        raise UnusableInput("gcs serve: --sim starts a swarm of its own: leave out --connect, or --sim")
    with importing():
        from gcs.app.fly_options import FlyOptions, prepare
    options = FlyOptions(
        mission=arguments.mission,
        config=arguments.config,
        settings=arguments.settings,
        vehicles=arguments.vehicles,
        seed=arguments.seed,
        run_dir=arguments.run_dir,
        realtime=True,
        speed=arguments.speed,
        connect=None if arguments.sim else tuple(parse_url(url) for url in arguments.connect or ()),
    )
    listen = parse_address(arguments.listen, "--listen", lowest=0)
    named = arguments.clients or [f"{THIS_MACHINE}:{GROUND_PORT}"]
    clients = tuple(parse_address(text, "--client") for text in named)
    world = prepare(options)
    with importing():
        from gcs.app.serve import ServeOptions, serve
        from gcs.drivers.forked_program import ForkedProgram
        from gcs.drivers.simulator import PROGRAM
    with ExitStack() as started:
        vehicle_sim = started.enter_context(ForkedProgram(PROGRAM)) if arguments.sim else None
        served = serve(ServeOptions(options, listen, clients), world, vehicle_sim)
    for folder in served.run_dirs:
        print(folder)
    return ExitStatus.INTERRUPTED if served.interrupted else ExitStatus.DONE
