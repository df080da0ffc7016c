"""Telemetry: MAVLink messages of the vehicles become measurements for the estimator."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.messages import Received
from gcs.mavlink.scan_sequence import ScanSequence, scan_stamp
from gcs.mavlink.telemetry_kernels import poses_and_motions
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, Position
from idc_controller.perception.scan_placement import Returns, ScanEnd

_POINT = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D]
_SCAN_END = LAYOUTS[mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE]
_AUTOPILOT = px4.AUTOPILOT_COMPONENT
_PAYLOAD_UNIT = px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT
_KINDS: dict[int, type[Measurement]] = {
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: Attitude,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: Position,
}
_READ = 32
"""Bytes of a navigation message that are read: stamp, pose and motion."""


def setpoint_flown(fields: tuple[Any, ...], thrust_max: float) -> tuple[float, float, float] | None:
    """Return the tilt of the thrust (north, east) and thrust (N) in an ATTITUDE_TARGET; None: it has neither.

    ``fields`` in the order of the wire; ``thrust_max`` (N) is what the vehicle means by thrust 1.
    """
    _, w, x, y, z, _, _, _, thrust, type_mask = fields
    if type_mask & mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE:
        return None
    flown = (-2.0 * (x * z + w * y), -2.0 * (y * z - w * x), thrust * thrust_max)
    return flown if math.isfinite(sum(flown)) else None


def measurements(messages: Sequence[tuple[Received, int, float]]) -> tuple[list[Measurement], list[int]]:
    """Return the measurements in ATTITUDE_QUATERNION and LOCAL_POSITION_NED, in order.

    There is none in values that cannot be measurements (not finite, no rotation). Where only the pose or only the
    motion cannot be one, that part is nan, as MAVLink has it for an unknown rate. The payload's navigation unit is a
    system of its own, forwarded by every vehicle. Nobody can write to their arrays, which share memory.

    Args:
        messages: Each with its UAV (0 .. N-1) and its time of validity (s, team time).

    Returns:
        The measurements, and the indices of the messages without a pose, a motion or both.
    """
    data = bytearray().join([received.payload[:_READ].ljust(_READ, b"\0") for received, _, _ in messages])
    kinds = [_KINDS[received.layout.message_id] for received, _, _ in messages]
    is_attitude = [kind is Attitude for kind in kinds]
    values, measured = poses_and_motions(np.frombuffer(data, "<f4").reshape(-1, _READ // 4), np.array(is_attitude))
    values.flags.writeable = False
    found: list[Measurement] = []
    partial: list[int] = []
    parts = zip(messages, kinds, measured.tolist(), values[:, :4], values[:, 4:], strict=True)
    for k, ((received, uav, time), kind, (has_pose, has_motion), pose, motion) in enumerate(parts):
        if (received.system, received.component) == _PAYLOAD_UNIT:
            source = PAYLOAD
        elif received.component == _AUTOPILOT:
            source = uav
        else:
            continue
        if not (has_pose and has_motion):
            partial.append(k)
            if not (has_pose or has_motion):
                continue
        found.append(kind(time, source, pose if kind is Attitude else pose[:3], motion))
    return found, partial


def scan_returns(received: Received) -> Returns:
    """Return the returns of a range sensor in an OBSTACLE_DISTANCE_3D or a run of them.

    One in a frame other than the body's has no place (nan).
    """
    data = received.payload if received.run > 1 else received.payload.ljust(_POINT.dtype.itemsize, b"\0")
    values = np.frombuffer(data, _POINT.dtype, received.run)
    points = np.empty((len(values), 3))
    points[:, 0], points[:, 1], points[:, 2] = values["x"], values["y"], values["z"]
    points[values["frame"] != mavlink.MAV_FRAME_BODY_FRD] = math.nan
    return Returns(received.time_boot_ms, points, values["max_distance"].astype(float))


def scan_end(received: Received, scans: ScanSequence) -> ScanEnd:
    """Return what an OBSTACLE_DISTANCE says: that a scan was made, whose messages are in ``scans``."""
    stamp, size = scan_stamp(received), _SCAN_END.dtype.itemsize
    values = np.frombuffer(received.payload[:size].ljust(size, b"\0"), _SCAN_END.dtype)
    return ScanEnd(stamp, 0.01 * values["max_distance"].item(), scans.is_complete(stamp))
