"""Impairments of timing: message rates, clocks, and stamps."""

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.faults import timing as kinds
from gcs.mavlink.stop_plan import PAYLOAD_TYPE
from vehicle_sim.faults.active import ActiveFault, Moment
from vehicle_sim.faults.impairment import DatagramChange, Frame, SampleImpairment, frames
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState

#: Streams of measurements, set-points and stop plans.
_STREAMED = frozenset(
    {
        mavlink.MAVLINK_MSG_ID_ATTITUDE,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT,
        mavlink.MAVLINK_MSG_ID_ODOMETRY,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
        mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET,
        mavlink.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED,
        mavlink.MAVLINK_MSG_ID_TRAJECTORY_REPRESENTATION_WAYPOINTS,
        mavlink.MAVLINK_MSG_ID_TUNNEL,
    }
)
_STOP_PLAN = PAYLOAD_TYPE.to_bytes(2, "little")
_OVERFLOW = 2**32 * 1e-3  # s


class MessageFilter(DatagramChange):
    """Loss of some messages of a datagram."""

    def keeps(self, frame: Frame) -> bool:
        """Return whether a message goes on."""
        raise NotImplementedError

    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        found = list(frames(data))
        kept = [frame for frame in found if self.keeps(frame)]
        if len(kept) == len(found):
            return data
        return b"".join(data[frame.start : frame.end] for frame in kept) or None


class LowRate(MessageFilter, of=kinds.LowRate):
    """Rate limiter: an even share of each stream; messages of one stamp (the points of a scan) stay together."""

    def __init__(self, fault: ActiveFault, generator: np.random.Generator) -> None:
        super().__init__(fault, generator)
        self._streams: dict[tuple[int, int, int], tuple[bytes, float, bool]] = {}

    def keeps(self, frame: Frame) -> bool:
        """Keep a message by a credit that grows with every new stamp of its stream."""
        if frame.message_id not in _STREAMED:
            return True
        if frame.message_id == mavlink.MAVLINK_MSG_ID_TUNNEL and frame.stamp[:2] != _STOP_PLAN:
            return True
        key = frame.system, frame.component, frame.message_id
        stamp, credit, kept = self._streams.get(key, (None, 1.0 - self.fault.settings.share, False))
        if frame.stamp != stamp:
            credit += self.fault.settings.share
            kept = credit >= 1.0 - 1e-9
            self._streams[key] = frame.stamp, credit - kept, kept
        return kept


class GroundHang(MessageFilter, of=kinds.GroundHang):
    """Loss of all that the ground sends but its heartbeats."""

    direction = "command"

    def keeps(self, frame: Frame) -> bool:
        """Keep a heartbeat."""
        return bool(frame.message_id == mavlink.MAVLINK_MSG_ID_HEARTBEAT)


CLOCKS = (kinds.ClockSkew, kinds.ClockStep, kinds.StampWrap)


def clock_error(fault: ActiveFault, now: float) -> float:
    """Return by how much a vehicle's clock is ahead (s), for a fault of the kinds :data:`CLOCKS`, and count it."""
    error, settings, moment = 0.0, fault.settings, fault.schedule.at(now)
    if isinstance(settings, kinds.ClockSkew):
        error = settings.rate * fault.schedule.active_time(now)
    elif moment is not None and isinstance(settings, kinds.StampWrap):
        error = _OVERFLOW - settings.lead - (now - moment.elapsed)
    elif moment is not None:
        error = float(settings.step)
    fault.seen += 1
    fault.disturbed += error != 0.0
    return error


class StaleStamps(SampleImpairment, of=kinds.StaleStamps):
    """Stamps of an earlier time on all that is reported."""

    def reported(self, vehicle: int, report: ReportedState, moment: Moment) -> ReportedState:
        """Return the report with earlier stamps."""
        return ReportedState(*(None if part is None else self._aged(part) for part in report))

    def payload(self, vehicle: int, sample: Measurement, moment: Moment) -> Measurement:
        """Return the sample with an earlier stamp."""
        return self._aged(sample)

    def scan(self, vehicle: int, sample: RangeSample, moment: Moment) -> RangeSample:
        """Return the scan with an earlier stamp."""
        return sample._replace(time=self._stamp(sample.time))

    def _aged(self, sample: Measurement) -> Measurement:
        return sample._replace(time=self._stamp(sample.time))

    def _stamp(self, time: float) -> float:
        """Return the stamp by the schedule at the sample's own time: the sample may be reported for the second time."""
        settings: kinds.StaleStamps = self.fault.settings
        return max(time - settings.age, 0.0) if self.fault.schedule.at(time) is not None else max(time, 0.0)
