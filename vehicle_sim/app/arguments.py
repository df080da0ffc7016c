"""The command line of ``vehicle-sim``: its options, what they may be, and the ports that follow."""

from __future__ import annotations

import argparse
from argparse import Namespace
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from gcs.app.arguments import SEED, SPEED, VEHICLES_MAX, VEHICLES_MIN, Parser, Version, add_settings, whole_number
from gcs.app.logs import add_log_arguments
from gcs.errors import UnusableInput
from gcs.mavlink.address import GROUND_PORT, SDK_PORT, THIS_MACHINE, VEHICLE_PORT, Address, resolved

_DESCRIPTION = """\
Launches the swarm: a world with one payload on rigid links, and quadrotors that carry it, each of which
speaks MAVLink like a PX4 autopilot on a UDP port of its own.

Vehicle i has the system id i and listens on port 14580 + i - 1 (--base-port, --host). As PX4 does, it sends in real
time all its streams, from the start and for ever, to port 14540 + i - 1, where SDKs listen (--sdk-port), and to port
14550, where ground stations listen for all vehicles (--ground-port), of this machine or another (--ground-host).
Whoever sends MAVLink to 14580 and on is answered there, and gets the streams until it has been silent for 10 s. The
payload's navigation unit is a system of its own, with id 100: every vehicle forwards its messages to whoever calls in
and to its SDK, vehicle 1 to the ground stations. Vehicles whose set-points stop brake and hold, then land.

With --free there is no payload: each vehicle takes off, flies missions, returns and lands by itself, as a PX4 does.

"vehicle-sim impair" is a program of its own: the loss, latency and rate of a radio, LTE, Wi-Fi or a satellite between
any two MAVLink programs (vehicle-sim impair --help)."""

_EPILOG = """\
On standard output, line by line: the clock's address (lockstep only), every vehicle's, and "ready".

Examples:
  vehicle-sim                                    four vehicles on ports 14580 .. 14583, in real time
  vehicle-sim --vehicles 6 --speed 2             six, twice as fast
  vehicle-sim --free --vehicles 2                two without a payload, each for a MAVLink client of its own
  vehicle-sim --mission missions/figure_eight.toml --run-dir runs/by-hand
                                                 the mission's home, obstacles, seed and system; truth.csv
  gcs fly missions/figure_eight.toml --realtime --connect
                                                 in another terminal: fly it
  vehicle-sim impair --profile lte udpin://127.0.0.1:14550 udpout://127.0.0.1:14560
                                                 what comes at port 14550 goes on to 14560 as over LTE, and back

Exit status: 0 ended by SIGTERM or with the process that started it, 2 unusable input, with the reason on standard
error and nothing started, 3 the records are incomplete, 130 interrupted, or its terminal closed.
"""


def parse(argv: list[str] | None) -> argparse.Namespace:
    """Return the options. Raises :class:`~gcs.errors.UnusableInput`; ``--help`` and ``--version`` exit."""
    parser = Parser(prog="vehicle-sim", description=_DESCRIPTION, epilog=_EPILOG)
    add = parser.add_argument
    add("--vehicles", metavar="N", help="number of vehicles (default: the system file's)")
    add("--free", action="store_true", help="vehicles without a payload, in a row, each of which flies by itself")
    add("--mission", type=Path, metavar="M",
        help="mission file (.toml, .plan, .waypoints) that gives home, obstacles, seed and system")  # fmt: skip
    add("--config", type=Path, metavar="C", help="system file (default: the mission's, else the packaged one)")
    add_settings(parser)
    add("--seed", type=SEED, metavar="S",
        help="seed of all sensor noise (default: the mission's, else 1)")  # fmt: skip
    add("--run-dir", type=Path, metavar="D",
        help="folder for truth.csv, obstacles.csv, manifest.json; made if absent, refused if not empty")  # fmt: skip
    add("--host", default=None, metavar="H",
        help="address to listen on (default: 127.0.0.1; with a --ground-host elsewhere 0.0.0.0)")  # fmt: skip
    add("--base-port", type=_whole(0, 65535), default=VEHICLE_PORT, metavar="P",
        help="port of vehicle 1; 0: any that are free (default: %(default)s)")  # fmt: skip
    add("--ground-host", default=None, metavar="H",
        help="machine to which the streams go in real time (default: 127.0.0.1)")  # fmt: skip
    add("--sdk-port", type=_whole(0, 65535), default=None, metavar="P",
        help="port there to which vehicle 1 sends its streams, the others to those that follow, whatever --base-port "
        f"is; 0: nowhere (default: {SDK_PORT})")  # fmt: skip
    add("--ground-port", type=_whole(0, 65535), default=None, metavar="P",
        help=f"port there to which all vehicles send their streams; 0: nowhere (default: {GROUND_PORT})")  # fmt: skip
    pace = parser.add_mutually_exclusive_group()
    pace.add_argument("--realtime", action="store_true", help="on this machine's clock (the default)")
    pace.add_argument(
        "--lockstep", action="store_true",
        help="on a virtual clock shared with one ground station, at port BASE - 1: as fast as both can, "
        "and the same every time",
    )  # fmt: skip
    add("--speed", type=SPEED, default=None, metavar="X",
        help="real time times X (default: 1)")  # fmt: skip
    add("--view", action="store_true", help="show the swarm in a browser: prints the address")
    add("--gui", action="store_true", help="show the world in a window")
    add("--with-parent", action="store_true", help=argparse.SUPPRESS)
    add_log_arguments(parser)
    add("--version", action=Version)
    options, unknown = parser.parse_known_args(argv)
    parser.refuse_unknown(unknown)
    if options.vehicles is not None:
        try:
            options.vehicles = whole_number(options.vehicles, 1 if options.free else VEHICLES_MIN, VEHICLES_MAX)
        except argparse.ArgumentTypeError as error:
            parser.error(f"--vehicles: {error}")
    if options.free and options.view:
        parser.error("--view: shows a team with its payload; not with --free")
    if options.with_parent:  # which logs what it learns of the vehicles itself
        options.quiet += 1
    if options.lockstep and options.speed is not None:
        parser.error("--speed: lockstep has no speed of its own, it is as fast as it can be")
    if options.lockstep:
        for name, value in (
            ("--ground-host", options.ground_host), ("--sdk-port", options.sdk_port),
            ("--ground-port", options.ground_port),
        ):  # fmt: skip
            if value:
                parser.error(f"{name}: in lockstep nothing is sent to ports of clients, only to who calls in")
    return options


def _whole(least: int, most: int) -> Callable[[str], int]:
    return partial(whole_number, least=least, most=most)


class ClientPorts(NamedTuple):
    """The host on which the vehicles listen, and the addresses of clients, None: nowhere."""

    listening_host: str
    sdk: Address | None
    """Of vehicle 1; the others send to the ports that follow."""
    ground: Address | None
    """Of all vehicles."""

    @classmethod
    def of(cls, options: Namespace, vehicles: int) -> ClientPorts:
        """Return what the options say for a number of vehicles. Raises :class:`UnusableInput`."""
        if options.lockstep:
            return cls(options.host or THIS_MACHINE, None, None)
        sdk_port = SDK_PORT if options.sdk_port is None else options.sdk_port
        ground_port = GROUND_PORT if options.ground_port is None else options.ground_port
        if sdk_port + vehicles - 1 > 65535:
            raise UnusableInput(f"--sdk-port {sdk_port}: port {sdk_port + vehicles - 1} of vehicle {vehicles} is none")
        there = resolved(options.ground_host or THIS_MACHINE, f"--ground-host {options.ground_host}")
        is_here = there.startswith("127.")
        host = options.host or (THIS_MACHINE if is_here else "0.0.0.0")
        if not is_here and resolved(host, f"--host {host}").startswith("127."):
            raise UnusableInput(
                f"--host {host}: from there nothing can be sent to --ground-host {options.ground_host}; "
                "name an address of this machine in that network, or 0.0.0.0"
            )
        listening = range(options.base_port, options.base_port + vehicles) if options.base_port else range(0)
        taken = {sdk_port + i for i in range(vehicles) if sdk_port} | {ground_port}
        if is_here and (both := taken.intersection(listening)):
            raise UnusableInput(
                f"{vehicles} vehicles from --base-port {options.base_port} on: port {min(both)} is a client's; "
                "choose another, or other ones of --sdk-port and --ground-port (0: nowhere)"
            )
        return cls(host, (there, sdk_port) if sdk_port else None, (there, ground_port) if ground_port else None)
