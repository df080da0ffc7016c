"""Feasibility of a mission, before anything is started: the formation at pad, waypoints and landing place, and between.

Looked at is what stands on the map, and the fence. Not looked at are obstacles that move, those that are not on the
map, and faults. What the safety filter or a detour leads round is a note; a place where the formation cannot be, and a
leg without any way, are problems.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gcs.config.validate import UnusableFile
from gcs.errors import UnusableInput
from gcs.mission.model import Limits, Lissajous, Mission, Obstacle
from gcs.mission.plausibility import implausible
from gcs.mission.route import Circle, GroundLeg, HoldForever, Land, Leg, Position, Route, TakeOff
from gcs.mission.route_clearance import (
    CHECKED_LEGS,
    SPACING,
    circle_places,
    curve_places,
    free_space,
    is_clear,
    keeps_margin,
    standing_obstacles,
)
from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace
from idc_controller.trajectory.lissajous import LissajousCurve, check_full_rate

if TYPE_CHECKING:
    from idc_controller.geometry.obstacles import PredictedObstacle, Region
    from idc_controller.parameters import SystemParameters
    from idc_controller.safety.separation import Obstruction

_SHORT = 0.3
"""m of the margin that a leg need not keep to be accepted: what the margin bars, a plan with slack may pass."""
_LED_ROUND = "is in the way: the safety filter or a detour leads round it"


@dataclass
class Feasibility:
    """What there is to say of a mission, one line each; without ``problems`` it can be flown."""

    ways: list[str] = field(default_factory=list)
    """Legs that lead round what is on the map, with the length of the way."""
    notes: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    @property
    def lines(self) -> list[str]:
        """Ways and notes."""
        return [*self.ways, *self.notes]


def preflight(mission: Mission) -> Feasibility:
    """Return what is in the way of ``mission``, as far as that is known before the flight.

    Raises :class:`UnusableInput` if it cannot be flown.
    """
    check_curve(mission)
    notes = implausible(mission)
    standing = standing_obstacles(mission)
    found = Feasibility() if is_clear(mission, standing) else _Check(mission, standing).run()
    if found.problems:
        raise UnusableFile([f"{mission.path}: {problem}" for problem in found.problems])
    found.notes += notes
    return found


def check_curve(mission: Mission) -> None:
    """Raise :class:`UnusableInput` for a figure eight that is faster than the limits of its curve."""
    figure = mission.reference
    if isinstance(figure, Lissajous):
        curve = LissajousCurve(figure.amplitude, down=-figure.altitude)
        try:
            check_full_rate(curve, figure.angular_frequency, mission.system.motion.curve_limits)
        except TrajectoryError as error:
            raise UnusableInput(f"{mission.path}: table [reference]: angular_frequency: {error}") from None


class _Place(NamedTuple):
    name: str
    source: str
    position: Array


class _Surroundings:
    """What stands about the formation. Compiled code and solvers are loaded only where something is near."""

    def __init__(self, mission: Mission, standing: Sequence[Obstacle]) -> None:
        self._mission, self._standing = mission, standing
        self._space = free_space(mission, standing)
        self.margin = self._space.margin

    def predict(self, times: Array, region: Region | None = None) -> list[PredictedObstacle]:
        """Return all that stands, as an :class:`ObstacleSource` does."""
        from idc_controller.geometry.obstacles import PredictedObstacle

        still = np.zeros(len(times))
        return [PredictedObstacle(o.name, o.shape, np.tile(o.position, (len(times), 1)), still) for o in self._standing]

    def obstruction(self, place: Array) -> Obstruction | None:
        """Return what is nearest to the formation at rest at ``place`` (3,), if nearer than the margin."""
        if not self.in_the_way(place[None]):
            return None
        from idc_controller.geometry.formation import Formation
        from idc_controller.safety.separation import obstruction

        return obstruction(Formation(self._mission.system.parameters()), self, 0.0, place, self.margin)

    def is_free_straight(self, start: Array, goal: Array) -> bool:
        """Return whether the formation keeps the margin on the straight line from ``start`` to ``goal`` (3,)."""
        return keeps_margin(self._space, start[None], goal[None])

    def in_the_way(self, places: Array) -> list[str]:
        """Return the names of what is nearer than the margin at any of ``places`` (P, 3), the nearest first."""
        clearance = self._space.clearance(places).min(axis=0)
        return [self._standing[j].name for j in np.argsort(clearance).tolist() if clearance[j] < self.margin]

    def way(self, start: Array, goal: Array) -> float:
        """Return the length (m) of a way round what stands from ``start`` to ``goal`` (3,); inf: there is none."""
        from idc_controller.guidance.detour import find_detour

        system = self._mission.system
        parameters, settings = system.parameters(), system.guidance.navigator
        at_rest = BoundingCylinder.of(parameters)
        moving = BoundingCylinder.of(parameters, settings.link_tilt)
        # Only this one leaves no way for certain: the formation at its narrowest, whichever way it is passed by.
        narrow = BoundingCylinder(_half_width(parameters), at_rest.above, at_rest.below)
        bodies = [(obstacle.shape, obstacle.position) for obstacle in self._standing]
        ends = FreeSpace(bodies, narrow, 0.0, -1.0, 1.0).clearance(np.array([start, goal])).min()
        tried = (
            (moving, self.margin + settings.spare), (moving, self.margin), (at_rest, self.margin),
            (narrow, max(min(self.margin - _SHORT, float(ends)), 0.0)),
        )  # fmt: skip
        highest = max(-start[2], -goal[2]) + settings.climb
        lowest = min(moving.below + settings.ground_clearance, -start[2], -goal[2])
        for formation, keep in tried:
            space = FreeSpace(bodies, formation, keep, lowest, highest, area=self._mission.area)
            detour = find_detour(space, start, goal, settings=system.guidance.detour)
            if detour.waypoints is not None:
                return detour.length
        return math.inf


class _Check:
    def __init__(self, mission: Mission, standing: Sequence[Obstacle]) -> None:
        self._mission, self._found = mission, Feasibility()
        self._surroundings = _Surroundings(mission, standing)
        self._resting = -mission.system.resting_altitude

    def run(self) -> Feasibility:
        """Look at all places and legs."""
        pad = _Place("the pad", "pad", np.array([0.0, 0.0, self._resting]))
        found, margin = self._surroundings.obstruction(pad.position), self._surroundings.margin
        if found is not None and found.distance <= 0.0:
            self._found.problems.append(f"pad: {found.lacking(0.0)}")
            return self._found
        if found is not None:
            self._found.notes.append(f"pad: {found.lacking(margin)}")
        if isinstance(self._mission.reference, Route):
            self._route(pad, self._mission.reference)
        else:
            self._pass("the curve", curve_places(self._mission.reference))
        return self._found

    def _route(self, pad: _Place, route: Route) -> None:
        here, legs = pad, route.first_lap(CHECKED_LEGS)
        for leg in legs:
            if isinstance(leg, HoldForever | GroundLeg):
                continue
            there = _end(leg, here.position)
            if isinstance(leg, TakeOff):
                # Its top need not be reached where something hangs there: on the way, another place does.
                if self._surroundings.is_free_straight(here.position, there.position):
                    here = _Place(here.name, there.source, there.position)
                continue
            if isinstance(leg, Circle):
                self._pass(leg.source, circle_places(leg, here.position))
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
        start, goal = here.position, there.position
        if self._surroundings.is_free_straight(start, goal):
            return
        straight = math.dist(start, goal)
        along = np.linspace(start, goal, 2 + int(straight / SPACING))
        obstacle = next(iter(self._surroundings.in_the_way(along)), "the fence")
        if math.isfinite(length := self._surroundings.way(start, goal)):
            led = f"{length:.1f} m in place of {straight:.1f} m"
            self._found.ways.append(f"{there.source}: {obstacle} {_LED_ROUND}, {led}")
        else:
            reason = f"there is no way from {here.name} to {there.name}: it is blocked by {obstacle}"
            self._found.problems.append(f"{there.source}: {reason}")

    def _pass(self, source: str, places: Array) -> None:
        """Note what is nearer to a curve than the margin."""
        for name in self._surroundings.in_the_way(places):
            self._found.notes.append(f"{source}: {name} {_LED_ROUND}")


def _half_width(parameters: SystemParameters) -> float:
    """Return half of the least width of payload and discs in plan view (m)."""
    headings = np.radians(np.arange(0.0, 360.0, 1.0))
    directions = np.array([np.cos(headings), np.sin(headings)])
    discs = (parameters.p[:, :2] @ directions).max(axis=0) + parameters.disc_radius
    extent = np.maximum(discs, (parameters.payload.vertices[:, :2] @ directions).max(axis=0))
    return float((extent + np.roll(extent, 180)).min()) / 2.0


def _end(leg: Leg, start: Array) -> _Place:
    """Return where a leg from ``start`` (3,) ends."""
    north, east, down = start.tolist()
    end: Position = leg.end((north, east, down)) if isinstance(leg, Circle) else leg.position
    names = {Land: "the landing place", Circle: "the end of the circle"}
    return _Place(names.get(type(leg), "the waypoint"), leg.source, np.array(end))
