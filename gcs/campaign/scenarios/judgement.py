"""The judgement of a flight through an obstacle scenario: contacts, clearance, angles, and arrival at the goal."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from gcs.campaign.process_pool import FlownProcess
from gcs.campaign.result import summary_columns
from gcs.campaign.scenarios.schedule import Schedule, arrival
from gcs.config import SystemConfig
from gcs.errors import GcsError
from gcs.mission.model import Limits
from gcs.mission.read import read_mission
from gcs.record.run_data import read_run

AT_GOAL = 0.5
"""m, horizontally, within which the payload has arrived."""
SEPARATION_TOLERANCE = 0.05
"""Share of the gap between neighbouring rotor discs in hover by which a flight may fall below the controller's limit,
whose rows are soft: with a spacing of 1 m 0.75 m where the controller keeps 0.77 m."""
COLUMNS = (
    "number", "name", "kind", "passed", "failures", "outcome", "reason", "exit_code", "clearance_min_m",
    "tilt_max_deg", "uav_separation_min_m", "contacts", "arrival_s", "nominal_arrival_s", "delay_s", "goal_error_m",
    "duration_s", "step_time_p50_ms", "step_time_p99_ms", "infeasible_steps", "real_time_factor", "wall_s", "replay",
    "position_rmse_m", "slack_max_m",
)  # fmt: skip
OPTIONAL = ("position_rmse_m", "slack_max_m")
"""Columns that results of earlier versions lack."""


def least_separation(system: SystemConfig) -> float:
    """Return the least distance between the centres of two UAVs (m) with which a flight passes."""
    return system.parameters().separation(system.control.mpc.separation_share - SEPARATION_TOLERANCE)


def judge(mission: Path, config: Path | None, held_to: Limits, flown: FlownProcess, run_dir: Path) -> dict[str, Any]:
    """Return the columns of a flight of ``mission`` by the system file ``config``, held to the limits ``held_to``."""
    summary = flown.summary
    as_flown = read_mission(mission, config)
    schedule = Schedule(as_flown)
    nominal = arrival(schedule.times, schedule.positions, schedule.goal, AT_GOAL)
    nominal = schedule.landing if nominal is None else nominal
    # From the start of the rotors on, as in the summary.
    spent = as_flown.system.flight.takeoff_landing.spool_up_time - schedule.start
    arrived, goal_error = _arrival(run_dir, schedule) if summary else (None, None)
    figures = summary_columns(flown, run_dir)
    clearance, tilt = figures["clearance_min_m"], figures["tilt_max_deg"]
    separation, outcome = figures["uav_separation_min_m"], summary.get("outcome", "failed")
    failures = {
        outcome: not summary.get("completed"),
        "contact": bool(figures["contacts"]),
        "clearance": clearance is not None and clearance < (held_to.clearance or 0.0),
        "tilt": tilt is not None and tilt > (held_to.payload_tilt_deg or math.inf),
        "separation": separation is not None and separation < least_separation(as_flown.system),
        "arrival": bool(summary) and arrived is None,
    }
    return {
        "failures": " ".join(name for name, failed in failures.items() if failed),
        "outcome": outcome,
        "arrival_s": arrived,
        "nominal_arrival_s": round(nominal + spent, 2),
        "delay_s": None if arrived is None else round(arrived - nominal - spent, 2),
        "goal_error_m": goal_error,
    }


def _arrival(run_dir: Path, schedule: Schedule) -> tuple[float | None, float | None]:
    """Return when the payload came to the goal (s from the start of the rotors), and its distance at the end (m)."""
    try:
        run = read_run(run_dir)
    except GcsError:
        return None, None
    powered = np.flatnonzero((run.thrust > 0.0).any(axis=1))
    if len(powered) == 0:
        return None, None
    flown = slice(powered[0], powered[-1] + 1)
    arrived = arrival(run.time[flown] - run.time[powered[0]], run.payload_position[flown], schedule.goal, AT_GOAL)
    error = float(np.linalg.norm(run.payload_position[powered[-1], :2] - schedule.goal[:2]))
    return None if arrived is None else round(arrived, 2), round(error, 3)
