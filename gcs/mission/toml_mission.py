"""The project's own ``.toml`` mission: its tables, and what must agree between them."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from gcs.config import UnusableFile
from gcs.config.system import SystemConfig
from gcs.config.tables import Vector
from gcs.config.toml_file import ParsedFile, read_toml
from gcs.config.validate import NotNegative, Positive, strict
from gcs.mission.faults import fault_data, fault_problems, fault_suggestions, parameter_problems
from gcs.mission.items import FARTHEST, ITEM_LIMIT
from gcs.mission.model import Fault, Limits, Lissajous, Name
from gcs.mission.motion import WaypointsMotion
from gcs.mission.obstacle_table import ObstacleTable
from gcs.mission.route import END, Route
from gcs.mission.steps import Descend, Go, Place, Step

DEFAULT_SEED = 1


@strict
@dataclass(frozen=True)
class MissionTable:
    """``[mission]``: its name, the system file beside it, the seed of every random number."""

    name: Name
    system: Annotated[str, Field(min_length=1)] | None = None
    seed: Annotated[int, Field(ge=0, lt=2**63)] = DEFAULT_SEED


@strict
@dataclass(frozen=True)
class WaypointsTable:
    """``[reference]`` of kind waypoints: a waypoint file, or points (NED, m) with a hold at each (s).

    After the last point the payload returns to land on the pad, unless ``return_home`` is false: then it lands there.
    """

    kind: Literal["waypoints"]
    file: Annotated[str, Field(min_length=1)] | None = None
    points: Annotated[tuple[Vector, ...], Field(min_length=1, max_length=ITEM_LIMIT)] | None = None
    speed: Positive | None = None
    hold: NotNegative | None = None
    return_home: bool | None = None


@strict
@dataclass(frozen=True)
class MissionFile:
    """The whole file."""

    mission: MissionTable
    reference: Annotated[Lissajous | WaypointsTable, Field(discriminator="kind")]
    obstacle: Annotated[tuple[ObstacleTable, ...], Field(max_length=1000)] = ()
    fault: Annotated[tuple[Fault, ...], Field(max_length=1000)] = ()
    limits: Limits | None = None


_OTHER_FILES = {
    "campaign": "this is a campaign, no mission: gcs faults flies it",
    **{table.name: "this is a system file, no mission: it goes with --config" for table in fields(SystemConfig)},
}


def read_mission_file(path: Path) -> tuple[ParsedFile, MissionFile]:
    """Read and check the tables of a mission, without the files it names.

    Raises :class:`UnusableFile` with every reason found.
    """
    file = read_toml(path)
    data, faults = file.data, file.data.get("fault")
    for table, use in _OTHER_FILES.items():
        if table in data and "mission" not in data and "reference" not in data:
            raise UnusableFile([file.problem((table,), use)])
    if isinstance(faults, list):
        data = {**data, "fault": [fault_data(file, i, fault) for i, fault in enumerate(faults)]}
    mission = file.validated(MissionFile, data, suggestions=fault_suggestions())
    problems = [problem for i, fault in enumerate(mission.fault) for problem in parameter_problems(file, i, fault)]
    if problems := [*problems, *_disagreements(file, mission)]:
        raise UnusableFile(problems)
    return file, mission


def points_route(file: ParsedFile, table: WaypointsTable, speed: float, system: SystemConfig) -> Route:
    """Return the route through ``points``. Raises :class:`UnusableFile` for points that cannot be flown to."""
    points = table.points or ()
    if found := unreachable(points, system):
        raise UnusableFile([file.problem(("reference", "points", i), reason) for i, reason in found])
    return route_through(points, speed, system, table.hold or 0.0, return_home=table.return_home is not False)


def unreachable(points: Sequence[Vector], system: SystemConfig) -> list[tuple[int, str]]:
    """Return index and reason of each of ``points`` (NED, m) at which the payload cannot be."""
    lowest, found = -system.resting_altitude, []
    for i, point in enumerate(points):
        if point[2] > lowest:
            found.append((i, f"z = {point[2]:g} m is below ground (limit {lowest:g} m, down is positive)"))
        if max(map(abs, point)) > FARTHEST:
            place = ", ".join(f"{value:g}" for value in point)
            found.append((i, f"[{place}] is more than {FARTHEST / 1000.0:g} km from home"))
    return found


def route_through(
    points: Sequence[Vector], speed: float, system: SystemConfig, hold: float = 0.0, *, return_home: bool = True
) -> Route:
    """Return the route from the pad through ``points`` (NED, m) at ``speed`` (m/s), to the pad or the last one."""
    steps: list[Step] = [Go(f"point {i}", Place((x, y), -z), hold) for i, (x, y, z) in enumerate(points, start=1)]
    if not return_home:
        steps.append(Descend(END, Place()))
    return Route(tuple(steps), speed, system.resting_altitude)


def check_with_system(file: ParsedFile, mission: MissionFile, system: SystemConfig) -> None:
    """Raise :class:`UnusableFile` for an altitude or for faults that do not agree with the system."""
    problems = [
        file.problem(("fault", i, key), reason)
        for i, fault in enumerate(mission.fault)
        for key, reason in fault_problems(fault, system)
    ]
    if isinstance(mission.reference, Lissajous) and mission.reference.altitude < system.resting_altitude:
        reason = f"{mission.reference.altitude:g} m is on the ground (limit {system.resting_altitude:g} m)"
        problems.append(file.problem(("reference", "altitude"), reason))
    if problems:
        raise UnusableFile(problems)


def _disagreements(file: ParsedFile, mission: MissionFile) -> Iterator[str]:
    reference = mission.reference
    if isinstance(reference, WaypointsTable):
        if (reference.file is None) == (reference.points is None):
            yield file.problem(("reference",), "needs either file or points")
        if reference.file is not None and reference.hold is not None:
            yield file.problem(("reference", "hold"), "goes with points; a waypoint file has its own")
        if reference.file is not None and reference.return_home is not None:
            yield file.problem(("reference", "return_home"), "goes with points; a waypoint file has its own end")
    names = Counter(obstacle.name for obstacle in mission.obstacle)
    for i, obstacle in enumerate(mission.obstacle):
        if names[obstacle.name] > 1:
            reason = f"'{obstacle.name}' appears {names[obstacle.name]} times"
            yield file.problem(("obstacle", i, "name"), reason)
        shape, motion = obstacle.shape, obstacle.motion
        if shape.is_grounded and motion is not None and not motion.is_level:
            reason = f"a {shape.kind} stands on the ground: no vertical motion"
            yield file.problem(("obstacle", i, "motion"), reason)
        if isinstance(motion, WaypointsMotion) and any(a == b for a, b in pairwise(motion.path)):
            yield file.problem(("obstacle", i, "motion"), "two consecutive points are the same")
