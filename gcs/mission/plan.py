"""QGroundControl's ``.plan``.

Format: https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from gcs.config import UnusableFile
from gcs.mission.content import ITEM_LIMIT, Fence, FileHome, WaypointFile
from gcs.mission.fence import read_fence
from gcs.mission.geodesy import check_latitude_longitude
from gcs.mission.items import PARAM_NAMES, ItemError, MissionItem, param

VERSIONS = {"plan": 1, "mission": 2, "geoFence": 2, "rallyPoints": 2}
COMPLEX_VERSIONS = {"survey": (4, 5), "CorridorScan": (2,), "StructureScan": (2, 3)}
TRANSECT_VERSIONS = (1, 2)


def read_plan(path: Path, text: str) -> WaypointFile:
    """Read the text of a plan. Raises :class:`UnusableFile` with every reason found."""
    document = _parse(path, text)
    problems: list[str] = []

    def attempt(where: str, read: Any, *arguments: Any) -> Any:
        try:
            return read(*arguments)
        except ItemError as problem:
            problems.append(f"{path}: {where}: {problem}")

    attempt("plan", _check_plan, document)
    sections = {name: attempt(name, _section, document, name) or {} for name in ("mission", "geoFence", "rallyPoints")}
    items, notes = [], []
    home = None
    if sections["mission"]:
        home = attempt("mission", _home, sections["mission"])
        for where, raw in _simple_items(path, sections["mission"], problems):
            if item := attempt(where, _item, where, raw):
                items.append(item)
        if not items and not problems:
            problems.append(f"{path}: mission: items: there is no waypoint")
    fence = Fence()
    if home is not None and sections["geoFence"]:
        fence = attempt("geoFence", read_fence, sections["geoFence"], home) or fence
    points = sections["rallyPoints"].get("points")
    if isinstance(points, list) and points:
        notes.append(f"rallyPoints: {len(points)} left out: the payload returns to its pad")
    if problems or home is None:
        raise UnusableFile(problems)
    return WaypointFile(home, tuple(items), fence, tuple(notes))


def _parse(path: Path, text: str) -> dict[str, Any]:
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise UnusableFile([f"{path}: line {error.lineno}: not valid JSON: {error.msg}"]) from error
    except (ValueError, RecursionError) as error:
        reason = "nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise UnusableFile([f"{path}: not valid JSON: {reason}"]) from error
    if not isinstance(document, dict):
        raise UnusableFile([f"{path}: not a plan: no JSON object"])
    return document


def _check_plan(document: dict[str, Any]) -> None:
    if document.get("fileType") != "Plan":
        raise ItemError("fileType", f'{_shown(document.get("fileType"))}, expected "Plan"')
    _check_version(document, (VERSIONS["plan"],))


def _check_version(table: dict[str, Any], supported: tuple[int, ...]) -> None:
    version = table.get("version")
    if isinstance(version, bool) or version not in supported:
        known = " or ".join(map(str, supported))
        raise ItemError("version", f"{_shown(version)} is not supported, only {known}")


def _section(document: dict[str, Any], name: str) -> dict[str, Any]:
    section = document.get(name)
    if section is None and name != "mission":
        return {}
    if section is None:
        raise ItemError("mission", "missing: there is nothing to fly")
    if not isinstance(section, dict):
        raise ItemError(name, "must be an object")
    _check_version(section, (VERSIONS[name],))
    return section


def _home(mission: dict[str, Any]) -> FileHome:
    key = "plannedHomePosition"
    home = mission.get(key)
    if home is None:
        raise ItemError(key, "missing: altitudes are above it")
    if not isinstance(home, list) or len(home) not in (2, 3):
        raise ItemError(key, "expected [latitude, longitude, altitude]")
    latitude, longitude, altitude = (_number(v, key) for v in [*home, None][:3])
    if latitude is None or longitude is None or (latitude == 0.0 and longitude == 0.0):
        raise ItemError(key, "gives no place")
    check_latitude_longitude(latitude, longitude)
    return FileHome(latitude, longitude, altitude)


def _simple_items(path: Path, mission: dict[str, Any], problems: list[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The simple items in the order of flight, each with its name; complex items by the items stored in them."""
    items = mission.get("items")
    if not isinstance(items, list):
        problems.append(f"{path}: mission: items: missing, or not a list")
        return
    count = 0
    for position, raw in enumerate(items, start=1):
        where = f"item {position}"
        try:
            if not isinstance(raw, dict):
                raise ItemError("type", "must be an object")
            if raw.get("type") == "SimpleItem":
                found = [(where, raw)]
            elif raw.get("type") == "ComplexItem":
                found = [(f"{where}.{i}", inner) for i, inner in enumerate(_stored_items(raw), start=1)]
            else:
                raise ItemError("type", f"{_shown(raw.get('type'))}, expected SimpleItem or ComplexItem")
        except ItemError as problem:
            problems.append(f"{path}: {where}: {problem}")
            continue
        count += len(found)
        if count > ITEM_LIMIT:
            problems.append(f"{path}: {where}: more than {ITEM_LIMIT} items")
            return
        yield from found


def _stored_items(raw: dict[str, Any]) -> list[dict[str, Any]]:
    kind = raw.get("complexItemType")
    if not isinstance(kind, str) or kind not in COMPLEX_VERSIONS:
        raise ItemError("complexItemType", f"{_shown(kind)} is not supported")
    _check_version(raw, COMPLEX_VERSIONS[kind])
    transects = raw.get("TransectStyleComplexItem")
    if not isinstance(transects, dict) or not transects.get("Items"):
        raise ItemError("TransectStyleComplexItem.Items", f"missing: a {kind} is flown by the items stored with it")
    _check_version(transects, TRANSECT_VERSIONS)
    items = transects["Items"]
    if not isinstance(items, list) or not all(isinstance(i, dict) and i.get("type") == "SimpleItem" for i in items):
        raise ItemError("TransectStyleComplexItem.Items", "expected a list of SimpleItem")
    return items


def _item(where: str, raw: dict[str, Any]) -> MissionItem:
    params = raw.get("params")
    if not isinstance(params, list) or len(params) != len(PARAM_NAMES):
        raise ItemError("params", f"expected a list of {len(PARAM_NAMES)}")
    jump_id = raw.get("doJumpId")
    autocontinue = raw.get("autoContinue", True)
    if not isinstance(autocontinue, bool):
        raise ItemError("autoContinue", f"{_shown(autocontinue)} is neither true nor false")
    return MissionItem(
        where,
        None if jump_id is None else _integer(jump_id, "doJumpId"),
        _integer(raw.get("frame"), "frame"),
        _integer(raw.get("command"), "command"),
        tuple(_number(v, f"params[{i}] ({PARAM_NAMES[i]})") for i, v in enumerate(params)),
        autocontinue,
    )


def _integer(value: Any, name: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ItemError(name, "missing" if value is None else f"{_shown(value)} is not a whole number")
    return value


def _number(value: Any, name: str) -> float | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ItemError(name, f"{_shown(value)} is not a number")
    try:
        return param(float(value), name)
    except OverflowError:
        raise ItemError(name, "is not finite") from None


def _shown(value: Any) -> str:
    """A value from the file, short enough for a message."""
    try:
        text = json.dumps(value)
    except (ValueError, RecursionError):
        text = type(value).__name__
    return text if len(text) <= 40 else text[:37] + "..."
