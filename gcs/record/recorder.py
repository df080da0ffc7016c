"""Recorder of a flight: telemetry log, reference, estimate, control steps, alarms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gcs.flight.phase import IN_AIR, Phase
from gcs.record.horizon_recorder import HorizonRecorder
from gcs.record.incomplete import IncompleteRecords
from gcs.record.innovation_recorder import InnovationRecorder
from gcs.record.obstacle_recorder import ObstacleRecorder
from gcs.record.tables import ALARMS, COLUMNS, ESTIMATE, GRID_TOLERANCE, PHASES, PLAN, REFERENCE, STEPS, TableWriter
from gcs.record.tlog import TelemetryLog
from idc_controller.rotations import quaternion_from_euler

if TYPE_CHECKING:
    from gcs.flight.alarms import Alarm
    from gcs.flight.control_loop import StepRecord
    from gcs.flight.flight import Flight
    from idc_controller.arrays import Array
    from idc_controller.control.controller import Decision
    from idc_controller.estimation.measurements import Estimate
    from idc_controller.perception.obstacle_map import ObstacleMap

REFERENCE_INTERVAL = 0.02  # s, the grid of truth.csv
_SD_DIGITS = 7
_MASS_DIGITS = 4
_SD_ORDER = np.array([*range(3), *range(6, 9), *range(3, 6), *range(9, 15)])
"""Of the columns, in the estimator's order: position, velocity, attitude, rates, force."""


class FlightRecorder(ExitStack):
    """The ground's records of one flight; a context manager that closes them.

    ``incomplete``: what could not be written.
    """

    def __init__(self, run_dir: Path, start_epoch: float) -> None:
        """``start_epoch``: seconds since 1970 at the ground's time 0, for the telemetry log."""
        super().__init__()
        self.incomplete = incomplete = IncompleteRecords()
        self._tlog = self.enter_context(TelemetryLog(run_dir / "telemetry.tlog", start_epoch, incomplete))
        self._reference, self._estimate, self._steps, self._alarms, self._plan, self._phases = (
            self.enter_context(TableWriter(run_dir / name, COLUMNS[name], incomplete))
            for name in (REFERENCE, ESTIMATE, STEPS, ALARMS, PLAN, PHASES)
        )
        self._obstacles = self.enter_context(closing(ObstacleRecorder(run_dir, incomplete)))
        self._phase: Phase | None = None
        self._innovations = self.enter_context(InnovationRecorder(run_dir, incomplete))
        self._horizon = self.enter_context(HorizonRecorder(run_dir, incomplete))
        self._next_row: int | None = None
        self.last_time = 0.0

    def datagrams(self, now: float, datagrams: Sequence[bytes]) -> None:
        """Record datagrams, sent or received."""
        self._tlog.write(now, *datagrams)

    def end_exchange(self) -> None:
        """Write the datagrams of an exchange."""
        self._tlog.flush()

    def step(self, flight: Flight, time: float, record: StepRecord | None) -> None:
        """Record a control step at team ``time`` (s)."""
        self.last_time = self.incomplete.time = time
        if flight.phase is not self._phase:
            self._phase = flight.phase
            self._phases.write([round(time, 6), flight.phase.value])
        if not math.isnan(flight.takeoff_time):
            self._write_reference(flight, time)
        if record is None:
            return
        estimate, decision = record.estimate, record.decision
        x = estimate.x[:12].tolist()
        attitude = quaternion_from_euler(*x[6:9]).tolist()
        self._estimate.write_numbers(
            [float(estimate.time), *x[0:3], *attitude, *x[3:6], *x[9:12], *estimate.force.tolist(),
             *_standard_deviations(estimate).tolist(), round(flight.control.controller.load.payload_mass, _MASS_DIGITS)]
        )  # fmt: skip
        control = flight.control
        self._innovations.record(control.estimator, estimate, time)
        if flight.phase not in IN_AIR:
            return
        self._write_plan(estimate.time, decision)
        if control.stop_plans and control.stop_plans[-1].start == estimate.time:
            chain, parameters = flight.mission.system.safety.planner.chain, control.controller.parameters
            trajectory = decision.reference.trajectory
            self._horizon.record(estimate.time, trajectory, control.stop_plans[-1], chain, parameters)

    def _write_plan(self, time: float, decision: Decision) -> None:
        position, _, acceleration = decision.flat.payload[:3, 0].tolist()
        safety = decision.safety
        bounds = (math.nan if b is None else b for b in (safety.payload_bound, safety.uav_bound))
        progress = (safety.slack, safety.lag, decision.progress_rate, decision.detours)
        sight = decision.sight
        limit = (min(sight.rate, 1.0), sight.distance, sight.code)
        check = (min(safety.clearance, 1e9), int(safety.verified), int(not safety.infeasible))
        self._plan.write_numbers([time, *position, *acceleration, *progress, *bounds, *limit, *check])

    def compute_times(self, time: float, decision: Decision, parts: Sequence[float]) -> None:
        """Record the compute times (s) of the control step at team ``time`` (s), as :class:`Part` orders them."""
        milliseconds = [1e3 * part for part in parts]
        telemetry, estimation, perception, planning, *others = milliseconds
        self._steps.write_numbers(
            [time, estimation, planning, 1e3 * decision.compute_time.tracker, sum(milliseconds), decision.iterations,
             int(decision.infeasible or decision.safety.infeasible), telemetry, perception, *others]
        )  # fmt: skip

    def obstacles(self, obstacle_map: ObstacleMap, time: float) -> None:
        """Record the detected obstacles at team ``time`` (s)."""
        self._obstacles.record(obstacle_map, time)

    def alarm(self, alarm: Alarm) -> None:
        """Record a new alarm."""
        code = alarm.code
        self._alarms.write([round(alarm.time, 6), alarm.source, code.code, code.severity.name.lower(), alarm.text])

    def _write_reference(self, flight: Flight, time: float) -> None:
        if flight.ended:
            return
        if self._next_row is None:
            self._next_row = math.ceil(flight.takeoff_time / REFERENCE_INTERVAL - GRID_TOLERANCE)
        last = math.floor(time / REFERENCE_INTERVAL + GRID_TOLERANCE)
        times = [row * REFERENCE_INTERVAL for row in range(self._next_row, last + 1)]
        if times:
            position, velocity = flight.reference(np.array(times))
            rows = zip(times, position.tolist(), velocity.tolist(), strict=True)
            self._reference.write_numbers(*[[round(t * 1e6) / 1e6, *p, *v] for t, p, v in rows])
            self._next_row = last + 1


def _standard_deviations(estimate: Estimate) -> Array:
    """Return those of the payload's state and of the force on it (15,), in the order of the columns."""
    variances = np.concatenate([estimate.predict_payload_variances(), estimate.force_covariance.diagonal()])
    return np.asarray(np.sqrt(variances[_SD_ORDER]).round(_SD_DIGITS))
