"""``QGC WPL 110``: the plain-text waypoint file of QGroundControl, Mission Planner and MAVProxy.

Format: https://mavlink.io/en/file_formats/ (twelve columns). Row 0 is home where ArduPilot's ground stations write the
file, and the first item where it is a list of PX4's items.
"""

import math
import re
from pathlib import Path

from gcs.config.validate import UnusableFile
from gcs.mission.commands import AMSL_FRAMES, FRAMES, Command
from gcs.mission.items import (
    ITEM_LIMIT,
    PARAM_NAMES,
    FileHome,
    ItemError,
    MissionItem,
    WaypointFile,
    first_position,
    nothing_to_fly,
)

VERSIONS = ("110", "120")
"""Of the same columns."""
HOME_COMMANDS = (0, Command.NAV_WAYPOINT)
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
            items.append(_item(line, cells))
        except ItemError as problem:
            problems.append(f"{path}: line {line}: {problem}")
        if index > ITEM_LIMIT:
            problems.append(f"{path}: line {line}: more than {ITEM_LIMIT} rows")
            break
    if problems:
        raise UnusableFile(problems)
    if not items:
        raise UnusableFile([f"{path}: no rows after the header: home is missing, and every waypoint"])
    first, notes = items[0], []
    has_home = _is_home(first)
    flown = items[1:] if has_home else items
    if reason := nothing_to_fly(flown):
        raise UnusableFile([f"{path}: {reason}"])
    row = first if has_home and first.has_position else first_position(flown)
    if row is None:
        raise UnusableFile([f"{path}: home: no row gives a place"])
    if row is not first or not has_home:
        why = "row 0 gives no place" if has_home else "no home row, the first row is an item, as in PX4's files"
        notes.append(f"home: {why}: on the ground below {row.label}")
    try:
        home = _home(row, has_altitude=row is first and has_home and row.frame in AMSL_FRAMES)
    except ItemError as problem:
        raise UnusableFile([f"{path}: {row.label}: {problem}"]) from problem
    first_number = first.number or 0
    if [item.number for item in items] != [*range(first_number, first_number + len(items))]:
        notes.append("index: rows are missing or repeated: they are flown in the order of the file")
    return WaypointFile(home, tuple(flown), notes=tuple(notes), firmware="ardupilot" if has_home else "px4")


def _check_header(path: Path, rows: list[tuple[int, list[str]]]) -> None:
    if not rows:
        raise UnusableFile([f"{path}: only comments: the header 'QGC WPL {VERSIONS[0]}' is missing"])
    line, header = rows[0]
    if header[:2] != ["QGC", "WPL"] or len(header) != 3:
        raise UnusableFile(
            [f"{path}: line {line}: header: expected 'QGC WPL {VERSIONS[0]}', found '{' '.join(header)}'"]
        )
    if header[2] not in VERSIONS:
        raise UnusableFile(
            [f"{path}: line {line}: header: version {header[2]} is not supported, only {' or '.join(VERSIONS)}"]
        )


def _item(line: int, cells: list[str]) -> MissionItem:
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
    for name, flag in (("current", current), ("autocontinue", autocontinue)):
        if flag not in (0, 1):
            raise ItemError(name, f"{flag} is neither 0 nor 1")
    params = tuple(values[name] for name in PARAM_NAMES)
    return MissionItem(f"line {line}: row {index}", index, frame, command, params, bool(autocontinue))


def _integer(value: float | None, name: str) -> int:
    if value is None or value != int(value) or value < 0:
        raise ItemError(name, f"{value} is not a whole number")
    return int(value)


def _is_home(row: MissionItem) -> bool:
    """Whether the first row is ArduPilot's home; else it is PX4's first item.

    Home is row 0, a waypoint or nothing, at an altitude above sea level or on the ground.
    """
    on_ground = row.frame in FRAMES and not row.params[6]
    return row.number == 0 and row.command in HOME_COMMANDS and (row.frame in AMSL_FRAMES or on_ground)


def _home(row: MissionItem, *, has_altitude: bool) -> FileHome:
    latitude, longitude, altitude = row.params[4:7]
    assert latitude is not None and longitude is not None  # for the type checker: the row has a position
    return FileHome(latitude, longitude, altitude if has_altitude else None)
