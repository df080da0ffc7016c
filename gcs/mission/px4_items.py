"""What a vehicle by itself takes of an uploaded plan: what PX4 takes, as far as it is flown or may be left out here.

The sets of commands are those of PX4's ``mavlink_mission.cpp``; what their parameters may be is in
:mod:`.item_parameters`, for these vehicles as for a team with its payload.
"""

from collections.abc import Sequence

from gcs.mission.commands import (
    FENCE_AND_RALLY,
    LEFT_OUT,
    RALLY_POINT,
    Command,
    Frame,
    frame_name,
)
from gcs.mission.flow import loop_in
from gcs.mission.item_parameters import (
    check_numbers,
    check_place,
    delay,
    repeats,
    seconds,
    speed_change,
    take_off_altitude,
    whole,
)
from gcs.mission.items import FileHome, ItemError, MissionItem, nothing_to_fly

PLACED_FRAMES = frozenset({Frame.GLOBAL, Frame.GLOBAL_RELATIVE_ALT, Frame.GLOBAL_INT, Frame.GLOBAL_RELATIVE_ALT_INT})
"""Frames of PX4's items with a place; the terrain frames are ArduPilot's."""

FLOWN_TO = frozenset(
    {
        Command.NAV_WAYPOINT,
        Command.NAV_LOITER_UNLIM,
        Command.NAV_LOITER_TIME,
        Command.NAV_LAND,
        Command.NAV_TAKEOFF,
        Command.NAV_LOITER_TO_ALT,
        Command.CONDITION_GATE,
    }
)
"""Commands with a place that a vehicle flies to."""

DONE = frozenset(
    {
        Command.NAV_RETURN_TO_LAUNCH,
        Command.NAV_DELAY,
        Command.CONDITION_DELAY,
        Command.DO_CHANGE_SPEED,
        Command.DO_JUMP,
    }
)
"""Commands without a place that a vehicle carries out."""

_ROI = frozenset({80, 201})
_ROI_LOCATION = 195
"""Regions of interest that are left out; the last one has a place always."""
_OTHER_DEVICES = frozenset(
    {
        187, 189, 196, 197, 200, 203, 204, 205, 206, 211, 214, 260, 530, 531, 532, 534, 1000, 1001, 2000, 2001, 2003,
        2500, 2501, 42600,
    }
)  # fmt: skip
"""Commands to devices that are left out, and marks, without a place."""
_CARGO = frozenset({Command.DO_GRIPPER, Command.DO_WINCH})
"""Commands to the payload unit, which a vehicle by itself does not have."""
LEFT_OUT_HERE = (LEFT_OUT | _CARGO) & (_ROI | {_ROI_LOCATION} | _OTHER_DEVICES)
"""Commands that are taken, as by PX4, and that do nothing here."""

_COMMANDS = dict.fromkeys(PLACED_FRAMES, FLOWN_TO | _ROI | {_ROI_LOCATION}) | {
    Frame.MISSION: DONE | _OTHER_DEVICES | _ROI
}
"""Commands by the frame that PX4 takes them in."""

VERTICES = frozenset({5001, 5002})
"""Corners of inclusion and exclusion polygons: parameter 1 is their number."""
CIRCLES = frozenset({5003, 5004})
"""Inclusion and exclusion circles: parameter 1 is the radius (m)."""
RETURN_POINT = 5000
"""Of a fence."""
_FENCE = FENCE_AND_RALLY - {RALLY_POINT}


def check_mission_item(item: MissionItem) -> None:
    """Refuse an item that PX4 refuses, or that could not be flown. Raises :class:`ItemError`."""
    _check_frame(item, frozenset(_COMMANDS))
    if item.command in FENCE_AND_RALLY:
        raise ItemError("command", "a fence or rally point, not a mission")
    if item.command not in _COMMANDS[Frame(item.frame)]:
        elsewhere = any(item.command in commands for commands in _COMMANDS.values())
        raise ItemError("command", f"not supported in {frame_name(item.frame)}" if elsewhere else "not supported")
    check_numbers(item)
    if item.frame in PLACED_FRAMES:
        check_place(item)
    match item.command:
        case Command.NAV_WAYPOINT | Command.NAV_LOITER_TIME:
            seconds(item)
        case Command.NAV_TAKEOFF:
            take_off_altitude(item)
        case Command.NAV_DELAY | Command.CONDITION_DELAY:
            delay(item)
        case Command.DO_CHANGE_SPEED:
            speed_change(item)
        case Command.DO_JUMP:
            whole(item, 0, "target")
            repeats(item)


def check_fence_item(item: MissionItem) -> None:
    """Refuse what is no corner, circle or return point of a fence. Raises :class:`ItemError`."""
    _check_frame(item, PLACED_FRAMES)
    if item.command not in _FENCE:
        raise ItemError("command", "no part of a fence")
    if item.command == RETURN_POINT:
        raise ItemError("command", "a fence's return point is not flown to; rally points are")
    check_numbers(item)
    _check_given_place(item)
    if item.command in VERTICES and whole(item, 0, "vertices") < 3:
        raise ItemError("param 1 (vertices)", f"{item.params[0]:g}, a polygon has three or more")
    if item.command in CIRCLES and not (item.params[0] or 0.0) > 0.0:
        raise ItemError("param 1 (radius)", f"{item.params[0] or 0.0:g} m")


def check_rally_point(item: MissionItem) -> None:
    """Refuse what is no rally point. Raises :class:`ItemError`."""
    _check_frame(item, PLACED_FRAMES)
    if item.command != RALLY_POINT:
        raise ItemError("command", "no rally point")
    check_numbers(item)
    _check_given_place(item)
    if item.params[6] is None:
        raise ItemError("altitude", "not given")


def check_jumps(items: Sequence[MissionItem]) -> None:
    """Refuse jumps out of the mission, and those in a loop in which nothing is flown. Raises :class:`ItemError`."""
    following: dict[int, list[int]] = {}
    for number, item in enumerate(items):
        if item.command in FLOWN_TO or item.command == Command.NAV_RETURN_TO_LAUNCH:
            continue
        following[number] = [number + 1]
        if item.command == Command.DO_JUMP:
            target = whole(item, 0, "target")
            if not 0 <= target < len(items):
                raise ItemError("param 1 (target)", f"{target}: there is no such item")
            if repeats(item) != 0:
                following[number].append(target)
    if (loop := loop_in(following)) is not None:
        jump = max(number for number in loop if items[number].command == Command.DO_JUMP)
        raise ItemError("param 1 (target)", f"{items[jump].label}: a loop without a waypoint in it would never end")


def check_fence(items: Sequence[MissionItem]) -> None:
    """Refuse polygons with missing corners. Raises :class:`ItemError`."""
    number = 0
    while number < len(items):
        item = items[number]
        if item.command not in VERTICES:
            number += 1
            continue
        corners = whole(item, 0, "vertices")
        polygon = items[number : number + corners]
        if len(polygon) < corners or any((i.command, i.params[0]) != (item.command, item.params[0]) for i in polygon):
            raise ItemError("param 1 (vertices)", f"{corners}, and fewer corners follow")
        number += corners


def why_unflyable(items: Sequence[MissionItem], home: FileHome) -> str | None:
    """Return the reason why a mission that was taken cannot be started, as PX4's feasibility check; None: it can."""
    if reason := nothing_to_fly(items):
        return reason
    for item in items:
        if item.command in FLOWN_TO and item.has_position:
            latitude, longitude = item.params[4:6]
            assert latitude is not None and longitude is not None  # for the type checker: it has a position
            try:
                home.north_east(latitude, longitude)
            except ItemError as error:
                return f"{item.label}: {error}"
    return None


def _check_frame(item: MissionItem, frames: frozenset[Frame]) -> None:
    if item.frame not in frames:
        raise ItemError("frame", f"{frame_name(item.frame)}, is not supported")


def _check_given_place(item: MissionItem) -> None:
    check_place(item)
    if item.params[4] is None:
        raise ItemError("latitude", "not given")
