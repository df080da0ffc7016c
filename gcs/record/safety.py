"""Safety figures of a flight: tracking errors against the bounds in the margins, slacks, detours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gcs.record.path_return import return_times
from gcs.record.run_data import RunData, Table
from gcs.record.tables import PLAN_COLUMNS, read_table

GRAVITY = 9.81  # m/s2


def safety_figures(run: RunData) -> dict[str, Any] | None:
    """Return the ``safety`` entry of the summary; None where nothing was planned.

    Tracking errors are those of the true state (of the estimate where there is no truth) against the plan in force,
    away from take-off and landing; UAVs against their positions by the plan's links (m).
    """
    path = Path(run.folder) / "plan.csv"
    if not path.exists():
        return None
    plan = read_table(path)
    if set(PLAN_COLUMNS) - set(plan) or len(plan["time_s"]) < 2 or len(run.time) == 0:
        return None
    time = plan["time_s"]
    # Steps that follow each other: in between the plan is followed, elsewhere nothing was planned.
    inside = (run.time >= time[0]) & (run.time <= time[-1])
    k = np.clip(np.searchsorted(time, run.time[inside]) - 1, 0, len(time) - 2)
    steady = time[k + 1] - time[k] < 0.2
    rows = np.flatnonzero(inside)[steady]

    def planned(axes: str) -> Any:
        return np.column_stack([np.interp(run.time[rows], time, plan[name]) for name in axes.split()])

    position, acceleration = planned("x_m y_m z_m"), planned("ax_mps2 ay_mps2 az_mps2")
    payload = np.linalg.norm(run.payload_position[rows] - position, axis=1)
    uav = None
    if run.number_of_uavs and len(rows):
        hover = run.uav_position[0] - run.payload_position[0]
        q = np.array([0.0, 0.0, GRAVITY]) - acceleration
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        # From its place in hover a UAV moves with its link's upper end.
        length = _link_length(run)
        shift = length * (np.array([0.0, 0.0, 1.0]) - q)
        expected = position[:, None] + hover + shift[:, None]
        uav = float(np.linalg.norm(run.uav_position[rows] - expected, axis=2).max())
    return {
        "payload_tracking_max_m": float(payload.max()) if len(rows) else None,
        "payload_tracking_bound_m": _bound(plan["payload_bound_m"]),
        "uav_tracking_max_m": uav,
        "uav_tracking_bound_m": _bound(plan["uav_bound_m"]),
        "slack_max_m": float(plan["slack_m"].max()),
        "way_back_max_s": max((after for _, after in return_times(run, _clearance(run, plan))), default=None),
        "detours": int(plan["detours"].max()),
        "clock_rate_min": float(plan["clock_rate"].min()),
    }


def _bound(values: Any) -> float | None:
    known = values[np.isfinite(values)]
    return float(known[0]) if len(known) else None


def _clearance(run: RunData, plan: Table) -> float:
    margin = run.manifest.get("system", {}).get("avoidance", {}).get("margin", 0.5)
    return float(margin) + (_bound(plan["payload_bound_m"]) or 0.0)


def _link_length(run: RunData) -> float:
    team = run.manifest.get("system", {}).get("team", {})
    return float(team.get("link_length", 3.2))
