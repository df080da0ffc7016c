"""``summary.json``: the figures of a flight, computed after it from its records."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from gcs.record.landing import in_air, landing_figures, onsets, stops
from gcs.record.outcome import Outcome
from gcs.record.reader import Table
from gcs.record.run_data import RunData, position_error
from gcs.record.run_folder import FORMAT
from gcs.record.safety import safety_figures
from gcs.record.verdict import Verdict
from idc_controller.arrays import Array
from idc_controller.rotations import euler_from_quaternion

DEFAULT_SETTLE = 10.0  # s
STEP_PARTS = {
    "telemetry": "telemetry_ms", "estimation": "estimator_ms", "perception": "perception_ms",
    "planning": "planner_ms", "control": "control_ms", "stop_plan": "stop_plan_ms", "monitoring": "monitoring_ms",
    "recording": "recording_ms", "setpoints": "setpoints_ms",
}  # fmt: skip
"""Parts of a control step, and their columns."""
_DIGITS = 6  # of a metre, a degree or a millisecond: below what is simulated faithfully
FIGURES = {
    "clearance": ("least clearance", "m", "at least"),
    "position_rmse": ("position error, RMS", "m", "at most"),
    "payload_tilt_deg": ("largest payload angle", "deg", "at most"),
    "arrival": ("waypoints missed by", "m", "at most"),
    "uav_separation": ("least distance of two UAVs", "m", "at least"),
    "touchdown_speed": ("touchdown speed", "m/s", "at most"),
    "contacts": ("contacts", "", "at most"),
}
"""What a flight is judged by, in the order in which it is shown: name, unit (none: a number of times), and the sense of
its limit. All but ``contacts`` are keys of a mission's ``[limits]``."""
LIMITS = tuple(name for name in FIGURES if name != "contacts")


def summarise(
    run: RunData,
    ended: Verdict,
    *,
    duration_s: float,
    real_time_factor: float | None,
    limits: Mapping[str, float | None] | None = None,
    obstacles: bool | None = None,
) -> dict[str, Any]:
    """Return the content of ``summary.json``, from the truth on record or, where there is none, the estimate.

    ``limits`` is the mission's table of that name: ``settle`` (s) and any of :data:`LIMITS` (m, deg, m/s),
    None for no limit. ``obstacles`` says whether the mission has any to keep clear of (None: as on record). Figures
    that the records do not contain are None. Raises ``ValueError`` for an unknown limit.
    """
    bounds = {name: float(limit) for name, limit in (limits or {}).items() if limit is not None}
    settle = bounds.pop("settle", DEFAULT_SETTLE)
    if ended.arrival is None:
        bounds.pop("arrival", None)
    for name in bounds:
        if name not in LIMITS:
            raise ValueError(f"limit {name!r} is none of {LIMITS}")
    rmse = position_rmse(run, settle)
    tilt = payload_tilt_max(run)
    clearance = _least(run.clearance[in_air(run)]) if run.barriers and run.number_of_uavs else None
    separation = _least(run.uav_separation()) if run.number_of_uavs > 1 else None
    landing = landing_figures(run)
    contacts = None if run.contacts is None else onsets(run.contacts)
    rows = result_rows(
        {
            "clearance": clearance,
            "position_rmse": rmse["total"],
            "payload_tilt_deg": max((angle for angle in tilt.values() if angle is not None), default=None),
            "arrival": None if ended.arrival is None else ended.arrival.largest,
            "uav_separation": separation,
            "touchdown_speed": None if landing is None else landing["speed_mps"],
            "contacts": contacts,
        },
        bounds,
        has_barriers=bool(run.barriers) or bool(obstacles),
    )
    summary: dict[str, Any] = _rounded(
        {
            "format": FORMAT,
            "completed": ended.outcome is Outcome.COMPLETED,
            "outcome": str(ended.outcome),
            "reason": ended.reason,
            "result": rows,
            "source": run.source,
            "duration_s": duration_s,
            "real_time_factor": real_time_factor,
            "position_rmse_m": rmse,
            "payload_tilt_max_deg": tilt,
            "clearance_min_m": clearance,
            "uav_separation_min_m": separation,
            "contacts": contacts,
            "landing": landing,
            "step_time_ms": _step_times(run.steps),
            "step_parts_ms": _step_parts(run.steps),
            "solver": _solver(run.steps),
            "safety": safety_figures(run),
            "limits": {
                row["name"]: {key: row[key] for key in ("value", "limit", "held")}
                for row in rows
                if row["limit"] is not None
            },
        }
    )
    if (landings := stops(run)) is not None:
        summary["stops"] = _rounded(landings)
    return summary


def result_rows(
    values: Mapping[str, float | None], limits: Mapping[str, float], *, has_barriers: bool
) -> list[dict[str, Any]]:
    """Return a row for each of :data:`FIGURES`, with its limit and whether it is held (None: it has none).

    A limit is held when its figure is known and within it; a clearance also when there is nothing to keep clear of
    (``has_barriers`` False).
    """
    rows = []
    for name, (what, unit, bound) in FIGURES.items():
        value, limit = values[name], limits.get(name)
        held = None
        if limit is not None and value is None:
            held = name == "clearance" and not has_barriers
        elif limit is not None and value is not None:
            held = value >= limit if bound == "at least" else value <= limit
        row = {"name": name, "what": what, "value": value, "unit": unit, "bound": bound, "limit": limit, "held": held}
        rows.append(row)
    return rows


def within_limits(summary: Mapping[str, Any]) -> bool:
    """Return whether every limit of a summary was held."""
    return not limits_not_held(summary)


def limits_not_held(summary: Mapping[str, Any]) -> list[str]:
    """Return the names of the limits of a summary that were not held."""
    return [name for name, limit in summary.get("limits", {}).items() if not limit["held"]]


def position_rmse(run: RunData, settle: float) -> dict[str, float | None]:
    """Return the root-mean-square position error (m), by axis and of all three together.

    Counted from ``settle`` seconds after the reference begins; None where no row is left.
    """
    time, error = position_error(run)
    if len(time):
        error = error[time >= run.reference["time_s"][0] + settle]
    if not len(error):
        return dict.fromkeys(("x", "y", "z", "total"))
    mean_square = np.mean(error**2, axis=0)
    x, y, z = np.sqrt(mean_square).tolist()
    return {"x": x, "y": y, "z": z, "total": float(np.sqrt(mean_square.sum()))}


def payload_angles(run: RunData) -> Array:
    """Return roll, pitch and yaw of the payload (T, 3) (deg)."""
    return np.rad2deg(euler_from_quaternion(run.payload_quaternion))


def payload_tilt_max(run: RunData) -> dict[str, float | None]:
    """Return the largest magnitude of the payload's roll, pitch and yaw (deg) from take-off to landing.

    That is: from the first to the last row with thrust; every row when thrust is not on record. None without
    a row.
    """
    if len(run.time) == 0:
        return dict.fromkeys(("roll", "pitch", "yaw"))
    angles = np.abs(payload_angles(run))
    powered = np.flatnonzero(np.any(run.thrust > 0.0, axis=1))
    if len(powered):
        angles = angles[powered[0] : powered[-1] + 1]
    return dict(zip(("roll", "pitch", "yaw"), np.max(angles, axis=0).tolist(), strict=True))


def _step_times(steps: Table) -> dict[str, float | None]:
    percents = {"p50": 50.0, "p99": 99.0, "max": 100.0}
    return {name: _percentile(steps["total_ms"], percent) for name, percent in percents.items()}


def _step_parts(steps: Table) -> dict[str, dict[str, float | None]] | None:
    """Return p50 and p99 of the parts of a control step; None without a step."""
    if not len(steps):
        return None
    return {
        part: {"p50": _percentile(steps[column], 50.0), "p99": _percentile(steps[column], 99.0)}
        for part, column in STEP_PARTS.items()
    }


def _solver(steps: Table) -> dict[str, float | int | None]:
    return {
        "mpc_p50_ms": _percentile(steps["mpc_ms"], 50.0),
        "planner_p50_ms": _percentile(steps["planner_ms"], 50.0),
        "infeasible_steps": int(np.count_nonzero(steps["infeasible"])) if len(steps) else None,
    }


def _percentile(values: Array, percent: float) -> float | None:
    values = values[np.isfinite(values)]
    return float(np.percentile(values, percent)) if len(values) else None


def _least(values: Array) -> float | None:
    values = values[np.isfinite(values)]
    return float(np.min(values)) if values.size else None


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    if isinstance(value, float):
        return round(value, _DIGITS) if np.isfinite(value) else None
    return value
