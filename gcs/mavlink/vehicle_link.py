"""The link to one vehicle: what it last reported, what it was commanded, and whether it answered."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from enum import Enum
from statistics import median

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.link_statistics import LinkStatistics
from gcs.mavlink.messages import Message, Received
from gcs.mavlink.settings import LinkSettings
from idc_controller.estimation.setpoint_history import Confirmation

_NAVIGATION = (mavlink.MAVLink_attitude_quaternion_message, mavlink.MAVLink_local_position_ned_message)


class CommandState(Enum):
    """How far a command has come."""

    PENDING = "pending"
    ACCEPTED = "accepted"
    REFUSED = "refused"
    UNANSWERED = "unanswered"


@dataclass
class Command:
    """A COMMAND_LONG on its way; repeated until it is answered."""

    number: int
    parameters: tuple[float, ...]
    state: CommandState = CommandState.PENDING
    result: int | None = None
    tries: int = 0
    next_try: float = -math.inf

    @property
    def name(self) -> str:
        """The command's MAVLink name."""
        entry = mavlink.enums["MAV_CMD"].get(self.number)
        return entry.name if entry else str(self.number)


@dataclass(eq=False)
class VehicleLink:
    """State of the link to one vehicle. Times are the ground's (s).

    More than a dozen attributes: each is a field that the vehicle reports, kept for all who read it.
    """

    system_id: int
    address: Address | None
    """None while it is not known: the vehicle has yet to offer itself."""
    settings: LinkSettings = field(default_factory=LinkSettings)
    clock: RemoteClock = field(init=False)
    received_at: float = -math.inf
    """When any message came last."""
    other_system_id: int | None = None
    """The system id that sends from its address in its place."""
    attitude_received_at: float = -math.inf
    position_received_at: float = -math.inf
    payload_received_at: float = -math.inf
    base_mode: int = 0
    custom_mode: int = 0
    landed_state: int = mavlink.MAV_LANDED_STATE_UNDEFINED
    prearm_ok: bool | None = None
    """The vehicle's prearm checks, from SYS_STATUS; None: not reported yet."""
    obstacle_sensing_valid: bool = True
    """Whether its range sensor works, by SYS_STATUS."""
    parameters: dict[str, float] = field(default_factory=dict)
    texts: deque[str] = field(default_factory=lambda: deque(maxlen=20))
    setpoint_delays: deque[float] = field(init=False)
    """Delays of the last set-points that it confirmed."""
    setpoint_loss: float = 0.0
    """Share of the set-points that do not arrive, by its confirmations."""
    lost_setpoints: int = 0
    """How often set-points were found to be lost."""
    statistics: LinkStatistics = field(init=False)
    _last_stamp: float = -math.inf
    _commands: dict[int, Command] = field(default_factory=dict)
    _wanted: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.clock = RemoteClock(self.settings.clock)
        self.setpoint_delays = deque(maxlen=self.settings.delays)
        self.statistics = LinkStatistics(self.settings.reordering_time)

    @property
    def copies(self) -> int:
        """How often to send what must arrive; once on a congested link, whose latency copies would increase."""
        if self.clock.lag > self.settings.congestion_lag:
            return 1
        thresholds = self.settings.second_copy_loss, self.settings.third_copy_loss
        return 1 + sum(self.setpoint_loss > threshold for threshold in thresholds)

    @property
    def setpoint_delay(self) -> float:
        """From when a set-point is sent until the vehicle flies it (s): by its confirmations, else by round trips."""
        if len(self.setpoint_delays) == self.settings.delays:
            # Round trips are worse: on a link that loses or reorders, those that arrive are not late.
            return median(self.setpoint_delays)
        return self.clock.delay + self._onboard_period

    def stamp(self, now: float) -> float:
        """For a set-point that is sent at ``now`` (s), by the vehicle's clock (s).

        Where that is set back, stamps are not: the vehicle would take the set-points for reordered ones.
        """
        stamp = now + self.clock.offset
        if 0.0 < self._last_stamp - stamp < self.settings.stamp_step_back:
            stamp = self._last_stamp + 0.001
        self._last_stamp = stamp
        return stamp

    @property
    def latency_max(self) -> float:
        """The longest that a set-point can take (s), by round trips."""
        return self.clock.round_trip_max + 2.0 * self._onboard_period + self.settings.stamp_error

    @property
    def _onboard_period(self) -> float:
        rate = self.parameters.get(px4.PARAM_ONBOARD_RATE, 0.0)
        return 1.0 / rate if rate > 0.0 else 0.0

    def confirm_setpoint(self, confirmation: Confirmation) -> None:
        """Learn from the vehicle's report of a set-point that it flew."""
        if confirmation.delay is not None:
            self.setpoint_delays.append(confirmation.delay)
        if (flown := confirmation.as_sent) is not None:
            self.setpoint_loss += self.settings.loss_filter * (float(not flown) - self.setpoint_loss)
            self.lost_setpoints += not flown

    @property
    def armed(self) -> bool:
        """As its last heartbeat says."""
        return bool(self.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)

    @property
    def offboard(self) -> bool:
        """Whether it flies the ground's set-points, as its last heartbeat says."""
        return self.custom_mode == px4.MODE_OFFBOARD

    @property
    def telemetry_received_at(self) -> float:
        """When its own attitude or position came last."""
        return max(self.attitude_received_at, self.position_received_at)

    @property
    def complete_telemetry_received_at(self) -> float:
        """When the staler of its own attitude and position came last."""
        return min(self.attitude_received_at, self.position_received_at)

    def handle(self, received: Received, now: float) -> None:
        """Learn from one message of this vehicle."""
        self.received_at = now
        message = received.message
        if received.component == px4.AUTOPILOT_COMPONENT:
            self._handle_autopilot(message, self.statistics.message(received.sequence, now), now)
        elif received.component == px4.PAYLOAD_UNIT_COMPONENT and isinstance(message, _NAVIGATION):
            self.payload_received_at = now
        if isinstance(message, mavlink.MAVLink_command_ack_message):
            self._acknowledged(message)
        elif isinstance(message, mavlink.MAVLink_param_value_message):
            self._parameter(message)
        elif isinstance(message, mavlink.MAVLink_timesync_message):
            if message.tc1:
                self.clock.add_answer(message.ts1, now)
        elif isinstance(message, mavlink.MAVLink_extended_sys_state_message):
            self.landed_state = message.landed_state
        elif isinstance(message, mavlink.MAVLink_sys_status_message):
            present, health = message.onboard_control_sensors_present, message.onboard_control_sensors_health
            if present & mavlink.MAV_SYS_STATUS_PREARM_CHECK:
                self.prearm_ok = bool(health & mavlink.MAV_SYS_STATUS_PREARM_CHECK)
            if present & mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY:
                self.obstacle_sensing_valid = bool(health & mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY)
        elif isinstance(message, mavlink.MAVLink_statustext_message):
            self.texts.append(message.text)

    def _handle_autopilot(self, message: Message, in_order: bool, now: float) -> None:
        if isinstance(message, mavlink.MAVLink_attitude_quaternion_message):
            self.clock.add_stamp(message.time_boot_ms * 1e-3, now, in_order)
            self.attitude_received_at = now
        elif isinstance(message, mavlink.MAVLink_local_position_ned_message):
            self.clock.add_stamp(message.time_boot_ms * 1e-3, now, in_order)
            self.position_received_at = now
        elif isinstance(message, mavlink.MAVLink_heartbeat_message):
            self.base_mode, self.custom_mode = message.base_mode, message.custom_mode

    def want_parameters(self, names: tuple[str, ...]) -> None:
        """Request parameters until they are known."""
        for name in names:
            if name not in self.parameters:
                self._wanted.setdefault(name, -math.inf)

    def command(self, number: int, *parameters: float) -> Command:
        """Send a command until it is answered; a new one takes the place of an older one of its number."""
        command = Command(number, (*parameters, *([0.0] * (7 - len(parameters)))))
        self._commands[number] = command
        return command

    def requests_to_send(self, now: float) -> list[Message]:
        """Parameter requests and commands that are due."""
        messages: list[Message] = []
        for name, due in self._wanted.items():
            if now >= due:
                self._wanted[name] = now + self.settings.retry_interval
                messages.append(
                    mavlink.MAVLink_param_request_read_message(
                        self.system_id, px4.AUTOPILOT_COMPONENT, name.encode(), -1
                    )
                )
        for command in self._commands.values():
            if command.state is not CommandState.PENDING or now < command.next_try:
                continue
            if command.tries >= self.settings.tries:
                command.state = CommandState.UNANSWERED
                continue
            messages.append(
                mavlink.MAVLink_command_long_message(
                    self.system_id, px4.AUTOPILOT_COMPONENT, command.number, command.tries, *command.parameters
                )
            )
            command.tries += 1
            command.next_try = now + self.settings.retry_interval
        return messages

    def _acknowledged(self, message: mavlink.MAVLink_command_ack_message) -> None:
        command = self._commands.get(message.command)
        if command is None or command.state is not CommandState.PENDING:
            return
        if message.result == mavlink.MAV_RESULT_IN_PROGRESS:
            return
        command.result = message.result
        accepted = message.result == mavlink.MAV_RESULT_ACCEPTED
        command.state = CommandState.ACCEPTED if accepted else CommandState.REFUSED

    def _parameter(self, message: mavlink.MAVLink_param_value_message) -> None:
        name = message.param_id
        try:
            value = px4.parameter_from_wire(message.param_value, message.param_type)
        except ValueError:
            return
        if math.isfinite(value):
            self.parameters[name] = float(value)
            self._wanted.pop(name, None)
