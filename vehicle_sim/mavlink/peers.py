"""Those a vehicle talks to: what each of them is sent, and when."""

from __future__ import annotations

import math
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec, gather
from vehicle_sim.mavlink.telemetry import Telemetry

PEER_TIMEOUT = 10.0  # s of silence after which a peer is forgotten
PEERS_MAX = 8
REPLIES_MAX = 200  # answers that wait for one peer; whoever asks for more at once gets no more

TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact

_TEXT_LIMIT = 50
_HEARTBEAT = mavlink.MAVLINK_MSG_ID_HEARTBEAT

_NAVIGATION = (
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
)
_SCAN = mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D
#: Messages that tell of one sample: never sent twice for the same one. All begin with its ``time_boot_ms``.
_OF_ONE_SAMPLE = (*_NAVIGATION, _SCAN)

_DEFAULT_INTERVALS: dict[tuple[int, int], float] = {
    (px4.AUTOPILOT_COMPONENT, _HEARTBEAT): 1.0,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_SYS_STATUS): 1.0,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE): 0.2,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_ATTITUDE): 0.1,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT): 0.2,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT): 1.0,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_HOME_POSITION): 2.0,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_BATTERY_STATUS): 2.0,
    (px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_VFR_HUD): 0.5,
    (px4.PAYLOAD_UNIT_COMPONENT, _HEARTBEAT): 1.0,
}

HASTE, REPEATS = 0.04, 3  # s between the repetitions of what has changed, and how many there are


class Stream:
    """One message that is sent again and again, at whole multiples of its interval, so that streams coincide."""

    __slots__ = ("component", "due", "hasty", "interval", "last_stamp", "message_id", "once_a_sample")

    def __init__(self, component: int, message_id: int, interval: float) -> None:
        """``interval`` in s; due at once."""
        self.component = component
        self.message_id = message_id
        self.interval = interval
        self.due = -math.inf
        self.hasty = 0
        self.once_a_sample = message_id in _OF_ONE_SAMPLE
        self.last_stamp: int | None = None

    def advance(self, now: float) -> None:
        """To the next multiple of the interval; in haste sooner."""
        self.due = (math.floor((now + TIME_TOLERANCE) / self.interval) + 1) * self.interval
        if self.hasty:
            self.hasty -= 1
            self.due = min(self.due, now + HASTE)


class Peer:
    """One address, with its own streams and its own sequence numbers, so that gaps show losses on its link only."""

    def __init__(self, address: Address, system_id: int, telemetry_interval: float) -> None:
        """``telemetry_interval`` (s) of position and attitude, the vehicle's and the payload's."""
        self.address = address
        self.heard_at = -math.inf
        self.next_due = -math.inf
        self._codecs = {
            component: Codec(system_id, component)
            for component in (px4.AUTOPILOT_COMPONENT, px4.PAYLOAD_UNIT_COMPONENT)
        }
        self.codec = self._codecs[px4.AUTOPILOT_COMPONENT]
        self._replies: list[bytes] = []
        self._defaults = dict(_DEFAULT_INTERVALS)
        for component in self._codecs:
            for message_id in _NAVIGATION:
                self._defaults[component, message_id] = telemetry_interval
        # With every sample goes what was being flown: set-points may be lost.
        self._defaults[px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET] = telemetry_interval
        # A scan is sent as soon as there is one, behind the attitude and position at which it was made.
        self._defaults[px4.AUTOPILOT_COMPONENT, _SCAN] = telemetry_interval
        self._streams: list[Stream] = []

    @property
    def is_streaming(self) -> bool:
        """Whether it gets everything; one that never answered gets heartbeats only."""
        return len(self._streams) > 1

    def start_streams(self) -> None:
        """All streams at their default rates."""
        self._streams = [Stream(*key, interval) for key, interval in self._defaults.items()]
        self.next_due = -math.inf

    def offer(self) -> None:
        """Heartbeats only, for an address that has not answered."""
        self._streams = [Stream(px4.AUTOPILOT_COMPONENT, _HEARTBEAT, 1.0)]
        self.next_due = -math.inf

    def set_interval(self, message_id: int, interval: float) -> None:
        """Interval (s) of an autopilot message on this link; 0 restores the default, infinity stops it."""
        component = px4.AUTOPILOT_COMPONENT
        if interval == 0.0:
            interval = self._defaults.get((component, message_id), math.inf)
        self._streams = [s for s in self._streams if (s.component, s.message_id) != (component, message_id)]
        if math.isfinite(interval):
            self._streams.append(Stream(component, message_id, interval))
        self.next_due = -math.inf

    def hasten(self, *message_ids: int) -> None:
        """What these tell has changed: send them at once, and again, because a datagram may be lost."""
        for stream in self._streams:
            if stream.message_id in message_ids:
                stream.due, stream.hasty = -math.inf, REPEATS if self.is_streaming else 0
        self.next_due = -math.inf

    def reply(self, message: Any) -> None:
        """Send a message (or a tuple of them) of the autopilot with the next datagrams."""
        if len(self._replies) < REPLIES_MAX:
            self._replies += [self.codec.encode(each) for each in _each(message)]
            self.next_due = -math.inf

    def tell(self, text: str, severity: int = mavlink.MAV_SEVERITY_WARNING) -> None:
        """A text for people, in pieces of a STATUSTEXT's length."""
        data = text.encode("ascii", "replace")
        for start in range(0, len(data), _TEXT_LIMIT):
            self.reply(mavlink.MAVLink_statustext_message(severity, data[start : start + _TEXT_LIMIT]))

    def datagrams(self, telemetry: Telemetry, now: float) -> list[bytes]:
        """Replies and what is due, in as few datagrams as possible."""
        if now + TIME_TOLERANCE < self.next_due:
            return []
        frames = self._replies
        self._replies = []
        next_due = math.inf
        for stream in self._streams:
            if stream.due <= now + TIME_TOLERANCE:
                message = telemetry.build(stream.component, stream.message_id, now)
                messages = () if message is None else _each(message)
                if messages and not (stream.once_a_sample and messages[0].time_boot_ms == stream.last_stamp):
                    if stream.once_a_sample:
                        stream.last_stamp = messages[0].time_boot_ms
                    codec = self._codecs[stream.component]
                    frames += [codec.encode(each) for each in messages]
                stream.advance(now)
            if stream.due < next_due:
                next_due = stream.due
        self.next_due = next_due
        return gather(frames)


def _each(built: Any) -> tuple[Any, ...]:
    return built if isinstance(built, tuple) else (built,)
