"""QGroundControl's ``.plan``.

Format: https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/plan.html. Complex items (surveys and the
like) are flown by the simple items that are stored with them.
"""

import json
import math
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from gcs.config.text_file import why_unparsed
from gcs.config.validate import Key, UnusableFile, dotted, shown, validated
from gcs.mission.fence import (
    Exclusion,
    Fence,
    boundary_of,
    circle_corners,
    encloses_area,
    excluded_circle,
    excluded_polygon,
)
from gcs.mission.items import (
    ITEM_LIMIT,
    PARAM_NAMES,
    FileHome,
    Firmware,
    ItemError,
    MissionItem,
    WaypointFile,
    nothing_to_fly,
)
from idc_controller.geometry.free_space import Ring

CORNER_LIMIT = 500
FIXED_WING = 1
"""MAV_TYPE of a plan's ``vehicleType`` for which its ``hoverSpeed`` has no meaning."""
_FIRMWARES: dict[int | None, Firmware] = {3: "ardupilot", 12: "px4"}
"""MAV_AUTOPILOT of a plan's ``firmwareType``; the others are not known to fly an item in a way of their own."""


def _supported(*versions: int) -> AfterValidator:
    def check(version: int) -> int:
        if version not in versions:
            raise ValueError(f"{version} is not supported, only {' or '.join(map(str, versions))}")
        return version

    return AfterValidator(check)


def _finite(value: float | None) -> float | None:
    """Return a parameter, None for NaN: not given."""
    if value is not None and math.isinf(value):
        raise ValueError("is not finite")
    return None if value is None or math.isnan(value) else value


Number = Annotated[float | None, AfterValidator(_finite)]
Natural = Annotated[int, Field(ge=0, lt=2**32)]
Place = Annotated[list[float], Field(min_length=2, max_length=3)]


class _Object(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True, defer_build=True)


class _SimpleItem(_Object):
    type: Literal["SimpleItem"]
    frame: Natural
    command: Natural
    params: Annotated[list[Number], Field(min_length=len(PARAM_NAMES), max_length=len(PARAM_NAMES))]
    doJumpId: Natural | None = None
    autoContinue: bool = True


class _Transects(_Object):
    version: Annotated[int, _supported(1, 2)]
    Items: Annotated[list[_SimpleItem], Field(min_length=1)]


class _Complex(_Object):
    type: Literal["ComplexItem"]
    TransectStyleComplexItem: _Transects


class _Survey(_Complex):
    complexItemType: Literal["survey"]
    version: Annotated[int, _supported(4, 5)]


class _CorridorScan(_Complex):
    complexItemType: Literal["CorridorScan"]
    version: Annotated[int, _supported(2)]


class _StructureScan(_Complex):
    complexItemType: Literal["StructureScan"]
    version: Annotated[int, _supported(2, 3)]


_ComplexItem = Annotated[_Survey | _CorridorScan | _StructureScan, Field(discriminator="complexItemType")]


class _Mission(_Object):
    version: Annotated[int, _supported(2)]
    firmwareType: int | None = None
    vehicleType: int | None = None
    hoverSpeed: Number = None
    plannedHomePosition: Annotated[list[Number], Field(min_length=2, max_length=3)]
    items: list[Annotated[_SimpleItem | _ComplexItem, Field(discriminator="type")]]


class _Circle(_Object):
    center: Place
    radius: Annotated[float, Field(gt=0.0, lt=1e5)]


class _FencePart(_Object):
    version: Annotated[int, _supported(1)]
    inclusion: bool


class _FenceCircle(_FencePart):
    circle: _Circle


class _FencePolygon(_FencePart):
    polygon: Annotated[list[Place], Field(min_length=3, max_length=CORNER_LIMIT)]


def _is_filled(section: Any) -> bool:
    return isinstance(section, dict) and any(value for value in section.values() if isinstance(value, list))


def _unless_empty(section: Any) -> Any:
    """Return a fence or rally points to be read; None where they are empty, whatever their version."""
    if not isinstance(section, dict):
        return section
    if not _is_filled(section):
        return None
    if section.get("version") != 2:
        raise ValueError(f"version {shown(section.get('version'))} is not supported, only 2")
    return section


class _GeoFence(_Object):
    circles: list[_FenceCircle] = []
    polygons: list[_FencePolygon] = []


class _RallyPoints(_Object):
    points: list[Any] = []


class _Plan(_Object):
    fileType: Literal["Plan"]
    version: Annotated[int, _supported(1)]
    mission: _Mission
    geoFence: Annotated[_GeoFence | None, BeforeValidator(_unless_empty)] = None
    rallyPoints: Annotated[_RallyPoints | None, BeforeValidator(_unless_empty)] = None


def read_plan(path: Path, text: str) -> WaypointFile:
    """Read the text of a plan. Raises :class:`UnusableFile` with every reason found."""

    def problem(key: Key, reason: str) -> str:
        if key[:2] == ("mission", "items") and len(key) > 2:  # as notes and later errors name it
            places = [f"item {int(key[2]) + 1}", *([dotted(key[3:])] if key[3:] else [])]
            return f"{path}: {': '.join(places)}: {reason}"
        return f"{path}: {dotted(key)}: {reason}"

    plan = validated(_Plan, _parse(path, text), problem)
    items = list(islice(_simple_items(plan.mission), ITEM_LIMIT + 1))
    problems = []
    if reason := nothing_to_fly(items):
        raise UnusableFile([problem(("mission", "items"), reason)])
    if len(items) > ITEM_LIMIT:
        problems.append(problem(("mission", "items"), f"more than {ITEM_LIMIT} items"))
    fence, notes = Fence(), []
    firmware = _FIRMWARES.get(plan.mission.firmwareType)
    try:
        home = _home(*plan.mission.plannedHomePosition)
    except ItemError as error:
        raise UnusableFile([*problems, problem(("mission", "plannedHomePosition"), str(error))]) from error
    try:
        fence = _fence(plan.geoFence, home, firmware) if plan.geoFence else fence
    except ItemError as error:
        problems.append(f"{path}: geoFence: {error}")
    if problems:
        raise UnusableFile(problems)
    if plan.rallyPoints and plan.rallyPoints.points:
        notes.append(f"rallyPoints: {len(plan.rallyPoints.points)} left out: the payload returns to its pad")
    numbers = [item.number for item in items if item.number is not None]
    if len(set(numbers)) < len(numbers):
        notes.append("doJumpId: some appear twice: the items are flown in the order of the file")
    hover = plan.mission.hoverSpeed or 0.0
    speed = hover if hover > 0.0 and plan.mission.vehicleType != FIXED_WING else None
    return WaypointFile(home, tuple(items), fence, tuple(notes), firmware, speed)


def _parse(path: Path, text: str) -> Any:
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        line = f"line {error.lineno}: " if isinstance(error, json.JSONDecodeError) else ""
        raise UnusableFile([f"{path}: {line}not valid JSON: {why_unparsed(error)}"]) from error
    if not isinstance(document, dict):
        raise UnusableFile([f"{path}: not a plan: no JSON object"])
    if document.get("fileType") == "Mission" or "complexItems" in document or "MAV_AUTOPILOT" in document:
        reason = "an old .mission file of QGroundControl: open it there and save it as .plan"
        raise UnusableFile([f"{path}: {reason}"])
    mission = document.get("mission")
    if _is_filled(document.get("geoFence")) and not (isinstance(mission, dict) and mission.get("items")):
        raise UnusableFile([f"{path}: a fence, not a mission: nothing to fly"])
    return document


def _home(latitude: float | None, longitude: float | None, altitude: float | None = None) -> FileHome:
    if latitude is None or longitude is None:
        raise ItemError("latitude, longitude", "home gives no place")
    return FileHome(latitude, longitude, altitude)


def _simple_items(mission: _Mission) -> Iterator[MissionItem]:
    for number, item in enumerate(mission.items, start=1):
        if isinstance(item, _SimpleItem):
            yield _item(f"item {number}", item)
        else:
            for i, stored in enumerate(item.TransectStyleComplexItem.Items, start=1):
                yield _item(f"item {number}.{i}", stored)


def _item(where: str, raw: _SimpleItem) -> MissionItem:
    return MissionItem(where, raw.doJumpId, raw.frame, raw.command, tuple(raw.params), raw.autoContinue)


def _fence(section: _GeoFence, home: FileHome, firmware: Firmware | None) -> Fence:
    """Return the fence: of several inclusion areas, ArduPilot's ``firmware`` takes what is common, any other all."""
    included: list[Ring] = []
    excluded: list[Exclusion] = []
    for number, circle in enumerate(section.circles, start=1):
        (centre,) = _places(f"circles[{number}].center", [circle.circle.center], home)
        if circle.inclusion:
            included.append(circle_corners(centre, circle.circle.radius))
        else:
            excluded.append(excluded_circle(f"fence circle {number}", centre, circle.circle.radius))
    for number, polygon in enumerate(section.polygons, start=1):
        corners = _places(f"polygons[{number}].polygon", polygon.polygon, home)
        if not encloses_area(corners):
            raise ItemError(f"polygons[{number}].polygon", "has no area, or crosses itself")
        if polygon.inclusion:
            included.append(corners)
        else:
            excluded.append(excluded_polygon(f"fence polygon {number}", corners))
    boundary = boundary_of(included, common=firmware == "ardupilot") if included else ()
    if included and not boundary:
        raise ItemError("inclusion", f"the {len(included)} areas have nothing in common")
    return Fence(boundary, tuple(excluded))


def _places(where: str, corners: list[Place], home: FileHome) -> Ring:
    try:
        return tuple(home.north_east(*corner[:2]) for corner in corners)
    except ItemError as error:
        raise ItemError(where, str(error)) from error
