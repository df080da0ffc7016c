"""A course of a suite, and the checks that all must pass before anything is started."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gcs.campaign.scenarios.passage import Passage, passage_of
from gcs.config import UnusableFile
from gcs.mission.model import Mission, Obstacle
from gcs.planning.schedule import Schedule
from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace

MOST_OBSTACLES = 1000
AT_PAD = 0.1
"""Least clearance (m) of the formation on the pad."""


@dataclass(frozen=True)
class Course:
    """One course: ``text`` is its mission file, ``files`` stand beside it; without a text it is the file ``source``."""

    name: str
    kind: str
    source: str
    passage: Passage | None
    text: str = ""
    files: Mapping[str, str] = field(default_factory=dict)


def checked_passage(
    mission: Mission, obstacles: Sequence[Obstacle], problem: Callable[[int | None, str], str]
) -> Passage | None:
    """Return the passage of a mission past ``obstacles`` that are added to it.

    Raises :class:`UnusableFile` where it cannot be flown, with lines that ``problem`` makes of the index of an obstacle
    (None: the mission) and a reason.
    """
    formation = BoundingCylinder.of(mission.system.parameters())
    pad = np.array([[0.0, 0.0, -mission.system.resting_altitude]])
    problems = []
    for i, obstacle in enumerate(obstacles):
        clearance = FreeSpace([(obstacle.shape, obstacle.position)], formation, 0.0, 0.0, 100.0).clearance(pad).item()
        if clearance < AT_PAD:
            reason = f"stands {clearance:.2f} m from the team on its pad (limit {AT_PAD:g} m)"
            problems.append(problem(i, reason))
    try:
        Schedule(mission)
    except ValueError as error:
        problems.append(problem(None, str(error)))
    if problems:
        raise UnusableFile(problems)
    return passage_of(replace(mission, obstacles=(*obstacles, *mission.obstacles)))
