"""One control step as the detectors of alarms get it, and the scope in which an alarm is raised."""

from collections.abc import Callable, Sequence
from enum import Enum
from typing import NamedTuple

from gcs.flight.alarms import AlarmCode, AlarmLog, Severity
from gcs.flight.control_loop import StepRecord
from gcs.flight.flight import Flight
from gcs.mavlink.id_check import SystemIdCheck
from gcs.mavlink.vehicle_link import VehicleLink


class Scope(Enum):
    """Phases in which a detector runs."""

    ALWAYS = "always"
    IN_AIR = "in the air"
    CLEAR_OF_GROUND = "in the air, with the payload clear of the ground"


class ScopedAlarm(AlarmCode):
    """An alarm that counts in some phases only."""

    scope: Scope

    def __init__(self, scope: Scope, severity: Severity, action: str, meaning: str) -> None:
        super().__init__(severity, action, meaning)
        self.scope = scope


class MonitorStep(NamedTuple):
    """Inputs of a detector in one control step: team ``time`` and ground time ``now`` (s)."""

    time: float
    now: float
    flight: Flight
    id_check: SystemIdCheck
    log: AlarmLog
    record: StepRecord | None
    in_air: bool
    names: Sequence[str]
    """Of all vehicles, then of the payload."""
    clear: bool
    """True in the air, clear of the ground, with an estimate of this step."""
    steady: bool
    """No hard manoeuvre lately: the attitude loop does what its linear model says."""

    @property
    def links(self) -> tuple[VehicleLink, ...]:
        """The links of all vehicles."""
        return self.flight.system.team.links

    def raise_alarm(self, source: str, code: ScopedAlarm, text: str = "") -> None:
        """Raise an alarm now, if its scope allows."""
        within = {Scope.ALWAYS: True, Scope.IN_AIR: self.in_air, Scope.CLEAR_OF_GROUND: self.clear}
        if within[code.scope]:
            self.log.raise_alarm(self.time, source, code, text)


Detector = Callable[[MonitorStep], None]
