"""The project's own ``.toml`` mission."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter

from gcs.config import UnusableFile
from gcs.config.system import SystemConfig
from gcs.config.tables import Vector
from gcs.config.toml_file import NotNegative, Positive, TomlFile, read_toml, strict
from gcs.faults import KINDS, settings_adapter
from gcs.mission.faults import fault_problems
from gcs.mission.model import RESTING_ALTITUDE, Fault, Limits, Lissajous, Name, WaypointsMotion
from gcs.mission.motion import moves_vertically
from gcs.mission.obstacle_table import ObstacleTable
from gcs.mission.route import Descend, Go, Place, Route, Step

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

    After the last point it returns to land on the pad, unless ``return_home`` is false: then it lands there.
    """

    kind: Literal["waypoints"]
    file: Annotated[str, Field(min_length=1)] | None = None
    points: Annotated[tuple[Vector, ...], Field(min_length=1, max_length=10_000)] | None = None
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
    limits: Limits | None = field(default=None)


_OTHER_FILES = {
    "campaign": "this is a campaign, no mission: gcs faults flies it",
    "uav": "this is a system file, no mission: it goes with --config",
}
_FAULT_KEYS = ("kind", "start", "duration", "every", "times", "vehicles", "direction")


@cache
def _adapter() -> TypeAdapter[MissionFile]:
    return TypeAdapter(MissionFile)


@cache
def _fault_adapter() -> TypeAdapter[Fault]:
    return TypeAdapter(Fault)


def read_mission_file(path: Path) -> tuple[TomlFile, MissionFile]:
    """Read and check the tables of a mission, without the files it names.

    Raises :class:`UnusableFile` with every reason found.
    """
    file = read_toml(path)
    data, faults = file.data, file.data.get("fault")
    for table, use in _OTHER_FILES.items():
        if table in data and "mission" not in data:
            raise UnusableFile([file.problem((table,), use)])
    if isinstance(faults, list):
        data = {**data, "fault": [_known_keys(fault) for fault in faults]}
    mission = file.validated(_adapter(), data)
    if isinstance(faults, list):  # the kinds' own keys, and the line of the fault
        mission = replace(
            mission,
            fault=tuple(
                replace(
                    fault,
                    settings=_kinds_keys(raw),
                    line=file.line(("fault", i)),
                )
                for i, (fault, raw) in enumerate(zip(mission.fault, faults, strict=True))
            ),
        )
    if problems := [*_fault_parameters(file, mission), *_disagreements(file, mission)]:
        raise UnusableFile(problems)
    return file, mission


def points_route(file: TomlFile, table: WaypointsTable, speed: float) -> Route:
    """The route through ``points``. Raises :class:`UnusableFile` for a point below the resting payload."""
    points = table.points or ()
    problems = [
        file.problem(("reference", "points", i), f"z = {z:g} m is below ground: at most {-RESTING_ALTITUDE:g} (down)")
        for i, (_, _, z) in enumerate(points)
        if z > -RESTING_ALTITUDE
    ]
    problems += [
        file.problem(("reference", "points", i), f"[{x:g}, {y:g}, {z:g}] is more than 10 km from home")
        for i, (x, y, z) in enumerate(points)
        if max(abs(x), abs(y), abs(z)) > 10_000.0
    ]
    if problems:
        raise UnusableFile(problems)
    return route_through(points, speed, table.hold or 0.0, return_home=table.return_home is not False)


def route_through(points: Sequence[Vector], speed: float, hold: float = 0.0, *, return_home: bool = True) -> Route:
    """From the pad through ``points`` (NED, m) at ``speed`` (m/s), and back to land on the pad or at the last one."""
    steps: list[Step] = [Go(f"point {i}", Place((x, y), -z), hold) for i, (x, y, z) in enumerate(points, start=1)]
    if not return_home:
        steps.append(Descend("end of mission", Place()))
    return Route(tuple(steps), speed, RESTING_ALTITUDE)


def check_faults(file: TomlFile, mission: MissionFile, system: SystemConfig) -> None:
    """Raises :class:`UnusableFile` for faults that do not agree with themselves or with the system."""
    problems = [
        file.problem(("fault", i, key), reason)
        for i, fault in enumerate(mission.fault)
        for key, reason in fault_problems(fault, system)
    ]
    if problems:
        raise UnusableFile(problems)


def _fault_parameters(file: TomlFile, mission: MissionFile) -> list[str]:
    """What is wrong with kinds and their parameters."""
    return [reason for i, fault in enumerate(mission.fault) for reason in _parameter_problems(file, i, fault)]


def _parameter_problems(file: TomlFile, index: int, fault: Fault) -> Sequence[str]:
    if fault.kind not in KINDS:
        near = get_close_matches(fault.kind, KINDS, 1)
        hint = f": did you mean '{near[0]}'?" if near else ": gcs faults --kinds lists them"
        return [file.problem(("fault", index, "kind"), f"there is no kind '{fault.kind}'{hint}")]
    try:
        file.validated(settings_adapter(fault.kind), dict(fault.settings), ("fault", index))
    except UnusableFile as error:
        return error.reasons
    return []


def read_fault(file: TomlFile, index: int, table: Mapping[str, Any]) -> Fault:
    """A fault from ``table``, which is the file's fault ``index`` (from 0).

    Raises :class:`UnusableFile` for unknown kinds and keys and for wrong values; whether the fault agrees with itself
    and with a system, :func:`gcs.mission.faults.fault_problems` checks.
    """
    fault = file.validated(_fault_adapter(), _known_keys(table), ("fault", index))
    fault = replace(fault, settings=_kinds_keys(table), line=file.line(("fault", index)))
    if problems := _parameter_problems(file, index, fault):
        raise UnusableFile(problems)
    return fault


def _kinds_keys(fault: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in fault.items() if key not in _FAULT_KEYS}


def _known_keys(fault: Any) -> Any:
    return {k: v for k, v in fault.items() if k in _FAULT_KEYS} if isinstance(fault, dict) else fault


def _disagreements(file: TomlFile, mission: MissionFile) -> list[str]:
    problems = []
    reference = mission.reference
    if isinstance(reference, WaypointsTable):
        if (reference.file is None) == (reference.points is None):
            problems.append(file.problem(("reference",), "needs either file or points"))
        if reference.file is not None and reference.hold is not None:
            problems.append(file.problem(("reference", "hold"), "goes with points; a waypoint file has its own"))
        if reference.file is not None and reference.return_home is not None:
            reason = "goes with points; a waypoint file says itself where it ends"
            problems.append(file.problem(("reference", "return_home"), reason))
    names = Counter(obstacle.name for obstacle in mission.obstacle)
    for i, obstacle in enumerate(mission.obstacle):
        if names[obstacle.name] > 1:
            reason = f"'{obstacle.name}' appears {names[obstacle.name]} times"
            problems.append(file.problem(("obstacle", i, "name"), reason))
        shape, motion = obstacle.shape, obstacle.motion
        if shape.is_grounded and motion is not None and moves_vertically(motion):
            reason = f"a {shape.kind} stands on the ground: no vertical motion"
            problems.append(file.problem(("obstacle", i, "motion"), reason))
        if isinstance(motion, WaypointsMotion):
            points = motion.points
            path = [*points, points[0]] if motion.repeat else points
            if any(a == b for a, b in pairwise(path)):
                reason = "two points after one another are the same"
                problems.append(file.problem(("obstacle", i, "motion"), reason))
    return problems
