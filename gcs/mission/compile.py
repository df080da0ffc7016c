"""Compilation of mission items into a route.

To add a mission command, add a function to :data:`_COMMANDS` that returns the item's :class:`~gcs.mission.route.Step`.
Meanings: https://mavlink.io/en/messages/common.html#mav_commands and
https://mavlink.io/en/services/mission.html
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from gcs.config import SystemConfig, UnusableFile
from gcs.mission.commands import (
    AMSL_FRAMES,
    FENCE_AND_RALLY,
    FRAMES,
    LAST_NAVIGATION,
    LEFT_OUT,
    Command,
    Frame,
    command_name,
    frame_name,
)
from gcs.mission.flow import check_flow
from gcs.mission.items import FARTHEST, ItemError, MissionItem, WaypointFile
from gcs.mission.route import Climb, Descend, Go, Jump, Place, Return, Route, Speed, Stay, Step, Turn, Wait

LOITER_RADIUS = 5.0
"""m, of loiter turns without a radius."""


@dataclass
class _Context:
    """The file that is compiled, the targets of its jumps, and the notes on it."""

    file: WaypointFile
    system: SystemConfig
    notes: list[str] = field(default_factory=list)
    index_of_number: dict[int, int] = field(default_factory=dict)
    index_of_tag: dict[int, int] = field(default_factory=dict)

    def note(self, item: MissionItem, text: str) -> None:
        self.notes.append(f"{item.label}: {text}")


def compile_route(path: Path, file: WaypointFile, system: SystemConfig, speed: float) -> tuple[Route, tuple[str, ...]]:
    """Return the route of a waypoint file and notes on what is left out, capped or added.

    ``speed`` (m/s) is flown where the file does not say. Raises :class:`UnusableFile` with every reason found.
    """
    context = _Context(file, system)
    problems: list[str] = []
    _number_items(file.items, context, path, problems)
    steps: list[Step | None] = []
    for item in file.items:
        step = None
        try:
            step = _step(item, context)
        except ItemError as problem:
            problems.append(f"{path}: {item.label}: {problem}")
        steps.append(step)
    if problems:
        raise UnusableFile(problems)
    route = Route(_joined(file.items, steps, context), speed, system.resting_altitude)
    problems, notes = check_flow(route, file.fence)
    if problems:
        raise UnusableFile([f"{path}: {problem}" for problem in problems])
    return route, (*file.notes, *context.notes, *notes)


def _number_items(items: tuple[MissionItem, ...], context: _Context, path: Path, problems: list[str]) -> None:
    """Find the targets of jumps: by number and by tag, each of which may appear only once."""
    for index, item in enumerate(items):
        kinds = [(context.index_of_number, item.number, "number")]
        if item.command == Command.JUMP_TAG:
            try:
                kinds.append((context.index_of_tag, _whole(item, 0, "tag"), "tag"))
            except ItemError as problem:
                problems.append(f"{path}: {item.label}: {problem}")
        for table, number, name in kinds:
            if number is not None and table.setdefault(number, index) != index:
                problems.append(f"{path}: {item.label}: {name}: {number} appears twice: jumps to it would be ambiguous")


def _step(item: MissionItem, context: _Context) -> Step | None:
    """Return the step of an item; None, and a note, if it is left out."""
    if item.frame not in FRAMES:
        raise ItemError("frame", f"{frame_name(item.frame)}, is not supported in a mission")
    if item.command in FENCE_AND_RALLY:
        raise ItemError("command", "a fence or rally point, not a mission")
    if (make := _COMMANDS.get(item.command)) is not None:
        return make(item, context)
    if item.command in LEFT_OUT:
        context.note(item, "left out")
        return None
    name = command_name(item.command)
    if name.startswith("NAV_") or item.command <= LAST_NAVIGATION:
        raise ItemError("command", f"navigation by {name} is not supported")
    name = name.removeprefix("command ")
    raise ItemError("command", f"{name} is not supported, and leaving it out could change the flight")


def _joined(items: tuple[MissionItem, ...], steps: list[Step | None], context: _Context) -> tuple[Step, ...]:
    """Return the steps that are flown, jump targets moved to match, and a hold where autocontinue is off."""
    joined: list[Step] = []
    index_of_item = []
    for item, step in zip(items, steps, strict=True):
        index_of_item.append(len(joined))
        if step is None:
            continue
        joined.append(step)
        if not item.autocontinue and isinstance(step, Climb | Go | Turn | Wait):
            context.note(item, "autocontinue is off: holds there until stopped")
            joined.append(Stay(item.label, Place()))
    return tuple(
        replace(step, target=index_of_item[step.target]) if isinstance(step, Jump) else step for step in joined
    )


# Parameters -----------------------------------------------------------------------------------------------------


def _place(item: MissionItem, context: _Context) -> Place:
    """Return the place of an item about home; what is not given stays open."""
    latitude, longitude, altitude = item.params[4:7]
    if (latitude is None) != (longitude is None):
        raise ItemError("latitude, longitude", "one is given without the other")
    here = latitude is None or longitude is None or (latitude == 0.0 and longitude == 0.0)
    if here and not altitude:
        return Place()
    if item.frame == Frame.MISSION:
        raise ItemError("frame", f"{frame_name(item.frame)}, has no coordinates")
    if altitude is not None:
        altitude = _above_home(item, altitude, context)
        if altitude < 0.0:
            raise ItemError("altitude", f"below ground: {-altitude:.6g} m lower than home")
        if altitude < context.system.resting_altitude:
            resting = context.system.resting_altitude
            reason = f"{altitude:.2g} m: on the ground, where the payload's centre is at {resting:g} m"
            raise ItemError("altitude", reason)
        if altitude > FARTHEST:
            raise ItemError("altitude", f"{altitude:.6g} m above home (limit {FARTHEST:g} m)")
    if here:
        return Place(None, altitude)
    assert latitude is not None and longitude is not None  # for the type checker: `here` covers None
    return Place(context.file.home.north_east(latitude, longitude), altitude)


def _above_home(item: MissionItem, altitude: float, context: _Context) -> float:
    if item.frame not in AMSL_FRAMES:
        return altitude
    if context.file.home.altitude is None:
        raise ItemError("altitude", "is above mean sea level, but home has no altitude: use a frame above home")
    return altitude - context.file.home.altitude


def _seconds(item: MissionItem) -> float:
    seconds = item.params[0] or 0.0
    if seconds < 0.0:
        raise ItemError("param 1", f"{seconds:g} s is negative")
    return seconds


def _whole(item: MissionItem, index: int, name: str) -> int:
    value = item.params[index]
    if value is None or value != math.floor(value):
        shown = "not given" if value is None else f"{value:g} is not a whole number"
        raise ItemError(f"param {index + 1} ({name})", shown)
    return int(value)


def _note_heading(item: MissionItem, context: _Context) -> None:
    if item.params[3]:
        context.note(item, f"heading {item.params[3]:g} deg left out: the payload keeps its heading")


# Commands -------------------------------------------------------------------------------------------------------


def _go(item: MissionItem, context: _Context) -> Go:
    return Go(item.label, _place(item, context), _seconds(item))


def _waypoint(item: MissionItem, context: _Context) -> Step:
    _note_heading(item, context)
    return _go(item, context)


def _loiter_unlimited(item: MissionItem, context: _Context) -> Step:
    _note_heading(item, context)
    return Stay(item.label, _place(item, context))


def _loiter_turns(item: MissionItem, context: _Context) -> Step:
    turns, radius = item.params[0], item.params[2]
    if turns is None or not 0.0 < turns <= 1e6:
        raise ItemError("param 1 (turns)", "not given" if turns is None else f"{turns:g} turns")
    if not radius:
        context.note(item, f"no radius given: flown with {LOITER_RADIUS:g} m")
        radius = LOITER_RADIUS
    if abs(radius) > FARTHEST:
        raise ItemError("param 3 (radius)", f"{radius:g} m (limit {FARTHEST:g} m)")
    return Turn(item.label, _place(item, context), abs(radius), turns, radius > 0.0)


def _land(item: MissionItem, context: _Context) -> Step:
    _note_heading(item, context)
    altitude = item.params[6]
    if altitude and item.frame != Frame.MISSION:
        height = _above_home(item, altitude, context)
        if height < -0.5:
            raise ItemError("altitude", f"below ground: {-height:.6g} m lower than home")
        if height > 0.5:
            context.note(item, f"altitude {altitude:g} m left out: the ground is flat, and the payload lands on it")
    return Descend(item.label, _place(replace(item, params=(*item.params[:6], None)), context))


def _take_off(item: MissionItem, context: _Context) -> Step:
    _note_heading(item, context)
    place = _place(item, context)
    if place.altitude is None:
        raise ItemError("altitude", "not given: a take-off needs one")
    return Climb(item.label, place)


def _delay(item: MissionItem, context: _Context) -> Step:
    if item.params[0] is None or item.params[0] < 0.0:
        raise ItemError("param 1", "not given: a delay in seconds is needed; a time of day is not supported")
    return Wait(item.label, item.params[0])


def _change_speed(item: MissionItem, context: _Context) -> Step | None:
    kind, speed = item.params[0] or 0.0, item.params[1]
    if kind in (2.0, 3.0):
        direction = "climb" if kind == 2.0 else "descent"
        context.note(item, f"{direction} speed left out: the system file's motion limits hold")
        return None
    if kind not in (0.0, 1.0):
        raise ItemError("param 1 (speed type)", f"{kind:g} is unknown")
    if speed is None or speed == -1.0:
        context.note(item, "no change of speed")
        return None
    if speed == -2.0:
        return Speed(item.label, None)
    if speed <= 0.0:
        raise ItemError("param 2 (speed)", f"{speed:g} m/s: the payload would never arrive")
    if speed > context.system.motion.speed_max:
        context.note(item, f"{speed:g} m/s capped to speed_max, {context.system.motion.speed_max:g} m/s")
        speed = context.system.motion.speed_max
    return Speed(item.label, speed)


def _jump(item: MissionItem, index_of: dict[int, int], name: str, context: _Context) -> Step | None:
    target = _whole(item, 0, name)
    repeats = _whole(item, 1, "repeats")
    if repeats < -1:
        raise ItemError("param 2 (repeats)", f"{repeats} is neither a number of times nor -1, endless")
    if target not in index_of:
        reason = "is home, not an item" if target == 0 and name == "target" else "there is no such item"
        raise ItemError(f"param 1 ({name})", f"{target}: {reason}")
    if repeats == 0:
        context.note(item, "repeats 0 times: the jump is not taken")
        return None
    return Jump(item.label, index_of[target], None if repeats == -1 else repeats)


_COMMANDS: dict[int, Callable[[MissionItem, _Context], Step | None]] = {
    Command.NAV_WAYPOINT: _waypoint,
    Command.NAV_SPLINE_WAYPOINT: lambda item, context: replace(_go(item, context), spline=True),
    Command.CONDITION_GATE: lambda item, context: Go(item.label, _place(item, context)),
    Command.NAV_LOITER_UNLIM: _loiter_unlimited,
    Command.NAV_LOITER_TURNS: _loiter_turns,
    Command.NAV_LOITER_TIME: _go,
    Command.NAV_RETURN_TO_LAUNCH: lambda item, context: Return(item.label),
    Command.NAV_LAND: _land,
    Command.NAV_TAKEOFF: _take_off,
    Command.NAV_DELAY: _delay,
    Command.CONDITION_DELAY: _delay,
    Command.DO_CHANGE_SPEED: _change_speed,
    Command.DO_JUMP: lambda item, context: _jump(item, context.index_of_number, "target", context),
    Command.JUMP_TAG: lambda item, context: None,
    Command.DO_JUMP_TAG: lambda item, context: _jump(item, context.index_of_tag, "tag", context),
}
