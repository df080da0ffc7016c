"""The link to one vehicle: what it last reported and when, its clock, and what it is sent."""

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.layout import Sample
from gcs.mavlink.link_statistics import LinkStatistics
from gcs.mavlink.messages import Received
from gcs.mavlink.requests import Requests
from gcs.mavlink.setpoints import SetpointStream
from gcs.mavlink.settings import LinkSettings
from gcs.mavlink.status_text import TextChunks

_ATTITUDE, _POSITION, _SETPOINT, _SCAN_END = Sample.ATTITUDE, Sample.POSITION, Sample.SETPOINT, Sample.SCAN_END
_TIMESYNC, _VIBRATION = mavlink.MAVLINK_MSG_ID_TIMESYNC, mavlink.MAVLINK_MSG_ID_VIBRATION
_AUTOPILOT = px4.AUTOPILOT_COMPONENT


@dataclass
class VehicleStatus:
    """Status that a vehicle has last reported."""

    autopilot: int | None = None
    """MAV_AUTOPILOT of its heartbeats; None: none has come yet."""
    custom_mode: int = 0
    armed: bool = False
    """True if its last heartbeat says so."""
    offboard: bool = False
    """True if it flies the ground's set-points, as its last heartbeat says."""
    landed_state: int = mavlink.MAV_LANDED_STATE_UNDEFINED
    prearm_ok: bool | None = None
    """Result of its prearm checks, from SYS_STATUS; None: not reported yet."""
    clipping: int | None = None
    """How often its accelerometer has been driven out of its range, from VIBRATION."""
    payload_clipping: int | None = None
    """How often that of the payload's unit has."""
    obstacle_sensing_valid: bool = True
    """Health of its range sensor, from SYS_STATUS."""
    parameters: dict[str, float] = field(default_factory=dict)
    texts: deque[str] = field(default_factory=lambda: deque(maxlen=20))
    payload_text: str = ""
    """Last STATUSTEXT of the payload's unit; empty: none."""
    _chunks: TextChunks = field(default_factory=TextChunks)
    _payload_chunks: TextChunks = field(default_factory=TextChunks)

    @property
    def last_text(self) -> str:
        """Its last STATUSTEXT in brackets; empty: there is none."""
        return f" ({self.texts[-1]})" if self.texts else ""

    @property
    def handlers(self) -> Mapping[int, Callable[[Any], None]]:
        """Return what takes a message that reports a status, by message id."""
        return {
            mavlink.MAVLINK_MSG_ID_HEARTBEAT: self._on_heartbeat,
            mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: self._on_extended_sys_state,
            mavlink.MAVLINK_MSG_ID_SYS_STATUS: self._on_sys_status,
            mavlink.MAVLINK_MSG_ID_VIBRATION: self._on_vibration,
            mavlink.MAVLINK_MSG_ID_STATUSTEXT: self._on_statustext,
        }

    def _on_heartbeat(self, message: mavlink.MAVLink_heartbeat_message) -> None:
        self.autopilot, self.custom_mode = message.autopilot, message.custom_mode
        self.armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
        self.offboard = message.custom_mode == px4.MODE_OFFBOARD

    def _on_extended_sys_state(self, message: mavlink.MAVLink_extended_sys_state_message) -> None:
        self.landed_state = message.landed_state

    def _on_sys_status(self, message: mavlink.MAVLink_sys_status_message) -> None:
        present, health = message.onboard_control_sensors_present, message.onboard_control_sensors_health
        if present & mavlink.MAV_SYS_STATUS_PREARM_CHECK:
            self.prearm_ok = bool(health & mavlink.MAV_SYS_STATUS_PREARM_CHECK)
        if present & mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY:
            self.obstacle_sensing_valid = bool(health & mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY)

    def _on_vibration(self, message: mavlink.MAVLink_vibration_message) -> None:
        self.clipping = message.clipping_0

    def _on_statustext(self, message: mavlink.MAVLink_statustext_message) -> None:
        text = self._chunks.add(message.text, message.id, message.chunk_seq)
        if text is not None:
            self.texts.append(text)

    def take_payload_text(self, message: mavlink.MAVLink_statustext_message) -> None:
        """Take a STATUSTEXT of the payload's unit."""
        text = self._payload_chunks.add(message.text, message.id, message.chunk_seq)
        if text is not None:
            self.payload_text = text


@dataclass
class AddressConflict:
    """Messages that show a wrong system id or address."""

    other_system_id: int | None = None
    """The system id that sends from the vehicle's address in its place."""
    second_address: Address | None = None
    """Another address from which the vehicle's system id was heard last."""
    second_address_at: float = -math.inf
    """When that was (s)."""


class VehicleLink:
    """State of the link to one vehicle. Times are the ground's (s)."""

    def __init__(self, system_id: int, address: Address | None, settings: LinkSettings | None = None) -> None:
        """``address``: None while it is not known: the vehicle has yet to offer itself."""
        settings = settings or LinkSettings()
        self.system_id, self.address = system_id, address
        self.conflict = AddressConflict()
        self.status = VehicleStatus()
        self.clock = RemoteClock(settings.clock)
        self.statistics = LinkStatistics(settings.reordering_time)
        self.requests = Requests(system_id, self.status.parameters, settings)
        self.setpoints = SetpointStream(self.clock, self.status.parameters, settings)
        self._handlers = {**self.status.handlers, **self.requests.handlers}
        self._payload_handlers: Mapping[int, Callable[[Any], None]] = {
            mavlink.MAVLINK_MSG_ID_COMMAND_ACK: self.requests.take_payload_unit_acknowledgement,
            mavlink.MAVLINK_MSG_ID_STATUSTEXT: self.status.take_payload_text,
        }
        """What takes a message of the vehicle's autopilot, by message id; others are not read."""
        self.received_at = -math.inf
        """Time of the last message of any kind."""
        self.attitude_received_at = -math.inf
        self.position_received_at = -math.inf
        self.payload_received_at = -math.inf

    @property
    def telemetry_received_at(self) -> float:
        """Time of its last attitude or position."""
        return max(self.attitude_received_at, self.position_received_at)

    @property
    def complete_telemetry_received_at(self) -> float:
        """Time of its last attitude or of its last position, the earlier of the two."""
        return min(self.attitude_received_at, self.position_received_at)

    def handle(self, messages: Sequence[Received], now: float, size: int = 0) -> list[Received]:
        """Take messages of this vehicle and of the payload unit, runs too, of one datagram of ``size`` bytes.

        Return the samples: the payload's attitude and position, and all of the vehicle's autopilot.
        """
        samples: list[Received] = []
        last_stamp = None
        for received in messages:
            layout, _, run, system, component, sequence, _, _, stamp = received
            sample = layout.sample
            if system != self.system_id:
                if component == px4.PAYLOAD_UNIT_COMPONENT:
                    if sample is _ATTITUDE or sample is _POSITION:
                        self.payload_received_at = now
                        samples.append(received)
                    elif layout.message_id == _VIBRATION:
                        *_, self.status.payload_clipping, _, _ = received.fields
                    elif (handler := self._payload_handlers.get(layout.message_id)) is not None:
                        handler(received.message)
                continue
            self.received_at = now
            if component != _AUTOPILOT:
                continue  # a companion answers TIMESYNC, too, by a clock of its own
            breaks = self.statistics.breaks
            if run > 1:
                self.statistics.run(sequence, run, now)
            else:
                in_order = self.statistics.message(sequence, now)
            if sample is _ATTITUDE or sample is _POSITION:
                if (stamp, in_order) != last_stamp:  # attitude and position are of one moment
                    last_stamp = stamp, in_order
                    self.clock.add_stamp(stamp * 1e-3, now, in_order)
                if sample is _ATTITUDE:
                    self.attitude_received_at = now
                else:
                    self.position_received_at = now
            elif sample is not None and sample is not _SETPOINT:
                self.statistics.scans.add(stamp, sample is _SCAN_END, breaks, self.statistics.breaks)
            if sample is not None:
                samples.append(received)
            elif layout.message_id == _TIMESYNC:
                tc1, ts1, *_ = received.fields
                if tc1:
                    self.clock.add_answer(ts1, now, tc1)
            elif (handler := self._handlers.get(layout.message_id)) is not None:
                handler(received.message)
        # Without a stamp of its own it counts as sent with the datagram before.
        self.clock.queue.add(size, self.clock.bounds.sent, now)
        return samples
