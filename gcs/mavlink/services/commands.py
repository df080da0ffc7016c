"""MAVLink commands to an aircraft: who may send them, that each is done once, and the answer."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.messages import BROADCAST
from gcs.mavlink.newer_messages import COMMAND_CANCEL, NEWER
from gcs.mavlink.services.aircraft import Aircraft, Control, MessageSource, Sender
from gcs.mavlink.services.answer import UNSUPPORTED, Answer, denied
from gcs.mavlink.services.dispatcher import Command, CommandHandler, Dispatcher, Request
from gcs.mavlink.services.flight_commands import FlightCommands
from gcs.mavlink.services.modes import ModeCommands
from gcs.mavlink.services.parameter_table import ParameterTable
from gcs.mavlink.services.streams import StreamRequests
from gcs.mavlink.services.system_commands import SystemCommands

#: Requests of information, or about the sender's own link: every ground may send them, to all systems at once, too.
INFORMATION = frozenset(
    (
        mavlink.MAV_CMD_REQUEST_MESSAGE,
        mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
        mavlink.MAV_CMD_GET_MESSAGE_INTERVAL,
        mavlink.MAV_CMD_GET_HOME_POSITION,
        mavlink.MAV_CMD_REQUEST_PROTOCOL_VERSION,
        mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES,
    )
)

_REMEMBERED = 32
"""Senders whose last command is kept."""
_DUPLICATE_TIME = 5.0
"""Time (s) in which a command that is sent again is the same one."""

_Contents = tuple[Any, ...]


class _Done(NamedTuple):
    """The last command of a sender that was carried out, and its answer."""

    contents: _Contents
    confirmation: int
    answer: Answer
    time: float


class CommandServer:
    """COMMAND_LONG, COMMAND_INT, COMMAND_CANCEL and SET_MODE; a command that no service has taken is unsupported."""

    def __init__(
        self,
        aircraft: Aircraft,
        control: Control,
        source: MessageSource,
        streams: StreamRequests,
        parameters: ParameterTable,
    ) -> None:
        self._aircraft = aircraft
        self._control = control
        self._services = (
            FlightCommands(aircraft, source),
            ModeCommands(aircraft, control),
            SystemCommands(aircraft, parameters, streams),
            streams,
        )
        self._handlers: Mapping[int, CommandHandler] = {}
        self._done: dict[tuple[Sender, int], _Done] = {}

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages and commands of this service, and carry out those that others take."""
        dispatcher.register(mavlink.MAVLink_command_long_message, self._on_command)
        dispatcher.register(mavlink.MAVLink_command_int_message, self._on_command)
        dispatcher.register_fields(NEWER[COMMAND_CANCEL], self._on_cancel)
        for service in self._services:
            service.register(dispatcher)
        self._handlers = dispatcher.commands

    def _on_command(self, message: Command, request: Request) -> None:
        is_information = message.command in INFORMATION
        done = None if is_information else self._repeated(message, request)
        if done is not None:
            self._acknowledge(message.command, done.answer, request)
            return
        answer = self._answer(message, request, is_information)
        if answer.text:
            request.peer.send_statustext(answer.text)
        if not is_information:
            self._remember(message, request, answer)
        self._acknowledge(message.command, answer, request)

    def _answer(self, message: Command, request: Request, is_information: bool) -> Answer:
        run = self._handlers.get(message.command)
        if is_information and run is not None:
            return run(message, request)
        if self._control.is_stranger(request.sender, request.now):
            return denied("Command denied: another ground station is in control")
        if run is None:
            return UNSUPPORTED
        if message.target_system == BROADCAST and not self._aircraft.obeys_broadcasts:
            return denied("Command to all systems denied: on a payload each vehicle is commanded by its own system id")
        return run(message, request)

    def _acknowledge(self, command: int, answer: Answer, request: Request) -> None:
        request.peer.reply(
            mavlink.MAVLink_command_ack_message(
                command, answer.result, 0, answer.parameter, request.system, request.component
            )
        )

    def _repeated(self, message: Command, request: Request) -> _Done | None:
        """Return what was done already if ``message`` repeats it: its acknowledgement was lost."""
        done = self._done.get((request.sender, request.component))
        confirmation = _confirmation(message)
        if done is None or confirmation <= done.confirmation or done.contents != _contents(message):
            return None
        return done if request.now - done.time < _DUPLICATE_TIME else None

    def _remember(self, message: Command, request: Request, answer: Answer) -> None:
        """Keep a command that was carried out; one that was refused may be tried again."""
        key = request.sender, request.component
        self._done.pop(key, None)
        if answer.result != mavlink.MAV_RESULT_ACCEPTED:
            return
        if len(self._done) >= _REMEMBERED:
            del self._done[next(iter(self._done))]
        self._done[key] = _Done(_contents(message), _confirmation(message), answer, request.now)

    def _on_cancel(self, fields: tuple[Any, ...], request: Request) -> None:
        """Answer with the result of the command if it was the sender's last: none is ever in progress."""
        command = fields[0]
        done = self._done.get((request.sender, request.component))
        if done is not None and done.contents[0] == command:
            self._acknowledge(command, done.answer, request)


def _confirmation(message: Command) -> int:
    """Return how often a command was sent before; COMMAND_INT does not say so."""
    return message.confirmation if isinstance(message, mavlink.MAVLink_command_long_message) else 0


def _contents(message: Command) -> _Contents:
    """Return command and parameters, NaN equal to itself."""
    values = [message.param1, message.param2, message.param3, message.param4]
    if isinstance(message, mavlink.MAVLink_command_long_message):
        values += [message.param5, message.param6, message.param7]
    else:
        values += [message.frame, message.x, message.y, message.z]
    return (message.command, *map(repr, values))
