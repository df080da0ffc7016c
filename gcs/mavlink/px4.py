"""The PX4 flavour of MAVLink: custom modes, byte-wise parameters, and the names both ends of the wire share.

Sources: PX4 ``px4_custom_mode.h``; MAVLink parameter protocol, "byte-wise" encoding.
"""

import struct
from enum import IntEnum
from functools import lru_cache

import pymavlink.dialects.v20.ardupilotmega as mavlink

AUTOPILOT_COMPONENT: int = mavlink.MAV_COMP_ID_AUTOPILOT1
#: The payload's navigation unit: a MAVLink system of its own, whose messages every vehicle forwards to the ground.
PAYLOAD_UNIT_SYSTEM = 100
#: Not an autopilot's, which would make it a vehicle; MAVLink's for a device without parameters.
PAYLOAD_UNIT_COMPONENT: int = mavlink.MAV_COMP_ID_PERIPHERAL

#: The ground station's system id.
GROUND_SYSTEM = 255

#: ``param2`` of MAV_CMD_COMPONENT_ARM_DISARM that overrides the checks.
FORCE_ARM_DISARM = 21196.0

# Parameters. At most 16 characters; PX4's own name where PX4 has the parameter.
PARAM_THRUST_MAX = "CLFT_THRUST_MAX"  #: N, the force of thrust 1.0 (thrust is linear in force), read-only
PARAM_MASS = "CLFT_MASS"  #: kg, the vehicle's own mass, read-only
PARAM_ATTITUDE_KP = "CLFT_ATT_KP"  #: 1/s2, torque = J (kp e - kd omega), read-only
PARAM_ATTITUDE_KD = "CLFT_ATT_KD"  #: 1/s, read-only
PARAM_MOTOR_LAG = "CLFT_MOTOR_LAG"  #: s, time constant of the rotor speed, read-only
PARAM_ONBOARD_RATE = "CLFT_LOOP_RATE"  #: Hz, integer, the onboard loop, read-only
PARAM_LAND_DELAY = "CLFT_LAND_DELAY"  #: s from holding after a loss to descending
PARAM_SETPOINT_LOSS = "COM_OF_LOSS_T"  #: s without set-points until the vehicle brakes
PARAM_LINK_LOSS = "COM_DL_LOSS_T"  #: s, integer, without any ground until a holding vehicle descends
PARAM_LINK_LOSS_ACTION = "NAV_DLL_ACT"  #: integer, one of LINK_LOSS_...
PARAM_LAND_SPEED = "MPC_LAND_SPEED"  #: m/s, the descent
PARAM_TAKEOFF_ALTITUDE = "MIS_TAKEOFF_ALT"  #: m
PARAM_SYSTEM_ID = "MAV_SYS_ID"  #: integer, read-only

PREFLIGHT_DISARM = 10.0
"""s for which an armed aircraft waits for a take-off: PX4's default of COM_DISARM_PRFLT."""

LINK_LOSS_NOTHING, LINK_LOSS_HOLD, LINK_LOSS_RETURN, LINK_LOSS_LAND = range(4)
"""Values of NAV_DLL_ACT."""


class MainMode(IntEnum):
    """PX4_CUSTOM_MAIN_MODE."""

    MANUAL = 1
    ALTCTL = 2
    POSCTL = 3
    AUTO = 4
    ACRO = 5
    OFFBOARD = 6
    STABILIZED = 7


class AutoMode(IntEnum):
    """PX4_CUSTOM_SUB_MODE_AUTO, the sub-modes of :attr:`MainMode.AUTO`."""

    READY = 1
    TAKEOFF = 2
    LOITER = 3
    MISSION = 4
    RTL = 5
    LAND = 6
    FOLLOW_TARGET = 8
    PRECLAND = 9


def encode_custom_mode(main: int, sub: int = 0) -> int:
    """Return ``custom_mode`` of a HEARTBEAT or SET_MODE: the main mode in bits 16-23, the sub-mode in bits 24-31."""
    return (main & 0xFF) << 16 | (sub & 0xFF) << 24


def decode_custom_mode(custom_mode: int) -> tuple[int, int]:
    """Return (main, sub) of a ``custom_mode``; either may be a number that PX4 does not use."""
    return custom_mode >> 16 & 0xFF, custom_mode >> 24 & 0xFF


MODE_MANUAL = encode_custom_mode(MainMode.MANUAL)
MODE_ALTCTL = encode_custom_mode(MainMode.ALTCTL)
MODE_POSCTL = encode_custom_mode(MainMode.POSCTL)
MODE_ORBIT = encode_custom_mode(MainMode.POSCTL, 1)
MODE_OFFBOARD = encode_custom_mode(MainMode.OFFBOARD)
MODE_TAKEOFF = encode_custom_mode(MainMode.AUTO, AutoMode.TAKEOFF)
MODE_HOLD = encode_custom_mode(MainMode.AUTO, AutoMode.LOITER)
MODE_MISSION = encode_custom_mode(MainMode.AUTO, AutoMode.MISSION)
MODE_RETURN = encode_custom_mode(MainMode.AUTO, AutoMode.RTL)
MODE_LAND = encode_custom_mode(MainMode.AUTO, AutoMode.LAND)

#: Modes that are one of MAVLink's standard modes, as of a multicopter.
STANDARD_MODES: dict[int, int] = {
    MODE_POSCTL: mavlink.MAV_STANDARD_MODE_POSITION_HOLD,
    MODE_ALTCTL: mavlink.MAV_STANDARD_MODE_ALTITUDE_HOLD,
    MODE_ORBIT: mavlink.MAV_STANDARD_MODE_ORBIT,
    MODE_RETURN: mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY,
    MODE_MISSION: mavlink.MAV_STANDARD_MODE_MISSION,
    MODE_LAND: mavlink.MAV_STANDARD_MODE_LAND,
    MODE_TAKEOFF: mavlink.MAV_STANDARD_MODE_TAKEOFF,
}

#: The names that PX4 shows users in AVAILABLE_MODES.
MODE_LABELS: dict[int, str] = {
    MODE_MANUAL: "Manual",
    MODE_ALTCTL: "Altitude",
    MODE_POSCTL: "Position",
    MODE_ORBIT: "Orbit",
    MODE_OFFBOARD: "Offboard",
    MODE_TAKEOFF: "Takeoff",
    MODE_HOLD: "Hold",
    MODE_MISSION: "Mission",
    MODE_RETURN: "Return",
    MODE_LAND: "Land",
}


def standard_mode(custom_mode: int) -> int:
    """Return the MAV_STANDARD_MODE of a custom mode; 0 (non-standard) if it is none."""
    return STANDARD_MODES.get(custom_mode, mavlink.MAV_STANDARD_MODE_NON_STANDARD)


@lru_cache(maxsize=64)
def mode_name(custom_mode: int) -> str:
    """Return the name: ``OFFBOARD``, ``AUTO.LOITER``, or the numbers of a mode that is not known."""
    main, sub = decode_custom_mode(custom_mode)
    if custom_mode == MODE_ORBIT:
        return "POSCTL.ORBIT"
    try:
        name = MainMode(main).name
        return f"{name}.{AutoMode(sub).name}" if main == MainMode.AUTO and sub else name
    except ValueError:
        return f"mode {main}.{sub}"


_INTEGER_FORMATS = {
    mavlink.MAV_PARAM_TYPE_UINT8: "<Bxxx",
    mavlink.MAV_PARAM_TYPE_INT8: "<bxxx",
    mavlink.MAV_PARAM_TYPE_UINT16: "<Hxx",
    mavlink.MAV_PARAM_TYPE_INT16: "<hxx",
    mavlink.MAV_PARAM_TYPE_UINT32: "<I",
    mavlink.MAV_PARAM_TYPE_INT32: "<i",
}


def parameter_to_wire(value: float, parameter_type: int) -> float:
    """Return the float that carries a parameter: integers keep their bytes, they are not converted.

    Raises ``ValueError`` for a value that does not fit its type, and for the few integers (about -4 to -8 million)
    whose bytes are a signalling NaN that a float conversion would change.
    """
    if parameter_type == mavlink.MAV_PARAM_TYPE_REAL32:
        return float(value)
    form = _INTEGER_FORMATS.get(parameter_type)
    if form is None or value != int(value):
        raise ValueError(f"{value} cannot be sent as a parameter of type {parameter_type}")
    try:
        data = struct.pack(form, int(value))
    except struct.error as error:
        raise ValueError(f"{value} does not fit parameter type {parameter_type}: {error}") from None
    wire: float = struct.unpack("<f", data)[0]
    if struct.pack("<f", wire) != data:
        raise ValueError(f"{value} does not survive the conversion to a float")
    return wire


def parameter_from_wire(wire: float, parameter_type: int) -> float | int:
    """Return the value of a PARAM_VALUE or PARAM_SET field. Raises ``ValueError`` for a type that PX4 does not use."""
    if parameter_type == mavlink.MAV_PARAM_TYPE_REAL32:
        return wire
    form = _INTEGER_FORMATS.get(parameter_type)
    if form is None:
        raise ValueError(f"parameter type {parameter_type} is not used over this protocol")
    value: int = struct.unpack(form, struct.pack("<f", wire))[0]
    return value
