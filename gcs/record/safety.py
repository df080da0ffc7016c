"""Safety figures of a flight: what the guarantee assumes, and where a flight went beyond it; detours."""

from typing import Any

import numpy as np

from gcs.record.landing import is_clear_of_ground
from gcs.record.reader import Table
from gcs.record.run_data import RunData, position_error
from gcs.record.tables import PLAN
from idc_controller.arrays import Array

GRAVITY = 9.81  # m/s2
BACK = 0.1  # m from the reference
EVERY = 5  # rows of the reference: ten times a second


def safety_figures(run: RunData) -> dict[str, Any] | None:
    """Return the ``safety`` entry of the summary; None where nothing was planned.

    Tracking errors are those of the true state (of the estimate where there is no truth) against the plan in force,
    while the payload is clear of the ground; UAVs against their positions by the plan's links (m).
    """
    plan = run.tables[PLAN]
    if len(plan) < 2 or len(run.time) == 0:
        return None
    time = plan["time_s"]
    # Steps that follow each other: in between the plan is followed, elsewhere nothing was planned.
    inside = (run.time >= time[0]) & (run.time <= time[-1])
    k = np.clip(np.searchsorted(time, run.time[inside]) - 1, 0, len(time) - 2)
    steady = time[k + 1] - time[k] < 0.2
    rows = np.flatnonzero(inside)[steady]
    rows = rows[is_clear_of_ground(run, run.setting("flight", "takeoff_landing", "clear_height"))[rows]]

    def planned(axes: str) -> Any:
        return np.column_stack([np.interp(run.time[rows], time, plan[name]) for name in axes.split()])

    position, acceleration = planned("x_m y_m z_m"), planned("ax_mps2 ay_mps2 az_mps2")
    payload = np.linalg.norm(run.payload_position[rows] - position, axis=1)
    uav = np.empty(0)
    if run.number_of_uavs and len(rows):
        hover = run.uav_position[0] - run.payload_position[0]
        q = np.array([0.0, 0.0, GRAVITY]) - acceleration
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        # From its place in hover a UAV moves with its link's upper end.
        shift = run.setting("team", "link_length") * (np.array([0.0, 0.0, 1.0]) - q)
        expected = position[:, None] + hover + shift[:, None]
        uav = np.linalg.norm(run.uav_position[rows] - expected, axis=2).max(axis=1)
    payload_bound, uav_bound = _bound(plan["payload_bound_m"]), _bound(plan["uav_bound_m"])
    margin = run.setting("avoidance", "margin")
    exceeded = {
        "plan_clearance": _fallen_below(time, plan["plan_clearance_m"], 0.0),
        "payload_deviation": _exceeded(run.time[rows], payload, payload_bound),
        "uav_deviation": _exceeded(run.time[rows], uav, uav_bound),
    }
    return {
        "payload_tracking_max_m": float(payload.max()) if len(rows) else None,
        "payload_tracking_bound_m": payload_bound,
        "uav_tracking_max_m": float(uav.max()) if len(uav) else None,
        "uav_tracking_bound_m": uav_bound,
        "slack_max_m": float(plan["slack_m"].max()),
        "way_back_max_s": max((after for _, after in return_times(run, margin + (payload_bound or 0.0))), default=None),
        "detours": int(plan["detours"].max()),
        "steps": len(time),
        "verified_steps": None if payload_bound is None else int(np.count_nonzero(plan["verified"])),
        "unverified_reason": None if payload_bound is None else _unverified(plan, margin),
        "clock_rate_min": float(plan["clock_rate"].min()),
        "exceeded": {name: entry for name, entry in exceeded.items() if entry is not None},
    }


def _unverified(plan: Table, margin: float) -> str | None:
    """Return why the least of the plans that were not verified was not; None: all were."""
    unverified = np.flatnonzero(plan["verified"] == 0.0)
    if not len(unverified):
        return None
    worst = unverified[np.argmin(plan["plan_clearance_m"][unverified])]
    clearance, time = float(plan["plan_clearance_m"][worst]), float(plan["time_s"][worst])
    found = "" if plan["solved"][worst] else "no QP had a solution; "
    return f"at {time:.1f} s {found}the plan comes within {clearance:.2f} m of an obstacle (margin {margin:.2f} m)"


def _exceeded(time: Array, values: Array, limit: float | None) -> dict[str, float] | None:
    """Return the largest of ``values`` with the ``limit`` (m) that it exceeds, and its time (s); None: none does."""
    if limit is None or not len(values) or not (values > limit).any():
        return None
    k = int(np.argmax(values))
    return {"value": float(values[k]), "limit": limit, "time_s": float(time[k])}


def _fallen_below(time: Array, values: Array, limit: float) -> dict[str, float] | None:
    """Return the least of ``values`` with the ``limit`` (m) that it falls below, and its time (s); None: none does."""
    found = _exceeded(time, -values, -limit)
    return None if found is None else {"value": -found["value"], "limit": limit, "time_s": found["time_s"]}


def _bound(values: Any) -> float | None:
    known = values[np.isfinite(values)]
    return float(known[0]) if len(known) else None


def return_times(run: RunData, clearance: float) -> list[tuple[float, float]]:
    """Return when the reference became free (s), and how long after that (s) the payload was within :data:`BACK` of it.

    The reference is free while the formation on it, level and with its links upright, keeps ``clearance`` (m) to all
    obstacles. Where the payload did not come back, the time to the end.
    """
    if not len(run.reference) or not run.obstacles or not run.number_of_uavs or not len(run.time):
        return []
    time, place = run.reference["time_s"][::EVERY], run.reference_position[::EVERY]
    found = run.level_formation(place).clearance(run.barriers_at(time))
    free = np.nan_to_num(found, nan=np.inf) >= clearance
    at, error = position_error(run)
    near = at[np.linalg.norm(error, axis=1) <= BACK]
    cleared = time[1:][free[1:] & ~free[:-1]]
    return [(float(t), float(min(near[near >= t], default=at[-1]) - t)) for t in cleared]
