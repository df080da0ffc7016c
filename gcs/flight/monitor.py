"""Flight monitor: runs the detectors once a control step; what they find goes to the alarm log."""

import math
from collections.abc import Sequence

from gcs.config.flight_settings import DEFAULTS, MonitorSettings
from gcs.flight.alarms import AlarmLog
from gcs.flight.control_loop import StepRecord
from gcs.flight.detectors import detectors
from gcs.flight.flight import Flight
from gcs.flight.monitor_step import Detector, MonitorStep
from gcs.flight.phase import IN_AIR
from gcs.mavlink.id_check import SystemIdCheck


class FlightMonitor:
    """Call :meth:`step` once a control step, after the flight's own; times are the team's (s)."""

    def __init__(
        self,
        flight: Flight,
        id_check: SystemIdCheck,
        log: AlarmLog,
        settings: MonitorSettings = DEFAULTS.monitor,
        others: Sequence[Detector] = (),
    ) -> None:
        """``others``: detectors that run after those of :func:`.detectors.detectors`."""
        self._flight, self._id_check, self._log, self._settings = flight, id_check, log, settings
        self._detectors = (*detectors(flight, settings), *others)
        self._names = [*(f"vehicle {link.system_id}" for link in flight.system.team.links), "payload"]
        self._tilts: list[float] = []
        self._steady_from = -math.inf

    def step(self, time: float, now: float, record: StepRecord | None) -> None:
        """Raise the alarms of team ``time``, ground time ``now``; ``record``: of the flight's step, if it made one."""
        flight = self._flight
        in_air = flight.phase in IN_AIR
        clear, steady = False, True
        if in_air and record is not None and flight.system.payload.is_clear(record.estimate):
            clear, steady = True, self._is_steady(time, record.decision.u[: 2 * len(flight.system.team.links)].tolist())
        step = MonitorStep(time, now, flight, self._id_check, self._log, record, in_air, self._names, clear, steady)
        for detector in self._detectors:
            detector(step)

    def _is_steady(self, time: float, tilts: list[float]) -> bool:
        """Return True if no tilt set-points (2 N,) (rad) of late stepped beyond the attitude loop's linear model."""
        s = self._settings
        steps = [abs(now - before) for now, before in zip(tilts, self._tilts, strict=False)]
        if max(steps, default=0.0) > s.manoeuvre_tilt:
            self._steady_from = time + s.manoeuvre_time
        self._tilts = tilts
        return time >= self._steady_from
