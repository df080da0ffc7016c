"""``gcs fly``: a mission file, a swarm, a driver and a run folder become one flight with a summary."""

import dataclasses
import json
import math
import os
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gcs.app.exit_status import ExitStatus
from gcs.app.flight_log import FlightLog
from gcs.app.fly_options import FlyOptions
from gcs.app.logs import LOG
from gcs.drivers.connection import Connection, LockstepConnection
from gcs.drivers.forked_program import ForkedProgram
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.live_view import LiveView
from gcs.drivers.lockstep import Pace, is_refused, run_in_lockstep
from gcs.drivers.realtime import run_in_real_time
from gcs.drivers.simulator import PROGRAM, Simulator
from gcs.errors import GcsError, UnusableInput
from gcs.flight import stack
from gcs.flight.alarms import AlarmLog
from gcs.flight.compute_times import ComputeTimes
from gcs.flight.control_loop import ControlLoop
from gcs.flight.feasibility import check_curve
from gcs.flight.flight import Flight
from gcs.flight.ground_station import GroundStation, Recorder
from gcs.flight.team import Team
from gcs.mavlink.address import Address, ConnectionUrl
from gcs.mavlink.vehicle_link import VehicleLink
from gcs.mission.model import Limits, Mission
from gcs.mission.targets import targets_of
from gcs.numerics import differences
from gcs.record.incomplete import Incomplete, read_line
from gcs.record.recorder import FlightRecorder
from gcs.record.run_data import RunData, read_run
from gcs.record.run_folder import SUMMARY, NewRunFolder, UnwritableFile, write_json, write_manifest
from gcs.record.summary import summarise, within_limits
from gcs.record.tables import TRUTH
from gcs.record.verdict import GroundReport, verdict
from idc_controller.guidance.progress import Guidance
from idc_controller.paper.avoidance import PrintedFilter
from idc_controller.safety.filter_protocol import NoObstacles, SafetyFilter


@dataclass(frozen=True)
class FlightResult:
    """Result of a flight."""

    records: RunData
    mission: Mission
    reason: str
    """Why it was not completed; empty: it was."""
    interrupted: bool
    flown: bool
    """True if take-off had begun."""
    incomplete: tuple[Incomplete, ...] = ()
    """What could not be written: the figures are of what there is."""

    @property
    def run_dir(self) -> Path:
        """The folder of the records."""
        return self.records.folder

    @property
    def summary(self) -> Mapping[str, Any]:
        """The summary."""
        return self.records.summary

    @property
    def exit_code(self) -> ExitStatus:
        """The exit status of the command."""
        if self.interrupted:
            return ExitStatus.INTERRUPTED
        if self.incomplete:
            return ExitStatus.INCOMPLETE
        held = self.summary["completed"] and within_limits(self.summary)
        return ExitStatus.DONE if held else ExitStatus.OUTSIDE_LIMITS


def fly(
    options: FlyOptions,
    mission: Mission,
    progress: Callable[[Flight], None],
    vehicle_sim: ForkedProgram | None = None,
) -> FlightResult:
    """Fly ``mission``; every record is closed however it ends.

    ``vehicle_sim``: the program forked in advance, before this process had more threads than one; None: it is forked
    here if it is needed.

    Raises :class:`UnusableInput` before anything is started, and :class:`GcsError` when no world could be started.
    """
    check_curve(mission)
    _check_clock(options)
    before = cpu_time()
    with Interrupt() as interrupt, ExitStack() as viewing, ExitStack() as resources:
        folder = resources.enter_context(NewRunFolder(mission.name, options.run_dir))
        run_dir, started = folder.path, datetime.now(UTC)
        write_manifest(
            run_dir, command=sys.argv, seed=mission.seed, mission=mission, system=mission.system, start=started
        )
        if others := differences():
            LOG.warning(others)
        if options.view:
            view = LiveView(run_dir)
            viewing.callback(view.end)  # with all that is written below; nobody waits for a browser
            print(f"live view: {view.url}", file=sys.stderr, flush=True)
        if vehicle_sim is None and options.connect is None:
            vehicle_sim = resources.enter_context(ForkedProgram(PROGRAM))
        connection = resources.enter_context(closing(Connection(_local_address(options.urls))))
        simulator = None
        if vehicle_sim is not None:
            arguments = simulator_arguments(options, mission, run_dir)
            simulator = resources.enter_context(Simulator(vehicle_sim, arguments, mission.system.drivers))
        addresses = options.addresses(mission.system.team.vehicles) if simulator is None else [*simulator.vehicles]
        recorder = resources.enter_context(FlightRecorder(run_dir, started.timestamp()))
        station = ground_station(mission, addresses, recorder, options.controller)
        log = FlightLog(station)
        ended = simulator.end_reason if simulator is not None else lambda: None

        settings, wall = mission.system.drivers, time.monotonic()

        def update() -> None:
            nonlocal wall
            if math.isnan(station.flight.takeoff_time):
                wall = time.monotonic()
            log.update()
            progress(station.flight)

        folder.keep()
        interrupt.begin_flight()
        if options.realtime:
            run_in_real_time(
                station, connection, interrupt, settings, speed=options.pace, progress=update, end_reason=ended
            )
        else:
            clock = _clock_address(options, simulator)
            in_lockstep = resources.enter_context(closing(LockstepConnection(connection, clock)))
            hint = "" if simulator is not None else "; for a swarm in real time add --realtime"
            pace = Pace(options.pace) if options.view else None
            run_in_lockstep(
                station, in_lockstep, clock, interrupt, settings,
                pace=pace, progress=update, end_reason=ended, hint=hint,
            )  # fmt: skip
        interrupt.end_flight()
        resources.close()
        incomplete = [*recorder.incomplete.found]
        if simulator is not None:
            incomplete += [found for line in simulator.last_lines if (found := read_line(line)) is not None]
        wall = time.monotonic() - wall
        used = cpu_time() - before
        return flight_result(run_dir, mission, station, recorder.last_time, wall, tuple(incomplete), used)


def cpu_time() -> float:
    """Return the CPU time (s) of this process and of those that it has waited for."""
    return sum(os.times()[:4])


def flight_result(
    run_dir: Path,
    mission: Mission,
    station: GroundStation,
    last_time: float,
    wall: float,
    incomplete: tuple[Incomplete, ...] = (),
    cpu: float | None = None,
) -> FlightResult:
    """Return how a flight of ``wall`` seconds ended, and write its summary; its records end at ``last_time`` (s).

    ``incomplete``: the records that end before. ``cpu``: time of the processor (s); None: not known.
    """
    flight = station.flight
    limits = dataclasses.asdict(mission.limits or Limits())
    begun = not math.isnan(flight.takeoff_time)
    duration = last_time - flight.takeoff_time if begun else 0.0
    records = read_run(run_dir)
    interrupted = flight.failsafes.interrupted
    ended_at = flight.failsafes.time
    ground = GroundReport(begun, flight.completed, flight.landed, interrupted, flight.reason, ended_at)
    truth_ends = all(file.name != TRUTH for file in incomplete)
    targets = targets_of(mission) if flight.completed and truth_ends and not flight.is_redirected else None
    ended = verdict(records, ground, targets, limits["arrival"], landing_on_record=truth_ends)
    summary = summarise(
        records,
        ended,
        duration_s=duration,
        real_time_factor=duration / wall if wall > 0.0 else None,
        limits=limits,
        obstacles=bool(mission.obstacles or mission.boundary),
    )
    # By the clock of the records, as it may be before take-off.
    summary["broken_off_s"] = None if math.isnan(flight.failsafes.time) else round(flight.failsafes.time, 6)
    summary["alarms"] = len(flight.failsafes.alarms.alarms)
    summary["cpu_s"] = None if cpu is None else round(cpu, 2)
    if incomplete:
        summary["incomplete_records"] = {file.name: file.end for file in incomplete}
    if not truth_ends:
        summary["landing"] = None  # it is not on record
    try:
        write_json(run_dir / SUMMARY, summary)
    except UnwritableFile as error:
        incomplete = (*incomplete, Incomplete(SUMMARY, None, error.cause.strerror or str(error.cause)))
    records = records.with_summary(summary)
    return FlightResult(records, mission, ended.reason, interrupted, begun, incomplete)


def ground_station(
    mission: Mission, addresses: Sequence[Address | None], recorder: Recorder, controller: str = "idc"
) -> GroundStation:
    """Return the ground station that flies ``mission`` with the vehicles of the system ids 1 .. N at ``addresses``.

    A vehicle whose address is None is flown from where it offers itself. ``controller``: ``idc`` avoids obstacles,
    ``mpc`` only tracks, ``paper`` corrects the thrusts by the paper's own filter.
    """
    config = mission.system
    model = stack.linear_model(config)
    links = [VehicleLink(i, address, config.mavlink.link) for i, address in enumerate(addresses, start=1)]
    stopwatch = time.perf_counter
    obstacle_map = stack.obstacle_map(mission)
    safety: SafetyFilter = NoObstacles()
    guidance: Guidance | None = None
    if controller == "idc":
        safety = stack.avoidance(config, model, obstacle_map)
        guidance = stack.guidance(config, model, obstacle_map, obstacle_map, mission.area)
    elif controller == "paper":
        safety = PrintedFilter(model, obstacle_map, config.avoidance.margin)
    control = ControlLoop(
        stack.estimator(config, model), stack.controller(config, model, safety, stopwatch, guidance),
        ComputeTimes(stopwatch), stack.grounded_links(config, model),
        stack.resting_place(config, model, obstacle_map, mission.area), stack.descent(config),
    )  # fmt: skip
    alarms = AlarmLog(recorder.alarm, config.flight.monitor)
    flight = Flight(mission, Team(links, model.parameters), control, alarms, obstacle_map)
    return GroundStation(flight, recorder)


def _check_clock(options: FlyOptions) -> None:
    """Raise :class:`UnusableInput` where no world in lockstep can be joined, because there is none."""
    if options.connect is None or options.realtime:
        return
    host, port = clock = options.clock_address()
    if is_refused(clock):
        raise UnusableInput(
            f"--connect: no swarm in lockstep at udp://{host}:{port}; for one in real time add --realtime "
            "(vehicle-sim without --lockstep)"
        )


def simulator_arguments(options: FlyOptions, mission: Mission, run_dir: Path) -> list[str]:
    """Return the arguments of a ``vehicle-sim`` for this flight."""
    arguments = ["--mission", str(options.mission), "--vehicles", str(mission.system.team.vehicles)]
    arguments += ["--seed", str(mission.seed), "--run-dir", str(run_dir), "--base-port", "0"]
    if options.config is not None:
        arguments += ["--config", str(options.config)]
    for path, value in (options.settings or {}).items():
        arguments += ["--set", f"{path}={json.dumps(value)}"]
    in_real_time = ["--realtime", "--speed", str(options.pace)]
    return arguments + (in_real_time if options.realtime else ["--lockstep", "--ground-port", "0"])


def _clock_address(options: FlyOptions, simulator: Simulator | None) -> Address:
    if simulator is not None:
        if simulator.clock_address is None:
            raise GcsError("vehicle-sim has not printed the address of its clock")
        return simulator.clock_address
    return options.clock_address()


def _local_address(urls: Sequence[ConnectionUrl]) -> Address:
    listening = [url for url in urls if url.listens]
    if listening:
        return listening[0].address
    remote = [url for url in urls if not url.host.startswith("127.")]
    return ("0.0.0.0" if remote else "127.0.0.1", 0)
