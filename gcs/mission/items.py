"""A waypoint file before it is compiled into a route: home, items and fence, whichever format they come from."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from gcs.mission import geodesy
from gcs.mission.commands import FENCE_AND_RALLY, LAST_NAVIGATION, LEFT_OUT, RALLY_POINT, Command, command_name
from gcs.mission.fence import Fence

Firmware = Literal["px4", "ardupilot"]
"""The autopilot that a file is written for, which decides where PX4 and ArduPilot fly an item differently."""

ITEM_LIMIT = 10_000
FARTHEST = 10_000.0
"""m from home. Beyond it the file's home is wrong, or the world no longer flat."""
PARAM_NAMES = ("param 1", "param 2", "param 3", "param 4", "latitude", "longitude", "altitude")


class ItemError(ValueError):
    """An item that cannot be flown: field and reason."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")
        self.field = field


@dataclass(frozen=True)
class MissionItem:
    """One MISSION_ITEM. ``where`` names its line or item; ``number`` is that by which a DO_JUMP refers to it.

    ``params`` are the seven of MAVLink, latitude and longitude in deg; None: not given.
    """

    where: str
    number: int | None
    frame: int
    command: int
    params: tuple[float | None, ...]
    autocontinue: bool = True

    @property
    def has_position(self) -> bool:
        """Whether latitude and longitude are given; 0, 0 stands for none."""
        return None not in self.params[4:6] and self.params[4:6] != (0.0, 0.0)

    @property
    def label(self) -> str:
        """Line or item with its command, for messages."""
        return f"{self.where} ({command_name(self.command)})"


@dataclass(frozen=True)
class FileHome:
    """Home as the file has it (deg, m above mean sea level); the altitude may not be known.

    Raises :class:`ItemError` for no place on earth, and for 0, 0, which stands for none.
    """

    latitude: float
    longitude: float
    altitude: float | None

    def __post_init__(self) -> None:
        if self.latitude == 0.0 and self.longitude == 0.0:
            raise ItemError("latitude, longitude", "0, 0: home gives no place")
        check_latitude_longitude(self.latitude, self.longitude)

    def north_east(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return the place (m from home), both on the ellipsoid's surface at home's altitude.

        Raises :class:`ItemError` for no place on earth, and beyond :data:`FARTHEST`.
        """
        check_latitude_longitude(latitude, longitude)
        altitude = self.altitude or 0.0
        north, east = geodesy.north_east(latitude, longitude, self.latitude, self.longitude, altitude)
        # The chord alone does not discriminate near the antipodes.
        if math.hypot(north, east) > FARTHEST or abs(latitude - self.latitude) > 1.0:
            kilometres = geodesy.angle_between(self.latitude, self.longitude, latitude, longitude) * 111.2
            reason = f"{kilometres:.0f} km from home (limit {FARTHEST / 1000:.0f} km)"
            raise ItemError("latitude, longitude", reason)
        return north, east


@dataclass(frozen=True)
class WaypointFile:
    """Home, items, fence, notes on what is left out, the autopilot it is written for, and its speed (m/s).

    None: not known, not given.
    """

    home: FileHome
    items: tuple[MissionItem, ...]
    fence: Fence = field(default_factory=Fence)
    notes: tuple[str, ...] = ()
    firmware: Firmware | None = None
    speed: float | None = None


def nothing_to_fly(items: Sequence[MissionItem]) -> str | None:
    """Return the reason why a file with these items is no mission; None if it is one."""
    commands = {item.command for item in items} - LEFT_OUT
    if commands and commands <= FENCE_AND_RALLY:
        what = "rally points" if commands == {RALLY_POINT} else "a fence"
        return f"{what}, not a mission: nothing to fly"
    if not any(command <= LAST_NAVIGATION or command == Command.CONDITION_GATE for command in commands):
        return "nothing to fly: there is no waypoint"
    return None


def first_position(items: Iterable[MissionItem]) -> MissionItem | None:
    """Return the first item with a latitude and longitude of its own that is flown, or that refuses the file."""
    return next((item for item in items if item.command not in LEFT_OUT and item.has_position), None)


def check_latitude_longitude(latitude: float, longitude: float) -> None:
    """Raise :class:`ItemError` outside -90 .. 90 and -180 .. 180 deg."""
    if not -90.0 <= latitude <= 90.0:
        raise ItemError("latitude", f"{latitude:g} is outside -90 .. 90 deg")
    if not -180.0 <= longitude <= 180.0:
        raise ItemError("longitude", f"{longitude:g} is outside -180 .. 180 deg")
