"""The judgement of a flight with faults."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gcs.campaign.faults.cases import Case
from gcs.campaign.faults.sources import AlarmRow, Isolation, isolation
from gcs.campaign.flight import FlightPlan
from gcs.campaign.result import Flown, Result
from gcs.errors import UnusableInput
from gcs.faults import KINDS
from gcs.record.faults import FAULTS_FILE, fault_notes
from gcs.record.landing import is_set_down
from gcs.record.modes import armed_at_end, stops_after
from gcs.record.outcome import Outcome
from gcs.record.reader import read_json, read_table
from gcs.record.summary import limits_not_held
from gcs.record.tables import ALARMS

WITHIN_LIMITS, SAFE, DISARMED = REQUIREMENTS = ("within limits", "safe", "safe and disarmed")
"""Conditions of a pass: completed within its limits; set down safely in any phase, with its limits held; besides that
the payload upright all the time, every vehicle disarmed at the end, and completed only where it arrived.
"""
LEAN_LIMIT_DEG = 20.0
"""Largest roll or pitch of an upright payload in flight."""

COLUMNS = (
    "number", "name", "fault", "kind", "level", "severity", "mission", "seed", "outcome", "passed", "within_limits",
    "failures", "reason", "exit_code", "clearance_min_m", "tilt_max_deg", "lean_max_deg", "uav_separation_min_m",
    "contacts", "landed", "touchdown_mps", "end_tilt_deg", "armed_at_end", "position_rmse_m", "duration_s", "stop_s",
    "team_stop_s", "team_spread_s", "detected_s", "detected_as", "false_alarms", "false_codes", "clean_s",
    "true_source", "isolation", "named_source", "notes", "wall_s", "run_dir", "replay", "format",
)  # fmt: skip


@dataclass(frozen=True)
class Detection:
    """Time (s) from the start of the case's first fault to the first alarm since, and that alarm; None: no alarm.

    ``false``: number of alarms before the flight's first fault, with their codes. ``alarms``: all since the start of
    the case's.
    """

    after: float | None
    alarm: str
    false: int | None
    false_codes: str = field(default="", compare=False)
    alarms: tuple[AlarmRow, ...] = field(default=(), compare=False)


def judge(case: Case, plan: FlightPlan, flown: Flown, run_dir: Path) -> dict[str, Any]:
    """Return the columns of a flight whose last faults are those of its case."""
    begin = first_start(run_dir, len(case.faults))
    stop = stop_time(flown.summary, begin)
    last, spread = team_stop(run_dir, begin) if stop is not None else (None, None)
    detected = detection(run_dir, begin)
    isolated = (
        isolation(case.sources, detected.alarms)
        if begin is not None and detected.false is not None
        else Isolation("", "")
    )
    return {
        "outcome": outcome(flown).value,
        "within_limits": flown.exit_code == 0,
        "failures": " ".join(limits_not_held(flown.summary)),
        "armed_at_end": vehicles_armed_at_end(run_dir),
        "stop_s": stop,
        "team_stop_s": last,
        "team_spread_s": spread,
        "detected_s": detected.after,
        "detected_as": detected.alarm,
        "false_alarms": detected.false,
        "false_codes": detected.false_codes,
        "clean_s": clean_time(flown.summary.get("duration_s"), run_dir),
        "isolation": isolated.verdict,
        "named_source": isolated.named,
        "notes": "; ".join(fault_notes(run_dir)),
    }


def outcome(flown: Flown) -> Outcome:
    """Return how a flight ended; one without a summary has failed."""
    return Outcome(flown.summary.get("outcome") or Outcome.FAILED)


def is_safe(result: Result) -> bool:
    """Return whether the payload was set down without contact, in any phase and wherever."""
    if result.contacts or result.outcome in (Outcome.COLLIDED, Outcome.LOST):
        return False
    if result.outcome != Outcome.FAILED:
        return True
    figures = (result.landed, result.end_tilt_deg, result.touchdown_mps, 0)
    keys = ("on_ground", "tilt_deg", "speed_mps", "contacts_before")
    return result.end_tilt_deg is not None and is_set_down(dict(zip(keys, figures, strict=True)))


def meets(requirement: str, result: Result) -> bool:
    """Return whether a flight passes by one of :data:`REQUIREMENTS`."""
    if requirement == WITHIN_LIMITS:
        return result.within_limits
    failures = set(result.failures.split())
    safe = is_safe(result) and not failures - {"arrival"}
    if requirement == SAFE:
        return safe
    is_down = result.landed is not False and not result.armed_at_end
    upright = result.lean_max_deg is None or result.lean_max_deg <= LEAN_LIMIT_DEG
    return safe and is_down and upright and not (result.outcome == Outcome.COMPLETED and "arrival" in failures)


def vehicles_armed_at_end(run_dir: Path) -> str:
    """Return the vehicles (system ids) that were armed at the end; "unknown" without a record of their modes."""
    try:
        return " ".join(map(str, armed_at_end(run_dir)))
    except UnusableInput:
        return "unknown"


def first_start(run_dir: Path, count: int | None = None) -> float | None:
    """Return the start of the first of the last ``count`` faults of a flight (None: of all), in time of the tables (s).

    The faults before them are the mission's own; of the last ones wind and load count only if there are no others.
    None: none of them started, or there is no record of them.
    """
    try:
        record = read_json(run_dir / FAULTS_FILE)
        faults = record["faults"][0 if count is None else len(record["faults"]) - count :]
        if count is not None:
            others = [f for f in faults if (kind := KINDS.get(f.get("kind"))) is None or kind.family != "world"]
            faults = others or faults
        first = min(fault["activations"][0][0] for fault in faults if fault["activations"])
        return float((record["take_off_s"] or 0.0) + first)
    except (UnusableInput, KeyError, TypeError, IndexError, ValueError):
        return None


def clean_time(duration: float | None, run_dir: Path) -> float | None:
    """Return how much of a flight's ``duration`` is before its :func:`first_start` (s); all, if no fault started."""
    first = first_start(run_dir)
    if duration is None or first is None:
        return duration
    record = read_json(run_dir / FAULTS_FILE)
    return round(max(0.0, duration - (float(record["end_s"]) - first)), 3)


def stop_time(summary: Mapping[str, Any], begin: float | None) -> float | None:
    """Return the time from ``begin``, the :func:`first_start` of a case, to the abort (s); None: there was none."""
    broken_off = summary.get("broken_off_s")
    return None if broken_off is None or begin is None or broken_off < begin else round(broken_off - begin, 3)


def team_stop(run_dir: Path, begin: float | None) -> tuple[float | None, float | None]:
    """Return the time from ``begin`` to the last vehicle's stop, and that from the first vehicle's stop (s)."""
    stops = stops_after(run_dir, begin).values() if begin is not None else ()
    if begin is None or not stops:
        return None, None
    return round(max(stops) - begin, 3), round(max(stops) - min(stops), 3)


def detection(run_dir: Path, begin: float | None) -> Detection:
    """Return the detection of the faults of a case that start at ``begin``, from the flight's table of alarms."""
    path, unknown = run_dir / ALARMS, Detection(None, "", None)
    if not path.exists():
        return unknown
    try:
        rows = read_table(path)[["time_s", "source", "code"]].tolist()
    except UnusableInput:
        return unknown
    first = first_start(run_dir)
    codes = [code for time, _, code in rows if first is None or time < first]
    false = len(codes), " ".join(codes)
    since = () if begin is None else tuple(AlarmRow(round(t - begin, 3), *names) for t, *names in rows if t >= begin)
    if not since:
        return Detection(None, "", *false)
    at_first = min(since, key=lambda alarm: alarm.after)
    return Detection(at_first.after, f"{at_first.code}, {at_first.source}", *false, since)
