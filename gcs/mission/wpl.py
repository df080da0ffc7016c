"""``QGC WPL 110``: the plain-text waypoint file of QGroundControl, Mission Planner and MAVProxy.

Format: https://mavlink.io/en/file_formats/ (twelve columns; row 0 is home).
"""

import math
import re
from pathlib import Path

from gcs.config.validate import UnusableFile
from gcs.mission.commands import AMSL_FRAMES, FRAMES, Command, command_name, frame_name
from gcs.mission.items import ITEM_LIMIT, PARAM_NAMES, FileHome, ItemError, MissionItem, WaypointFile

VERSION = "110"
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE | re.ASCII)
_COLUMNS = ("index", "current", "frame", "command", *PARAM_NAMES, "autocontinue")


def read_wpl(path: Path, text: str) -> WaypointFile:
    """Read the text of a WPL file. Raises :class:`UnusableFile` with every malformed row."""
    rows = [
        (number, cells)
        for number, line in enumerate(text.splitlines(), start=1)
        if (cells := line.partition("#")[0].split())
    ]
    _check_header(path, rows)
    items, problems = [], []
    for index, (line, cells) in enumerate(rows[1:]):
        try:
            items.append(_item(line, cells, index))
        except ItemError as problem:
            problems.append(f"{path}: line {line}: {problem}")
        if index > ITEM_LIMIT:
            problems.append(f"{path}: line {line}: more than {ITEM_LIMIT} rows")
            break
    if problems:
        raise UnusableFile(problems)
    if not items:
        raise UnusableFile([f"{path}: no rows after the header: home is missing, and every waypoint"])
    try:
        home = _home(items[0])
    except ItemError as problem:
        raise UnusableFile([f"{path}: {items[0].label}: {problem}"]) from problem
    if len(items) == 1:
        raise UnusableFile([f"{path}: only home: there is no waypoint"])
    return WaypointFile(home, tuple(items[1:]))


def _check_header(path: Path, rows: list[tuple[int, list[str]]]) -> None:
    if not rows:
        raise UnusableFile([f"{path}: only comments: the header 'QGC WPL {VERSION}' is missing"])
    line, header = rows[0]
    if header[:2] != ["QGC", "WPL"] or len(header) != 3:
        raise UnusableFile([f"{path}: line {line}: header: expected 'QGC WPL {VERSION}', found '{' '.join(header)}'"])
    if header[2] != VERSION:
        raise UnusableFile([f"{path}: line {line}: header: version {header[2]} is not supported, only {VERSION}"])


def _item(line: int, cells: list[str], expected_index: int) -> MissionItem:
    if len(cells) != len(_COLUMNS):
        raise ItemError("row", f"{len(cells)} columns, expected {len(_COLUMNS)}")
    values = {}
    for name, cell in zip(_COLUMNS, cells, strict=True):
        if not _NUMBER.fullmatch(cell):
            raise ItemError(name, f"'{cell}' is not a number")
        value = float(cell)
        if math.isinf(value):
            raise ItemError(name, "is not finite")
        values[name] = None if math.isnan(value) else value
    index, current, frame, command, autocontinue = (
        _integer(values[name], name) for name in ("index", "current", "frame", "command", "autocontinue")
    )
    if index != expected_index:
        reason = "row 0, which is home, is missing" if expected_index == 0 else "jumps could not be followed"
        raise ItemError("index", f"{index}, expected {expected_index}: {reason}")
    for name, flag in (("current", current), ("autocontinue", autocontinue)):
        if flag not in (0, 1):
            raise ItemError(name, f"{flag} is neither 0 nor 1")
    params = tuple(values[name] for name in PARAM_NAMES)
    return MissionItem(f"line {line}: row {index}", index, frame, command, params, bool(autocontinue))


def _integer(value: float | None, name: str) -> int:
    if value is None or value != int(value) or value < 0:
        raise ItemError(name, f"{value} is not a whole number")
    return int(value)


def _home(item: MissionItem) -> FileHome:
    if item.command != Command.NAV_WAYPOINT:
        reason = f"row 0 must be home, a NAV_WAYPOINT; {command_name(item.command)} is not: home is missing"
        raise ItemError("command", reason)
    if item.frame not in FRAMES:
        raise ItemError("frame", f"{frame_name(item.frame)}, is not supported in a mission")
    latitude, longitude, altitude = item.params[4:7]
    if latitude is None or longitude is None:
        raise ItemError("latitude, longitude", "home gives no place")
    return FileHome(latitude, longitude, altitude if item.frame in AMSL_FRAMES else None)
