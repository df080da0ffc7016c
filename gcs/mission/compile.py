"""Compilation of mission items into a route.

To add a mission command, add a function to :data:`_COMMANDS` that returns the item's :class:`~gcs.mission.route.Step`.
Meanings: https://mavlink.io/en/messages/common.html#mav_commands and
https://mavlink.io/en/services/mission.html
"""

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
    WINCH_ACTIONS,
    Command,
    Frame,
    command_name,
    frame_name,
)
from gcs.mission.flow import check_flow
from gcs.mission.item_parameters import (
    DEFAULT_SPEED,
    VERTICAL_SPEEDS,
    check_radius,
    delay,
    gripper_action,
    repeats,
    seconds,
    speed_change,
    take_off_altitude,
    turns,
    whole,
)
from gcs.mission.items import FARTHEST, ItemError, MissionItem, WaypointFile
from gcs.mission.route import Route
from gcs.mission.steps import (
    Climb,
    Descend,
    Go,
    Grip,
    Jump,
    Place,
    PlacePayload,
    Return,
    Speed,
    Stay,
    Step,
    Turn,
    Wait,
)

LOITER_RADIUS = 5.0
"""m, of loiter turns without a radius."""
_WITH_HEADING = (Command.NAV_WAYPOINT, Command.NAV_LOITER_UNLIM, Command.NAV_LAND, Command.NAV_TAKEOFF)
"""Commands whose param 4 is a heading."""
_NO_CARGO = "the system file has no [[cargo]] to unload or load"
HIGH_CLIMB = 120.0
"""m above home. Higher, an altitude above mean sea level may be one above another home."""


@dataclass
class _Context:
    """The file that is compiled, the targets of its jumps (indices of items), and the notes on it."""

    file: WaypointFile
    system: SystemConfig
    notes: list[str] = field(default_factory=list)
    indices_of_number: dict[int, list[int]] = field(default_factory=dict)
    indices_of_tag: dict[int, list[int]] = field(default_factory=dict)

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
    _note_climb(file.items, steps, context)
    route = Route(_joined(file.items, steps, context), speed, system.resting_altitude)
    problems, notes = check_flow(route, file.fence)
    if problems:
        raise UnusableFile([f"{path}: {problem}" for problem in problems])
    return route, (*file.notes, *context.notes, *notes)


def _number_items(items: tuple[MissionItem, ...], context: _Context, path: Path, problems: list[str]) -> None:
    """Find the targets of jumps: by number and by tag."""
    for index, item in enumerate(items):
        if item.number is not None:
            context.indices_of_number.setdefault(item.number, []).append(index)
        if item.command == Command.JUMP_TAG:
            try:
                context.indices_of_tag.setdefault(whole(item, 0, "tag"), []).append(index)
            except ItemError as problem:
                problems.append(f"{path}: {item.label}: {problem}")


def _step(item: MissionItem, context: _Context) -> Step | None:
    """Return the step of an item; None, and a note, if it is left out."""
    if item.frame not in FRAMES:
        raise ItemError("frame", f"{frame_name(item.frame)}, is not supported in a mission")
    if item.command in FENCE_AND_RALLY:
        raise ItemError("command", "a fence or rally point, not a mission")
    if (make := _COMMANDS.get(item.command)) is not None:
        if item.command in _WITH_HEADING and item.params[3]:
            context.note(item, f"heading {item.params[3]:g} deg left out: the payload keeps its heading")
        return make(item, context)
    if item.command in LEFT_OUT:
        context.note(item, "left out")
        return None
    name = command_name(item.command)
    if name.startswith("NAV_") or item.command <= LAST_NAVIGATION:
        raise ItemError("command", "navigation that is not supported")
    raise ItemError("command", "not supported, and leaving it out could change the flight")


def _note_climb(items: tuple[MissionItem, ...], steps: list[Step | None], context: _Context) -> None:
    """Note the climb to the first altitude, if it is above mean sea level and home may have another one than meant."""
    home = context.file.home.altitude
    for item, step in zip(items, steps, strict=True):
        if isinstance(step, Climb | Go | Turn | Stay | PlacePayload) and (climb := step.place.altitude) is not None:
            if item.frame in AMSL_FRAMES and home is not None and (home == 0.0 or climb > HIGH_CLIMB):
                reason = f"{home + climb:g} m above mean sea level, and home at {home:g} m"
                context.note(item, f"altitude: {reason}: climbs {climb:g} m")
            return


def _joined(items: tuple[MissionItem, ...], steps: list[Step | None], context: _Context) -> tuple[Step, ...]:
    """Return the steps that are flown, jump targets moved to match, and a hold where autocontinue is off."""
    joined: list[Step] = []
    index_of_item = []
    for item, step in zip(items, steps, strict=True):
        index_of_item.append(len(joined))
        if step is None:
            continue
        joined.append(step)
        if item.autocontinue or not isinstance(step, Climb | Go | Turn | Wait):
            continue
        if context.file.firmware == "ardupilot":
            context.note(item, "autocontinue is off: flown on all the same, as ArduPilot does")
        else:
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
    if altitude == 0.0 and context.file.firmware == "ardupilot":
        context.note(item, "altitude 0: keeps the altitude, as ArduPilot does")
        altitude = None
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


# Commands -------------------------------------------------------------------------------------------------------


def _go(item: MissionItem, context: _Context) -> Go:
    return Go(item.label, _place(item, context), seconds(item))


def _loiter_turns(item: MissionItem, context: _Context) -> Step:
    count, radius = turns(item), item.params[2]
    if not radius:
        context.note(item, f"no radius given: flown with {LOITER_RADIUS:g} m")
        radius = LOITER_RADIUS
    check_radius(radius)
    return Turn(item.label, _place(item, context), abs(radius), count, radius > 0.0)


def _land(item: MissionItem, context: _Context) -> Step:
    altitude = item.params[6]
    if altitude and item.frame != Frame.MISSION:
        height = _above_home(item, altitude, context)
        if abs(height) > 0.5:
            context.note(item, f"altitude {altitude:g} m left out: the ground is flat, and the payload lands on it")
    return Descend(item.label, _place(replace(item, params=(*item.params[:6], None)), context))


def _payload_place(item: MissionItem, context: _Context) -> Step:
    descent_max, altitude = item.params[0] or None, item.params[6]
    if descent_max is not None and descent_max < 0.0:
        raise ItemError("param 1 (maximum descent)", f"{descent_max:g} m is negative")
    if not context.system.cargo:
        context.note(item, f"nothing to release: {_NO_CARGO}")
    # As of a landing: 0 is the ground.
    place = _place(item if altitude else replace(item, params=(*item.params[:6], None)), context)
    seconds_standing, releases = context.system.flight.takeoff_landing.place_time, bool(context.system.cargo)
    return PlacePayload(item.label, place, seconds_standing, releases, descent_max)


def _gripper(item: MissionItem, context: _Context) -> Step:
    return Grip(item.label, gripper_action(item), _gripper_number(item, context))


def _winch(item: MissionItem, context: _Context) -> Step | None:
    action = whole(item, 1, "action")
    if action not in WINCH_ACTIONS:
        context.note(item, f"action {action} left out: it neither delivers nor loads")
        return None
    return Grip(item.label, WINCH_ACTIONS[action], _gripper_number(item, context))


def _gripper_number(item: MissionItem, context: _Context) -> int:
    """Return the gripper of an item; 0: all."""
    number, known = whole(item, 0, "gripper"), sorted(cargo.gripper for cargo in context.system.cargo)
    if not known:
        raise ItemError("command", _NO_CARGO)
    if number and number not in known:
        raise ItemError("param 1 (gripper)", f"{number}: the system file has {', '.join(map(str, known))}")
    return number


def _take_off(item: MissionItem, context: _Context) -> Step:
    altitude, resting = take_off_altitude(item), context.system.resting_altitude
    lowest = resting + context.system.guidance.navigator.ground_clearance
    if 0.0 <= _above_home(item, altitude, context) < lowest:
        reason = (
            f"on the pad the payload's centre is at {resting:g} m, and guidance.navigator.ground_clearance above it"
        )
        context.note(item, f"altitude {altitude:g} m raised to {lowest:g} m above home: {reason}")
        item = replace(item, frame=Frame.GLOBAL_RELATIVE_ALT, params=(*item.params[:6], lowest))
    return Climb(item.label, _place(item, context))


def _loiter_to_altitude(item: MissionItem, context: _Context) -> Step:
    if item.params[1]:
        context.note(item, f"radius {item.params[1]:g} m left out: flown straight to the place at its altitude")
    return Go(item.label, _place(item, context))


def _delay(item: MissionItem, context: _Context) -> Step:
    return Wait(item.label, delay(item))


def _change_speed(item: MissionItem, context: _Context) -> Step | None:
    kind, speed = speed_change(item)
    if kind in VERTICAL_SPEEDS:
        context.note(item, f"{VERTICAL_SPEEDS[kind]} speed left out: the system file's motion limits hold")
        return None
    if speed is None:
        context.note(item, "no change of speed")
        return None
    if speed == DEFAULT_SPEED:
        return Speed(item.label, None)
    if speed > context.system.motion.speed_max:
        context.note(item, f"{speed:g} m/s capped to speed_max, {context.system.motion.speed_max:g} m/s")
        speed = context.system.motion.speed_max
    return Speed(item.label, speed)


def _jump(item: MissionItem, indices_of: dict[int, list[int]], name: str, context: _Context) -> Step | None:
    target, times = whole(item, 0, name), repeats(item)
    targets = indices_of.get(target, [])
    if len(targets) != 1:
        is_home = target == 0 and name == "target"
        absent = "is home, not an item" if is_home else "there is no such item"
        reason = f"there are {len(targets)} such items" if targets else absent
        raise ItemError(f"param 1 ({name})", f"{target:g}: {reason}")
    if times == 0:
        context.note(item, "repeats 0 times: the jump is not taken")
        return None
    return Jump(item.label, targets[0], None if times == -1 else times)


_COMMANDS: dict[int, Callable[[MissionItem, _Context], Step | None]] = {
    Command.NAV_WAYPOINT: _go,
    Command.NAV_SPLINE_WAYPOINT: lambda item, context: replace(_go(item, context), spline=True),
    Command.CONDITION_GATE: lambda item, context: Go(item.label, _place(item, context)),
    Command.NAV_LOITER_UNLIM: lambda item, context: Stay(item.label, _place(item, context)),
    Command.NAV_LOITER_TURNS: _loiter_turns,
    Command.NAV_LOITER_TIME: _go,
    Command.NAV_LOITER_TO_ALT: _loiter_to_altitude,
    Command.NAV_RETURN_TO_LAUNCH: lambda item, context: Return(item.label),
    Command.NAV_LAND: _land,
    Command.NAV_TAKEOFF: _take_off,
    Command.NAV_DELAY: _delay,
    Command.CONDITION_DELAY: _delay,
    Command.NAV_PAYLOAD_PLACE: _payload_place,
    Command.DO_CHANGE_SPEED: _change_speed,
    Command.DO_GRIPPER: _gripper,
    Command.DO_WINCH: _winch,
    Command.DO_JUMP: lambda item, context: _jump(item, context.indices_of_number, "target", context),
    Command.JUMP_TAG: lambda item, context: None,
    Command.DO_JUMP_TAG: lambda item, context: _jump(item, context.indices_of_tag, "tag", context),
}
