"""The services of an aircraft: one table of the messages that they handle, one of the commands."""

from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.messages import Message, Received
from gcs.mavlink.services.aircraft import Sender
from gcs.mavlink.services.answer import Answer
from gcs.mavlink.services.peer import Peer

M = TypeVar("M", bound=Message)

Command = mavlink.MAVLink_command_long_message | mavlink.MAVLink_command_int_message


class Request(NamedTuple):
    """Sender and time (s) of a message; answers go to ``peer``, addressed to sender and ``component``."""

    sender: Sender
    component: int
    peer: Peer
    now: float

    @property
    def system(self) -> int:
        """The sender's system id."""
        return self.sender[1]


CommandHandler = Callable[[Command, Request], Answer]
"""Carries out a command, and returns the answer."""


class Dispatcher:
    """All that the services of an aircraft do for others; what is taken out of a table is not served."""

    def __init__(self) -> None:
        self.messages: dict[type[Message], tuple[Callable[..., None], Callable[[Received], Any]]] = {}
        """By the class of a message its handler, and what of the message is handed to it."""
        self.commands: dict[int, CommandHandler] = {}
        """By MAV_CMD."""
        self.requests: dict[int, CommandHandler] = {}
        """By the id of a message what answers its MAV_CMD_REQUEST_MESSAGE, where the request has parameters."""

    def register(self, kind: type[M], handler: Callable[[M, Request], None]) -> None:
        """Hand every message of a class to ``handler``."""
        self.messages[kind] = handler, attrgetter("message")

    def register_fields(self, kind: type[Message], handler: Callable[[tuple[Any, ...], Request], None]) -> None:
        """Hand the fields of every message of a class, in the order of the wire, to ``handler``."""
        self.messages[kind] = handler, attrgetter("fields")

    def register_commands(self, handlers: Mapping[int, CommandHandler]) -> None:
        """Have commands carried out by their MAV_CMD."""
        self.commands.update(handlers)

    def dispatch(self, received: Received, request: Request) -> None:
        """Hand a message to its service; one without a service is ignored."""
        if (service := self.messages.get(received.layout.kind)) is not None:
            handler, part = service
            handler(part(received), request)
