"""Tests of Aerialist, and of the UAV testing competitions: a YAML file, the ``.plan`` that it names, and boxes.

Format: https://github.com/skhatiri/Aerialist. An obstacle's x points north and its y east, in m from where the vehicle
starts; r turns it from x towards y, in degrees; its base is at the height z. Keys that do not concern mission, place of
the start and obstacles (the autopilot's parameters, commands, assertions, agents, the simulator) are left out.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field

from gcs.campaign.folder import digest, plain
from gcs.campaign.scenarios.generator import HELD_TO
from gcs.campaign.scenarios.passage import passage_comments
from gcs.campaign.suites.course import MOST_OBSTACLES, Course, checked_passage
from gcs.campaign.suites.yaml_file import read_yaml
from gcs.campaign.toml_text import mission_text
from gcs.config.text_file import read_text
from gcs.config.toml_file import ParsedFile
from gcs.config.validate import Key, NotNegative, Positive, UnusableFile, dotted, strict, validated
from gcs.mission.items import FARTHEST, FileHome, ItemError
from gcs.mission.model import Obstacle
from gcs.mission.read import read_mission
from idc_controller.geometry.shapes import Pole, Wall

KIND = "aerialist"
_FLAT = ("l", "w", "h", "x", "y", "z", "r")
"""Numbers of an obstacle where they stand in one list."""
_Coordinate = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]


@strict
@dataclass(frozen=True)
class _Size:
    l: NotNegative
    w: NotNegative
    h: Positive
    r: NotNegative = 0.0


@strict
@dataclass(frozen=True)
class _Position:
    x: _Coordinate
    y: _Coordinate
    z: _Coordinate = 0.0
    r: float = 0.0


@strict
@dataclass(frozen=True)
class _Obstacle:
    size: _Size
    position: _Position
    shape: Literal["box", "cylinder"] | None = None


@strict
@dataclass(frozen=True)
class _Test:
    """What a course is made of."""

    mission_file: Annotated[str, Field(min_length=1)]
    obstacles: Annotated[tuple[_Obstacle, ...], Field(max_length=MOST_OBSTACLES)]
    home_position: tuple[Annotated[float, Field(ge=-90.0, le=90.0)], float, float] | None


def read_aerialist(path: Path, config: Path | None, speed: float, seed: int) -> Course:
    """Return the course of a test, its plan flown at ``speed`` (m/s) with noise of ``seed``.

    Raises :class:`UnusableFile` with every reason found.
    """
    file = read_yaml(path)
    test, keys = _test(file)
    plan = _plan(file, keys.plan, test.mission_file)
    mission = read_mission(plan, config)
    start = (0.0, 0.0)
    if test.home_position is not None:
        latitude, longitude, _ = test.home_position
        try:
            home = FileHome(mission.home.latitude, mission.home.longitude, mission.home.altitude)
            start = home.north_east(latitude, longitude)
        except ItemError as error:
            raise UnusableFile([file.problem(("simulation", "home_position"), str(error))]) from error
    obstacles: list[Obstacle] = []
    problems = []
    for i, each in enumerate(test.obstacles):
        try:
            obstacles.append(_obstacle(i + 1, each, start))
        except ValueError as error:
            problems.append(file.problem(keys.obstacle(i), str(error)))
    if problems:
        raise UnusableFile(problems)
    passage = checked_passage(
        mission, obstacles, lambda i, reason: file.problem(keys.plan if i is None else keys.obstacle(i), reason)
    )
    comments = [f"Test {path.name} of Aerialist, its mission {plan.name}.", *passage_comments(passage)]
    if "wind" in _table(file, "simulation"):
        comments.append("Left out: simulation.wind.")
    text = read_text(plan)
    beside = f"{plain(plan.stem)}-{digest(text)}.plan"
    content = mission_text(path.stem, seed, {"file": beside, "speed": speed}, obstacles, HELD_TO, comments)
    return Course(path.stem, KIND, str(path), passage, content, {beside: text})


class _Keys(NamedTuple):
    """Where the file has the mission and the obstacles."""

    plan: Key
    is_flat: bool

    def obstacle(self, i: int) -> Key:
        return ("simulation", "obstacles", i * len(_FLAT) if self.is_flat else i)


def _test(file: ParsedFile) -> tuple[_Test, _Keys]:
    robot = "robot" if "robot" in file.data else "drone"  # as earlier versions name it
    simulation = _table(file, "simulation")
    obstacles = simulation.get("obstacles") or []
    is_flat = isinstance(obstacles, list) and any(isinstance(each, int | float) for each in obstacles)
    keys = _Keys((robot, "mission_file"), is_flat)
    if is_flat:
        if len(obstacles) % len(_FLAT):
            reason = f"{len(obstacles)} numbers: {', '.join(_FLAT)} of each obstacle are {len(_FLAT)}"
            raise UnusableFile([file.problem(("simulation", "obstacles"), reason)])
        rows = [obstacles[i : i + len(_FLAT)] for i in range(0, len(obstacles), len(_FLAT))]
        obstacles = [{"size": dict(zip("lwh", row, strict=False)), "position": dict(zip("xyzr", row[3:], strict=True))}
                     for row in rows]  # fmt: skip
    data = {
        "mission_file": _table(file, robot).get("mission_file"),
        "obstacles": obstacles,
        "home_position": simulation.get("home_position"),
    }

    def problem(key: Key, reason: str) -> str:
        if key[:1] == ("mission_file",):
            absent = data["mission_file"] is None
            return file.problem(keys.plan, "missing key: the plan that is flown" if absent else reason)
        if key[:1] == ("obstacles",) and len(key) > 1 and isinstance(key[1], int):
            if is_flat:
                return file.problem(keys.obstacle(key[1]), f"{dotted(key[2:])}: {reason}")
            return file.problem((*keys.obstacle(key[1]), *key[2:]), reason)
        return file.problem(("simulation", *key), reason)

    return validated(_Test, data, problem), keys


def _table(file: ParsedFile, key: str) -> dict[str, Any]:
    """Return a mapping of the file, empty where it is absent."""
    table = file.data.get(key) or {}
    if not isinstance(table, dict):
        raise UnusableFile([file.problem((key,), "must be a mapping of keys")])
    return table


def _plan(file: ParsedFile, key: Key, name: str) -> Path:
    """Return the plan: as written from the test's folder or one above it, else by its name alone beside the test."""
    folder = file.path.absolute().parent
    places = [*(above / name for above in (folder, *folder.parents)), folder / Path(name).name]
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        reason = f"there is no file {name}, neither from {file.path.parent} or a folder above it, nor beside the test"
        raise UnusableFile([file.problem(key, reason)])
    return found


def _obstacle(number: int, read: _Obstacle, start: tuple[float, float]) -> Obstacle:
    """Return an obstacle that is not on the map. Raises :class:`ValueError` for one that cannot be."""
    size, place = read.size, read.position
    north, east = round(start[0] + place.x, 4), round(start[1] + place.y, 4)
    if read.shape == "cylinder":
        if size.r == 0.0:
            raise ValueError("size.r: the radius of a cylinder must be above 0 m")
        if place.z != 0.0:
            raise ValueError(f"position.z: a cylinder stands on the ground, found {place.z:g} m")
        return Obstacle(f"cylinder {number}", (north, east, -size.h / 2.0), Pole(size.r, size.h), False)
    if size.l == 0.0 or size.w == 0.0:
        raise ValueError("size: l and w of a box must be above 0 m")
    box = Wall((size.l, size.w, size.h), math.radians(place.r))
    return Obstacle(f"box {number}", (north, east, round(-place.z - size.h / 2.0, 4)), box, False)
