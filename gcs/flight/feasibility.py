"""Feasibility of a mission, before anything is started: the formation at pad, waypoints and landing place, and between.

Looked at is what stands on the map, and the fence. Not looked at are obstacles that move, those that are not on the
map, and faults. What the safety filter or a detour leads round is a note; a place where the formation cannot be, and a
leg without any way, are problems.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from gcs.mission.known_obstacles import map_of
from gcs.mission.model import Limits, Mission
from gcs.mission.route import Circle, HoldForever, Land, Leg, Position, Route, TakeOff
from idc_controller.arrays import Array
from idc_controller.geometry.formation import BoundingCylinder, Formation
from idc_controller.geometry.free_space import FreeSpace
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.guidance.detour import find_detour
from idc_controller.safety.obstruction import Obstruction
from idc_controller.safety.separation import PredictedObstacles, separations

TRIED_LEGS = 2000
"""So many legs are looked at: a mission of more repeats itself."""
_SPACING = 0.1
"""m between places on a curve that are looked at."""
_HIGHEST = 1e5
"""m, above all that is flown."""
_SHORT = 0.3
"""m of the margin that a plan may lack where there is no other way: what lacks more is never flown."""


class Way(NamedTuple):
    """How a leg that does not lead straight to its end leads there."""

    source: str
    obstacle: str
    """What is in its way."""
    straight: float
    """Length of the leg (m)."""
    length: float
    """Length of the detour (m)."""

    def __str__(self) -> str:
        """Return it in words."""
        return (
            f"{self.source}: {self.obstacle} is in the way: the safety filter or a detour leads round it, "
            f"{self.length:.1f} m in place of {self.straight:.1f} m"
        )


@dataclass
class Feasibility:
    """What was found: ways round obstacles, further notes, and problems, one line each."""

    ways: list[Way] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def feasibility(mission: Mission) -> Feasibility:
    """Return whether ``mission`` can be flown, as far as that is known before the flight."""
    found = Feasibility()
    standing = [PredictedObstacle(o.name, o.shape, o.centre[None], np.zeros(1)) for o in map_of(mission) if not o.moves]
    if standing:
        _Check(mission, standing, found).run()
    return found


class _Place(NamedTuple):
    """A place where the payload is to be."""

    name: str
    source: str
    position: Array


class _Surroundings:
    """What stands about the formation."""

    def __init__(self, mission: Mission, standing: Sequence[PredictedObstacle]) -> None:
        config, self.area = mission.system, mission.area
        parameters, settings = config.parameters(), config.guidance.navigator
        self.margin = config.avoidance.margin
        self.formation = Formation(parameters)
        self.at_rest = BoundingCylinder.of(parameters)
        self.moving = BoundingCylinder.of(parameters, settings.link_tilt)
        hull = self.formation.hull_points(np.zeros((1, 3)))[0, :, :2]
        headings = np.radians(np.arange(0.0, 180.0, 1.0))
        width = float(np.ptp(hull @ np.array([np.cos(headings), np.sin(headings)]), axis=0).min())
        self.narrow = BoundingCylinder(width / 2.0, self.at_rest.above, self.at_rest.below)
        """The formation at its narrowest, whichever way it is passed by."""
        self.predicted = PredictedObstacles(standing)
        self.bodies = [(o.shape, o.positions[0]) for o in standing]
        self.names = [o.name for o in standing]

    def space(self, formation: BoundingCylinder, margin: float) -> FreeSpace:
        """Return the free space of a ``formation`` at any altitude."""
        return FreeSpace(self.bodies, formation, margin, -_HIGHEST, _HIGHEST, area=self.area)

    def obstruction(self, place: Array) -> Obstruction | None:
        """Return what is nearest to the formation at rest at ``place`` (3,), if nearer than the margin."""
        if (self.space(self.at_rest, self.margin).clearance(place[None]) >= self.margin).all():
            return None
        near = separations(self.formation, place[None], np.zeros((1, 3)), self.predicted, self.margin)
        found = [Obstruction(each.obstacle.name, float(each.distance[0])) for each in near]
        return min((each for each in found if each.distance < self.margin), key=lambda o: o.distance, default=None)

    def is_free_straight(self, start: Array, goal: Array) -> bool:
        """Return whether the formation keeps the margin on the straight line from ``start`` to ``goal`` (3,)."""
        return bool(self.space(self.at_rest, self.margin).are_free_segments(start[None], goal[None])[0])

    def in_the_way(self, places: Array) -> list[str]:
        """Return the names of what is nearer than the margin at any of ``places`` (P, 3), the nearest first."""
        clearance = self.space(self.at_rest, self.margin).clearance(places).min(axis=0)
        return [self.names[j] for j in np.argsort(clearance).tolist() if clearance[j] < self.margin]


class _Check:
    """The check of one mission."""

    def __init__(self, mission: Mission, standing: Sequence[PredictedObstacle], found: Feasibility) -> None:
        self._mission, self._found = mission, found
        self._surroundings = _Surroundings(mission, standing)
        self._resting = -mission.system.resting_altitude

    def run(self) -> None:
        """Look at all places and legs."""
        pad = _Place("the pad", "pad", np.array([0.0, 0.0, self._resting]))
        found, margin = self._surroundings.obstruction(pad.position), self._surroundings.margin
        if found is not None and found.distance <= 0.0:
            self._found.problems.append(f"pad: {found.lacking(0.0)}")
            return
        if found is not None:
            self._found.notes.append(f"pad: {found.lacking(margin)}")
        if isinstance(self._mission.reference, Route):
            self._route(pad, self._mission.reference)
        else:
            self._curve()

    def _route(self, pad: _Place, route: Route) -> None:
        here, legs = pad, route.first_lap(TRIED_LEGS)
        for leg in legs:
            if isinstance(leg, HoldForever):
                continue
            there = _end(leg, here.position)
            if isinstance(leg, TakeOff):
                # Its top need not be reached where something hangs there: on the way, another place does.
                if self._surroundings.is_free_straight(here.position, there.position):
                    here = _Place(here.name, there.source, there.position)
                continue
            if isinstance(leg, Circle):
                self._circle(leg, here.position)
            if not self._is_free(there, kept_at=here.position):
                continue
            if not isinstance(leg, Circle):
                self._leg(here, there)
            here = there

    def _is_free(self, place: _Place, kept_at: Array) -> bool:
        """Return whether the formation can be at ``place``, else add a note or problem."""
        if math.dist(place.position, kept_at) < 1e-3:
            return True
        found, margin = self._surroundings.obstruction(place.position), self._surroundings.margin
        if found is None:
            return True
        north, east, down = place.position
        where = f"{place.source}: {place.name} at {north:.1f} m north, {east:.1f} m east, {-down:.1f} m high"
        # Nowhere does the clearance change faster than the place. Drawn there, plans keep less than the margin.
        if found.distance <= 0.0 and margin - found.distance > (self._mission.limits or Limits()).arrival:
            self._found.problems.append(f"{where} cannot be reached: {found.lacking(margin)}")
            return False
        self._found.notes.append(f"{where}: {found.lacking(margin)}")
        return True

    def _leg(self, here: _Place, there: _Place) -> None:
        """Look for a way from ``here`` to ``there``."""
        around, system = self._surroundings, self._mission.system
        start, goal = here.position, there.position
        if around.is_free_straight(start, goal):
            return
        straight, settings = math.dist(start, goal), system.guidance.navigator
        obstacle = around.in_the_way(np.linspace(start, goal, 2 + int(straight / _SPACING)))[0]
        highest = max(-start[2], -goal[2]) + settings.climb
        lowest = min(around.moving.below + settings.ground_clearance, -start[2], -goal[2])
        ends = around.space(around.narrow, 0.0).clearance(np.array([start, goal])).min()
        # Only the last of them is certain to leave no way: the formation at its narrowest, however it turns.
        tried = (
            (around.moving, around.margin + settings.spare), (around.moving, around.margin),
            (around.at_rest, around.margin), (around.narrow, max(min(around.margin - _SHORT, float(ends)), 0.0)),
        )  # fmt: skip
        for formation, keep in tried:
            detour = find_detour(
                around.bodies, start, goal, formation, keep, lowest=lowest, highest=highest, area=around.area,
                names=around.names, settings=system.guidance.detour,
            )  # fmt: skip
            if detour.waypoints is not None:
                self._found.ways.append(Way(there.source, obstacle, straight, detour.length))
                return
        self._found.problems.append(
            f"{there.source}: there is no way from {here.name} to {there.name}: it is blocked by {obstacle}"
        )

    def _circle(self, circle: Circle, start: Array) -> None:
        angle = math.atan2(start[1] - circle.centre[1], start[0] - circle.centre[0])
        turn = min(circle.turns, 1.0) * math.tau * (1.0 if circle.clockwise else -1.0)
        angles = angle + np.linspace(0.0, turn, 2 + int(abs(turn) * circle.radius / _SPACING))
        north, east, down = circle.centre
        places = np.stack(
            [north + circle.radius * np.cos(angles), east + circle.radius * np.sin(angles), np.full(len(angles), down)],
            axis=1,
        )
        self._pass(circle.source, places)

    def _curve(self) -> None:
        figure = self._mission.reference
        assert not isinstance(figure, Route)
        a, b = figure.amplitude
        phase = np.linspace(0.0, math.tau, 2 + int(math.tau * max(a, 2.0 * b) / _SPACING))
        down = np.full(len(phase), -figure.altitude)
        self._pass("the curve", np.stack([a * np.sin(phase), -b * np.sin(2.0 * phase), down], axis=1))

    def _pass(self, source: str, places: Array) -> None:
        """Note what is nearer to a curve than the margin."""
        for name in self._surroundings.in_the_way(places):
            self._found.notes.append(f"{source}: {name} is in the way: the safety filter or a detour leads round it")


def _end(leg: Leg, start: Array) -> _Place:
    """Return where a leg from ``start`` (3,) ends."""
    north, east, down = start.tolist()
    end: Position = leg.end((north, east, down)) if isinstance(leg, Circle) else leg.position
    names = {Land: "the landing place", Circle: "the end of the circle"}
    return _Place(names.get(type(leg), "the waypoint"), leg.source, np.array(end))
