"""An item of a mission, a fence or a set of rally points, as MISSION_ITEM_INT carries it."""

from typing import NamedTuple


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
    """Latitude (1e-7 deg) in a global frame."""
    y: int
    """Longitude (1e-7 deg) in a global frame."""
    z: float
    """Altitude (m), above mean sea level or above home by the frame."""
