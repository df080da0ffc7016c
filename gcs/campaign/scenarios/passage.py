"""Whether the formation can pass the standing obstacles of a mission, and their narrowest gap."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import Literal

import numpy as np

from gcs.config import SystemConfig
from gcs.mission.fence import boundary_walls
from gcs.mission.model import Mission, Obstacle
from gcs.mission.route import FlyTo, GroundLeg, Land, Route, TakeOff
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.free_space import BoundingCylinder, FlightArea, FreeSpace
from idc_controller.guidance.detour import find_detour
from idc_controller.guidance.narrowest_gap import Gap, narrowest_gap

Place = tuple[float, float, float]
Verdict = Literal["passable", "impassable", "marginal"]

SPARE = 0.2
"""m of clearance, more than a detour's, with which a gap can be passed for certain: the search is on a grid."""
SHORT = 0.1
"""m of clearance, less than the margin about the formation at its narrowest, with which it cannot for certain."""
_MOST_LEGS = 200


@dataclass(frozen=True)
class Passage:
    """``gap``: the narrowest on the widest path; None: there is no narrow one.

    A ``marginal`` gap lies between what can be passed for certain and what cannot.
    """

    verdict: Verdict
    gap: Gap | None

    def __str__(self) -> str:
        """Return the verdict in words."""
        return self.verdict + ("" if self.gap is None else f", narrowest gap {self.gap}")


class Passages:
    """The formation of a ``system``, and how its detours are searched."""

    def __init__(self, system: SystemConfig) -> None:
        parameters, settings = system.parameters(), system.guidance.navigator
        self.formation = BoundingCylinder.of(parameters, settings.link_tilt)
        self._system = system
        self._lowest = self.formation.below + settings.ground_clearance
        self._climb, self._margin = settings.climb, system.avoidance.margin
        self._keep = self._margin + settings.spare
        hull = Formation(parameters).hull_points(np.zeros((1, 3)))[0, :, :2]
        angles = np.radians(np.arange(0.0, 180.0, 1.0))
        self._half_width = float(np.ptp(hull @ np.array([np.cos(angles), np.sin(angles)]), axis=0).min()) / 2.0

    def between(
        self, places: Sequence[Place], obstacles: Sequence[Obstacle], area: FlightArea | None = None
    ) -> Passage:
        """Return the passage from each of ``places`` (NED, m) to the next, in ``area``, past what stands."""
        bodies = [(o.shape, o.position) for o in obstacles if o.motion is None]
        names = [o.name for o in obstacles if o.motion is None]
        highest = max(-down for _, _, down in places) + self._climb
        space = FreeSpace(bodies, self.formation, self._keep, self._lowest, highest, area=area)
        narrowest: Gap | None = None
        for begin, end in pairwise(places):
            gap = narrowest_gap(space, begin, end, names=names, settings=self._system.guidance.detour)
            if gap is not None and (narrowest is None or gap.clearance < narrowest.clearance):
                narrowest = gap
        return Passage(self._verdict(narrowest), narrowest)

    def agrees(self, passage: Passage, places: Sequence[Place], obstacles: Sequence[Obstacle]) -> bool:
        """Return whether the search for detours finds a way, or none, as ``passage`` says."""
        bodies = [(o.shape, np.array(o.position)) for o in obstacles if o.motion is None]
        highest = max(-down for _, _, down in places) + self._climb
        space = FreeSpace(bodies, self.formation, self._keep, self._lowest, highest)
        found = all(
            find_detour(space, begin, end, settings=self._system.guidance.detour).waypoints is not None
            for begin, end in pairwise(places)
        )
        return found == (passage.verdict == "passable")

    def _verdict(self, gap: Gap | None) -> Verdict:
        if gap is None or gap.clearance >= self._keep + SPARE:
            return "passable"
        if gap.is_height:
            too_narrow = gap.clearance <= self._margin - SPARE
        else:
            too_narrow = gap.clearance + self.formation.radius <= self._half_width + self._margin - SHORT
        return "impassable" if too_narrow else "marginal"


def passage_comments(passage: Passage | None) -> list[str]:
    """Return what a mission file says of its passage."""
    return [] if passage is None else [f"For the formation {passage}."]


def places_of(mission: Mission) -> tuple[Place, ...]:
    """Return the places of the payload between which a mission leads straight, from above the pad to above the goal.

    Empty for a curve. Of an endless mission the first few hundred.
    """
    if not isinstance(mission.reference, Route):
        return ()
    places: list[Place] = []
    for leg in islice(mission.reference.legs(), _MOST_LEGS):
        if isinstance(leg, TakeOff | FlyTo):
            places.append(leg.position)
        elif not isinstance(leg, Land | GroundLeg):
            break
    return tuple(place for i, place in enumerate(places) if not i or place != places[i - 1])


def passage_of(mission: Mission) -> Passage | None:
    """Return the passage of a mission past its standing obstacles and within its fence; None of a curve."""
    places = places_of(mission)
    if len(places) < 2:
        return None
    obstacles = (*mission.obstacles, *boundary_walls(mission.boundary))
    return Passages(mission.system).between(places, obstacles, mission.area)
