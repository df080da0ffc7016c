"""Set-points of position, velocity and acceleration read from messages, as PX4 takes them."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.setpoints import SetpointError

ToLocal = Callable[[float, float, float], Vector]
"""From latitude and longitude (deg) and altitude above mean sea level (m) to the local frame (NED, m)."""

_NAN: Vector = (math.nan, math.nan, math.nan)
_POSITION, _VELOCITY, _ACCELERATION = 1, 8, 64  # the lowest of the three bits of each in a type mask
_YAW: int = mavlink.POSITION_TARGET_TYPEMASK_YAW_IGNORE
_YAW_RATE: int = mavlink.POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE
_FORCE: int = mavlink.POSITION_TARGET_TYPEMASK_FORCE_SET

_BODY_FRAMES = (mavlink.MAV_FRAME_BODY_NED, mavlink.MAV_FRAME_BODY_FRD)
_ABOVE_SEA = (mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT)
_ABOVE_HOME = (mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT)


class PositionSetpoint(NamedTuple):
    """Set-point of the position control in the local frame (NED, m, m/s, m/s2, rad, rad/s); NaN: not given.

    ``time_boot_ms``: the sender's stamp.
    """

    position: Vector
    velocity: Vector
    acceleration: Vector
    yaw: float
    yaw_rate: float
    time_boot_ms: int


def read_local(fields: tuple[Any, ...], heading: float) -> PositionSetpoint:
    """Return the set-point in the ``fields`` of a SET_POSITION_TARGET_LOCAL_NED, in the order of the wire.

    Velocity and acceleration of a body frame are turned by the vehicle's ``heading`` (rad); a position there is not
    taken. Raises :class:`SetpointError`.
    """
    stamp, x, y, z, v_x, v_y, v_z, a_x, a_y, a_z, yaw, yaw_rate, mask, _, _, frame = fields
    if frame == mavlink.MAV_FRAME_LOCAL_NED:
        return _setpoint(stamp, (x, y, z), (v_x, v_y, v_z), (a_x, a_y, a_z), yaw, yaw_rate, mask)
    if frame not in _BODY_FRAMES:
        raise SetpointError(f"coordinate frame {frame} is not supported: LOCAL_NED or BODY_NED")
    found = _setpoint(stamp, _NAN, (v_x, v_y, v_z), (a_x, a_y, a_z), yaw, yaw_rate, mask | 7 * _POSITION)
    velocity, acceleration = _turned(found.velocity, heading), _turned(found.acceleration, heading)
    return found._replace(velocity=velocity, acceleration=acceleration)


def read_global(fields: tuple[Any, ...], to_local: ToLocal, home_altitude: float) -> PositionSetpoint:
    """Return the set-point in the ``fields`` of a SET_POSITION_TARGET_GLOBAL_INT, in the order of the wire.

    ``home_altitude`` above mean sea level (m). Raises :class:`SetpointError`.
    """
    stamp, latitude, longitude, altitude, v_x, v_y, v_z, a_x, a_y, a_z, yaw, yaw_rate, mask, _, _, frame = fields
    if frame in _ABOVE_HOME:
        altitude += home_altitude
    elif frame not in _ABOVE_SEA:
        raise SetpointError(f"coordinate frame {frame} is not supported: GLOBAL_INT or GLOBAL_RELATIVE_ALT_INT")
    position = _NAN
    if mask & 7 * _POSITION != 7 * _POSITION:
        position = to_local(latitude * 1e-7, longitude * 1e-7, altitude)
    return _setpoint(stamp, position, (v_x, v_y, v_z), (a_x, a_y, a_z), yaw, yaw_rate, mask)


def _setpoint(
    stamp: int, position: Vector, velocity: Vector, acceleration: Vector, yaw: float, yaw_rate: float, mask: int
) -> PositionSetpoint:
    if mask & _FORCE:
        raise SetpointError("a force cannot be flown")
    position, velocity = _given(position, mask, _POSITION), _given(velocity, mask, _VELOCITY)
    acceleration = _given(acceleration, mask, _ACCELERATION)
    if all(map(math.isnan, (*position, *velocity, *acceleration))):
        raise SetpointError(f"type_mask {mask} gives neither position, velocity nor acceleration")
    if any(map(math.isinf, (*position, *velocity, *acceleration))):
        raise SetpointError("a number is infinite")
    yaw = yaw if not mask & _YAW and math.isfinite(yaw) else math.nan
    yaw_rate = yaw_rate if not mask & _YAW_RATE and math.isfinite(yaw_rate) else math.nan
    return PositionSetpoint(position, velocity, acceleration, yaw, yaw_rate, stamp)


def _given(values: Vector, mask: int, first: int) -> Vector:
    """Return what the three bits of the mask from ``first`` on leave of a vector."""
    x, y, z = values
    return (
        math.nan if mask & first else x,
        math.nan if mask & first << 1 else y,
        math.nan if mask & first << 2 else z,
    )


def _turned(vector: Vector, heading: float) -> Vector:
    x, y, z = vector
    cos, sin = math.cos(heading), math.sin(heading)
    return cos * x - sin * y, sin * x + cos * y, z
