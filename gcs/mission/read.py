"""Read a mission of any of the three formats, with the system it is flown by."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from gcs.config import SystemConfig, UnusableFile, read_system
from gcs.config.overrides import with_settings
from gcs.config.text_file import read_text
from gcs.config.toml_file import ParsedFile
from gcs.config.validate import Key
from gcs.mission.model import DEFAULT_HOME, Home, Lissajous, Mission
from gcs.mission.own import named
from gcs.mission.reasons import merged
from gcs.mission.route import Route
from gcs.mission.toml_mission import DEFAULT_SEED, check_with_system, points_route, read_mission_file

_SUFFIXES = {".waypoints": "wpl", ".txt": "wpl", ".plan": "plan", ".json": "plan", ".toml": "toml"}


def read_mission(
    path: Path | str, config_path: Path | str | None = None, settings: Mapping[str, Any] | None = None
) -> Mission:
    """Read a mission: ``.toml``, ``QGC WPL 110`` or QGroundControl ``.plan``, recognised by their content.

    ``path`` may be the name of one of the package's own (:mod:`gcs.mission.own`). The system comes from
    ``config_path``, else from the file that the mission names, else from ``system.toml`` beside the mission, else the
    default system; ``settings`` by dotted path take the place of its own.

    Raises :class:`UnusableFile` (a :class:`gcs.errors.UnusableInput`) with every reason found.
    """
    path = named(path)
    config = None if config_path is None else Path(config_path)
    text = read_text(path)
    if mission_format(path, text) == "toml":
        return _from_toml(path, config, settings or {})
    system = with_settings(_system(path, None, config), settings or {})
    return _from_waypoints(path, text, system)


def mission_format(path: Path, text: str) -> str:
    """Return ``wpl``, ``plan`` or ``toml``: by content where possible, else by suffix."""
    first = next((line for line in map(str.strip, text.splitlines()) if line and not line.startswith("#")), "")
    if first.startswith("QGC"):
        return "wpl"
    if first.startswith("{"):
        return "plan"
    if kind := _SUFFIXES.get(path.suffix.lower()):
        return kind
    if first.startswith("[") or "=" in first:
        return "toml"
    raise UnusableFile([f"{path}: not a mission: neither QGC WPL, nor a QGroundControl plan, nor TOML"])


def _from_waypoints(path: Path, text: str, system: SystemConfig, speed: float | None = None) -> Mission:
    """Return the mission of a waypoint file, flown at ``speed`` (m/s), else the file's own, where items name none."""
    # Spent only where there are waypoints.
    from gcs.mission.compile import compile_route
    from gcs.mission.plan import read_plan
    from gcs.mission.wpl import read_wpl

    kind = mission_format(path, text)
    if kind == "toml":
        raise UnusableFile([f"{path}: neither a QGC WPL file nor a QGroundControl plan"])
    with _reasons_merged(path):
        file = read_wpl(path, text) if kind == "wpl" else read_plan(path, text)
        capped = tuple[str, ...]()
        if speed is None:
            speed, capped = _capped("hoverSpeed", file.speed, system)
        route, notes = compile_route(path, file, system, speed)
    notes = (*capped, *merged(notes))
    altitude = file.home.altitude
    if altitude is None:
        altitude = DEFAULT_HOME.altitude
        notes += (f"home: altitude not given: {altitude:g} m above mean sea level",)
    home = Home(file.home.latitude, file.home.longitude, altitude)
    fence = file.fence
    return Mission(
        path.stem, path, DEFAULT_SEED, system, route, home, fence.obstacles, fence.boundary, fence.excluded, notes=notes
    )  # fmt: skip


@contextmanager
def _reasons_merged(path: Path) -> Iterator[None]:
    try:
        yield
    except UnusableFile as error:
        prefix = f"{path}: "
        reasons = merged(reason.removeprefix(prefix) for reason in error.reasons)
        raise UnusableFile([prefix + reason for reason in reasons]) from error


def mission_of_plan(path: Path, text: str, world: Mission) -> Mission:
    """Return the mission of a plan's ``text`` in ``world``, whose system, home and obstacles it is flown by.

    It holds where a mission without a landing ends. Raises :class:`UnusableFile`, its reasons with ``path``.
    """
    mission = _from_waypoints(path, text, world.system)
    assert isinstance(mission.reference, Route)
    return replace(
        world,
        name=path.stem,
        path=path,
        reference=replace(mission.reference, holds_at_end=True),
        obstacles=(*world.obstacles, *mission.obstacles),
        boundary=mission.boundary,
        excluded=mission.excluded,
        faults=(),
        notes=mission.notes,
    )


def _from_toml(path: Path, config: Path | None, settings: Mapping[str, Any]) -> Mission:
    file, table = read_mission_file(path)
    if config is None and table.mission.system is not None:
        _beside(file, ("mission", "system"), table.mission.system)
    system = with_settings(_system(path, table.mission.system, config), settings)
    check_with_system(file, table, system)
    reference, capped = table.reference, tuple[str, ...]()
    if isinstance(reference, Lissajous):
        mission = Mission(path.stem, path, DEFAULT_SEED, system, reference)
    else:
        speed, capped = _capped("reference.speed", reference.speed, system)
        if reference.file is None:
            mission = Mission(path.stem, path, DEFAULT_SEED, system, points_route(file, reference, speed, system))
        else:
            waypoints = _beside(file, ("reference", "file"), reference.file)
            mission = _from_waypoints(waypoints, read_text(waypoints), system, reference.speed and speed)
    return replace(
        mission,
        name=table.mission.name,
        path=path,
        seed=table.mission.seed,
        obstacles=(*table.obstacle, *mission.obstacles),
        faults=table.fault,
        limits=table.limits,
        notes=(*capped, *mission.notes),
    )


def _capped(name: str, speed: float | None, system: SystemConfig) -> tuple[float, tuple[str, ...]]:
    """Return the speed that is flown (m/s), the system's own where none is given, and a note where it is capped."""
    highest = system.motion.speed_max
    if speed is None:
        return system.motion.speed, ()
    if speed > highest:
        return highest, (f"{name}: {speed:g} m/s capped to speed_max, {highest:g} m/s",)
    return speed, ()


def _beside(file: ParsedFile, key: Key, name: str) -> Path:
    """Return the path of a file that stands beside the mission that names it."""
    path = file.path.parent / name
    if not path.is_file():
        raise UnusableFile([file.problem(key, f"there is no file {name}")])
    return path


def _system(mission: Path, named: str | None, config: Path | None) -> SystemConfig:
    """Return the system by which ``mission``, which may have ``named`` one, is flown."""
    beside = mission.parent / (named or "system.toml")
    return read_system(config or (beside if named is not None or beside.is_file() else None))
