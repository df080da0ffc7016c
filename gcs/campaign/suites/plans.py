"""Plans of suites of other people's obstacle scenarios (``gcs courses --suite``)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcs.campaign.flight import FlightPlan
from gcs.campaign.folder import plain
from gcs.campaign.scenarios.plans import CourseFlights
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
    passage = checked_passage(read_mission(path, config), (), lambda _, reason: f"{path}: {reason}")
    return Course(path.stem, MISSION, str(path), passage)


@dataclass(frozen=True, kw_only=True)
class Suite(CourseFlights):
    """``courses`` of other people, with noise of ``seed`` where they do not say."""

    courses: tuple[Course, ...]
    speed: float

    what = "courses"

    @property
    def settings(self) -> dict[str, Any]:
        """All but the courses: one that has changed is flown again."""
        return {
            "suite": True,
            "seed": self.seed,
            "speed": self.speed,
            "controller": self.controller,
            "config": self.config_digest,
        }

    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield a flight for each course."""
        for number, course in enumerate(self.courses, start=1):
            name = f"{number:04d}-{plain(course.name)}"
            mission = out / "missions" / f"{name}.toml" if course.text else named(course.source).absolute()
            files = {mission: course.text} if course.text else {}
            files |= {out / "missions" / beside: text for beside, text in course.files.items()}
            yield from self.flights_through(number, name, course.kind, mission, course.passage, files)
