"""Telemetry: MAVLink messages of the vehicles become measurements for the estimator."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import LAYOUTS, Sample
from gcs.mavlink.messages import Received
from gcs.mavlink.telemetry_kernels import poses_and_motions
from idc_controller.estimation.measurements import Attitude, Measurement, Position
from idc_controller.perception.scan_placement import Returns, ScanEnd

_POINT, _SCAN_END = LAYOUTS[Sample.RETURNS.value].dtype, LAYOUTS[Sample.SCAN_END.value].dtype
_ATTITUDE = Sample.ATTITUDE
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
    motion cannot be one, that part is nan, as MAVLink has it for an unknown rate. Nobody can write to their arrays,
    which share memory.

    Args:
        messages: Each with its source and its time of validity (s, team time).

    Returns:
        The measurements, and the indices of the messages without a pose, a motion or both.
    """
    data = bytearray().join([received.payload[:_READ].ljust(_READ, b"\0") for received, _, _ in messages])
    is_attitude = [received.layout.sample is _ATTITUDE for received, _, _ in messages]
    values, measured = poses_and_motions(np.frombuffer(data, "<f4").reshape(-1, _READ // 4), np.array(is_attitude))
    values.flags.writeable = False
    found: list[Measurement] = []
    partial: list[int] = []
    parts = zip(messages, is_attitude, measured.tolist(), values[:, :4], values[:, 4:], strict=True)
    for k, ((_, source, time), attitude, (has_pose, has_motion), pose, motion) in enumerate(parts):
        if not (has_pose and has_motion):
            partial.append(k)
            if not (has_pose or has_motion):
                continue
        found.append(Attitude(time, source, pose, motion) if attitude else Position(time, source, pose[:3], motion))
    return found, partial


def scan_returns(received: Received) -> Returns:
    """Return the returns of a range sensor in an OBSTACLE_DISTANCE_3D or a run of them.

    One in a frame other than the body's has no place (nan).
    """
    data = received.payload if received.run > 1 else received.payload.ljust(_POINT.itemsize, b"\0")
    values = np.frombuffer(data, _POINT, received.run)
    points = np.empty((len(values), 3))
    points[:, 0], points[:, 1], points[:, 2] = values["x"], values["y"], values["z"]
    points[values["frame"] != mavlink.MAV_FRAME_BODY_FRD] = math.nan
    return Returns(received.time_boot_ms, points, values["max_distance"].astype(float))


def scan_end(received: Received, is_complete: bool) -> ScanEnd:
    """Return what an OBSTACLE_DISTANCE says: that a scan was made, of which all messages or not all have come."""
    size = _SCAN_END.itemsize
    values = np.frombuffer(received.payload[:size].ljust(size, b"\0"), _SCAN_END)
    return ScanEnd(received.time_boot_ms, 0.01 * values["max_distance"].item(), is_complete)
