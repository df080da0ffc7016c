"""Commands and frames of mission items, by the numbers and names of MAVLink's common and ArduPilot's dialect.

They stand here because importing the dialect takes longer than reading a mission; a test compares them with it.
"""

from enum import IntEnum


class Command(IntEnum):
    """A MAV_CMD of navigation, waiting, speed or jumps; :mod:`.compile` has those that are flown."""

    NAV_WAYPOINT = 16
    NAV_LOITER_UNLIM = 17
    NAV_LOITER_TURNS = 18
    NAV_LOITER_TIME = 19
    NAV_RETURN_TO_LAUNCH = 20
    NAV_LAND = 21
    NAV_TAKEOFF = 22
    NAV_LAND_LOCAL = 23
    NAV_TAKEOFF_LOCAL = 24
    NAV_FOLLOW = 25
    NAV_CONTINUE_AND_CHANGE_ALT = 30
    NAV_LOITER_TO_ALT = 31
    NAV_ARC_WAYPOINT = 36
    NAV_PATHPLANNING = 81
    NAV_SPLINE_WAYPOINT = 82
    NAV_VTOL_TAKEOFF = 84
    NAV_VTOL_LAND = 85
    NAV_GUIDED_ENABLE = 92
    NAV_DELAY = 93
    NAV_PAYLOAD_PLACE = 94
    CONDITION_DELAY = 112
    CONDITION_CHANGE_ALT = 113
    CONDITION_DISTANCE = 114
    DO_JUMP = 177
    DO_CHANGE_SPEED = 178
    JUMP_TAG = 600
    DO_JUMP_TAG = 601
    CONDITION_GATE = 4501
    """Of MAVLink's development dialect: a point to fly through, which QGroundControl writes into surveys."""


class Frame(IntEnum):
    """A MAV_FRAME that a mission may have."""

    GLOBAL = 0
    MISSION = 2
    GLOBAL_RELATIVE_ALT = 3
    GLOBAL_INT = 5
    GLOBAL_RELATIVE_ALT_INT = 6
    GLOBAL_TERRAIN_ALT = 10
    GLOBAL_TERRAIN_ALT_INT = 11


FRAMES = frozenset(Frame)
AMSL_FRAMES = frozenset({Frame.GLOBAL, Frame.GLOBAL_INT})
"""Frames whose altitudes are above mean sea level; those of the others are above home, over flat ground."""

LAST_NAVIGATION = 95
"""MAV_CMD_NAV_LAST: the commands up to this number navigate."""
RALLY_POINT = 5100
FENCE_AND_RALLY = frozenset({*range(5000, 5005), RALLY_POINT})

LEFT_OUT = {
    # camera and video
    200: "DO_CONTROL_VIDEO",
    202: "DO_DIGICAM_CONFIGURE",
    203: "DO_DIGICAM_CONTROL",
    206: "DO_SET_CAM_TRIGG_DIST",
    214: "DO_SET_CAM_TRIGG_INTERVAL",
    521: "REQUEST_CAMERA_INFORMATION",
    522: "REQUEST_CAMERA_SETTINGS",
    525: "REQUEST_STORAGE_INFORMATION",
    526: "STORAGE_FORMAT",
    527: "REQUEST_CAMERA_CAPTURE_STATUS",
    529: "RESET_CAMERA_SETTINGS",
    530: "SET_CAMERA_MODE",
    531: "SET_CAMERA_ZOOM",
    532: "SET_CAMERA_FOCUS",
    533: "SET_STORAGE_USAGE",
    534: "SET_CAMERA_SOURCE",
    2000: "IMAGE_START_CAPTURE",
    2001: "IMAGE_STOP_CAPTURE",
    2002: "REQUEST_CAMERA_IMAGE_CAPTURE",
    2003: "DO_TRIGGER_CONTROL",
    2004: "CAMERA_TRACK_POINT",
    2005: "CAMERA_TRACK_RECTANGLE",
    2010: "CAMERA_STOP_TRACKING",
    2500: "VIDEO_START_CAPTURE",
    2501: "VIDEO_STOP_CAPTURE",
    2502: "VIDEO_START_STREAMING",
    2503: "VIDEO_STOP_STREAMING",
    2504: "REQUEST_VIDEO_STREAM_INFORMATION",
    2505: "REQUEST_VIDEO_STREAM_STATUS",
    260: "OBLIQUE_SURVEY",
    # gimbal and region of interest
    204: "DO_MOUNT_CONFIGURE",
    205: "DO_MOUNT_CONTROL",
    220: "DO_MOUNT_CONTROL_QUAT",
    1000: "DO_GIMBAL_MANAGER_PITCHYAW",
    1001: "DO_GIMBAL_MANAGER_CONFIGURE",
    80: "NAV_ROI",
    201: "DO_SET_ROI",
    195: "DO_SET_ROI_LOCATION",
    196: "DO_SET_ROI_WPNEXT_OFFSET",
    197: "DO_SET_ROI_NONE",
    198: "DO_SET_ROI_SYSID",
    # heading
    115: "CONDITION_YAW",
    # other devices on board
    183: "DO_SET_SERVO",
    184: "DO_REPEAT_SERVO",
    181: "DO_SET_RELAY",
    182: "DO_REPEAT_RELAY",
    187: "DO_SET_ACTUATOR",
    211: "DO_GRIPPER",
    216: "DO_SPRAYER",
    217: "DO_SEND_SCRIPT_MESSAGE",
    218: "DO_AUX_FUNCTION",
    42600: "DO_WINCH",
    405: "ILLUMINATOR_ON_OFF",
    406: "DO_ILLUMINATOR_CONFIGURE",
    2510: "LOGGING_START",
    2511: "LOGGING_STOP",
    # marks in the file, without an action
    189: "DO_LAND_START",
    188: "DO_RETURN_PATH_START",
}
"""Commands that concern devices which these vehicles do not have, the heading, which is kept, or nothing at all."""

_NAMES = {command.value: command.name for command in Command}


def command_name(command: int) -> str:
    """Return ``NAV_WAYPOINT``, or the number where MAVLink's dialects have no name for it."""
    if name := _NAMES.get(command) or LEFT_OUT.get(command):
        return name
    from pymavlink.dialects.v20 import ardupilotmega  # the common dialect and ArduPilot's

    entry = ardupilotmega.enums["MAV_CMD"].get(command)
    return entry.name.removeprefix("MAV_CMD_") if entry else f"command {command}"


def frame_name(frame: int) -> str:
    """Return ``frame 3, GLOBAL_RELATIVE_ALT``."""
    from pymavlink.dialects.v20 import common

    entry = common.enums["MAV_FRAME"].get(frame)
    return f"frame {frame}" + (f", {entry.name.removeprefix('MAV_FRAME_')}" if entry else "")
