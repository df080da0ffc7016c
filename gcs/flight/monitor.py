"""Flight monitor: runs the detectors once a control step; what they find goes to the alarm log."""

from __future__ import annotations

from gcs.config.flight_settings import DEFAULTS, MonitorSettings
from gcs.flight.alarms import AlarmLog
from gcs.flight.control_loop import StepRecord
from gcs.flight.detectors import ManoeuvreDetector, Observation, detectors
from gcs.flight.flight import Flight
from gcs.flight.phase import IN_AIR
from gcs.mavlink.id_check import SystemIdCheck


class FlightMonitor:
    """Call :meth:`step` once a control step, after the flight's own; times are the team's (s)."""

    def __init__(
        self, flight: Flight, id_check: SystemIdCheck, log: AlarmLog, settings: MonitorSettings = DEFAULTS.monitor
    ) -> None:
        self._flight, self._id_check, self._log = flight, id_check, log
        self._detectors = detectors(flight, settings)
        self._manoeuvre = ManoeuvreDetector(settings)

    def step(self, time: float, now: float, record: StepRecord | None) -> None:
        """Raise the alarms of team ``time``, ground time ``now``; ``record``: of the flight's step, if it made one."""
        flight = self._flight
        in_air = flight.phase in IN_AIR
        clear = in_air and record is not None and flight.payload.is_clear(record.estimate)
        steady = True
        if clear and record is not None:
            steady = self._manoeuvre.is_steady(time, record.decision.u[: 2 * len(flight.team.links)])
        seen = Observation(time, now, flight, self._id_check, self._log, record, in_air, clear, steady)
        for detector in self._detectors:
            detector(seen)
