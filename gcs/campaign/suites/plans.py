"""Plans of suites of other people's obstacle scenarios (``gcs courses --suite``)."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import RenderableType

from gcs.campaign.engine import PlanGenerator
from gcs.campaign.flight import FlightPlan
from gcs.campaign.folder import plain
from gcs.campaign.grid import Grid, variants
from gcs.campaign.result import Result
from gcs.campaign.scenarios.generator import HELD_TO
from gcs.campaign.scenarios.judgement import COLUMNS, judge, least_separation
from gcs.campaign.scenarios.planning import fly_planning
from gcs.campaign.scenarios.plans import Scenarios
from gcs.campaign.suites.course import Course, checked_passage
from gcs.config import UnusableFile, read_system
from gcs.mission.own import named
from gcs.mission.read import read_mission

AERIALIST, LISTS = (".yaml", ".yml"), (".jsonl", ".ndjson")
MISSION = "mission"


def read_suite(files: Sequence[Path], config: Path | None, speed: float, seed: int) -> list[Course]:
    """Return the courses of ``files``: tests of Aerialist, lists in JSON lines, missions; by their suffix.

    Args:
        config: system file; None: the default system.
        speed: of missions that do not say (m/s).
        seed: of the noise.

    Raises:
        UnusableFile: with every reason found in all files.
    """
    from gcs.campaign.suites.course_list import read_list  # not needed where random scenarios are flown

    system = read_system(config)
    speed = min(speed, system.motion.speed_max)
    courses: list[Course] = []
    problems: list[str] = []
    for path in files:
        try:
            if path.suffix.lower() in AERIALIST:
                from gcs.campaign.suites.aerialist import read_aerialist  # an extra

                courses.append(read_aerialist(path, config, speed, seed))
            elif path.suffix.lower() in LISTS:
                courses += read_list(path, system, speed, seed)
            else:
                courses.append(_mission(path, config))
        except UnusableFile as error:
            problems += error.reasons
    if problems:
        raise UnusableFile(problems)
    return courses


def _mission(path: Path, config: Path | None) -> Course:
    """Return a mission that is flown as it is."""
    passage, problems = checked_passage(read_mission(path, config), (), lambda _, reason: f"{path}: {reason}")
    if problems:
        raise UnusableFile(problems)
    return Course(path.stem, MISSION, str(path), passage)


@dataclass(frozen=True)
class Suite(PlanGenerator):
    """``courses`` of other people, with noise of ``seed`` where they do not say.

    ``planning``: on that level; ``grid``: of settings, with each of which every course is flown.
    """

    courses: tuple[Course, ...]
    seed: int
    speed: float
    controller: str = "idc"
    config: Path | None = None
    planning: bool = False
    grid: Grid = field(default_factory=dict)

    what = "courses"
    passed_means = "passed"
    columns = COLUMNS
    shown = Scenarios.shown

    @property
    def settings(self) -> dict[str, Any]:
        """All but the courses: one that has changed is flown again."""
        return {
            "suite": True,
            "seed": self.seed,
            "speed": self.speed,
            "controller": self.controller,
            "config": None if self.config is None else hashlib.sha256(self.config.read_bytes()).hexdigest()[:16],
        }

    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield a flight for each course."""
        config = self.config and self.config.absolute()
        for number, course in enumerate(self.courses, start=1):
            name = f"{number:04d}-{plain(course.name)}"
            mission = out / "missions" / f"{name}.toml" if course.text else named(course.source).absolute()
            files = {mission: course.text} if course.text else {}
            files |= {out / "missions" / beside: text for beside, text in course.files.items()}
            judgement = partial(judge, HELD_TO, course.passage)
            fly = partial(fly_planning, HELD_TO, course.passage) if self.planning else None
            plan = FlightPlan(
                number, name, mission, judgement, self.controller, config,
                labels={"kind": course.kind}, files=files, fly=fly,
            )  # fmt: skip
            yield from variants(plan, self.grid)

    def report(self, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
        """Write ``results.csv``, ``timing.csv`` and the distribution."""
        from gcs.campaign.scenarios.report import report  # matplotlib takes long to import

        return report(results, out, least_separation(read_system(self.config)))
