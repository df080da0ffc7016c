"""One draft of a random scenario: a path, obstacles drawn on it, and whether it can be flown by construction."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from gcs.campaign.scenarios.moving import FLIGHT, MOTIONS, Random, displacement, motion_for, stop_and_go, top_speed
from gcs.config import SystemConfig
from gcs.mission.model import Lissajous, Mission, Obstacle
from gcs.mission.motion import AnyMotion, LinearMotion
from gcs.mission.route import Route
from gcs.mission.toml_mission import route_through
from gcs.planning.schedule import Schedule
from idc_controller.arrays import Array
from idc_controller.geometry.free_space import BoundingCylinder, FreeSpace
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.guidance.detour import find_detour

END_CLEARANCE = 3.0
"""Clearance (m) of the formation where it takes off and lands."""
MARGIN = 0.9
"""Least clearance (m) of a detour round static obstacles: margin, growth for uncertainty, corners cut."""
LINK_TILT = 0.1
"""Tilt of the links (rad) for which the formation is bounded."""
SPACING = 5.0
"""Distance (m) between obstacles along the path, and about moving ones."""
CEILING = 14.0
"""Highest altitude (m) of a detour."""
TALL = 18.0
"""Height (m) of obstacles that cannot be flown over."""
LARGEST_DELAY = 25.0
"""Delay (s) of the landing up to which no obstacle approaches the payload."""
ON_THE_MAP, MOVING_ON_THE_MAP = 0.4, 0.15
"""Shares of static and moving obstacles that are on the map."""


@dataclass(frozen=True)
class Contents:
    """Contents of a kind of scenario.

    ``figure_share``: share of scenarios on a figure eight. ``obstacles``: least and largest number, and what to add.
    """

    figure_share: float
    obstacles: tuple[tuple[int, int, tuple[Callable[[Draft, float], None], ...]], ...]


class Draft:
    """A path, and the obstacles drawn so far."""

    def __init__(self, random: Random, system: SystemConfig, fastest: float) -> None:
        self.random, self._system, self._fastest = random, system, fastest
        self.obstacles: list[Obstacle] = []
        self._static: list[float] = []  # m along the path
        self._moving: list[tuple[float, Array]] = []  # m along the path, and the place
        self.reference: Lissajous | dict[str, Any] = {}

    def draw(self, contents: Contents) -> None:
        """Draw a path and obstacles."""
        if contents.figure_share and self.random.random() < contents.figure_share:
            self._lay_figure()
        else:
            self._lay_legs()
        for least, most, adders in contents.obstacles:
            for _ in range(self.random.integers(least, most + 1)):
                add = adders[self.random.integers(len(adders))]
                if (along := self._station()) is not None:
                    add(self, along)

    def _uniform(self, low: float, high: float) -> float:
        return round(self.random.uniform(low, high), 3)

    def _lay_legs(self) -> None:
        """Lay a path of 15 to 30 m in one or two legs."""
        random = self.random
        length, heading = random.uniform(15.0, 30.0), random.uniform(-math.pi, math.pi)
        altitude = random.uniform(4.0, 6.0)
        legs = [(length, heading)]
        if length > 20.0 and random.random() < 0.4:
            first = random.uniform(0.35, 0.65) * length
            legs = [(first, heading), (length - first, heading + math.radians(random.uniform(-50.0, 50.0)))]
        north = east = 0.0
        points = []
        for step, angle in legs:
            north, east = north + step * math.cos(angle), east + step * math.sin(angle)
            points.append((round(north, 3), round(east, 3), -round(altitude, 3)))
        self._lay_route(points, self._uniform(1.0, 1.5))

    def lay_straight(self, speed: float) -> None:
        """Lay a straight path of 30 m at a ``speed`` (m/s)."""
        heading, altitude = self.random.uniform(-math.pi, math.pi), self._uniform(4.0, 6.0)
        goal = _rounded(np.array([30.0 * math.cos(heading), 30.0 * math.sin(heading), -altitude]))
        self._lay_route([(0.0, 0.0, -altitude), goal], speed)

    def _lay_route(self, points: list[tuple[float, float, float]], speed: float) -> None:
        self.reference = {"points": points, "speed": speed, "return_home": False}
        self._lay(route_through(points, speed, self._system, return_home=False))

    def _lay_figure(self) -> None:
        """Lay a lap and a half of a figure eight at up to 2.5 m/s."""
        a, b = self._uniform(6.0, 8.0), self._uniform(2.5, 3.5)
        rate = round(min(0.4, self.random.uniform(1.8, 2.5) / math.hypot(a, 2.0 * b)), 4)
        altitude, duration = self._uniform(4.0, 6.0), round(3.0 * math.pi / rate, 3)
        self.reference = Lissajous((a, b), rate, altitude, duration)
        self._lay(self.reference)

    def _lay(self, reference: Lissajous | Route) -> None:
        self.schedule = schedule = Schedule(Mission("", Path(), 1, self._system, reference))
        level = np.flatnonzero(schedule.positions[:, 2] <= schedule.goal[2] + 0.05)
        self._times, self._path = schedule.times[level], schedule.positions[level]
        steps = np.linalg.norm(np.diff(self._path, axis=0), axis=1)
        self._along = np.concatenate([[0.0], np.cumsum(steps)])

    # Obstacles

    def _station(self) -> float | None:
        """Return a distance along the path (m) that is ``SPACING`` from the obstacles so far; None: not found."""
        taken = [*self._static, *(along for along, _ in self._moving)]
        for _ in range(20):
            along = float(self.random.uniform(5.5, self._along[-1] - 5.0))
            if all(abs(along - other) >= SPACING for other in taken):
                return along
        return None

    def _place(self, along: float, sideways: float) -> tuple[Array, Array, float]:
        """Return the place (3,) there, ``sideways`` m off the path, the path's direction (3,), and the time (s)."""
        index = int(np.searchsorted(self._along, along))
        here = self._path[index]
        before, after = self._path[max(index - 5, 0)], self._path[min(index + 5, len(self._path) - 1)]
        direction = (after - before) / max(float(np.linalg.norm(after - before)), 1e-9)
        aside = np.array([-direction[1], direction[0], 0.0])
        return here + sideways * aside, direction, float(self._times[index])

    def add_sphere(self, along: float) -> None:
        """Add a sphere at any height between payload and discs."""
        where, _, _ = self._place(along, self.random.uniform(-1.2, 1.2))
        shape = Sphere(self._uniform(0.3, 0.8))
        self._add_static(along, shape, _rounded(where - [0.0, 0.0, self.random.uniform(-0.5, 3.5)]))

    def add_poles(self, along: float) -> None:
        """Add one pole, or two with a gap that is either wide enough or closed."""
        height = self._uniform(12.0, TALL)
        offsets = [self.random.uniform(-1.5, 1.5)]
        if self.random.random() < 0.4:
            apart = self.random.uniform(0.8, 1.6) if self.random.random() < 0.4 else self.random.uniform(5.0, 6.5)
            middle = self.random.uniform(-1.0, 1.0)
            offsets = [middle - apart / 2.0, middle + apart / 2.0]
        for offset in offsets:
            north, east, _ = _rounded(self._place(along, offset)[0])
            self._add_static(along, Pole(self._uniform(0.15, 0.4), height), (north, east, -height / 2.0))

    def add_wall(self, along: float) -> None:
        """Add a wall across the path: low, to be flown over, or high, to be flown round."""
        random = self.random
        if random.random() < 0.4:
            width, aside = random.uniform(4.0, 12.0), random.uniform(-2.0, 2.0)
            height = -self.schedule.goal[2] + random.uniform(-1.0, 1.5)
        else:
            width, height = random.uniform(2.0, 6.0), TALL
            aside = random.uniform(-0.5, 0.5) * width
        where, direction, _ = self._place(along, aside)
        size = (self._uniform(0.2, 0.5), round(width, 3), round(float(height), 3))
        yaw = math.degrees(math.atan2(direction[1], direction[0])) + random.uniform(-25.0, 25.0)
        north, east, _ = _rounded(where)
        self._add_static(along, Wall(size, math.radians(round(yaw, 2))), (north, east, -size[2] / 2.0))

    def add_moving(self, along: float) -> None:
        """Add a sphere that is where the undisturbed payload is when it passes."""
        random = self.random
        where, direction, time = self._place(along, 0.0)
        shape, up = Sphere(self._uniform(0.3, 0.6)), random.uniform(-0.2, 3.0)
        motion = motion_for(MOTIONS[random.integers(len(MOTIONS))], random, time, direction, self._fastest)
        known = bool(random.random() < MOVING_ON_THE_MAP)
        self._add_meeting(self._name("moving sphere"), along, where, up, time, shape, motion, known)

    def add_approaching(self, along: float, speed: float) -> None:
        """Add a sphere that meets the undisturbed payload at ``speed`` (m/s) from any bearing, not on the map."""
        where, _, time = self._place(along, 0.0)
        bearing, up = self.random.uniform(-math.pi, math.pi), self.random.uniform(-0.2, 3.0)
        motion = LinearMotion(_rounded(speed * np.array([math.cos(bearing), math.sin(bearing), 0.0])))
        self._add_meeting("ball", along, where, up, time, Sphere(0.5), motion)

    def add_stop_and_go(self, along: float) -> None:
        """Add a sphere that stops and goes about where the undisturbed payload passes, not on the map."""
        random = self.random
        where, direction, time = self._place(along, random.uniform(-0.5, 0.5))
        shape, up = Sphere(self._uniform(0.3, 0.6)), random.uniform(-0.2, 3.0)
        motion = stop_and_go(random, time, direction)
        self._add_meeting(self._name("moving sphere"), along, where, up, time, shape, motion)

    def _add_meeting(
        self, name: str, along: float, where: Array, up: float, time: float, shape: Shape, motion: AnyMotion,
        known: bool = False,
    ) -> None:  # fmt: skip
        """Add an obstacle that is ``up`` m above the place ``where`` (3,) on the path at ``time`` (s)."""
        [then] = displacement(motion, np.array([time]))
        self._moving.append((along, where))
        self.obstacles.append(Obstacle(name, _rounded(where - [0.0, 0.0, up] - then), shape, known, motion))

    def _add_static(self, along: float, shape: Shape, position: tuple[float, float, float]) -> None:
        known = bool(self.random.random() < ON_THE_MAP)
        self._static.append(along)
        self.obstacles.append(Obstacle(self._name(shape.kind), position, shape, known))

    def _name(self, what: str) -> str:
        return f"{what} {1 + sum(obstacle.name.startswith(what) for obstacle in self.obstacles)}"

    # Conditions of a scenario that can be flown

    def can_be_flown(self) -> bool:
        """Return whether the draft meets the conditions in the description of the module."""
        if not self.obstacles:
            return False
        formation = BoundingCylinder.of(self._system.parameters(), LINK_TILT)
        static = [(o.shape, np.array(o.position)) for o in self.obstacles if o.motion is None]
        moving = [(o, o.motion) for o in self.obstacles if o.motion is not None]
        # From the path down to the ground.
        heights = np.arange(self.schedule.goal[2], -self._system.resting_altitude, 0.5)
        ends = [[x, y, z] for x, y, _ in (self._path[0], self.schedule.goal) for z in heights]
        waypoints = self.reference["points"] if isinstance(self.reference, dict) else []
        return (
            all(
                FreeSpace(static, formation, clearance, 0.0, 100.0).is_free(np.array(places)).all()
                for clearance, places in ((END_CLEARANCE, ends), (MARGIN, waypoints))
                if len(places)
            )
            and self._has_detours(static, formation)
            and all(self._keeps_clear_of_ends(*each, formation) for each in moving)
            and self._keeps_clear_of_moving(static)
        )

    def _has_detours(self, static: Sequence[tuple[Shape, Array]], formation: BoundingCylinder) -> bool:
        """Return whether there is a detour round static obstacles, past every place between two of them."""
        between = [(a + b) / 2.0 for a, b in pairwise(sorted(set(self._static)))]
        places = [self._path[0], *(self._place(along, 0.0)[0] for along in between), self._path[-1]]
        space = FreeSpace(static, formation, MARGIN, 2.0, CEILING)
        for begin, end in pairwise(places):
            detour = find_detour(space, begin, end)
            if detour.waypoints is None or detour.length > 2.0 * float(np.linalg.norm(end - begin)) + 8.0:
                return False
        return True

    def _keeps_clear_of_ends(self, obstacle: Obstacle, motion: AnyMotion, formation: BoundingCylinder) -> bool:
        """Return whether it is slow enough, stays in the air, and keeps clear of take-off and landing."""
        if top_speed(motion) > self._fastest + 1e-3:
            return False
        times = FLIGHT[: int((self.schedule.landing + LARGEST_DELAY + 15.0) / FLIGHT[1])]
        places = np.array(obstacle.position) + displacement(motion, times)
        if (-places[:, 2]).min() < obstacle.shape.reach + 0.3:
            return False
        keep = END_CLEARANCE + obstacle.shape.reach + formation.radius
        for place, busy in (
            (self._path[0], times < self._times[0] + 4.0),
            (self.schedule.goal, times > self.schedule.landing - 4.0),
        ):
            if np.linalg.norm((places - place)[busy, :2], axis=1).min(initial=math.inf) < keep:
                return False
        return True

    def _keeps_clear_of_moving(self, static: Sequence[tuple[Shape, Array]]) -> bool:
        """Return whether static obstacles keep clear of the places where moving ones meet the payload."""
        if not (static and self._moving):
            return True
        space = FreeSpace(static, BoundingCylinder(0.0, TALL, TALL), 0.0, -100.0, 100.0)
        return bool((space.clearance(np.array([place for _, place in self._moving])) >= SPACING - 1.0).all())


def _rounded(place: Array) -> tuple[float, float, float]:
    north, east, down = (round(float(value), 3) for value in place)
    return north, east, down
