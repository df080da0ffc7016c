"""Faults of timing: streams that are thinned out, clocks, and stamps."""

from __future__ import annotations

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.faults import timing as kinds
from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.frames import Frame, frames
from vehicle_sim.faults.impairment import Stage
from vehicle_sim.faults.interface import Datagram
from vehicle_sim.faults.schedule import Moment

#: Streams of measurements and of set-points: each message begins with its stamp.
_STREAMED = frozenset(
    {
        mavlink.MAVLINK_MSG_ID_ATTITUDE,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT,
        mavlink.MAVLINK_MSG_ID_ODOMETRY,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D,
        mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED,
        mavlink.MAVLINK_MSG_ID_TRAJECTORY_REPRESENTATION_WAYPOINTS,
        mavlink.MAVLINK_MSG_ID_TRAJECTORY_REPRESENTATION_BEZIER,
    }
)
_OVERFLOW = 2**32 * 1e-3  # s


class Thinning(Stage):
    """Lets through some messages of a datagram and not others."""

    def keeps(self, frame: Frame) -> bool:
        """Whether a message goes on."""
        raise NotImplementedError

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Without what is not kept."""
        data = datagram[0]
        found = list(frames(data))
        kept = [frame for frame in found if self.keeps(frame)]
        if len(kept) == len(found):
            out.append(datagram)
            return False
        if kept:
            out.append((b"".join(data[frame.start : frame.end] for frame in kept), datagram[1]))
        return True


class LowRate(Thinning):
    """An even share of each stream; messages of one stamp (the points of a scan) stay together."""

    def __init__(self, fault: ActiveFault, generator: np.random.Generator) -> None:
        super().__init__(fault, generator)
        self._streams: dict[tuple[int, int], tuple[bytes, float, bool]] = {}

    def keeps(self, frame: Frame) -> bool:
        """By a credit that grows with every new stamp of a stream."""
        if frame.message_id not in _STREAMED:
            return True
        key = frame.component, frame.message_id
        stamp, credit, kept = self._streams.get(key, (None, 1.0 - self.fault.settings.share, False))
        if frame.stamp != stamp:
            credit += self.fault.settings.share
            kept = credit >= 1.0 - 1e-9
            self._streams[key] = frame.stamp, credit - kept, kept
        return kept


class GroundHang(Thinning):
    """Heartbeats only."""

    def keeps(self, frame: Frame) -> bool:
        """A heartbeat."""
        return frame.message_id == mavlink.MAVLINK_MSG_ID_HEARTBEAT


STAGES: dict[type, type[Stage]] = {kinds.LowRate: LowRate, kinds.GroundHang: GroundHang}

CLOCKS = (kinds.ClockSkew, kinds.ClockStep, kinds.StampWrap)


def clock_error(fault: ActiveFault, now: float) -> float:
    """What a vehicle's clock is ahead (s) by a fault of the kinds :data:`CLOCKS`."""
    settings = fault.settings
    if isinstance(settings, kinds.ClockSkew):
        return settings.rate * fault.schedule.time_there(now)
    moment = fault.schedule.at(now)
    if moment is None:
        return 0.0
    if isinstance(settings, kinds.StampWrap):
        return _OVERFLOW - settings.lead - (now - moment.elapsed)
    return float(settings.step)


def stamp_age(fault: ActiveFault, now: float) -> float:
    """By how much stamps are too old (s)."""
    return float(fault.settings.age) if fault.schedule.at(now) is not None else 0.0
