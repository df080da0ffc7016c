"""Alarms: codes with a MAVLink severity and a text for the operator, and the log of those that were raised."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, IntEnum

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import DEFAULTS, MonitorSettings


class Severity(IntEnum):
    """MAV_SEVERITY, as far as alarms use it."""

    ALERT = mavlink.MAV_SEVERITY_ALERT
    CRITICAL = mavlink.MAV_SEVERITY_CRITICAL
    ERROR = mavlink.MAV_SEVERITY_ERROR
    WARNING = mavlink.MAV_SEVERITY_WARNING
    NOTICE = mavlink.MAV_SEVERITY_NOTICE


class AlarmCode(Enum):
    """Base of the enums of alarms: each member has a severity, what to do about it, and what it means.

    Members are declared where the alarm is detected: :mod:`gcs.flight.detectors`, :mod:`gcs.flight.guarantee`,
    :mod:`gcs.flight.failsafe`.
    """

    def __init__(self, severity: Severity, action: str, meaning: str) -> None:
        self.severity, self.action, self.meaning = severity, action, meaning

    @property
    def code(self) -> str:
        """The name in snake case, which programs read."""
        return self.name.lower()


@dataclass(frozen=True)
class Alarm:
    """One row of ``alarms.csv``."""

    time: float
    """Time at which it was raised (s, team time)."""
    source: str
    """``vehicle 3``, ``payload``, ``team``, or an obstacle's name."""
    code: AlarmCode
    text: str


class AlarmLog:
    """All alarms of a flight, in the order in which they were raised."""

    def __init__(
        self, sink: Callable[[Alarm], None] = lambda alarm: None, settings: MonitorSettings = DEFAULTS.monitor
    ) -> None:
        """``sink`` gets every new alarm."""
        self._sink, self._hold_time = sink, settings.hold_time
        self.alarms: list[Alarm] = []
        self._last: dict[tuple[str, AlarmCode], float] = {}

    def raise_alarm(self, time: float, source: str, code: AlarmCode, text: str = "") -> None:
        """Raise an alarm at ``time`` (s), unless it has been raised within the hold time."""
        if time - self._last.get((source, code), -math.inf) > self._hold_time:
            self.alarms.append(Alarm(time, source, code, text))
            self._sink(self.alarms[-1])
        self._last[source, code] = time
