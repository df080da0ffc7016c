"""Whether anything is near the route of a mission: the first preflight check of obstacles, at little cost."""

import math
from collections.abc import Sequence

import numpy as np

from gcs.mission.fence import boundary_walls
from gcs.mission.model import Lissajous, Mission, Obstacle
from gcs.mission.route import Circle, GroundLeg, Route
from idc_controller.arrays import Array
from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace

CHECKED_LEGS = 2000
"""So many legs are looked at: a mission of more repeats itself."""
_HIGHEST = 1e5
"""m, above all that is flown."""
_SHORTEST = 0.02
"""m, half of a segment that is not cut any more."""
SPACING = 0.1
"""m between the places by which a curve is looked at."""


def standing_obstacles(mission: Mission) -> list[Obstacle]:
    """Return the obstacles of the map that do not move, and the walls along the edges of the fence."""
    on_map = [obstacle for obstacle in mission.obstacles if obstacle.known and obstacle.motion is None]
    return [*on_map, *boundary_walls(mission.boundary)]


def is_clear(mission: Mission, standing: Sequence[Obstacle]) -> bool:
    """Return whether the formation surely keeps the margin from all that is ``standing`` along the whole route."""
    if not standing:
        return True
    space = free_space(mission, standing)
    path = np.vstack([[0.0, 0.0, -mission.system.resting_altitude], route_places(mission)])
    return keeps_margin(space, path[:-1], path[1:])


def free_space(mission: Mission, standing: Sequence[Obstacle]) -> FreeSpace:
    """Return the space in which the formation at rest keeps the margin from what is ``standing``, at any altitude."""
    formation = BoundingCylinder.of(mission.system.parameters())
    bodies = [(obstacle.shape, obstacle.position) for obstacle in standing]
    return FreeSpace(bodies, formation, mission.system.avoidance.margin, -_HIGHEST, _HIGHEST)


def keeps_margin(space: FreeSpace, starts: Array, ends: Array) -> bool:
    """Return whether the formation keeps the margin on all lines from ``starts`` to ``ends`` (E, 3) (NED, m)."""
    while len(starts):
        middles, half_lengths = (starts + ends) / 2.0, np.linalg.norm(ends - starts, axis=1) / 2.0
        # Nowhere does the clearance change faster than the place.
        near = space.clearance(middles).min(axis=1) < space.margin + half_lengths
        if (half_lengths[near] < _SHORTEST).any():
            return False
        starts, middles, ends = starts[near], middles[near], ends[near]
        starts, ends = np.vstack([starts, middles]), np.vstack([middles, ends])
    return True


def circle_places(circle: Circle, start: Array) -> Array:
    """Return places (P, 3) along a ``circle`` from ``start`` (3,) (NED, m), once round at most."""
    angle = math.atan2(start[1] - circle.centre[1], start[0] - circle.centre[0])
    turn = min(circle.turns, 1.0) * math.tau * (1.0 if circle.clockwise else -1.0)
    angles = angle + np.linspace(0.0, turn, 2 + int(abs(turn) * circle.radius / SPACING))
    north, east, down = circle.centre
    level = [north + circle.radius * np.cos(angles), east + circle.radius * np.sin(angles)]
    return np.stack([*level, np.full(len(angles), down)], axis=1)


def curve_places(curve: Lissajous) -> Array:
    """Return places (P, 3) along a curve (NED, m)."""
    a, b = curve.amplitude
    phase = np.linspace(0.0, math.tau, 2 + int(math.tau * max(a, 2.0 * b) / SPACING))
    return np.stack([a * np.sin(phase), -b * np.sin(2.0 * phase), np.full(len(phase), -curve.altitude)], axis=1)


def route_places(mission: Mission) -> Array:
    """Return the places (P, 3) between which the route leads straight, of a curve many."""
    if not isinstance(mission.reference, Route):
        return curve_places(mission.reference)
    places: list[Array] = []
    here = np.zeros(3)
    for leg in mission.reference.first_lap(CHECKED_LEGS):
        if isinstance(leg, GroundLeg):
            continue
        along = circle_places(leg, here) if isinstance(leg, Circle) else np.array([leg.position])
        places.append(along)
        here = along[-1]
    return np.vstack(places)
