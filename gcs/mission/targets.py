"""Targets of a mission: its waypoints in order, and the landing place."""

import re
from dataclasses import dataclass

from gcs.mission.model import Mission
from gcs.mission.route import END, Circle, FlyTo, GroundLeg, HoldForever, Land, Position, Route, TakeOff

_NUMBER = re.compile(r"(?:item|row|point) (\d+(?:\.\d+)?)")


@dataclass(frozen=True)
class Target:
    """A place (NED, m) that the payload is to reach, by the name and number that the mission file gives it."""

    name: str
    position: Position
    is_climb: bool = False
    """The top of the climb, of which the height counts alone: the payload rises from where it stands."""
    is_landing: bool = False
    """A place on the ground, at whatever height the payload rests there."""


@dataclass(frozen=True)
class Targets:
    """Waypoints and stops in the order of flight, and the last landing (north, east) (m); None: where it took off."""

    waypoints: tuple[Target, ...] = ()
    landing: tuple[float, float] | None = None


def targets_of(mission: Mission) -> Targets:
    """Return the targets of a mission. Only for one that has come to its end: others may have none."""
    if not isinstance(mission.reference, Route):
        top = (0.0, 0.0, -mission.reference.altitude)
        return Targets((Target("the curve's altitude", top, is_climb=True),))
    legs = mission.reference.legs()
    landing: Land | None = None
    waypoints = []
    stops = 0
    here: Position = (0.0, 0.0, 0.0)
    for leg in legs:
        if isinstance(leg, GroundLeg):
            continue
        if isinstance(leg, Land):
            landing = leg
            continue
        if landing is not None:
            stops += 1
            waypoints.append(Target(_stop_name(stops, landing), landing.position, is_landing=True))
            landing = None
        here = leg.end(here) if isinstance(leg, Circle) else leg.position
        waypoints.append(Target(_name(leg), here, isinstance(leg, TakeOff)))
    return Targets(tuple(waypoints), None if landing is None else landing.position[:2])


def _stop_name(number: int, leg: Land) -> str:
    found = _NUMBER.search(leg.source)
    return f"stop {number} ({found[0] if found else leg.source})"


def _name(leg: TakeOff | FlyTo | Circle | HoldForever) -> str:
    found = _NUMBER.search(leg.source)
    if isinstance(leg, TakeOff):
        return f"take-off altitude ({found[0] if found else leg.source})"
    if leg.source == END:
        return "place above the landing"
    name = f"waypoint {found[1]}" if found else f"waypoint ({leg.source})"
    return f"end of the circle about {name}" if isinstance(leg, Circle) else name
