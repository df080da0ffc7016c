"""What came of one flight with faults."""

from __future__ import annotations

import dataclasses
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcs.fault_campaign.detection import detection, first_start
from gcs.fault_campaign.sweep import FaultFlight
from gcs.faults.record import fault_notes
from gcs.side_by_side import Ended

WITHIN, OUTSIDE, ABORTED, COLLIDED, FAILED, NOT_FLOWN = VERDICTS = (
    "within limits", "outside limits", "aborted", "collided", "failed", "not flown",
)  # fmt: skip
"""How a flight ended, from good to bad: ``aborted`` is landed safely, but before its mission was done."""


@dataclass(frozen=True)
class FaultResult:
    """What came of one flight: a row of the table. m, s, deg; None: not known, or it never happened.

    ``stop_s``: from the start of the case's first fault to the moment when the flight was broken off.
    ``detected_s``: from there to the first alarm, ``detected_as``. ``false_alarms``: alarms before any fault.
    ``notes``: faults that never came or disturbed nothing. ``run_dir`` is empty where it was not kept.
    """

    number: int
    name: str
    fault: str
    kind: str
    level: int
    severity: str
    mission: str
    seed: int
    outcome: str
    within_limits: bool
    failures: str
    reason: str
    exit_code: int
    clearance_min_m: float | None
    tilt_max_deg: float | None
    uav_separation_min_m: float | None
    contacts: int | None
    position_rmse_m: float | None
    duration_s: float | None
    stop_s: float | None
    detected_s: float | None
    detected_as: str
    false_alarms: int | None
    notes: str
    wall_s: float
    run_dir: str
    replay: str

    @property
    def passed(self) -> bool:
        """Whether the flight was completed within its limits."""
        return self.within_limits


COLUMNS = tuple(field.name for field in dataclasses.fields(FaultResult))


def replay_command(mission: Path, options: Sequence[str]) -> str:
    """The command that repeats a flight."""
    return shlex.join(["gcs", "fly", str(mission), *options])


def evaluate(flight: FaultFlight, ended: Ended, run_dir: Path, replay: str) -> FaultResult:
    """The result of a flight."""
    summary = ended.summary
    noticed = detection(run_dir, len(flight.case.faults))
    angles = [angle for angle in summary.get("payload_tilt_max_deg", {}).values() if angle is not None]
    return FaultResult(
        number=flight.number,
        name=flight.name,
        fault=flight.case.name,
        kind=flight.case.kind,
        level=flight.case.level,
        severity=flight.case.severity,
        mission=flight.mission,
        seed=flight.seed,
        outcome=verdict(ended),
        within_limits=ended.exit_code == 0,
        failures=" ".join(limits_not_held(summary)),
        reason=ended.reason,
        exit_code=ended.exit_code,
        clearance_min_m=summary.get("clearance_min_m"),
        tilt_max_deg=max(angles, default=None),
        uav_separation_min_m=summary.get("uav_separation_min_m"),
        contacts=summary.get("contacts"),
        position_rmse_m=summary.get("position_rmse_m", {}).get("total"),
        duration_s=summary.get("duration_s"),
        stop_s=stop_time(summary, run_dir, len(flight.case.faults)),
        detected_s=noticed.after,
        detected_as=noticed.told,
        false_alarms=noticed.false,
        notes="; ".join(fault_notes(run_dir)),
        wall_s=round(ended.wall, 1),
        run_dir=str(run_dir) if run_dir.exists() else "",
        replay=replay,
    )


def verdict(ended: Ended) -> str:
    """One of :data:`VERDICTS`."""
    outcome = ended.summary.get("outcome")
    if outcome is None:
        return NOT_FLOWN
    if outcome != "completed":
        return str(outcome)
    return WITHIN if ended.exit_code == 0 else OUTSIDE


def limits_not_held(summary: dict[str, Any]) -> list[str]:
    """The names of them."""
    return [name for name, (_, _, held) in summary.get("limits", {}).items() if not held]


def stop_time(summary: Mapping[str, Any], run_dir: Path, count: int) -> float | None:
    """From the first of the last ``count`` faults to when the flight was broken off (s); None: it was not."""
    broken_off = summary.get("broken_off_s")
    begin = first_start(run_dir, count)
    return None if begin is None or broken_off is None or broken_off < begin else round(broken_off - begin, 3)
