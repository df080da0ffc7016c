"""The services of an aircraft by the messages that they handle."""

from collections.abc import Callable
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.messages import Message, Received
from gcs.mavlink.services.aircraft import Sender
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


class Dispatcher:
    """The services of an aircraft by the class of the messages they handle."""

    def __init__(self) -> None:
        self._handlers: dict[type[Message], tuple[Callable[..., None], Callable[[Received], Any]]] = {}
        """The handler of each class, and what of a message is handed to it."""

    def register(self, kind: type[M], handler: Callable[[M, Request], None]) -> None:
        """Hand every message of a class to ``handler``."""
        self._handlers[kind] = handler, attrgetter("message")

    def register_fields(self, kind: type[Message], handler: Callable[[tuple[Any, ...], Request], None]) -> None:
        """Hand the fields of every message of a class, in the order of the wire, to ``handler``."""
        self._handlers[kind] = handler, attrgetter("fields")

    def serves(self, kind: type[Message]) -> bool:
        """Return True if messages of a class are handed to somebody."""
        return kind in self._handlers

    def dispatch(self, received: Received, request: Request) -> None:
        """Hand a message to its service; one without a service is ignored."""
        if (service := self._handlers.get(received.layout.kind)) is not None:
            handler, part = service
            handler(part(received), request)
