"""The judgement of a flight with faults."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gcs.campaign.faults.detection import detection, first_start
from gcs.campaign.process_pool import FlownProcess
from gcs.campaign.result import Result
from gcs.faults.record import fault_notes
from gcs.record.modes import stops_after

WITHIN, OUTSIDE, ABORTED, COLLIDED, FAILED, NOT_FLOWN = VERDICTS = (
    "within limits", "outside limits", "aborted", "collided", "failed", "not flown",
)  # fmt: skip
"""How a flight ended, from good to bad: ``aborted`` is set down safely, but before its mission was done."""

WITHIN_LIMITS, SAFE = REQUIREMENTS = ("within limits", "safe")
"""What a flight passes by: completed within its limits; or set down safely in any phase, with its limits held."""

COLUMNS = (
    "number", "name", "fault", "kind", "level", "severity", "mission", "seed", "outcome", "passed", "within_limits",
    "failures", "reason", "exit_code", "clearance_min_m", "tilt_max_deg", "uav_separation_min_m", "contacts", "landed",
    "touchdown_mps", "end_tilt_deg", "position_rmse_m", "duration_s", "stop_s", "team_stop_s", "team_spread_s",
    "detected_s", "detected_as", "false_alarms", "notes", "wall_s", "run_dir", "replay",
)  # fmt: skip


def is_safe(result: Result) -> bool:
    """Return whether the payload was set down without contact, in any phase."""
    return result.outcome in (WITHIN, OUTSIDE, ABORTED) and not result.contacts


def meets(requirement: str, result: Result) -> bool:
    """Return whether a flight passes by one of :data:`REQUIREMENTS`."""
    return result.within_limits if requirement == WITHIN_LIMITS else is_safe(result) and not result.failures


def judge(count: int, flown: FlownProcess, run_dir: Path) -> dict[str, Any]:
    """Return the columns of a flight whose last ``count`` faults are those of its case."""
    stop = stop_time(flown.summary, run_dir, count)
    last, spread = team_stop(run_dir, count) if stop is not None else (None, None)
    detected = detection(run_dir, count)
    return {
        "outcome": verdict(flown),
        "within_limits": flown.exit_code == 0,
        "failures": " ".join(limits_not_held(flown.summary)),
        "stop_s": stop,
        "team_stop_s": last,
        "team_spread_s": spread,
        "detected_s": detected.after,
        "detected_as": detected.alarm,
        "false_alarms": detected.false,
        "notes": "; ".join(fault_notes(run_dir)),
    }


def verdict(flown: FlownProcess) -> str:
    """Return one of :data:`VERDICTS`."""
    outcome = flown.summary.get("outcome")
    if outcome is None:
        return NOT_FLOWN
    if outcome != "completed":
        return str(outcome)
    return WITHIN if flown.exit_code == 0 else OUTSIDE


def limits_not_held(summary: dict[str, Any]) -> list[str]:
    """Return the names of the limits that were not held."""
    return [name for name, (_, _, held) in summary.get("limits", {}).items() if not held]


def stop_time(summary: Mapping[str, Any], run_dir: Path, count: int) -> float | None:
    """Return the time from :func:`first_start` of the last ``count`` faults to the abort (s); None: there was none."""
    broken_off, begin = summary.get("broken_off_s"), first_start(run_dir, count)
    return None if broken_off is None or begin is None or broken_off < begin else round(broken_off - begin, 3)


def team_stop(run_dir: Path, count: int) -> tuple[float | None, float | None]:
    """Return the time from :func:`first_start` to the last vehicle's stop, and that from the first one's stop (s)."""
    begin = first_start(run_dir, count)
    stops = stops_after(run_dir, begin).values() if begin is not None else ()
    if begin is None or not stops:
        return None, None
    return round(max(stops) - begin, 3), round(max(stops) - min(stops), 3)
