"""One flight of a campaign: ``gcs fly`` as a process of its own, and what its run folder says of it."""

from __future__ import annotations

import dataclasses
import math
import shlex
import threading
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gcs.campaign.courses.generator import HELD_TO, RandomCourse
from gcs.campaign.courses.schedule import Schedule, arrival
from gcs.campaign.process_pool import Ended, fly_process
from gcs.errors import GcsError
from gcs.mission.model import Limits
from gcs.mission.read import read_mission
from gcs.record.run_data import read_run

AT_GOAL = 0.5
"""m, horizontally, within which the payload has arrived."""
SEPARATION = 0.75
"""m, the least distance between the centres of two UAVs."""


@dataclass(frozen=True)
class Result:
    """What came of one course. m, s, deg; None: not known, or it never happened."""

    number: int
    name: str
    kind: str
    passed: bool
    failures: str
    outcome: str
    reason: str
    exit_code: int
    clearance_min_m: float | None
    tilt_max_deg: float | None
    uav_separation_min_m: float | None
    contacts: int | None
    arrival_s: float | None
    nominal_arrival_s: float
    delay_s: float | None
    goal_error_m: float | None
    duration_s: float | None
    step_time_p50_ms: float | None
    step_time_p99_ms: float | None
    infeasible_steps: int | None
    real_time_factor: float | None
    wall_s: float
    replay: str
    position_rmse_m: float | None = None
    slack_max_m: float | None = None


COLUMNS = tuple(field.name for field in dataclasses.fields(Result))
REQUIRED = {field.name for field in dataclasses.fields(Result) if field.default is dataclasses.MISSING}
"""Columns that results of every version have."""


@dataclass(frozen=True)
class FlightPlan:
    """Where a course lies and flies, and by which options of ``gcs fly``."""

    course: RandomCourse
    mission: Path
    run_dir: Path
    options: tuple[str, ...]
    held_to: Limits = HELD_TO

    @property
    def replay(self) -> str:
        """The command that repeats the flight."""
        return shlex.join(["gcs", "fly", str(self.mission), *self.options])


def fly_course(plan: FlightPlan, stop: threading.Event) -> Result | None:
    """Fly it and say what came of it; None if ``stop`` was set before it ended."""
    ended = fly_process(plan.mission, plan.options, plan.run_dir, stop)
    return None if ended is None else evaluate(plan, ended)


def evaluate(plan: FlightPlan, ended: Ended) -> Result:
    """The result of a flight."""
    summary = ended.summary
    mission = read_mission(plan.mission, _config(plan.options))
    schedule = Schedule(mission)
    nominal = arrival(schedule.times, schedule.positions, schedule.goal, AT_GOAL)
    nominal = schedule.landing if nominal is None else nominal
    # By the clock that starts when the rotors do, as the summary's.
    spent = mission.system.flight.takeoff_landing.spool_up_time - schedule.start
    arrived, goal_error = _arrival(plan.run_dir, schedule) if summary else (None, None)
    angles = [angle for angle in summary.get("payload_tilt_max_deg", {}).values() if angle is not None]
    tilt = max(angles, default=None)
    clearance, separation = summary.get("clearance_min_m"), summary.get("uav_separation_min_m")
    contacts, outcome = summary.get("contacts"), summary.get("outcome", "failed")
    failures = []
    if not summary.get("completed"):
        failures.append(outcome)
    if contacts:
        failures.append("contact")
    if clearance is not None and clearance < (plan.held_to.clearance or 0.0):
        failures.append("clearance")
    if tilt is not None and tilt > (plan.held_to.payload_tilt_deg or math.inf):
        failures.append("tilt")
    if separation is not None and separation < SEPARATION:
        failures.append("separation")
    if summary and arrived is None:
        failures.append("arrival")
    steps, solver = summary.get("step_time_ms", {}), summary.get("solver", {})
    course = plan.course
    return Result(
        number=course.number,
        name=course.name,
        kind=course.kind,
        passed=not failures,
        failures=" ".join(dict.fromkeys(failures)),
        outcome=outcome,
        reason=ended.reason,
        exit_code=ended.exit_code,
        clearance_min_m=clearance,
        tilt_max_deg=tilt,
        uav_separation_min_m=separation,
        contacts=contacts,
        arrival_s=arrived,
        nominal_arrival_s=round(nominal + spent, 2),
        delay_s=None if arrived is None else round(arrived - nominal - spent, 2),
        goal_error_m=goal_error,
        duration_s=summary.get("duration_s"),
        step_time_p50_ms=steps.get("p50"),
        step_time_p99_ms=steps.get("p99"),
        infeasible_steps=solver.get("infeasible_steps"),
        real_time_factor=summary.get("real_time_factor"),
        wall_s=round(ended.wall, 1),
        replay=plan.replay,
        position_rmse_m=summary.get("position_rmse_m", {}).get("total"),
        slack_max_m=(summary.get("safety") or {}).get("slack_max_m"),
    )


def _arrival(run_dir: Path, schedule: Schedule) -> tuple[float | None, float | None]:
    """When the payload came to the goal, in s since the rotors started, and how far from it it ended (m)."""
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


def _config(options: tuple[str, ...]) -> Path | None:
    return Path(options[options.index("--config") + 1]) if "--config" in options else None
