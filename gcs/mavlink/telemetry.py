"""Telemetry: MAVLink messages of the vehicles become measurements for the estimator."""

import math
from collections.abc import Callable
from functools import lru_cache
from struct import Struct
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.messages import Received
from gcs.mavlink.scan_sequence import ScanSequence, scan_stamp
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position
from idc_controller.perception.scan_placement import Returns, ScanEnd

_ATTITUDE = LAYOUTS[mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION]
_POSITION = LAYOUTS[mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED]
_POINT = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D]
_SCAN_END = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE]
_NAN = math.nan
_THREE, _FOUR = Struct("3d").pack, Struct("4d").pack
_THREE_UNKNOWN, _FOUR_UNKNOWN = _THREE(*[_NAN] * 3), _FOUR(*[_NAN] * 4)

_Values = tuple[Array, Array] | None
"""Pose and motion, one of them nan if it cannot be a measurement; None: neither can."""


def setpoint_flown(fields: tuple[Any, ...], thrust_max: float) -> Array | None:
    """Return the tilt of the thrust (north, east) and thrust (N), (3,), in an ATTITUDE_TARGET; None: it has neither.

    ``fields`` in the order of the wire; ``thrust_max`` (N) is what the vehicle means by thrust 1.
    """
    _, w, x, y, z, _, _, _, thrust, type_mask = fields
    if type_mask & mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE:
        return None
    flown = (-2.0 * (x * z + w * y), -2.0 * (y * z - w * x), thrust * thrust_max)
    return np.array(flown) if math.isfinite(sum(flown)) else None


def measurement(received: Received, uav: int, time: float) -> Measurement | None:
    """Return the measurement in a message of UAV ``uav`` (0 .. N-1), true at ``time`` (s, team time).

    None for messages that measure nothing and for values that cannot be measurements (not finite, no rotation). Where
    only the pose or only the motion cannot be one, that part is nan, as MAVLink has it for an unknown rate.
    The payload's navigation unit is a component of its own, relayed by every vehicle.
    """
    layout, component = received.layout, received.component
    if layout is not _ATTITUDE and layout is not _POSITION:
        return None
    if component == px4.AUTOPILOT_COMPONENT:
        source, values = uav, _READ[layout.message_id](received.payload)
    elif component == px4.PAYLOAD_UNIT_COMPONENT:
        source, values = PAYLOAD, _READ_ONCE[layout.message_id](received.payload)
    else:
        return None
    if values is None:
        return None
    return (Attitude if layout is _ATTITUDE else Position)(time, source, *values)


def scan_returns(received: Received) -> Returns:
    """Return the returns of a range sensor in an OBSTACLE_DISTANCE_3D or a run of them.

    One in a frame other than the body's has no place (nan).
    """
    data = received.payload if received.run > 1 else received.payload.ljust(_POINT.dtype.itemsize, b"\0")
    values = np.frombuffer(data, _POINT.dtype, received.run)
    points = np.empty((len(values), 3))
    points[:, 0], points[:, 1], points[:, 2] = values["x"], values["y"], values["z"]
    points[values["frame"] != mavlink.MAV_FRAME_BODY_FRD] = _NAN
    return Returns(received.time_boot_ms, points, values["max_distance"].astype(float))


def scan_end(received: Received, scans: ScanSequence) -> ScanEnd:
    """Return what an OBSTACLE_DISTANCE says: that a scan was made, whose messages are in ``scans``."""
    stamp, size = scan_stamp(received), _SCAN_END.dtype.itemsize
    values = np.frombuffer(received.payload[:size].ljust(size, b"\0"), _SCAN_END.dtype)
    return ScanEnd(stamp, 0.01 * values["max_distance"].item(), scans.is_complete(stamp))


def _attitude(payload: bytes) -> _Values:
    _, w, x, y, z, p, q, r, _, _, _, _ = _ATTITUDE.fields(payload)
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    return _values(
        _FOUR(w / norm, x / norm, y / norm, z / norm) if 0.9 < norm < 1.1 else None,
        _THREE(p, q, r) if math.isfinite(p + q + r) else None,
        unknown_pose=_FOUR_UNKNOWN,
    )


def _position(payload: bytes) -> _Values:
    _, x, y, z, v_x, v_y, v_z = _POSITION.fields(payload)
    return _values(
        _THREE(x, y, z) if math.isfinite(x + y + z) else None,
        _THREE(v_x, v_y, v_z) if math.isfinite(v_x + v_y + v_z) else None,
        unknown_pose=_THREE_UNKNOWN,
    )


def _values(pose: bytes | None, motion: bytes | None, unknown_pose: bytes) -> _Values:
    """Return pose and motion as arrays that nobody can write to: all who relay them share them.

    None: it cannot be a measurement.
    """
    if pose is None and motion is None:
        return None
    return np.frombuffer(pose or unknown_pose), np.frombuffer(motion or _THREE_UNKNOWN)


_READ: dict[int, Callable[[bytes], _Values]] = {_ATTITUDE.message_id: _attitude, _POSITION.message_id: _position}
#: The payload unit's messages are equal from whomever relays them: each is read once.
_READ_ONCE = {message_id: lru_cache(maxsize=4)(read) for message_id, read in _READ.items()}
