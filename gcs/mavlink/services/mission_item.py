"""An item of a mission, a fence or a set of rally points, as MISSION_ITEM_INT carries it."""

import struct
import zlib
from collections.abc import Iterable
from enum import IntEnum
from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

UNKNOWN = 2**31 - 1
"""``x`` or ``y`` that is not given, as NaN is for the other parameters."""
_NONE_INVERTED = 0xFFFFFFFF
_CRC_OF_ITEM = struct.Struct("<BHB4fiif")


class PlanType(IntEnum):
    """MAV_MISSION_TYPE of a plan."""

    MISSION = mavlink.MAV_MISSION_TYPE_MISSION
    FENCE = mavlink.MAV_MISSION_TYPE_FENCE
    RALLY = mavlink.MAV_MISSION_TYPE_RALLY


class MissionItem(NamedTuple):
    """One item; the meaning of the parameters is the command's (MAV_CMD). NaN: not given."""

    frame: int
    """MAV_FRAME, one of the global ones where the command has a place."""
    command: int
    autocontinue: bool
    param1: float
    param2: float
    param3: float
    param4: float
    x: int
    """Latitude (1e-7 deg) in a global frame, :data:`UNKNOWN` if it is not given."""
    y: int
    """Longitude (1e-7 deg) in a global frame, :data:`UNKNOWN` if it is not given."""
    z: float
    """Altitude (m), above mean sea level or above home by the frame."""

    @property
    def place(self) -> tuple[float, float]:
        """Latitude and longitude of a global frame (deg)."""
        return self.x * 1e-7, self.y * 1e-7

    @property
    def parameters(self) -> list[float | None]:
        """The seven parameters, latitude and longitude in deg; None or NaN for what is not given."""
        scale = 1.0 if self.frame == mavlink.MAV_FRAME_MISSION else 1e-7
        x, y = (None if value == UNKNOWN else value * scale for value in (self.x, self.y))
        return [self.param1, self.param2, self.param3, self.param4, x, y, self.z]


def opaque_id(items: Iterable[MissionItem]) -> int:
    """Return the id of a plan by which a ground sees that it has changed; 0 without items.

    PX4's: the CRC32 of MAVLink FTP (initial value 0, no final inversion) over frame, command, autocontinue and the
    seven parameters of each item, in order.
    """
    checksum = _NONE_INVERTED
    for item in items:
        checksum = zlib.crc32(_CRC_OF_ITEM.pack(*item), checksum)
    return checksum ^ _NONE_INVERTED
