"""Obstacle scenarios on the planning level: on ideal tracking, judged as flights are."""

import time
from typing import Any

from gcs.campaign.flight import DONE, OUTSIDE_LIMITS, FlightPlan
from gcs.campaign.result import Flown, Result, summary_columns
from gcs.campaign.scenarios.judgement import judged
from gcs.campaign.scenarios.passage import Passage
from gcs.mission.model import Limits
from gcs.mission.read import read_mission
from gcs.planning.flight import PlanningFlight
from gcs.planning.outcome import planned
from gcs.planning.schedule import Schedule


def fly_planning(held_to: Limits, passage: Passage | None, plan: FlightPlan) -> Result:
    """Fly the mission of a ``plan`` on ideal tracking in this process; the arguments are those of its judgement."""
    wall, cpu = time.monotonic(), time.process_time()
    mission = read_mission(plan.mission, plan.config, plan.settings)
    schedule = Schedule(mission)
    flight, run = PlanningFlight(mission, schedule.start), None
    exit_code, summary, reason = OUTSIDE_LIMITS, dict[str, Any](), ""
    try:
        flight.fly()
        run = planned(flight)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
    else:
        summary = {**run.summary, "cpu_s": round(time.process_time() - cpu, 2)}
        exit_code, reason = DONE, summary["reason"]
    flown = Flown(exit_code, summary, reason, time.monotonic() - wall)
    columns = judged(mission, schedule, held_to, passage, flown, run)
    return Result(**{**summary_columns(flown), **columns})
