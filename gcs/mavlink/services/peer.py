"""One peer of an aircraft, and its streams."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec, gather
from gcs.mavlink.layout import Packed, PackedRun, packed
from gcs.mavlink.messages import Message
from gcs.mavlink.services.aircraft import Built, MessageKey, Sample
from gcs.mavlink.settings import PeerSettings

TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact

_TEXT_LIMIT, _TEXT_ID_MAX = 50, 0xFFFF
_AUTOPILOT = px4.AUTOPILOT_COMPONENT
_HEARTBEAT = _AUTOPILOT, mavlink.MAVLINK_MSG_ID_HEARTBEAT

#: Messages of one sample, which begin with its stamp: never sent twice for the same one.
_OF_ONE_SAMPLE = (
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
    mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D,
    mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
)
_STAMP_LENGTH = 4


class Stream:
    """One message that is sent again and again, at whole multiples of its interval, so that streams coincide."""

    __slots__ = ("_last_stamp", "_of_one_sample", "_offset", "_waits", "due", "interval", "key", "repeats")

    def __init__(self, component: int, message_id: int, interval: float, offset: float = 0.0) -> None:
        """``interval`` in s; due at once, or with an ``offset`` (s) so long after the next multiple."""
        self.key = component, message_id
        self.interval = interval
        self._offset = offset
        self._waits = offset > 0.0
        self.due = -math.inf
        self.repeats = 0
        self._of_one_sample = message_id in _OF_ONE_SAMPLE
        self._last_stamp = b""

    def take(self, sample: Sample, now: float, repeat_interval: float) -> Built:
        """Return the messages of ``sample`` that are due, none where those of its stamp were sent already.

        They are due next at the next multiple of the interval; sooner while repetitions are due (interval in s).
        """
        passed = math.floor((now + TIME_TOLERANCE - self._offset) / self.interval)
        self.due = (passed + 1) * self.interval + self._offset
        waits, self._waits = self._waits, False
        if waits and not self.repeats:
            return ()
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
        identities: Sequence[tuple[int, int]],
        intervals: Mapping[MessageKey, float],
        settings: PeerSettings,
        silent: int | None = None,
        offsets: Mapping[MessageKey, float] = MappingProxyType({}),
    ) -> None:
        """``identities``: system and component of each who sends; ``intervals`` (s) of the streams in their order.

        All streams start at once, or with their ``offsets`` (s); those of the ``silent`` component only on request:
        another sends them there.
        """
        self.address = address
        self.heard_at = -math.inf
        self.answered = False
        """Whether it is known to receive what is sent to it: until then it gets no more bytes than it sent.

        Anybody can write any address on a datagram, and would else have the streams sent there.
        """
        self.parameters_sent_at = -math.inf
        """When the list of parameters was sent here last (s)."""
        self._received = self._sent = 0
        """Bytes from and to it before it has answered."""
        self.next_due = -math.inf
        self._settings = settings
        self._codecs = {component: Codec(system, component) for system, component in identities}
        self._replies: list[bytes] = []
        self._defaults = intervals
        self._offsets = offsets
        self._streams = [self._new(key, interval) for key, interval in intervals.items() if key[0] != silent]
        self._text_id = 0

    def _new(self, key: MessageKey, interval: float) -> Stream:
        return Stream(*key, interval, self._offsets.get(key, 0.0) if interval == self._defaults.get(key) else 0.0)

    @property
    def is_full(self) -> bool:
        """True if further answers are dropped until the next datagrams."""
        return len(self._replies) >= self._settings.replies_max

    def interval(self, message_id: int, component: int = _AUTOPILOT) -> float:
        """Return the interval (s) of a message on this link; infinity: it is not streamed."""
        intervals = (stream.interval for stream in self._streams if stream.key == (component, message_id))
        return next(intervals, math.inf)

    def hear(self, size: int, *, addressed: bool) -> None:
        """Take that ``size`` bytes have come; ``addressed``: some of them to this aircraft by a system id.

        It has answered when it names a system id, or when it speaks again after something was sent to it.
        """
        self.answered = addressed or self._sent > 0
        self._received += size
        self.next_due = -math.inf

    def set_interval(self, message_id: int, interval: float, component: int = _AUTOPILOT) -> None:
        """Set the interval (s) of a message on this link; 0 restores the default, infinity stops it."""
        key = component, message_id
        if interval == 0.0:
            interval = self._defaults.get(key, math.inf)
        self._streams = [stream for stream in self._streams if stream.key != key]
        if math.isfinite(interval):
            self._streams.append(self._new(key, interval))
        self.next_due = -math.inf

    def repeat(self, *message_ids: int, component: int = _AUTOPILOT) -> None:
        """Send these messages at once, and repeatedly: their content has changed, one may be lost."""
        for stream in self._streams:
            if stream.key[0] == component and stream.key[1] in message_ids:
                stream.due, stream.repeats = -math.inf, self._settings.repeats
        self.next_due = -math.inf

    def reply(self, *messages: Message, component: int = _AUTOPILOT) -> None:
        """Send messages of a component with the next datagrams."""
        self.reply_packed(*packed(*messages), component=component)

    def reply_packed(self, *messages: Packed, component: int = _AUTOPILOT) -> None:
        """Send messages with the next datagrams, as :meth:`reply` does."""
        if not self.is_full:
            self._replies += [self._codecs[component].frame(message) for message in messages]
            self.next_due = -math.inf

    def reply_built(self, built: Built, component: int = _AUTOPILOT) -> None:
        """Send what was built of one message with the next datagrams, as :meth:`reply` does."""
        if not isinstance(built, PackedRun):
            self.reply_packed(*built, component=component)
        elif not self.is_full:
            self._replies += self._codecs[component].frames(built)
            self.next_due = -math.inf

    def send_statustext(
        self, text: str, severity: int = mavlink.MAV_SEVERITY_WARNING, component: int = _AUTOPILOT
    ) -> None:
        """Send a text to the operator as STATUSTEXT, a long one in chunks, of which the last has room left."""
        data = text.encode("ascii", "replace")
        if len(data) <= _TEXT_LIMIT:
            self.reply(mavlink.MAVLink_statustext_message(severity, data), component=component)
            return
        self._text_id = self._text_id % _TEXT_ID_MAX + 1
        for number, start in enumerate(range(0, len(data) + 1, _TEXT_LIMIT)):
            chunk = data[start : start + _TEXT_LIMIT]
            self.reply(mavlink.MAVLink_statustext_message(severity, chunk, self._text_id, number), component=component)

    def datagrams(self, sample: Sample, now: float) -> list[bytes]:
        """Return replies and what is due of ``sample``, in as few datagrams as possible."""
        latest = now + TIME_TOLERANCE
        if latest < self.next_due:
            return []
        if not self.answered:
            return self._first_datagrams(sample)
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

    def _first_datagrams(self, sample: Sample) -> list[bytes]:
        """Return replies and HEARTBEAT to one that has not answered, as far as they are no more than it sent."""
        codec = self._codecs[_AUTOPILOT]
        heartbeat = [codec.frame(message) for message in sample.messages(_HEARTBEAT) if isinstance(message, tuple)]
        frames: list[bytes] = []
        for queue in (self._replies, heartbeat):
            for frame in queue:
                if self._sent + len(frame) > self._received:
                    break  # with what follows, which may acknowledge it
                self._sent += len(frame)
                frames.append(frame)
        self._replies = []
        self.next_due = math.inf
        return gather(frames)
