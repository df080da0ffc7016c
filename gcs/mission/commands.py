"""Commands and frames of mission items, by the numbers and names of MAVLink's common and ArduPilot's dialect.

Those that are flown stand here because importing the dialect takes longer than reading a mission; a test compares them
with it.
"""

from enum import IntEnum


class Command(IntEnum):
    """A MAV_CMD that is flown, by :mod:`.compile`."""

    NAV_WAYPOINT = 16
    NAV_LOITER_UNLIM = 17
    NAV_LOITER_TURNS = 18
    NAV_LOITER_TIME = 19
    NAV_RETURN_TO_LAUNCH = 20
    NAV_LAND = 21
    NAV_TAKEOFF = 22
    NAV_LOITER_TO_ALT = 31
    NAV_SPLINE_WAYPOINT = 82
    NAV_DELAY = 93
    NAV_PAYLOAD_PLACE = 94
    CONDITION_DELAY = 112
    DO_JUMP = 177
    DO_CHANGE_SPEED = 178
    DO_GRIPPER = 211
    JUMP_TAG = 600
    DO_JUMP_TAG = 601
    CONDITION_GATE = 4501
    """Of MAVLink's development dialect: a point to fly through, which QGroundControl writes into surveys."""
    DO_WINCH = 42600


class GripperAction(IntEnum):
    """A GRIPPER_ACTION."""

    RELEASE = 0
    GRAB = 1


WINCH_ACTIONS = {4: GripperAction.RELEASE, 6: GripperAction.GRAB, 7: GripperAction.GRAB}
"""WINCH_ACTIONS that unload or load: DELIVER, LOAD_LINE and LOAD_PAYLOAD."""


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

LEFT_OUT = frozenset({
    # camera and video
    200, 202, 203, 206, 214, 260, 521, 522, 525, 526, 527, 529, 530, 531, 532, 533, 534, 2000, 2001, 2002, 2003, 2004,
    2005, 2010, 2500, 2501, 2502, 2503, 2504, 2505,
    # gimbal and region of interest
    80, 195, 196, 197, 198, 201, 204, 205, 220, 1000, 1001,
    115,  # heading
    # other devices on board
    181, 182, 183, 184, 187, 216, 217, 218, 405, 406, 2510, 2511,
    188, 189,  # marks in the file, without an action
})  # fmt: skip
"""Commands that concern devices which these vehicles do not have, the heading, which is kept, or nothing at all."""

_NAMES = {command.value: command.name for command in Command}


def command_name(command: int) -> str:
    """Return ``NAV_WAYPOINT``, or the number where MAVLink's dialects have no name for it."""
    if name := _NAMES.get(command):
        return name
    from pymavlink.dialects.v20 import ardupilotmega  # the common dialect and ArduPilot's

    entry = ardupilotmega.enums["MAV_CMD"].get(command)
    return entry.name.removeprefix("MAV_CMD_") if entry else f"command {command}"


def frame_name(frame: int) -> str:
    """Return ``frame 3, GLOBAL_RELATIVE_ALT``."""
    from pymavlink.dialects.v20 import common

    entry = common.enums["MAV_FRAME"].get(frame)
    return f"frame {frame}" + (f", {entry.name.removeprefix('MAV_FRAME_')}" if entry else "")
