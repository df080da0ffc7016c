"""The source of a fault, and the one that an alarm names: which part of which vehicles."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from gcs.faults import KINDS
from gcs.mission.model import Fault

LINK, CLOCK, NAVIGATION, RANGE_SENSOR, SYSTEM_ID, FORCE, GROUND = PARTS = (
    "link", "clock", "navigation", "range sensor", "system id", "wind or load", "ground",
)  # fmt: skip
"""Parts that a fault acts on; the payload has navigation only, and forces act on all."""

RIGHT, AMBIGUOUS, WRONG, NONE = ISOLATIONS = ("right", "ambiguous", "wrong", "none")
"""Whether the first alarms name the true source alone, another beside or before it, only others, or there are none."""

_PARTS_OF_KINDS = {
    "low_rate": LINK,
    "ground_hang": GROUND,
    "swapped_vehicles": SYSTEM_ID,
    "obstacle_sensing_lost": RANGE_SENSOR,
}
_PARTS_OF_FAMILIES = {"link": LINK, "timing": CLOCK, "values": NAVIGATION, "sensors": NAVIGATION, "world": FORCE}

_CODES: dict[tuple[str, ...], str] = {
    (LINK,): "link_latency link_jitter link_congestion messages_lost messages_reordered messages_duplicated "
    "messages_corrupted setpoints_lost all_telemetry_lost telemetry_lost link_latency_exceeded link_unfit "
    "autopilot_unfit offboard_left",
    (CLOCK,): "clock_error",
    (GROUND,): "control_overrun",
    (NAVIGATION,): "stuck_sensor channel_isolated inconsistent_state measurements_rejected innovation_bias "
    "innovation_noise sensor_noise positions_lost telemetry_incomplete attitude_wrong attitude_misaligned",
    (RANGE_SENSOR,): "range_sensor_failed range_sensor_silent range_sensor_displaced obstacle_sensing_lost",
    (SYSTEM_ID,): "id_swap duplicate_system_id",
    (FORCE,): "covariance_reset disturbance_force process_noise plan_deviation_exceeded wind_exceeded unloading_failed "
    "lifted_again",
    (LINK, NAVIGATION): "telemetry_timeout pose_missing",
    (NAVIGATION, RANGE_SENSOR): "values_not_finite vehicle_map_offset map_offset",
}
NAMED_PARTS = {code: parts for parts, codes in _CODES.items() for code in codes.split()}
"""Parts that the code of an alarm names, by what it says to check; other codes name none."""


@dataclass(frozen=True)
class AlarmRow:
    """A row of ``alarms.csv``, its time (s) from the start of the fault."""

    after: float
    source: str
    code: str

    def __str__(self) -> str:
        """The source that it names; where it names no part, its code."""
        parts = " or ".join(NAMED_PARTS.get(self.code, (self.code,)))
        return f"{parts} of {self.source}"


@dataclass(frozen=True)
class FaultSource:
    """The source of a fault: a part of some vehicles, of all (None), or of the payload."""

    part: str
    vehicles: tuple[int, ...] | None = None
    of_payload: bool = False

    def __str__(self) -> str:
        """The source in words."""
        if self.part in (FORCE, GROUND):
            return self.part
        if self.of_payload:
            return f"{self.part} of payload"
        if self.vehicles is None:
            return f"{self.part} of all vehicles"
        return f"{self.part} of {'vehicle' if len(self.vehicles) == 1 else 'vehicles'} " + ", ".join(
            map(str, self.vehicles)
        )

    def is_named_by(self, alarm: AlarmRow) -> bool:
        """Return whether ``alarm`` names it. A fault of all vehicles is named by the team or by any of them."""
        if self.part not in NAMED_PARTS.get(alarm.code, ()):
            return False
        if self.part == FORCE:
            return True
        if self.of_payload:
            return alarm.source == "payload"
        number = re.fullmatch(r"vehicle (\d+)", alarm.source)
        if self.vehicles is None:
            return number is not None or alarm.source == "team"
        return number is not None and int(number[1]) in self.vehicles


def source_of(fault: Fault) -> FaultSource:
    """Return the source of a fault, which follows from its kind, channel and vehicles."""
    channel = str(fault.settings.get("channel", ""))
    part = _PARTS_OF_KINDS.get(fault.kind) or _PARTS_OF_FAMILIES[KINDS[fault.kind].family]
    vehicles = fault.vehicles
    if channel == "obstacles":
        part = RANGE_SENSOR
    elif part == SYSTEM_ID and vehicles is not None:
        vehicles = tuple(sorted((*vehicles, int(fault.settings["other"]))))
    # The payload's one unit is relayed by all vehicles: a fault of single ones is of their relay.
    of_payload = vehicles is None and (channel.startswith("payload_") or fault.kind == "payload_unit_lost")
    return FaultSource(part, vehicles, of_payload)


def sources_of(faults: Sequence[Fault]) -> tuple[FaultSource, ...]:
    """Return the sources of faults that are flown together; those of the world only if there are no others."""
    sources = tuple(dict.fromkeys(map(source_of, faults)))
    return tuple(source for source in sources if source.part != FORCE) or sources


@dataclass(frozen=True)
class Isolation:
    """Whether alarms name the source of a fault: one of :data:`ISOLATIONS`, and what the first name in its place."""

    verdict: str
    named: str


def isolation(sources: Sequence[FaultSource], alarms: Sequence[AlarmRow]) -> Isolation:
    """Compare the alarms since the start of a fault with its sources.

    They are right if all that were raised at the time of the first one name a source of the fault.
    """
    if not alarms:
        return Isolation(NONE, "")
    first = min(alarm.after for alarm in alarms)

    def right(alarm: AlarmRow) -> bool:
        return any(source.is_named_by(alarm) for source in sources)

    at_first = [alarm for alarm in alarms if alarm.after == first]
    named = ", ".join(dict.fromkeys(str(alarm) for alarm in at_first if not right(alarm)))
    if not named:
        return Isolation(RIGHT, "")
    return Isolation(AMBIGUOUS if any(map(right, alarms)) else WRONG, named)
