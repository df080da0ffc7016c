"""Random obstacle scenarios that can be flown: a path and obstacles on it, each from its seed and number.

A draft is drawn again until it can be flown by construction: start and goal are clear by 3 m, there is a detour round
all static obstacles, moving obstacles keep clear of them, and none approaches the payload while it takes off or lands.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcs.campaign.scenarios.moving import FLIGHT, MOTIONS, displacement, motion_for, top_speed
from gcs.campaign.scenarios.schedule import Schedule
from gcs.campaign.toml_text import mission_text
from gcs.config import SystemConfig, read_system
from gcs.errors import GcsError
from gcs.mission.model import RESTING_ALTITUDE, Limits, Lissajous, Mission, Obstacle
from gcs.mission.route import Route
from gcs.mission.toml_mission import route_through
from idc_controller.geometry.box import Wall
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.sphere import Sphere
from idc_controller.guidance.detour import BoundingCylinder, FreeSpace, find_detour

Array = NDArray[np.float64]
Random = np.random.Generator

KINDS = ("spheres", "poles", "walls", "moving", "mixed")
HELD_TO = Limits(clearance=0.3, payload_tilt_deg=6.0)

CLEAR = 3.0
"""m about the formation where it takes off and lands."""
MARGIN = 0.9
"""m, the least clearance of a detour round static obstacles: margin, growth for uncertainty, corners cut."""
LINK_TILT = 0.1
"""rad, for which the formation is bounded."""
APART = 5.0
"""m along the path between obstacles, and about moving ones."""
CEILING = 14.0
"""m, the highest altitude of a detour."""
TALL = 18.0
"""m, the height of obstacles that cannot be flown over."""
LATE = 25.0
"""s of delay with which no obstacle approaches the landing payload yet."""
MAX_DRAFTS = 400
ON_THE_MAP, MOVING_ON_THE_MAP = 0.4, 0.15
"""Shares of the obstacles that the ground knows."""


@dataclass(frozen=True)
class RandomScenario:
    """One scenario: ``text`` is the mission file."""

    number: int
    kind: str
    name: str
    text: str


def generate(
    seed: int, number: int, kind: str, config: SystemConfig | None = None, fastest: float = 2.0
) -> RandomScenario:
    """Return scenario ``number`` of ``seed``; obstacles move at up to ``fastest`` (m/s).

    ``config`` is the system that will fly it; None: the packaged one. The same arguments give the same scenario.
    Raises :class:`GcsError` where none could be found.
    """
    if kind not in KINDS:
        raise ValueError(f"{kind!r} is none of {KINDS}")
    system = read_system(None) if config is None else config
    random = np.random.default_rng([seed, number, KINDS.index(kind)])
    name = f"{number:04d}-{kind}"
    for _ in range(MAX_DRAFTS):
        draft = _Draft(random, system, fastest)
        _FILL[kind](draft)
        if draft.can_be_flown():
            comment = f"Random course {number} of seed {seed}, kind {kind}."
            noise_seed = int(random.integers(2**31))
            text = mission_text(name, noise_seed, draft.reference, draft.obstacles, HELD_TO, [comment])
            return RandomScenario(number, kind, name, text)
    raise GcsError(f"scenario {number} of seed {seed}: none can be flown of {MAX_DRAFTS} drafts: take another seed")


class _Draft:
    """A path, and the obstacles drawn so far."""

    def __init__(self, random: Random, system: SystemConfig, fastest: float) -> None:
        self.random, self._system, self._fastest = random, system, fastest
        self.obstacles: list[Obstacle] = []
        self._standing: list[float] = []  # m along the path
        self._moving: list[tuple[float, Array]] = []  # m along the path, and the place
        self.reference: Lissajous | dict[str, Any] = {}

    def along_points(self) -> None:
        """15 to 30 m in one or two legs."""
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
        speed = round(random.uniform(1.0, 1.5), 3)
        self.reference = {"points": points, "speed": speed, "return_home": False}
        self._lay(route_through(points, speed, return_home=False))

    def along_figure(self) -> None:
        """A lap and a half of a figure eight at up to 2.5 m/s."""
        random = self.random
        a, b = round(random.uniform(6.0, 8.0), 3), round(random.uniform(2.5, 3.5), 3)
        rate = round(min(0.4, random.uniform(1.8, 2.5) / math.hypot(a, 2.0 * b)), 4)
        altitude, duration = round(random.uniform(4.0, 6.0), 3), round(3.0 * math.pi / rate, 3)
        self.reference = Lissajous((a, b), rate, altitude, duration)
        self._lay(self.reference)

    def _lay(self, reference: Lissajous | Route) -> None:
        self.schedule = schedule = Schedule(Mission("", Path(), 1, self._system, reference))
        level = np.flatnonzero(schedule.positions[:, 2] <= schedule.goal[2] + 0.05)
        self._times, self._way = schedule.times[level], schedule.positions[level]
        steps = np.linalg.norm(np.diff(self._way, axis=0), axis=1)
        self._along = np.concatenate([[0.0], np.cumsum(steps)])

    # Obstacles

    def station(self) -> float | None:
        """Return a place along the path (m) that is ``APART`` from the obstacles so far; None: not found."""
        taken = [*self._standing, *(along for along, _ in self._moving)]
        for _ in range(20):
            along = float(self.random.uniform(5.5, self._along[-1] - 5.0))
            if all(abs(along - other) >= APART for other in taken):
                return along
        return None

    def place(self, along: float, sideways: float) -> tuple[Array, Array, float]:
        """Return that place (3,), ``sideways`` m off the path, the direction of the path (3,), and the time (s)."""
        index = int(np.searchsorted(self._along, along))
        here = self._way[index]
        before, after = self._way[max(index - 5, 0)], self._way[min(index + 5, len(self._way) - 1)]
        direction = (after - before) / max(float(np.linalg.norm(after - before)), 1e-9)
        aside = np.array([-direction[1], direction[0], 0.0])
        return here + sideways * aside, direction, float(self._times[index])

    def add_sphere(self) -> None:
        if (along := self.station()) is None:
            return
        where, _, _ = self.place(along, self.random.uniform(-1.2, 1.2))
        radius = round(self.random.uniform(0.3, 0.8), 3)
        up = self.random.uniform(-0.5, 3.5)  # anywhere between payload and discs
        self._stand(
            along, Obstacle(self._name("sphere"), _rounded(where - [0.0, 0.0, up]), Sphere(radius), self._known())
        )

    def add_poles(self) -> None:
        """Add one pole, or two with a gap that is either wide enough or closed."""
        if (along := self.station()) is None:
            return
        height = round(self.random.uniform(12.0, TALL), 3)
        offsets = [self.random.uniform(-1.5, 1.5)]
        if self.random.random() < 0.4:
            apart = self.random.uniform(0.8, 1.6) if self.random.random() < 0.4 else self.random.uniform(5.0, 6.5)
            middle = self.random.uniform(-1.0, 1.0)
            offsets = [middle - apart / 2.0, middle + apart / 2.0]
        for offset in offsets:
            where, _, _ = self.place(along, offset)
            radius = round(self.random.uniform(0.15, 0.4), 3)
            north, east, _ = _rounded(where)
            self._stand(
                along, Obstacle(self._name("pole"), (north, east, -height / 2.0), Pole(radius, height), self._known())
            )

    def add_wall(self) -> None:
        """Add a wall across the path: low, to be flown over, or high, to be flown round."""
        if (along := self.station()) is None:
            return
        random = self.random
        if random.random() < 0.4:
            width, aside = random.uniform(4.0, 12.0), random.uniform(-2.0, 2.0)
            height = -self.schedule.goal[2] + random.uniform(-1.0, 1.5)
        else:
            width, height = random.uniform(2.0, 6.0), TALL
            aside = random.uniform(-0.5, 0.5) * width
        where, direction, _ = self.place(along, aside)
        size = (round(random.uniform(0.2, 0.5), 3), round(width, 3), round(float(height), 3))
        yaw = math.degrees(math.atan2(direction[1], direction[0])) + random.uniform(-25.0, 25.0)
        centre = (*_rounded(where)[:2], -size[2] / 2.0)
        self._stand(along, Obstacle(self._name("wall"), centre, Wall(size, math.radians(round(yaw, 2))), self._known()))

    def add_moving(self) -> None:
        """Add a sphere that is where the undisturbed payload is when it passes."""
        if (along := self.station()) is None:
            return
        random = self.random
        where, direction, time = self.place(along, 0.0)
        radius = round(random.uniform(0.3, 0.6), 3)
        up = random.uniform(-0.2, 3.0)
        motion = motion_for(MOTIONS[random.integers(len(MOTIONS))], random, time, direction, self._fastest)
        [then] = displacement(motion, np.array([time]))
        rest = _rounded(where - [0.0, 0.0, up] - then)
        known = bool(random.random() < MOVING_ON_THE_MAP)
        self._moving.append((along, where))
        self.obstacles.append(Obstacle(self._name("moving sphere"), rest, Sphere(radius), known, motion))

    def _stand(self, along: float, obstacle: Obstacle) -> None:
        self._standing.append(along)
        self.obstacles.append(obstacle)

    def _name(self, what: str) -> str:
        return f"{what} {1 + sum(obstacle.name.startswith(what) for obstacle in self.obstacles)}"

    def _known(self) -> bool:
        return bool(self.random.random() < ON_THE_MAP)

    # Whether it can be flown

    def can_be_flown(self) -> bool:
        """Return whether the draft can be flown, as in the description of the module."""
        if not self.obstacles:
            return False
        formation = BoundingCylinder.of(self._system.parameters(), LINK_TILT)
        standing = [(o.shape, np.array(o.position)) for o in self.obstacles if o.motion is None]
        moving = [o for o in self.obstacles if o.motion is not None]
        return (
            self._is_clear_at_ends(standing, formation)
            and self._is_clear_at_waypoints(standing, formation)
            and self._is_open(standing, formation)
            and all(self._keeps_clear_of_ends(obstacle, formation) for obstacle in moving)
            and self._keeps_clear_of_moving(standing)
        )

    def _is_clear_at_ends(self, standing: Sequence[tuple[Shape, Array]], formation: BoundingCylinder) -> bool:
        """Return whether both ends are clear at every height between the ground and the altitude of the path."""
        space = FreeSpace(standing, formation, CLEAR, 0.0, 100.0)
        top = self.schedule.goal[2]
        ends = [
            [x, y, z] for x, y, _ in (self._way[0], self.schedule.goal) for z in np.arange(top, -RESTING_ALTITUDE, 0.5)
        ]
        return bool(space.is_free(np.array(ends)).all())

    def _is_clear_at_waypoints(self, standing: Sequence[tuple[Shape, Array]], formation: BoundingCylinder) -> bool:
        """Return whether no waypoint is inside a static obstacle."""
        if not isinstance(self.reference, dict):
            return True
        space = FreeSpace(standing, formation, MARGIN, 0.0, 100.0)
        return bool(space.is_free(np.array(self.reference["points"])).all())

    def _is_open(self, standing: Sequence[tuple[Shape, Array]], formation: BoundingCylinder) -> bool:
        """Return whether there is a detour round static obstacles, past every place between two of them."""
        stops = sorted(set(self._standing))
        between = [(a + b) / 2.0 for a, b in pairwise(stops)]
        places = [self._way[0], *(self.place(along, 0.0)[0] for along in between), self._way[-1]]
        for begin, end in pairwise(places):
            detour = find_detour(standing, begin, end, formation, MARGIN, lowest=2.0, highest=CEILING)
            if detour.waypoints is None or detour.length > 2.0 * float(np.linalg.norm(end - begin)) + 8.0:
                return False
        return True

    def _keeps_clear_of_ends(self, obstacle: Obstacle, formation: BoundingCylinder) -> bool:
        """Return whether it is slow enough, stays in the air, and keeps clear of take-off and landing."""
        assert obstacle.motion is not None
        if top_speed(obstacle.motion) > self._fastest + 1e-3:
            return False
        times = FLIGHT[: int((self.schedule.landing + LATE + 15.0) / FLIGHT[1])]
        places = np.array(obstacle.position) + displacement(obstacle.motion, times)
        if (-places[:, 2]).min() < obstacle.shape.reach + 0.3:
            return False
        keep = CLEAR + obstacle.shape.reach + formation.radius
        for place, busy in (
            (self._way[0], times < self._times[0] + 4.0),
            (self.schedule.goal, times > self.schedule.landing - 4.0),
        ):
            if np.linalg.norm((places - place)[busy, :2], axis=1).min(initial=math.inf) < keep:
                return False
        return True

    def _keeps_clear_of_moving(self, standing: Sequence[tuple[Shape, Array]]) -> bool:
        """Return whether static obstacles keep clear of the places where moving ones meet the payload."""
        if not (standing and self._moving):
            return True
        space = FreeSpace(standing, BoundingCylinder(0.0, TALL, TALL), 0.0, -100.0, 100.0)
        return bool((space.clearance(np.array([place for _, place in self._moving])) >= APART - 1.0).all())


def _rounded(place: Array) -> tuple[float, float, float]:
    north, east, down = (round(float(value), 3) for value in place)
    return north, east, down


def _some(draft: _Draft, least: int, most: int, *add: Callable[[_Draft], None]) -> None:
    for _ in range(draft.random.integers(least, most + 1)):
        add[draft.random.integers(len(add))](draft)


def _spheres(draft: _Draft) -> None:
    draft.along_figure() if draft.random.random() < 0.25 else draft.along_points()
    _some(draft, 1, 4, _Draft.add_sphere)


def _poles(draft: _Draft) -> None:
    draft.along_points()
    _some(draft, 1, 4, _Draft.add_poles)


def _walls(draft: _Draft) -> None:
    draft.along_points()
    _some(draft, 1, 2, _Draft.add_wall)


def _moving(draft: _Draft) -> None:
    draft.along_figure() if draft.random.random() < 0.25 else draft.along_points()
    _some(draft, 1, 3, _Draft.add_moving)


def _mixed(draft: _Draft) -> None:
    draft.along_points()
    _some(draft, 1, 2, _Draft.add_moving)
    _some(draft, 1, 3, _Draft.add_sphere, _Draft.add_poles, _Draft.add_wall)


_FILL: dict[str, Callable[[_Draft], None]] = {
    "spheres": _spheres,
    "poles": _poles,
    "walls": _walls,
    "moving": _moving,
    "mixed": _mixed,
}
