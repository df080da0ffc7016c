"""The services of a vehicle by the messages that they handle."""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

from gcs.mavlink.messages import Message, Received
from vehicle_sim.mavlink.control_owner import Sender
from vehicle_sim.mavlink.peer import Peer

M = TypeVar("M", bound=Message)


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
    """The services of a vehicle by the class of the messages they handle."""

    def __init__(self) -> None:
        self._handlers: dict[type[Message], Callable[[Received, Request], None]] = {}

    def register(self, kind: type[M], handler: Callable[[M, Request], None]) -> None:
        """Hand every message of a class to ``handler``."""
        handle: Callable[..., None] = handler
        self._handlers[kind] = lambda received, request: handle(received.message, request)

    def register_fields(self, kind: type[Message], handler: Callable[[tuple[Any, ...], Request], None]) -> None:
        """Hand the fields of every message of a class, in the order of the wire, to ``handler``."""
        self._handlers[kind] = lambda received, request: handler(received.fields, request)

    def dispatch(self, received: Received, request: Request) -> None:
        """Hand a message to its service; one without a service is ignored."""
        if (handler := self._handlers.get(received.layout.kind)) is not None:
            handler(received, request)
