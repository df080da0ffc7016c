"""Read a mission of any of the three formats, with the system it is flown by."""

from __future__ import annotations

from pathlib import Path

from gcs.config import SystemConfig, UnusableFile, read_system
from gcs.config.text_file import read_text
from gcs.mission.compile import compile_route
from gcs.mission.content import WaypointFile
from gcs.mission.model import DEFAULT_HOME, Home, Lissajous, Mission
from gcs.mission.plan import read_plan
from gcs.mission.route import Route
from gcs.mission.toml_mission import DEFAULT_SEED, check_faults, points_route, read_mission_file
from gcs.mission.wpl import read_wpl

_SUFFIXES = {".waypoints": "wpl", ".txt": "wpl", ".plan": "plan", ".json": "plan", ".toml": "toml"}


def read_mission(path: Path | str, config_path: Path | str | None = None) -> Mission:
    """Read a mission: ``.toml``, ``QGC WPL 110`` or QGroundControl ``.plan``, recognised by their content.

    The system comes from ``config_path``, else from the file that the mission names, else from ``system.toml`` beside
    the mission, else the default system.

    Raises :class:`UnusableFile` (a :class:`gcs.errors.UnusableInput`) with every reason found.
    """
    path = Path(path)
    config = None if config_path is None else Path(config_path)
    text = read_text(path)
    if mission_format(path, text) == "toml":
        return _from_toml(path, config)
    system = _system(path, None, config)
    file = _waypoint_file(path, text)
    reference, notes = compile_route(path, file, system.motion, system.motion.speed)
    return Mission(
        path.stem, path, DEFAULT_SEED, system, reference, _home(file), file.fence.obstacles, file.fence.boundary,
        notes=(*notes, *_home_notes(file)),
    )  # fmt: skip


def mission_format(path: Path, text: str) -> str:
    """``wpl``, ``plan`` or ``toml``: by content where possible, else by suffix."""
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


def _waypoint_file(path: Path, text: str) -> WaypointFile:
    kind = mission_format(path, text)
    if kind == "toml":
        raise UnusableFile([f"{path}: neither a QGC WPL file nor a QGroundControl plan"])
    return read_wpl(path, text) if kind == "wpl" else read_plan(path, text)


def _from_toml(path: Path, config: Path | None) -> Mission:
    file, table = read_mission_file(path)
    named = table.mission.system
    if config is None and named is not None and not (path.parent / named).is_file():
        raise UnusableFile([file.problem(("mission", "system"), f"there is no file {named}")])
    system = _system(path, named, config)
    check_faults(file, table, system)
    reference: Lissajous | Route
    home, obstacles, boundary, notes = DEFAULT_HOME, table.obstacle, None, []
    if isinstance(table.reference, Lissajous):
        reference = table.reference
    else:
        speed = system.motion.speed if table.reference.speed is None else table.reference.speed
        if speed > system.motion.speed_max:
            notes.append(f"reference.speed: {speed:g} m/s capped to speed_max, {system.motion.speed_max:g} m/s")
            speed = system.motion.speed_max
        if table.reference.file is None:
            reference = points_route(file, table.reference, speed)
        else:
            waypoint_path = path.parent / table.reference.file
            if not waypoint_path.is_file():
                reason = f"there is no file {table.reference.file}"
                raise UnusableFile([file.problem(("reference", "file"), reason)])
            waypoints = _waypoint_file(waypoint_path, read_text(waypoint_path))
            reference, more = compile_route(waypoint_path, waypoints, system.motion, speed)
            notes += [*more, *_home_notes(waypoints)]
            home, boundary = _home(waypoints), waypoints.fence.boundary
            obstacles = (*obstacles, *waypoints.fence.obstacles)
    return Mission(
        table.mission.name, path, table.mission.seed, system, reference, home, obstacles, boundary,
        table.fault, table.limits, tuple(notes),
    )  # fmt: skip


def _system(mission: Path, named: str | None, config: Path | None) -> SystemConfig:
    return read_system(system_path(mission, named, config))


def system_path(mission: Path, named: str | None = None, config: Path | None = None) -> Path | None:
    """Return the system file by which ``mission``, which may have ``named`` one, is flown; None: the default system."""
    if config is not None:
        return config
    beside = mission.parent / (named or "system.toml")
    return beside if named is not None or beside.is_file() else None


def _home(file: WaypointFile) -> Home:
    altitude = file.home.altitude
    return Home(file.home.latitude, file.home.longitude, DEFAULT_HOME.altitude if altitude is None else altitude)


def _home_notes(file: WaypointFile) -> tuple[str, ...]:
    if file.home.altitude is not None:
        return ()
    return (f"home: altitude not given: {DEFAULT_HOME.altitude:g} m above mean sea level",)
