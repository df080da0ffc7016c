"""Requests to one vehicle: commands and parameter reads, repeated until they are answered."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.log_requests import LogRequests
from gcs.mavlink.messages import Message
from gcs.mavlink.settings import LinkSettings
from idc_controller.settings import Setting


class WantedParameter(NamedTuple):
    """A parameter of a vehicle that the ground depends on."""

    purpose: str
    possible: Setting
    """The values that are taken."""
    is_settable: bool = False
    """Whether it may change. Another one is taken once: its value is the one that was checked before take-off."""


class CommandState(Enum):
    """Progress of a command."""

    PENDING = "pending"
    ACCEPTED = "accepted"
    REFUSED = "refused"
    UNANSWERED = "unanswered"


@dataclass
class Command:
    """A COMMAND_LONG that is sent until it is answered."""

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


PAYLOAD_UNIT_COMMANDS = frozenset({mavlink.MAV_CMD_DO_GRIPPER})
"""Commands to the payload unit whose answers are kept."""


def _payload_unit_stream(message_id: int) -> Message:
    """Return the request of a stream of the payload unit at its default rate."""
    unit, command = (px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT), mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
    return mavlink.MAVLink_command_long_message(*unit, command, 0, message_id, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


_PAYLOAD_UNIT_ATTITUDE = _payload_unit_stream(mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION)
_PAYLOAD_UNIT_POSITION = _payload_unit_stream(mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED)


class Requests:
    """Commands and parameter reads of one vehicle. Times are the ground's (s)."""

    def __init__(self, system_id: int, parameters: dict[str, float], settings: LinkSettings) -> None:
        """``parameters`` takes the values of those that are wanted."""
        self._system_id, self._parameters, self.settings = system_id, parameters, settings
        self._pending: dict[int, Command] = {}
        self._wanted: dict[str, float] = {}
        self._kept: dict[str, WantedParameter] = {}
        """Parameters that were ever wanted, by name: any others, forged ones too, are not kept."""
        self._for_log = LogRequests(system_id, settings)
        self._payload_unit_wanted = False
        self._payload_unit_due = -math.inf
        self._for_payload_unit: list[Message] = []
        self.payload_unit_answers: dict[int, int] = {}
        """MAV_RESULT of the payload unit by command, as it has come through this vehicle since the command was sent."""

    def want_payload_unit(self) -> None:
        """Request that the vehicle forwards the payload unit's telemetry here: another one may do it in its place."""
        self._payload_unit_wanted = True

    def want_log(self) -> None:
        """Request, once, what its log is to have: see :class:`.LogRequests`."""
        self._for_log.want()

    def want_parameters(self, wanted: Mapping[str, WantedParameter]) -> None:
        """Request parameters, by name, until they are known."""
        self._kept.update(wanted)
        for name in wanted:
            if name not in self._parameters:
                self._wanted.setdefault(name, -math.inf)

    def command(self, number: int, *parameters: float) -> Command:
        """Send a command until it is answered; a new one takes the place of an older one of its number."""
        command = Command(number, (*parameters, *([0.0] * (7 - len(parameters)))))
        self._pending[number] = command
        return command

    def command_payload_unit(self, number: int, parameters: tuple[float, ...], confirmation: int) -> None:
        """Send a command to the payload unit through this vehicle, once; ``confirmation``: how often it was sent."""
        target, rest = (px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT), [0.0] * (7 - len(parameters))
        self._for_payload_unit.append(
            mavlink.MAVLink_command_long_message(*target, number, confirmation, *parameters, *rest)
        )

    def due(self, now: float) -> list[Message]:
        """Return the requests that are to be sent at ``now``."""
        messages = self._for_log.due(now) + self._for_payload_unit
        self._for_payload_unit = []
        if self._payload_unit_wanted and now >= self._payload_unit_due:
            self._payload_unit_wanted, self._payload_unit_due = False, now + self.settings.retry_interval
            messages += [_PAYLOAD_UNIT_ATTITUDE, _PAYLOAD_UNIT_POSITION]
        if not (self._wanted or self._pending):
            return messages
        target, s = (self._system_id, px4.AUTOPILOT_COMPONENT), self.settings
        for name, due in self._wanted.items():
            if now >= due:
                self._wanted[name] = now + s.retry_interval
                messages.append(mavlink.MAVLink_param_request_read_message(*target, name.encode(), -1))
        for command in [*self._pending.values()]:
            if now < command.next_try:
                continue
            interval = s.mode_interval if command.number == mavlink.MAV_CMD_DO_SET_MODE else s.retry_interval
            if command.tries * interval >= s.tries * s.retry_interval:
                command.state = CommandState.UNANSWERED
                del self._pending[command.number]
                continue
            messages.append(
                mavlink.MAVLink_command_long_message(*target, command.number, command.tries, *command.parameters)
            )
            command.tries += 1
            command.next_try = now + interval
        return messages

    @property
    def handlers(self) -> Mapping[int, Callable[[Any], None]]:
        """Return what takes an answer, by message id."""
        return {
            mavlink.MAVLINK_MSG_ID_COMMAND_ACK: self.take_acknowledgement,
            mavlink.MAVLINK_MSG_ID_PARAM_VALUE: self.take_value,
            mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION: self._for_log.take_version,
        }

    def take_acknowledgement(self, message: mavlink.MAVLink_command_ack_message) -> None:
        """Take the answer to a command."""
        command = self._pending.get(message.command)
        if command is None or message.result == mavlink.MAV_RESULT_IN_PROGRESS:
            return
        del self._pending[command.number]
        command.result = message.result
        accepted = message.result == mavlink.MAV_RESULT_ACCEPTED
        command.state = CommandState.ACCEPTED if accepted else CommandState.REFUSED

    def take_payload_unit_acknowledgement(self, message: mavlink.MAVLink_command_ack_message) -> None:
        """Take the payload unit's answer to a command."""
        if message.result != mavlink.MAV_RESULT_IN_PROGRESS and message.command in PAYLOAD_UNIT_COMMANDS:
            self.payload_unit_answers[message.command] = message.result

    def take_value(self, message: mavlink.MAVLink_param_value_message) -> None:
        """Take the value of a parameter, where it is a possible one and may have changed."""
        self._for_log.take_value(message)
        name = message.param_id
        wanted = self._kept.get(name)
        if wanted is None or not (wanted.is_settable or name in self._wanted):
            return
        try:
            value = px4.parameter_from_wire(message.param_value, message.param_type)
        except ValueError:
            return
        if wanted.possible.allows(value):
            self._parameters[name] = float(value)
            self._wanted.pop(name, None)
