"""The result of one flight of a campaign: a row of its table."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcs.record.reader import read_json
from gcs.record.run_folder import FORMAT

TIMING = (
    "wall_s", "cpu_s", "real_time_factor", "step_time_p50_ms", "step_time_p99_ms", "run_dir", "replay",
)  # fmt: skip
"""Columns that depend on the machine and on the folder: those of ``timing.csv``, and of no other table."""


@dataclass(frozen=True)
class Flown:
    """How a flight ended: exit status, summary (empty without one), reason (empty: completed), wall time (s)."""

    exit_code: int
    summary: Mapping[str, Any]
    reason: str
    wall: float


@dataclass(frozen=True)
class Result:
    """One flight. m, s, deg; None: not known, or it never happened.

    A table of all columns that any campaign has, hence so many fields; each campaign writes those that it names.
    """

    number: int = 0
    name: str = ""
    kind: str = ""
    passed: bool = False
    failures: str = ""
    outcome: str = ""
    reason: str = ""
    exit_code: int = 0
    wall_s: float = 0.0
    cpu_s: float | None = None
    run_dir: str = ""
    """Empty where it was discarded."""
    replay: str = ""

    format: int = FORMAT

    # From the summary of the flight.
    clearance_min_m: float | None = None
    tilt_max_deg: float | None = None
    """Of roll, pitch and yaw."""
    lean_max_deg: float | None = None
    """Of roll and pitch."""
    uav_separation_min_m: float | None = None
    contacts: int | None = None
    duration_s: float | None = None
    position_rmse_m: float | None = None
    slack_max_m: float | None = None
    step_time_p50_ms: float | None = None
    step_time_p99_ms: float | None = None
    infeasible_steps: int | None = None
    real_time_factor: float | None = None
    landed: bool | None = None
    touchdown_mps: float | None = None
    end_tilt_deg: float | None = None

    # Which flight it is, beside number, name and kind.
    mission: str = ""
    seed: int = 0
    fault: str = ""
    level: int = 0
    severity: str = ""
    variant: str = ""

    # Judgement of an obstacle scenario.
    arrival_s: float | None = None
    nominal_arrival_s: float | None = None
    delay_s: float | None = None
    goal_error_m: float | None = None
    passage: str = ""
    """Whether standing obstacles leave a way: passable, marginal, impassable; empty where a way is there by design."""
    gap_m: float | None = None
    gap_named_m: float | None = None
    """The narrowest gap, and what the reason of the abort says it is."""

    # Judgement of a flight with faults, from the start of its case's first fault: to the abort, to the stop of the
    # last vehicle (then from the first vehicle's), to the first alarm; and alarms before any fault.
    within_limits: bool = False
    stop_s: float | None = None
    team_stop_s: float | None = None
    team_spread_s: float | None = None
    armed_at_end: str = ""
    """Vehicles (system ids) that were armed at the end."""
    detected_s: float | None = None
    detected_as: str = ""
    false_alarms: int | None = None
    false_codes: str = ""
    clean_s: float | None = None
    """Time before any fault, in which those were raised; without a fault that of the flight."""
    true_source: str = ""
    isolation: str = ""
    """Whether alarms name the true source (see `gcs.campaign.faults.sources`)."""
    named_source: str = ""
    """What the first alarms name in its place."""
    notes: str = ""
    """Faults that never came or disturbed nothing."""

    def row(self, columns: Sequence[str]) -> dict[str, Any]:
        """Return the values of ``columns``."""
        return {name: getattr(self, name) for name in columns}

    def figure(self, column: str) -> float | None:
        """Return the value of a column of numbers."""
        value = getattr(self, column)
        return None if value is None else float(value)


_OF_SUMMARY = ("cpu_s", "clearance_min_m", "uav_separation_min_m", "contacts", "duration_s", "real_time_factor")
"""Columns that the summary has by the same names."""


def summary_columns(flown: Flown) -> dict[str, Any]:
    """Return the columns that follow from the summary of a flight, and how it ended."""
    summary = flown.summary
    tilt = {axis: angle for axis, angle in summary.get("payload_tilt_max_deg", {}).items() if angle is not None}
    steps, landing = summary.get("step_time_ms", {}), summary.get("landing") or {}
    return {
        "reason": flown.reason,
        "exit_code": flown.exit_code,
        "wall_s": round(flown.wall, 1),
        **{column: summary.get(column) for column in _OF_SUMMARY},
        "tilt_max_deg": max(tilt.values(), default=None),
        "lean_max_deg": max((angle for axis, angle in tilt.items() if axis != "yaw"), default=None),
        "position_rmse_m": summary.get("position_rmse_m", {}).get("total"),
        "slack_max_m": (summary.get("safety") or {}).get("slack_max_m"),
        "step_time_p50_ms": steps.get("p50"),
        "step_time_p99_ms": steps.get("p99"),
        "infeasible_steps": summary.get("solver", {}).get("infeasible_steps"),
        "landed": landing.get("on_ground"),
        "touchdown_mps": landing.get("speed_mps"),
        "end_tilt_deg": landing.get("tilt_deg"),
    }


def read_result(path: Path, key: str, columns: Collection[str]) -> Result | None:
    """Read a stored result of ``columns``; None where there is none, or one that was kept by another ``key``."""
    content = read_json(path)
    if content.pop("key", None) != key or content.keys() != set(columns) or content["format"] != FORMAT:
        return None
    return Result(**content)


COLUMN_TYPES = {field.name: str(field.type) for field in dataclasses.fields(Result)}
