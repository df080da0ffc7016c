"""A waypoint file before it is compiled into a route: home, items and fence, whichever format they come from."""

import math
from dataclasses import dataclass, field

import pymap3d
from pymap3d.haversine import anglesep
from pymavlink.dialects.v20 import common as mavlink

from gcs.mission.fence import Fence

ITEM_LIMIT = 10_000
FARTHEST = 10_000.0
"""m from home. Beyond it the file's home is wrong, or the world no longer flat."""
PARAM_NAMES = ("param 1", "param 2", "param 3", "param 4", "latitude", "longitude", "altitude")


class ItemError(ValueError):
    """An item that cannot be flown: field and reason."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")


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
        north, east, _ = pymap3d.geodetic2ned(latitude, longitude, altitude, self.latitude, self.longitude, altitude)
        # The chord alone does not discriminate near the antipodes.
        if math.hypot(north, east) > FARTHEST or abs(latitude - self.latitude) > 1.0:
            kilometres = float(anglesep(self.longitude, self.latitude, longitude, latitude)) * 111.2
            reason = f"{kilometres:.0f} km from home (limit {FARTHEST / 1000:.0f} km)"
            raise ItemError("latitude, longitude", reason)
        return float(north), float(east)


@dataclass(frozen=True)
class WaypointFile:
    """Home, items, fence, and notes on what is left out."""

    home: FileHome
    items: tuple[MissionItem, ...]
    fence: Fence = field(default_factory=Fence)
    notes: tuple[str, ...] = ()


def check_latitude_longitude(latitude: float, longitude: float) -> None:
    """Raise :class:`ItemError` outside -90 .. 90 and -180 .. 180 deg."""
    if not -90.0 <= latitude <= 90.0:
        raise ItemError("latitude", f"{latitude:g} is outside -90 .. 90 deg")
    if not -180.0 <= longitude <= 180.0:
        raise ItemError("longitude", f"{longitude:g} is outside -180 .. 180 deg")


def command_name(command: int) -> str:
    """Return ``NAV_WAYPOINT``, or the number where MAVLink's common dialect has no name for it."""
    if command == CONDITION_GATE:
        return "CONDITION_GATE"
    entry = mavlink.enums["MAV_CMD"].get(command)
    return entry.name.removeprefix("MAV_CMD_") if entry else f"command {command}"


def frame_name(frame: int) -> str:
    """Return ``frame 3, GLOBAL_RELATIVE_ALT``."""
    entry = mavlink.enums["MAV_FRAME"].get(frame)
    return f"frame {frame}" + (f", {entry.name.removeprefix('MAV_FRAME_')}" if entry else "")


CONDITION_GATE = 4501
"""Of MAVLink's development dialect: a point to fly through, which QGroundControl writes into surveys."""

AMSL_FRAMES = frozenset({mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT})
ABOVE_HOME_FRAMES = frozenset(
    {
        mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
        mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT,  # the ground is flat
        mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT,
    }
)
FRAMES = AMSL_FRAMES | ABOVE_HOME_FRAMES | {mavlink.MAV_FRAME_MISSION}

FENCE_AND_RALLY = frozenset(range(5000, 5005)) | {mavlink.MAV_CMD_NAV_RALLY_POINT}

LEFT_OUT = frozenset(
    getattr(mavlink, f"MAV_CMD_{name}")
    for name in (
        # camera and video
        "DO_CONTROL_VIDEO", "DO_DIGICAM_CONFIGURE", "DO_DIGICAM_CONTROL", "DO_SET_CAM_TRIGG_DIST",
        "DO_SET_CAM_TRIGG_INTERVAL", "REQUEST_CAMERA_INFORMATION", "REQUEST_CAMERA_SETTINGS",
        "REQUEST_STORAGE_INFORMATION", "STORAGE_FORMAT", "REQUEST_CAMERA_CAPTURE_STATUS", "RESET_CAMERA_SETTINGS",
        "SET_CAMERA_MODE", "SET_CAMERA_ZOOM", "SET_CAMERA_FOCUS", "SET_STORAGE_USAGE", "SET_CAMERA_SOURCE",
        "IMAGE_START_CAPTURE", "IMAGE_STOP_CAPTURE", "REQUEST_CAMERA_IMAGE_CAPTURE", "DO_TRIGGER_CONTROL",
        "CAMERA_TRACK_POINT", "CAMERA_TRACK_RECTANGLE", "CAMERA_STOP_TRACKING", "VIDEO_START_CAPTURE",
        "VIDEO_STOP_CAPTURE", "VIDEO_START_STREAMING", "VIDEO_STOP_STREAMING", "REQUEST_VIDEO_STREAM_INFORMATION",
        "REQUEST_VIDEO_STREAM_STATUS",
        # gimbal and region of interest
        "DO_MOUNT_CONFIGURE", "DO_MOUNT_CONTROL", "DO_MOUNT_CONTROL_QUAT", "DO_GIMBAL_MANAGER_PITCHYAW",
        "DO_GIMBAL_MANAGER_CONFIGURE", "NAV_ROI", "DO_SET_ROI", "DO_SET_ROI_LOCATION", "DO_SET_ROI_WPNEXT_OFFSET",
        "DO_SET_ROI_NONE", "DO_SET_ROI_SYSID",
        # other devices on board
        "DO_SET_SERVO", "DO_REPEAT_SERVO", "DO_SET_RELAY", "DO_REPEAT_RELAY", "DO_SET_ACTUATOR", "DO_GRIPPER",
        "DO_WINCH", "ILLUMINATOR_ON_OFF", "DO_ILLUMINATOR_CONFIGURE", "LOGGING_START", "LOGGING_STOP",
        # marks in the file, without an action
        "DO_LAND_START", "DO_RETURN_PATH_START",
    )
)  # fmt: skip
"""Commands that concern devices which these vehicles do not have, or nothing at all."""
