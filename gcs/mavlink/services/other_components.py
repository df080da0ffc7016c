"""Commands that reach an aircraft but are not its own: to a device whose messages it forwards, or to what is absent."""

from collections.abc import Mapping
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.messages import BROADCAST, Received
from gcs.mavlink.services.answer import UNSUPPORTED, Answer
from gcs.mavlink.services.dispatcher import CommandHandler, Request

_COMMANDS = (mavlink.MAVLINK_MSG_ID_COMMAND_LONG, mavlink.MAVLINK_MSG_ID_COMMAND_INT)


class OtherComponents:
    """Answers every command, so that nobody waits: the device sends messages, what is absent does nothing."""

    def __init__(self, own: tuple[int, int], device: tuple[int, int], handlers: Mapping[int, CommandHandler]) -> None:
        """``own`` system and component, and those of the ``device``, with what carries out its commands."""
        self._own = own
        self._device = device
        self._of_device = handlers

    def handle(self, received: Received, request: Request) -> None:
        """Carry out or refuse a command; the system that it is for answers. What is for nobody here is ignored."""
        if received.message_id not in _COMMANDS:
            return
        if received.target_system == self._own[0]:
            self._answer(received, request, UNSUPPORTED, self._own[1])
        elif received.target_system == self._device[0]:
            message: Any = received.message
            run = self._of_device.get(message.command)
            is_present = received.target_component in (BROADCAST, self._device[1])
            answer = UNSUPPORTED if run is None or not is_present else run(message, request)
            self._answer(received, request, answer, self._device[1])

    def _answer(self, received: Received, request: Request, answer: Answer, component: int) -> None:
        command: Any = received.message
        if answer.text:
            request.peer.send_statustext(answer.text, component=component)
        request.peer.reply(
            mavlink.MAVLink_command_ack_message(
                command.command, answer.result, 0, answer.parameter, request.system, request.component
            ),
            component=component,
        )
