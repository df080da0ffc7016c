"""``gcs serve``: sockets, a swarm and run folders become a team that any ground station flies as one aircraft."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import NamedTuple

from gcs.app.flight_log import FlightLog
from gcs.app.fly import simulator_arguments
from gcs.app.fly_options import FlyOptions
from gcs.app.logs import LOG
from gcs.app.served_flight import Flights, take_truth
from gcs.drivers.connection import Connection, LockstepConnection
from gcs.drivers.forked_program import ForkedProgram
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.lockstep import Pace, run_in_lockstep
from gcs.drivers.participant import INTERRUPTED_TWICE
from gcs.drivers.realtime import run_in_real_time
from gcs.drivers.simulator import Simulator
from gcs.flight.ground_station import GroundStation
from gcs.mavlink.address import Address
from gcs.mission.model import Mission
from gcs.record.run_folder import NewRunFolder, write_manifest
from gcs.serve.server import TEAM_SYSTEM, TeamServer


@dataclass(frozen=True)
class ServeOptions:
    """Options of ``gcs serve`` beside those that it shares with ``gcs fly``."""

    fly: FlyOptions
    listen: Address
    """Where ground stations and companions call in; what is sent to them comes from there."""
    clients: tuple[Address, ...]
    """Where the streams go from the start."""


class Served(NamedTuple):
    """What was served."""

    run_dirs: list[Path]
    """Of the flights."""
    interrupted: bool
    """True if it was interrupted in flight."""


def serve(options: ServeOptions, world: Mission, vehicle_sim: ForkedProgram | None) -> Served:
    """Serve the team in ``world`` until it is interrupted.

    ``vehicle_sim``: the program forked in advance; None: a swarm that runs already is flown. Raises
    :class:`UnusableInput` before anything is started.
    """
    with Interrupt() as interrupt, ExitStack() as resources:
        folder = resources.enter_context(NewRunFolder("serve", options.fly.run_dir))
        begin = datetime.now(UTC)
        write_manifest(folder.path, command=sys.argv, seed=world.seed, mission=world, system=world.system, start=begin)
        connection = resources.enter_context(closing(Connection(options.listen)))
        simulator = None
        if vehicle_sim is not None:
            arguments = simulator_arguments(replace(options.fly, realtime=False), world, folder.path)
            simulator = resources.enter_context(Simulator(vehicle_sim, arguments, world.system.drivers))
        vehicles = world.system.team.vehicles
        addresses = options.fly.addresses(vehicles) if simulator is None else [*simulator.vehicles]
        flights = Flights(addresses, folder.path, begin=begin)
        if simulator is not None:  # its rows are in the file before the messages that follow from them
            flights.keep_truth = partial(take_truth, folder.path)
        server = TeamServer(world, flights.open, options.clients)
        resources.callback(server.session.close)
        folder.keep()
        host, port = connection.socket.getsockname()
        logs: dict[GroundStation, FlightLog] = {}

        def update() -> None:
            station = server.session.station
            if station not in logs:
                logs.clear()
                logs[station] = FlightLog(station)
            if server.session.is_armed:
                logs[station].update()

        interrupt.begin_flight()  # before clients know that it is ready, and may end it
        for name, address in (("team", (host, port)), *(("sends to", client) for client in options.clients)):
            print(f"{name}: udp://{address[0]}:{address[1]}")
        print(f"system {TEAM_SYSTEM}: ready; Ctrl-C lands the payload and ends", flush=True)
        if simulator is None:
            run_in_real_time(
                server, connection, interrupt, world.system.drivers, speed=options.fly.pace, progress=update
            )
        else:
            _run_with(simulator, server, connection, interrupt, options, update)
        if interrupt.requested_again:
            LOG.error(INTERRUPTED_TWICE)
        interrupt.end_flight()
    if simulator is not None and (reason := simulator.last_lines):
        print(*reason, sep="\n", file=sys.stderr)
    return Served([result.run_dir for result in flights.results], server.session.is_interrupted)


def _run_with(
    simulator: Simulator,
    server: TeamServer,
    connection: Connection,
    interrupt: Interrupt,
    options: ServeOptions,
    update: Callable[[], None],
) -> None:
    """Run in lockstep, no faster than the wall clock: on a busy machine time goes more slowly, and nothing is lost."""
    clock = simulator.clock_address
    assert clock is not None  # of a world in lockstep
    settings = server.session.world.system.drivers
    with closing(LockstepConnection(connection, clock)) as in_lockstep:
        run_in_lockstep(
            server, in_lockstep, clock, interrupt, settings,
            pace=Pace(options.fly.pace), progress=update, end_reason=simulator.end_reason,
        )  # fmt: skip
