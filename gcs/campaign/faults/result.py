"""What came of one flight with faults."""

from __future__ import annotations

import dataclasses
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcs.campaign.faults.detection import detection, first_start
from gcs.campaign.faults.sweep import FaultFlight
from gcs.campaign.process_pool import Ended
from gcs.faults.record import fault_notes
from gcs.record.modes import stops_after

WITHIN, OUTSIDE, ABORTED, COLLIDED, FAILED, NOT_FLOWN = VERDICTS = (
    "within limits", "outside limits", "aborted", "collided", "failed", "not flown",
)  # fmt: skip
"""How a flight ended, from good to bad: ``aborted`` is set down safely, but before its mission was done."""

WITHIN_LIMITS, SAFE = REQUIREMENTS = ("within limits", "safe")
"""What a flight passes by: completed within its limits; or set down safely in whatever way, with its limits held."""


@dataclass(frozen=True)
class FaultResult:
    """What came of one flight: a row of the table. m, s, deg; None: not known, or it never happened.

    ``stop_s``: from the start of the case's first fault to the moment when the flight was broken off;
    ``team_stop_s``: to when the last vehicle had stopped flying the ground's set-points, then ``team_spread_s`` after
    the first one. ``landed``, ``touchdown_mps`` and ``end_tilt_deg``: whether the payload stands on the ground at the
    end, how fast it touched, and its angle to upright.
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
    passed: bool
    within_limits: bool
    failures: str
    reason: str
    exit_code: int
    clearance_min_m: float | None
    tilt_max_deg: float | None
    uav_separation_min_m: float | None
    contacts: int | None
    landed: bool | None
    touchdown_mps: float | None
    end_tilt_deg: float | None
    position_rmse_m: float | None
    duration_s: float | None
    stop_s: float | None
    team_stop_s: float | None
    team_spread_s: float | None
    detected_s: float | None
    detected_as: str
    false_alarms: int | None
    notes: str
    wall_s: float
    run_dir: str
    replay: str

    @property
    def safe(self) -> bool:
        """Whether the payload was set down without contact, in whatever way."""
        return self.outcome in (WITHIN, OUTSIDE, ABORTED) and not self.contacts

    def held_to(self, requirement: str) -> FaultResult:
        """The same with ``passed`` by one of :data:`REQUIREMENTS`."""
        passed = self.within_limits if requirement == WITHIN_LIMITS else self.safe and not self.failures
        return dataclasses.replace(self, passed=passed)


COLUMNS = tuple(field.name for field in dataclasses.fields(FaultResult))


def replay_command(mission: Path, options: Sequence[str]) -> str:
    """The command that repeats a flight."""
    return shlex.join(["gcs", "fly", str(mission), *options])


def evaluate(flight: FaultFlight, ended: Ended, run_dir: Path, replay: str) -> FaultResult:
    """The result of a flight."""
    summary = ended.summary
    landing = summary.get("landing") or {}
    count = len(flight.case.faults)
    stop = stop_time(summary, run_dir, count)
    last, spread = team_stop(run_dir, count) if stop is not None else (None, None)
    noticed = detection(run_dir, count)
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
        passed=ended.exit_code == 0,
        within_limits=ended.exit_code == 0,
        failures=" ".join(limits_not_held(summary)),
        reason=ended.reason,
        exit_code=ended.exit_code,
        clearance_min_m=summary.get("clearance_min_m"),
        tilt_max_deg=max(angles, default=None),
        uav_separation_min_m=summary.get("uav_separation_min_m"),
        contacts=summary.get("contacts"),
        landed=landing.get("on_ground"),
        touchdown_mps=landing.get("speed_mps"),
        end_tilt_deg=landing.get("tilt_deg"),
        position_rmse_m=summary.get("position_rmse_m", {}).get("total"),
        duration_s=summary.get("duration_s"),
        stop_s=stop,
        team_stop_s=last,
        team_spread_s=spread,
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
    """From :func:`first_start` of the last ``count`` faults to when the flight was broken off (s); None: it was not."""
    broken_off, begin = summary.get("broken_off_s"), first_start(run_dir, count)
    return None if broken_off is None or begin is None or broken_off < begin else round(broken_off - begin, 3)


def team_stop(run_dir: Path, count: int) -> tuple[float | None, float | None]:
    """From :func:`first_start` to the last vehicle's stop, and from the first one's to the last one's (s)."""
    begin = first_start(run_dir, count)
    stops = stops_after(run_dir, begin).values() if begin is not None else ()
    if begin is None or not stops:
        return None, None
    return round(max(stops) - begin, 3), round(max(stops) - min(stops), 3)
