"""Plans of random obstacle scenarios (``gcs courses``)."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import RenderableType

from gcs.campaign.engine import PlanGenerator
from gcs.campaign.flight import FlightPlan
from gcs.campaign.grid import Grid, variants
from gcs.campaign.result import Result
from gcs.campaign.scenarios.generator import DEFAULT_KINDS, HELD_TO, generate
from gcs.campaign.scenarios.judgement import COLUMNS, judge, least_separation
from gcs.campaign.scenarios.planning import fly_planning
from gcs.config import read_system


@dataclass(frozen=True)
class Scenarios(PlanGenerator):
    """``count`` random scenarios of ``seed``, of ``kinds`` in turn; obstacles move at up to ``fastest`` (m/s).

    ``planning``: on the planning level. ``grid``: of settings, with each of which every scenario is flown.
    """

    count: int
    seed: int
    kinds: tuple[str, ...] = DEFAULT_KINDS
    controller: str = "idc"
    config: Path | None = None
    fastest: float = 2.0
    planning: bool = False
    grid: Grid = field(default_factory=dict)

    what = "scenarios"
    passed_means = "passed"
    columns = COLUMNS
    shown = (
        ("clearance", "clearance_min_m", "m"),
        ("angle", "tilt_max_deg", "deg"),
        ("separation", "uav_separation_min_m", "m"),
        ("delay", "delay_s", "s"),
    )

    @property
    def settings(self) -> dict[str, Any]:
        """All but the number of scenarios."""
        return {
            "seed": self.seed,
            "kinds": list(self.kinds),
            "controller": self.controller,
            "config": None if self.config is None else hashlib.sha256(self.config.read_bytes()).hexdigest()[:16],
            "obstacle_speed": self.fastest,
        }

    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield a flight for each scenario."""
        system = read_system(self.config)
        config = self.config and self.config.absolute()
        for number in range(1, self.count + 1):
            kind = self.kinds[(number - 1) % len(self.kinds)]
            scenario = generate(self.seed, number, kind, system, self.fastest)
            mission = out / "missions" / f"{scenario.name}.toml"
            judgement = partial(judge, HELD_TO, scenario.passage)
            fly = partial(fly_planning, HELD_TO, scenario.passage) if self.planning else None
            plan = FlightPlan(
                number, scenario.name, mission, judgement, self.controller, config,
                labels={"kind": kind}, files={mission: scenario.text}, fly=fly,
            )  # fmt: skip
            yield from variants(plan, self.grid)

    def report(self, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
        """Write ``results.csv``, ``timing.csv`` and the distribution."""
        from gcs.campaign.scenarios.report import report  # matplotlib takes long to import

        return report(results, out, least_separation(read_system(self.config)))
