"""Requests of one message or of its stream."""

import math
from collections.abc import Mapping
from types import MappingProxyType

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.services.aircraft import Control, MessageSource
from gcs.mavlink.services.answer import ACCEPTED, UNSUPPORTED, Answer, denied, rejected_for_now
from gcs.mavlink.services.dispatcher import Command, CommandHandler, Dispatcher, Request
from gcs.mavlink.settings import PeerSettings

_STOPPED, _NOT_AVAILABLE = -1, 0
"""Intervals in MESSAGE_INTERVAL (us)."""
_INTERVAL_MAX = 2000.0  # s; MESSAGE_INTERVAL holds 2147 s


class StreamRequests:
    """Commands about the messages of one component; ``handlers`` by MAV_CMD. What is accepted is sent."""

    def __init__(
        self,
        component: int,
        source: MessageSource,
        control: Control,
        settings: PeerSettings,
        requests: Mapping[int, CommandHandler] = MappingProxyType({}),
    ) -> None:
        """``requests``: see :attr:`.Dispatcher.requests`."""
        self._component = component
        self._source = source
        self._control = control
        self._interval_min = settings.interval_min
        self._requests = requests
        self.handlers: Mapping[int, CommandHandler] = {
            mavlink.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_message_interval,
            mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: self._get_message_interval,
        }

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the commands of this service."""
        dispatcher.register_commands(self.handlers)

    def sending(self, message_id: int) -> CommandHandler:
        """Return what answers an older command that requests one message."""
        name = LAYOUTS[message_id].kind.msgname

        def send(message: Command, request: Request) -> Answer:
            return self._send(message_id, request)

        send.__doc__ = f"Send {name} once."
        return send

    def _request_message(self, message: Command, request: Request) -> Answer:
        """Send a message (param1) once."""
        wanted = whole(message.param1, 1 << 24)
        if wanted is None:
            return UNSUPPORTED
        send = self._requests.get(wanted)
        return self._send(wanted, request) if send is None else send(message, request)

    def _send(self, wanted: int, request: Request) -> Answer:
        key = self._component, wanted
        if key not in self._source.builders:
            return UNSUPPORTED
        built = self._source.builders[key](request.now)
        if not built:
            return rejected_for_now(f"Message {wanted} denied: {self._source.absence(key) or 'no data of it now'}")
        request.peer.reply_built(built, self._component)
        return ACCEPTED

    def _set_message_interval(self, message: Command, request: Request) -> Answer:
        """Start (param2 us), stop (-1) or restore (0) the stream of a message (param1) on the sender's link."""
        wanted = self._wanted(message)
        if wanted is None:
            return UNSUPPORTED
        if self._control.is_stranger_at_its_address(request.sender, request.now):
            return denied("Interval denied: another ground station flies by this link")
        microseconds = message.param2
        if microseconds == _STOPPED:
            interval = math.inf
        elif microseconds == 0.0:
            interval = 0.0
        elif self._interval_min * 1e6 <= microseconds <= _INTERVAL_MAX * 1e6:
            interval = microseconds * 1e-6
        else:
            return denied(
                f"Interval denied: {microseconds:g} us is not within {self._interval_min:g} to {_INTERVAL_MAX:g} s", 2
            )
        reason = self._source.absence((self._component, wanted))
        if reason is not None and 0.0 < interval < math.inf:
            return denied(f"Interval denied: {reason}", 1)
        request.peer.set_interval(wanted, interval, self._component)
        return ACCEPTED

    def _get_message_interval(self, message: Command, request: Request) -> Answer:
        """Send MESSAGE_INTERVAL of a message (param1) on the sender's link."""
        number = whole(message.param1, 1 << 16)
        if number is None:
            return denied(f"Interval denied: {message.param1:g} is no message", 1)
        interval = request.peer.interval(number, self._component)
        microseconds = _STOPPED if math.isinf(interval) else round(interval * 1e6)
        if (self._component, number) not in self._source.builders:
            microseconds = _NOT_AVAILABLE
        request.peer.reply(mavlink.MAVLink_message_interval_message(number, microseconds), component=self._component)
        return ACCEPTED

    def _wanted(self, message: Command) -> int | None:
        """Return the message id that a command names; None: there is no such message."""
        wanted = whole(message.param1, 1 << 24)
        return wanted if (self._component, wanted) in self._source.builders else None


def whole(value: float, limit: int = 256) -> int | None:
    """Return a whole number from 0 to below the limit; None for any other parameter (NaN, 2.5, -1)."""
    return int(value) if 0.0 <= value < limit and value == int(value) else None
