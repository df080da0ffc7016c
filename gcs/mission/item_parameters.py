"""What the parameters of a mission item may be, whoever flies it: a team with its payload, or a vehicle by itself.

Each function raises :class:`~gcs.mission.items.ItemError` with field and reason.
"""

import math
from typing import NamedTuple

from gcs.mission.commands import GripperAction
from gcs.mission.items import FARTHEST, ItemError, MissionItem, check_latitude_longitude

GROUND_SPEEDS = (0.0, 1.0)
"""Speed types of DO_CHANGE_SPEED that are flown: airspeed and ground speed are the same without wind."""
DEFAULT_SPEED = -2.0
"""Speed of DO_CHANGE_SPEED that stands for the default one."""
VERTICAL_SPEEDS = {2.0: "climb", 3.0: "descent"}


class SpeedChange(NamedTuple):
    """A DO_CHANGE_SPEED: its type, and the speed (m/s); None: no change."""

    kind: float
    speed: float | None


def check_numbers(item: MissionItem) -> None:
    """Refuse parameters that are not finite."""
    for number, value in enumerate(item.params, start=1):
        if value is not None and not math.isfinite(value):
            raise ItemError(f"param {number}", f"{value:g} is not finite")


def check_place(item: MissionItem) -> None:
    """Refuse one of latitude and longitude without the other, and places that are none on earth."""
    latitude, longitude = item.params[4:6]
    if (latitude is None) != (longitude is None):
        raise ItemError("latitude, longitude", "one is given without the other")
    if latitude is not None and longitude is not None:
        check_latitude_longitude(latitude, longitude)


def seconds(item: MissionItem) -> float:
    """Return the time (s) to stay at a waypoint."""
    value = item.params[0] or 0.0
    if value < 0.0:
        raise ItemError("param 1", f"{value:g} s is negative")
    return value


def delay(item: MissionItem) -> float:
    """Return the time (s) of a delay."""
    if item.params[0] is None or item.params[0] < 0.0:
        raise ItemError("param 1", "not given: a delay in seconds is needed; a time of day is not supported")
    return item.params[0]


def turns(item: MissionItem) -> float:
    """Return the number of turns of a loiter."""
    value = item.params[0]
    if value is None or not 0.0 < value <= 1e6:
        raise ItemError("param 1 (turns)", "not given" if value is None else f"{value:g} turns")
    return value


def check_radius(radius: float) -> None:
    """Refuse a radius (m) of loiter turns that is too large."""
    if abs(radius) > FARTHEST:
        raise ItemError("param 3 (radius)", f"{radius:g} m (limit {FARTHEST:g} m)")


def take_off_altitude(item: MissionItem) -> float:
    """Return the altitude (m) of a take-off, in the item's frame."""
    altitude = item.params[6]
    if altitude is None:
        raise ItemError("altitude", "not given: a take-off needs one")
    return altitude


def speed_change(item: MissionItem) -> SpeedChange:
    """Return the speed that is commanded."""
    kind, speed = item.params[0] or 0.0, item.params[1]
    if kind in VERTICAL_SPEEDS:
        return SpeedChange(kind, None)
    if kind not in GROUND_SPEEDS:
        raise ItemError("param 1 (speed type)", f"{kind:g} is unknown")
    if speed is None or speed == -1.0:
        return SpeedChange(kind, None)
    if speed <= 0.0 and speed != DEFAULT_SPEED:
        raise ItemError("param 2 (speed)", f"{speed:g} m/s: it would never arrive")
    return SpeedChange(kind, speed)


def gripper_action(item: MissionItem) -> GripperAction:
    """Return what a gripper is to do."""
    action = whole(item, 1, "action")
    if action not in set(GripperAction):
        raise ItemError("param 2 (action)", f"{action} is neither 0, release, nor 1, grab")
    return GripperAction(action)


def whole(item: MissionItem, index: int, name: str) -> int:
    """Return a parameter that is a whole number, the first at ``index`` 0."""
    value = item.params[index]
    if value is None or value != math.floor(value):
        shown = "not given" if value is None else f"{value:g} is not a whole number"
        raise ItemError(f"param {index + 1} ({name})", shown)
    return int(value)


def repeats(item: MissionItem) -> int:
    """Return how often a jump is taken; -1: without end."""
    value = whole(item, 1, "repeats")
    if value < -1:
        raise ItemError("param 2 (repeats)", f"{value} is neither a number of times nor -1, endless")
    return value
