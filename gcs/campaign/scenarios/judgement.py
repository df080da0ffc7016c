"""The judgement of a flight through an obstacle scenario: contacts, clearance, angles, and arrival at the goal.

Where the standing obstacles leave no way, the flight must be broken off, and its reason name the narrowest gap.
"""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from gcs.campaign.flight import FlightPlan
from gcs.campaign.result import Flown, summary_columns
from gcs.campaign.scenarios.passage import Passage
from gcs.config import SystemConfig
from gcs.errors import GcsError
from gcs.mission.model import Limits, Mission
from gcs.mission.read import read_mission
from gcs.planning.schedule import Schedule, arrival
from gcs.record.outcome import Outcome
from gcs.record.run_data import RunData, read_run

AT_GOAL = 0.5
"""m, horizontally, within which the payload has arrived."""
GAP_TOLERANCE = 0.3
"""m, within which the reason of an abort must name the narrowest gap."""
_NAMED_GAP = re.compile(r"narrowest gap is (\d+\.\d+) m (?:wide|high)")
SEPARATION_TOLERANCE = 0.05
"""Share of the gap between neighbouring rotor discs in hover by which a flight may fall below the controller's limit,
whose rows are soft: with a spacing of 1 m 0.75 m where the controller keeps 0.77 m."""
COLUMNS = (
    "number", "name", "kind", "variant", "passed", "failures", "outcome", "reason", "exit_code", "clearance_min_m",
    "tilt_max_deg", "uav_separation_min_m", "contacts", "arrival_s", "nominal_arrival_s", "delay_s", "goal_error_m",
    "duration_s", "step_time_p50_ms", "step_time_p99_ms", "infeasible_steps", "real_time_factor", "wall_s", "cpu_s",
    "replay", "position_rmse_m", "slack_max_m", "passage", "gap_m", "gap_named_m", "format",
)  # fmt: skip


def least_separation(system: SystemConfig) -> float:
    """Return the least distance between the centres of two UAVs (m) with which a flight passes."""
    return system.parameters().separation(system.control.mpc.separation_share - SEPARATION_TOLERANCE)


def judge(held_to: Limits, passage: Passage | None, plan: FlightPlan, flown: Flown, run_dir: Path) -> dict[str, Any]:
    """Return the columns of a flight, held to the limits ``held_to``.

    ``passage``: of the standing obstacles; None: there is a way.
    """
    as_flown = read_mission(plan.mission, plan.config, plan.settings)
    try:
        run = read_run(run_dir) if flown.summary else None
    except GcsError:
        run = None
    return judged(as_flown, Schedule(as_flown), held_to, passage, flown, run)


def judged(
    as_flown: Mission,
    schedule: Schedule,
    held_to: Limits,
    passage: Passage | None,
    flown: Flown,
    run: RunData | None,
) -> dict[str, Any]:
    """Return the columns of a flight of known ``schedule`` with the records ``run``; None: it has none."""
    summary, figures = flown.summary, summary_columns(flown)
    nominal = arrival(schedule.times, schedule.positions, schedule.goal, AT_GOAL)
    nominal = schedule.landing if nominal is None else nominal
    # From the start of the rotors on, as in the summary.
    spent = as_flown.system.flight.takeoff_landing.spool_up_time - schedule.start
    arrived, goal_error = (None, None) if run is None else _arrival(run, schedule)
    clearance, tilt = figures["clearance_min_m"], figures["tilt_max_deg"]
    separation, outcome = figures["uav_separation_min_m"], summary.get("outcome", Outcome.FAILED.value)
    named = named_gap(flown.reason)
    may_end = passage is not None and passage.verdict != "passable" and outcome == Outcome.ABORTED
    failures = {
        outcome: not summary.get("completed") and not may_end,
        "gap": may_end and not names_the_gap(passage, flown.reason),
        "contact": bool(figures["contacts"]),
        "clearance": clearance is not None and clearance < (held_to.clearance or 0.0),
        "tilt": tilt is not None and tilt > (held_to.payload_tilt_deg or math.inf),
        "separation": separation is not None and separation < least_separation(as_flown.system),
        "arrival": bool(summary) and arrived is None and not may_end,
    }
    return {
        "failures": " ".join(name for name, failed in failures.items() if failed),
        "outcome": outcome,
        "arrival_s": arrived,
        "nominal_arrival_s": round(nominal + spent, 2),
        "delay_s": None if arrived is None else round(arrived - nominal - spent, 2),
        "goal_error_m": goal_error,
        "passage": "" if passage is None else passage.verdict,
        "gap_m": None if passage is None or passage.gap is None else round(passage.gap.width, 2),
        "gap_named_m": named,
    }


def named_gap(reason: str) -> float | None:
    """Return the width (m) of the narrowest gap that the ``reason`` of an abort names."""
    found = _NAMED_GAP.search(reason)
    return None if found is None else float(found[1])


def names_the_gap(passage: Passage | None, reason: str) -> bool:
    """Return whether the ``reason`` of an abort names the narrowest gap, or the waypoint that is not free."""
    if passage is None or passage.gap is None:
        return False
    if passage.gap.is_at_waypoint and ("at the waypoint" in reason or "at the goal" in reason):
        return True
    named = named_gap(reason)
    return named is not None and abs(named - passage.gap.width) <= GAP_TOLERANCE


def _arrival(run: RunData, schedule: Schedule) -> tuple[float | None, float | None]:
    """Return when the payload came to the goal (s from the start of the rotors), and its distance at the end (m)."""
    powered = np.flatnonzero((run.thrust > 0.0).any(axis=1))
    if len(powered) == 0:
        return None, None
    flown = slice(powered[0], powered[-1] + 1)
    arrived = arrival(run.time[flown] - run.time[powered[0]], run.payload_position[flown], schedule.goal, AT_GOAL)
    error = float(np.linalg.norm(run.payload_position[powered[-1], :2] - schedule.goal[:2]))
    return None if arrived is None else round(arrived, 2), round(error, 3)
