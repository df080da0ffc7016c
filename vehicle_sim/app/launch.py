"""From options to a running simulator: reads what is to be simulated, opens everything or nothing, runs a driver."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import sys
import tempfile
from argparse import Namespace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from gcs.config import SystemConfig, read_system
from gcs.config.overrides import with_settings
from gcs.drivers.live_view import LiveView
from gcs.errors import UnusableInput
from gcs.mavlink.address import THIS_MACHINE, VEHICLE_PORT
from gcs.mission.faults import check_faults_of
from gcs.mission.model import Mission
from gcs.mission.read import read_mission
from gcs.numerics import differences
from gcs.record.incomplete import INCOMPLETE, IncompleteRecords, in_one_line
from gcs.record.run_folder import NewRunFolder, check_run_folder, write_manifest
from vehicle_sim.app.arguments import ClientPorts
from vehicle_sim.app.drivers import LOG, LockstepDriver, RealTimeDriver
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.swarm_sockets import SwarmSockets, url
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.engine_messages import check_display, messages_of_engine_aside
from vehicle_sim.world.truth_log import TruthLog

if TYPE_CHECKING:
    from vehicle_sim.faults.fault_injector import FaultInjector

DEFAULT_SEED = 1


def launch(options: Namespace, arguments: list[str]) -> int:
    """Run the simulator that the options describe until it ends; returns the exit status.

    Raises :class:`~gcs.errors.GcsError` or :class:`SimulationError` for what cannot be done; nothing is left open.
    """
    incomplete = IncompleteRecords()
    with contextlib.ExitStack() as started:
        status = _run(options, arguments, started, incomplete)
    if not incomplete.found:
        return status
    if options.with_parent:
        with contextlib.suppress(BrokenPipeError):  # which has ended before
            print(*(file.line() for file in incomplete.found), sep="\n", flush=True)
    else:
        print(in_one_line(incomplete.found), file=sys.stderr)
    return status or INCOMPLETE


def _run(options: Namespace, arguments: list[str], started: contextlib.ExitStack, incomplete: IncompleteRecords) -> int:
    if not options.with_parent and options.run_dir is not None:
        check_run_folder(options.run_dir)
    mission, config = _read(options)
    ports = ClientPorts.of(options, config.team.vehicles)
    seed = options.seed if options.seed is not None else DEFAULT_SEED if mission is None else mission.seed
    if options.gui:
        check_display()
    if not options.with_parent and (others := differences()):
        LOG.warning(others)
    ending = started.enter_context(contextlib.closing(Ending(sys.stdin.fileno() if options.with_parent else None)))
    started.enter_context(ending.on_signals())
    injector = None
    if mission is not None and mission.faults:
        # The kinds take long to import, spent only where there are faults.
        from vehicle_sim.faults.fault_injector import FaultInjector

        injector = FaultInjector(mission.faults, seed, config, mission)
    with messages_of_engine_aside() if options.gui else contextlib.nullcontext():
        swarm = started.enter_context(
            Swarm(
                config,
                seed=seed,
                home=None if mission is None else mission.home,
                obstacles=() if mission is None else mission.obstacles,
                ground_address=ports.ground,
                sdk_address=ports.sdk,
                faults=injector,
                gui=options.gui,
                free=options.free,
            )
        )
    sockets = started.enter_context(
        SwarmSockets(ports.listening_host, options.base_port, len(swarm.vehicles), options.lockstep)
    )
    if options.view and options.run_dir is None:
        options.run_dir = Path(started.enter_context(tempfile.TemporaryDirectory(prefix="vehicle-sim-")), "run")
    if options.run_dir is not None:
        view = started.enter_context(contextlib.ExitStack())  # ends when the records are closed
        truth = _truth_log(options, arguments, seed, mission, config)
        if options.view:
            print(f"live view: {view.enter_context(LiveView(options.run_dir)).url}", file=sys.stderr, flush=True)
        started.callback(lambda: incomplete.found.extend(truth.incomplete.found))
        swarm.record(truth)
        started.callback(truth.close)
    if injector is not None:
        started.callback(_report_faults, options, injector, swarm, incomplete)
    driver: LockstepDriver | RealTimeDriver
    if options.lockstep:
        driver = LockstepDriver(swarm, sockets, ending)
    else:
        driver = RealTimeDriver(swarm, sockets, ending, options.speed or 1.0)
    try:
        _announce(sockets, options)
    except BrokenPipeError:  # the process that started this has ended already
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    driver.run()
    return ending.status


def _read(options: Namespace) -> tuple[Mission | None, SystemConfig]:
    mission = None if options.mission is None else read_mission(options.mission, options.config, options.settings)
    config = with_settings(read_system(options.config), options.settings or {}) if mission is None else mission.system
    if options.free:
        number = options.vehicles or config.team.vehicles
        config = dataclasses.replace(config, team=dataclasses.replace(config.team, vehicles=number, attachments=None))
    elif options.vehicles is not None:
        config = config.with_vehicles(options.vehicles)
    if mission is not None:
        if options.free:
            _refuse_faults_of_payload(mission)
        mission = dataclasses.replace(mission, system=config)
        check_faults_of(mission)
    return mission, config


def _refuse_faults_of_payload(mission: Mission) -> None:
    """Raise :class:`UnusableInput` for a fault of a payload that is not there, or in a phase of its flight."""
    for fault in mission.faults:
        if fault.start_phase is not None:
            reason = "start_phase: with --free every vehicle flies by itself: start is the time after take-off"
            raise UnusableInput(f"{mission.path}: line {fault.line}: fault {fault.kind}: {reason}")
        if fault.kind.startswith("payload_") or str(fault.settings.get("channel", "")).startswith("payload_"):
            raise UnusableInput(
                f"{mission.path}: line {fault.line}: fault {fault.kind}: with --free there is no payload"
            )


def _truth_log(
    options: Namespace, arguments: list[str], seed: int, mission: Mission | None, config: SystemConfig
) -> TruthLog:
    if options.with_parent:  # the folder is the parent's, and so is the manifest
        return TruthLog(options.run_dir, config.team.vehicles, payload=not options.free)
    with NewRunFolder("", options.run_dir) as folder:
        write_manifest(
            folder.path, command=["vehicle-sim", *arguments], seed=seed, mission=mission, system=config,
            start=datetime.now(UTC),
        )  # fmt: skip
        truth = TruthLog(folder.path, config.team.vehicles, payload=not options.free)
        folder.keep()
    return truth


def _report_faults(options: Namespace, injector: FaultInjector, swarm: Swarm, incomplete: IncompleteRecords) -> None:
    """Record what the faults affected, and print notes on those that affected nothing."""
    from gcs.record.faults import notes_of
    from vehicle_sim.faults.fault_injector import faults_record, record_faults

    if options.run_dir is not None:
        record_faults(options.run_dir, injector, swarm.time, incomplete)
    if not options.with_parent:
        for note in notes_of(faults_record(injector, swarm.time)):
            print(note, file=sys.stderr, flush=True)


def _announce(sockets: SwarmSockets, options: Namespace) -> None:
    """Print every listening address: programs read these lines, too."""
    lines = []
    if sockets.clock is not None:
        lines.append(f"clock: {url(sockets.clock)}")
    lines += [f"vehicle {i}: {url(endpoint)}" for i, endpoint in enumerate(sockets.vehicles, start=1)]
    lines.append("ready")
    for line in lines:
        print(line, flush=True)
    if not options.with_parent:
        default = sockets.vehicles[0].getsockname() == (THIS_MACHINE, VEHICLE_PORT)
        addresses = "" if default else "".join(f" {url(endpoint)}" for endpoint in sockets.vehicles)
        hint = f"gcs fly MISSION --realtime --connect{addresses}"
        if options.free:
            hint = "no payload: for MAVLink clients, see docs/clients.md"
        if options.lockstep:
            hint = "lockstep: waiting for a ground station at the clock"
        print(f"({hint}; Ctrl-C ends)", flush=True)
