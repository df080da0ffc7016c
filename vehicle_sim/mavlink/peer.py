"""One peer of a vehicle, and its streams."""

import math
from dataclasses import fields

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import StreamIntervals, VehicleLinkSettings
from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec, gather
from gcs.mavlink.layout import Packed, PackedRun, packed
from gcs.mavlink.messages import Message
from vehicle_sim.mavlink.telemetry import Built, TelemetrySample

TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact

_TEXT_LIMIT = 50
_AUTOPILOT, _PAYLOAD = px4.AUTOPILOT_COMPONENT, px4.PAYLOAD_UNIT_COMPONENT

#: Messages of one sample, which begin with its stamp: never sent twice for the same one.
_OF_ONE_SAMPLE = (
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
    mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D,
    mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
)
_STAMP_LENGTH = 4


def default_intervals(intervals: StreamIntervals, telemetry_interval: float) -> dict[tuple[int, int], float]:
    """Return the intervals (s) of all streams by component and message, in the order in which they are sent.

    ``telemetry_interval`` of position and attitude, the vehicle's and the payload's. With every sample goes the
    set-point that was being flown, because set-points may be lost. A scan is sent as soon as there is one, behind the
    attitude and position at which it was made: its returns, then the message that ends it.
    """
    return {
        # The settings have the names of the messages.
        **{
            (_AUTOPILOT, getattr(mavlink, f"MAVLINK_MSG_ID_{setting.name.upper()}")): getattr(intervals, setting.name)
            for setting in fields(intervals)
        },
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_HEARTBEAT): intervals.heartbeat,
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_VIBRATION): intervals.vibration,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED): telemetry_interval,
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION): telemetry_interval,
        (_PAYLOAD, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D): telemetry_interval,
        (_AUTOPILOT, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE): telemetry_interval,
    }


class Stream:
    """One message that is sent again and again, at whole multiples of its interval, so that streams coincide."""

    __slots__ = ("_last_stamp", "_of_one_sample", "due", "interval", "key", "repeats")

    def __init__(self, component: int, message_id: int, interval: float) -> None:
        """``interval`` in s; due at once."""
        self.key = component, message_id
        self.interval = interval
        self.due = -math.inf
        self.repeats = 0
        self._of_one_sample = message_id in _OF_ONE_SAMPLE
        self._last_stamp = b""

    def take(self, sample: TelemetrySample, now: float, repeat_interval: float) -> Built:
        """Return the messages of ``sample`` that are due, none where those of its stamp were sent already.

        They are due next at the next multiple of the interval; sooner while repetitions are due (interval in s).
        """
        self.due = (math.floor((now + TIME_TOLERANCE) / self.interval) + 1) * self.interval
        if self.repeats:
            self.repeats -= 1
            self.due = min(self.due, now + repeat_interval)
        messages = sample.messages(self.key)
        if messages and self._of_one_sample:
            first = messages.values[0].tobytes() if isinstance(messages, PackedRun) else messages[0][1]
            stamp = first[:_STAMP_LENGTH]
            if stamp == self._last_stamp:
                return ()
            self._last_stamp = stamp
        return messages


class Peer:
    """One address, with its own streams and its own sequence numbers, so that gaps show losses on its link only."""

    def __init__(
        self,
        address: Address,
        system_id: int,
        intervals: dict[tuple[int, int], float],
        settings: VehicleLinkSettings,
        with_payload: bool = True,
    ) -> None:
        """``intervals`` as :func:`default_intervals` gives them; all streams start at once.

        Without ``with_payload`` those of the payload unit start only on request: another vehicle sends them there.
        """
        self.address = address
        self.heard_at = -math.inf
        self.next_due = -math.inf
        self._settings = settings
        self._codecs = {
            _AUTOPILOT: Codec(system_id, _AUTOPILOT),
            _PAYLOAD: Codec(px4.PAYLOAD_UNIT_SYSTEM, _PAYLOAD),
        }
        self._replies: list[bytes] = []
        self._defaults = intervals
        self._streams = [
            Stream(*key, interval) for key, interval in intervals.items() if with_payload or key[0] != _PAYLOAD
        ]

    def set_interval(self, message_id: int, interval: float, component: int = _AUTOPILOT) -> None:
        """Set the interval (s) of a message on this link; 0 restores the default, infinity stops it.

        ``component`` of the vehicle's autopilot or of the payload unit.
        """
        key = component, message_id
        if interval == 0.0:
            interval = self._defaults.get(key, math.inf)
        self._streams = [stream for stream in self._streams if stream.key != key]
        if math.isfinite(interval):
            self._streams.append(Stream(*key, interval))
        self.next_due = -math.inf

    def repeat(self, *message_ids: int, component: int = _AUTOPILOT) -> None:
        """Send these messages at once, and repeatedly: their content has changed, one may be lost."""
        for stream in self._streams:
            if stream.key[0] == component and stream.key[1] in message_ids:
                stream.due, stream.repeats = -math.inf, self._settings.repeats
        self.next_due = -math.inf

    def reply(self, *messages: Message, component: int = _AUTOPILOT) -> None:
        """Send messages of the autopilot or of the payload unit with the next datagrams."""
        self.reply_packed(*packed(*messages), component=component)

    def reply_packed(self, *messages: Packed, component: int = _AUTOPILOT) -> None:
        """Send messages with the next datagrams, as :meth:`reply` does."""
        if len(self._replies) < self._settings.replies_max:
            self._replies += [self._codecs[component].frame(message) for message in messages]
            self.next_due = -math.inf

    def send_statustext(self, text: str) -> None:
        """Send a warning to the operator as STATUSTEXT, in pieces of its length."""
        data = text.encode("ascii", "replace")
        for start in range(0, len(data), _TEXT_LIMIT):
            piece = data[start : start + _TEXT_LIMIT]
            self.reply(mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_WARNING, piece))

    def datagrams(self, sample: TelemetrySample, now: float) -> list[bytes]:
        """Return replies and what is due of ``sample``, in as few datagrams as possible."""
        latest = now + TIME_TOLERANCE
        if latest < self.next_due:
            return []
        frames = self._replies
        self._replies = []
        next_due, repeat_interval = math.inf, self._settings.repeat_interval
        for stream in self._streams:
            if stream.due <= latest:
                messages = stream.take(sample, now, repeat_interval)
                codec = self._codecs[stream.key[0]]
                if isinstance(messages, PackedRun):
                    frames += codec.frames(messages)
                else:
                    for message in messages:
                        frames.append(codec.frame(message))
            if stream.due < next_due:
                next_due = stream.due
        self.next_due = next_due
        return gather(frames)
