"""A mission item, whichever file it comes from, and the names of MAVLink's commands and frames."""

from __future__ import annotations

import math
from dataclasses import dataclass

from pymavlink.dialects.v20 import common as mavlink

PARAM_NAMES = ("param 1", "param 2", "param 3", "param 4", "latitude", "longitude", "altitude")


@dataclass(frozen=True)
class MissionItem:
    """One MISSION_ITEM. ``where`` names its line or item; ``number`` is what a DO_JUMP to it would say.

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
        """Line or item, and command."""
        return f"{self.where} ({command_name(self.command)})"


class ItemError(Exception):
    """What is wrong with an item: field and reason."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")


def command_name(command: int) -> str:
    """``NAV_WAYPOINT``, or the number where MAVLink's common dialect has no name for it."""
    if command == CONDITION_GATE:
        return "CONDITION_GATE"
    entry = mavlink.enums["MAV_CMD"].get(command)
    return entry.name.removeprefix("MAV_CMD_") if entry else f"command {command}"


def frame_name(frame: int) -> str:
    """``frame 3, GLOBAL_RELATIVE_ALT``."""
    entry = mavlink.enums["MAV_FRAME"].get(frame)
    return f"frame {frame}" + (f", {entry.name.removeprefix('MAV_FRAME_')}" if entry else "")


def param(value: float, name: str) -> float | None:
    """A parameter as written: NaN means not given.

    Raises :class:`ItemError` for an infinite one.
    """
    if math.isinf(value):
        raise ItemError(name, "is not finite")
    return None if math.isnan(value) else float(value)


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
