"""Lists of poles and boxes in JSON lines: a course a line."""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from pydantic import Field

from gcs.campaign.scenarios.generator import HELD_TO
from gcs.campaign.scenarios.passage import passage_comments
from gcs.campaign.suites.course import MOST_OBSTACLES, Course, checked_passage
from gcs.campaign.toml_text import mission_text
from gcs.config import SystemConfig
from gcs.config.tables import Vector
from gcs.config.text_file import read_text, why_unparsed
from gcs.config.validate import Key, Positive, UnusableFile, dotted, strict, validated
from gcs.mission.items import FARTHEST, ITEM_LIMIT
from gcs.mission.model import Mission, Name, Obstacle
from gcs.mission.toml_mission import route_through, unreachable
from idc_controller.geometry.shapes import Pole, Wall

KIND = "list"
_Coordinate = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]


@strict
@dataclass(frozen=True)
class _Pole:
    """An upright cylinder on the ground (m)."""

    north: _Coordinate
    east: _Coordinate
    radius: Positive
    height: Positive


@strict
@dataclass(frozen=True)
class _Box:
    """A box (m) whose length is along ``yaw_deg``, from north towards east, and whose base is at ``bottom``."""

    north: _Coordinate
    east: _Coordinate
    length: Positive
    width: Positive
    height: Positive
    bottom: _Coordinate = 0.0
    yaw_deg: float = 0.0


@strict
@dataclass(frozen=True)
class _Line:
    """A course: its way through ``points`` (NED, m) from home at ``speed`` (m/s), and what stands about it."""

    points: Annotated[tuple[Vector, ...], Field(min_length=1, max_length=ITEM_LIMIT)]
    name: Name | None = None
    speed: Positive | None = None
    return_home: bool = False
    poles: Annotated[tuple[_Pole, ...], Field(max_length=MOST_OBSTACLES)] = ()
    boxes: Annotated[tuple[_Box, ...], Field(max_length=MOST_OBSTACLES)] = ()
    known: bool = False


def read_list(path: Path, system: SystemConfig, speed: float, seed: int) -> Iterator[Course]:
    """Yield the courses of a list, flown at ``speed`` (m/s) where they do not say, with noise of ``seed``.

    Raises :class:`UnusableFile` with every reason found in a line.
    """
    for number, text in enumerate(read_text(path).split("\n"), start=1):
        if text.strip():
            yield _course(path, number, _read(f"{path}: line {number}", text), system, speed, seed)


def _read(where: str, text: str) -> _Line:
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UnusableFile([f"{where}: not valid JSON: {why_unparsed(error)}"]) from error
    if not isinstance(data, dict):
        raise UnusableFile([f"{where}: must be a JSON object"])
    return validated(_Line, data, lambda key, reason: f"{where}: {dotted(key)}: {reason}")


def _course(path: Path, number: int, line: _Line, system: SystemConfig, speed: float, seed: int) -> Course:
    def problem(key: Key, reason: str) -> str:
        return f"{path}: line {number}: {dotted(key)}: {reason}"

    poles = [
        Obstacle(f"pole {i}", (p.north, p.east, -p.height / 2.0), Pole(p.radius, p.height), line.known)
        for i, p in enumerate(line.poles, start=1)
    ]
    boxes = [
        Obstacle(
            f"box {i}",
            (b.north, b.east, -b.bottom - b.height / 2.0),
            Wall((b.length, b.width, b.height), math.radians(b.yaw_deg)),
            line.known,
        )
        for i, b in enumerate(line.boxes, start=1)
    ]
    keys: list[Key] = [*(("poles", i) for i in range(len(poles))), *(("boxes", i) for i in range(len(boxes)))]
    obstacles = [*poles, *boxes]
    problems = [problem(("points", i), reason) for i, reason in unreachable(line.points, system)]
    if len(obstacles) > MOST_OBSTACLES:
        reason = f"{len(obstacles)} poles and boxes (limit {MOST_OBSTACLES})"
        problems.append(problem(("poles",), reason))
    if problems:
        raise UnusableFile(problems)
    own_speed = min(line.speed or speed, system.motion.speed_max)
    name = line.name or f"{path.stem}-{number}"
    route = route_through(line.points, own_speed, system, return_home=line.return_home)
    passage = checked_passage(
        Mission(name, path, seed, system, route),
        obstacles,
        lambda i, reason: problem(("points",) if i is None else keys[i], reason),
    )
    reference = {"points": line.points, "speed": own_speed, "return_home": line.return_home}
    comments = [f"Line {number} of {path.name}.", *passage_comments(passage)]
    content = mission_text(name, seed, reference, obstacles, HELD_TO, comments)
    return Course(name, KIND, f"{path}: line {number}", passage, content)
