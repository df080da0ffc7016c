"""Plans of random obstacle scenarios (``gcs courses``)."""

import hashlib
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import RenderableType

from gcs.campaign.engine import PlanGenerator
from gcs.campaign.flight import DONE, OUTSIDE_LIMITS, FlightPlan
from gcs.campaign.grid import Grid, variants
from gcs.campaign.result import Flown, Result, summary_columns
from gcs.campaign.scenarios.generator import DEFAULT_KINDS, HELD_TO, generate
from gcs.campaign.scenarios.judgement import COLUMNS, judge, judged, least_separation
from gcs.campaign.scenarios.passage import Passage
from gcs.config import read_system
from gcs.mission.model import Limits
from gcs.mission.read import read_mission
from gcs.planning.flight import PlanningFlight, planned
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


@dataclass(frozen=True, kw_only=True)
class CourseFlights(PlanGenerator):
    """Flights through obstacle scenarios, whose noise or whose drawing is of ``seed``.

    ``planning``: on the planning level. ``grid``: of settings, with each of which every scenario is flown.
    """

    seed: int
    controller: str = "idc"
    config: Path | None = None
    planning: bool = False
    grid: Grid = field(default_factory=dict)

    passed_means = "passed"
    columns = COLUMNS
    shown = (
        ("clearance", "clearance_min_m", "m"),
        ("angle", "tilt_max_deg", "deg"),
        ("separation", "uav_separation_min_m", "m"),
        ("delay", "delay_s", "s"),
    )

    @property
    def config_digest(self) -> str | None:
        """Digest of the system file; None: the default system."""
        return None if self.config is None else hashlib.sha256(self.config.read_bytes()).hexdigest()[:16]

    def flights_through(
        self, number: int, name: str, kind: str, mission: Path, passage: Passage | None, files: Mapping[Path, str]
    ) -> Iterator[FlightPlan]:
        """Yield the flights of a scenario with each combination of settings."""
        judgement = partial(judge, HELD_TO, passage)
        fly = partial(fly_planning, HELD_TO, passage) if self.planning else None
        config = self.config and self.config.absolute()
        plan = FlightPlan(
            number, name, mission, judgement, self.controller, config, labels={"kind": kind}, files=files, fly=fly
        )
        return variants(plan, self.grid)

    def report(self, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
        """Write ``results.csv``, ``timing.csv`` and the distribution."""
        from gcs.campaign.scenarios.report import report  # matplotlib takes long to import

        return report(results, out, least_separation(read_system(self.config)))


@dataclass(frozen=True, kw_only=True)
class Scenarios(CourseFlights):
    """``count`` random scenarios of ``seed``, of ``kinds`` in turn; obstacles move at up to ``fastest`` (m/s)."""

    count: int
    kinds: tuple[str, ...] = DEFAULT_KINDS
    fastest: float = 2.0

    what = "scenarios"

    @property
    def settings(self) -> dict[str, Any]:
        """All but the number of scenarios."""
        return {
            "seed": self.seed,
            "kinds": list(self.kinds),
            "controller": self.controller,
            "config": self.config_digest,
            "obstacle_speed": self.fastest,
        }

    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield a flight for each scenario."""
        system = read_system(self.config)
        for number in range(1, self.count + 1):
            kind = self.kinds[(number - 1) % len(self.kinds)]
            scenario = generate(self.seed, number, kind, system, self.fastest)
            mission = out / "missions" / f"{scenario.name}.toml"
            files = {mission: scenario.text}
            yield from self.flights_through(number, scenario.name, kind, mission, scenario.passage, files)
