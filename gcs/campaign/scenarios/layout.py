"""Layouts of standing obstacles about a path, and the conditions that a layout must meet."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from gcs.campaign.scenarios.passage import Passage, Passages, Place
from gcs.mission.model import Obstacle
from idc_controller.geometry.free_space import FreeSpace
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Pole, Sphere, Wall

Random = np.random.Generator

END_CLEARANCE = 3.0
"""Clearance (m) of the formation at waypoints, where it takes off and where it lands."""
ON_PATH = 1.0
"""Clearance (m) below which an obstacle is on the path."""


@dataclass
class Layout:
    """A path through ``points`` (NED, m) at ``speed`` (m/s) from home, and the obstacles about it, none on the map.

    ``passable``: whether there shall be a way; None: either.
    """

    points: list[Place]
    speed: float
    passable: bool | None = True
    obstacles: list[Obstacle] = field(default_factory=list)

    @property
    def places(self) -> list[Place]:
        """The places from above the pad on (NED, m)."""
        return [(0.0, 0.0, self.points[0][2]), *self.points]

    @property
    def length(self) -> float:
        """Length of the path (m)."""
        return sum(math.dist(a, b) for a, b in pairwise(self.places))

    def at(self, along: float, sideways: float = 0.0) -> tuple[tuple[float, float], float]:
        """Return the place (north, east) ``along`` m on the path and ``sideways`` m to its right, and its heading."""
        for a, b in pairwise(self.places):
            leg, heading = math.dist(a, b), math.atan2(b[1] - a[1], b[0] - a[0])
            if along <= leg or b is self.points[-1]:
                break
            along -= leg
        north = a[0] + along * math.cos(heading) - sideways * math.sin(heading)
        east = a[1] + along * math.sin(heading) + sideways * math.cos(heading)
        return (north, east), heading

    def add_wall(
        self,
        name: str,
        place: tuple[float, float],
        size: tuple[float, float, float],
        heading: float = 0.0,
        bottom: float = 0.0,
    ) -> Obstacle:
        """Add a box of edges ``size`` (m) ``bottom`` m above the ground, its first edge along ``heading`` (rad)."""
        edges = (round(size[0], 3), round(size[1], 3), round(size[2], 3))
        shape = Wall(edges, math.radians(round(math.degrees(math.remainder(heading, math.tau)), 2)))
        return self._add(name, (*place, -round(bottom, 3) - edges[2] / 2.0), shape)

    def add_pole(self, name: str, place: tuple[float, float], radius: float, height: float) -> Obstacle:
        """Add a pole (m)."""
        shape = Pole(round(radius, 3), round(height, 3))
        return self._add(name, (*place, -shape.height / 2.0), shape)

    def add_sphere(self, name: str, place: tuple[float, float], altitude: float, radius: float) -> Obstacle:
        """Add a sphere ``altitude`` m above the ground."""
        return self._add(name, (*place, -altitude), Sphere(round(radius, 3)))

    def _add(self, name: str, place: Place, shape: Shape) -> Obstacle:
        number = 1 + sum(o.name.rsplit(" ", 1)[0] == name for o in self.obstacles)
        north, east, down = (round(float(value), 4) for value in place)
        obstacle = Obstacle(f"{name} {number}", (north, east, down), shape, False)
        self.obstacles.append(obstacle)
        return obstacle

    # Conditions

    def is_clear(self, passages: Passages, obstacles: Sequence[Obstacle] | None = None) -> bool:
        """Return whether ``obstacles`` (all) keep clear of the waypoints, the pad, the goal and what is above them."""
        bodies = [(o.shape, o.position) for o in (self.obstacles if obstacles is None else obstacles)]
        space = FreeSpace(bodies, passages.formation, END_CLEARANCE, 0.0, 100.0)
        return bool(space.is_free(np.array([*self.points, *self._columns()])).all())

    def _columns(self) -> Iterator[Place]:
        """Yield places from the ground up to the path, where it begins and ends."""
        for north, east, down in (self.places[0], self.points[-1]):
            for altitude in np.arange(0.3, -down + 0.25, 0.5).tolist():
                yield north, east, -altitude

    def is_in_the_way(self, passages: Passages) -> bool:
        """Return whether an obstacle is on the path."""
        bodies = [(o.shape, o.position) for o in self.obstacles]
        space = FreeSpace(bodies, passages.formation, ON_PATH, 0.0, 100.0)
        path = [
            np.linspace(a, b, max(2, math.ceil(math.dist(a, b) / 0.25))) for a, b in pairwise(self.places) if a != b
        ]
        return bool(len(bodies)) and not space.is_free(np.vstack(path)).all()

    def passage(self, passages: Passages) -> Passage | None:
        """Return the passage, if the layout meets all conditions."""
        if not (self.is_clear(passages) and self.is_in_the_way(passages)):
            return None
        found = passages.between(self.places, self.obstacles)
        wanted = {None: ("passable", "impassable"), True: ("passable",), False: ("impassable",)}[self.passable]
        if found.verdict not in wanted or not passages.agrees(found, self.places, self.obstacles):
            return None
        return found


def leg(start: Place, length: float, heading: float) -> Place:
    """Return the place (NED, m) ``length`` m from ``start`` by ``heading`` (rad)."""
    north, east = start[0] + length * math.cos(heading), start[1] + length * math.sin(heading)
    return round(north, 3), round(east, 3), start[2]


def above_pad(altitude: float) -> Place:
    """Return the place above the pad (NED, m)."""
    return 0.0, 0.0, -round(altitude, 3)
