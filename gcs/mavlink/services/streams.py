"""Requests of one message or of its stream."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.aircraft import Control, MessageSource
from gcs.mavlink.services.answer import ACCEPTED, UNSUPPORTED, Answer, denied
from gcs.mavlink.services.dispatcher import Command, Request
from gcs.mavlink.settings import PeerSettings


class StreamRequests:
    """MAV_CMD_REQUEST_MESSAGE and MAV_CMD_SET_MESSAGE_INTERVAL for the messages of one component."""

    def __init__(self, component: int, source: MessageSource, control: Control, settings: PeerSettings) -> None:
        self._component = component
        self._builders = source.builders
        self._control = control
        self._interval_min = settings.interval_min

    def request_message(self, message: Command, request: Request) -> Answer:
        """Send a message once."""
        wanted = self._wanted(message)
        if wanted is None:
            return UNSUPPORTED
        built = self._builders[self._component, wanted](request.now)
        if not built:
            return Answer(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
        request.peer.reply_packed(*built, component=self._component)
        return ACCEPTED

    def set_message_interval(self, message: Command, request: Request) -> Answer:
        """Start, stop or restore the stream of a message on the sender's link."""
        wanted = self._wanted(message)
        if wanted is None:
            return UNSUPPORTED
        if self._control.is_stranger_at_its_address(request.sender, request.now):
            return denied("Interval denied: another ground station flies by this link")
        microseconds = message.param2
        if microseconds == -1.0:
            interval = math.inf
        elif microseconds == 0.0:
            interval = 0.0
        elif self._interval_min * 1e6 <= microseconds <= 3.6e9:
            interval = microseconds * 1e-6
        else:
            return denied("")
        request.peer.set_interval(wanted, interval, self._component)
        return ACCEPTED

    def _wanted(self, message: Command) -> int | None:
        """Return the message id that a command names; None: there is no such message."""
        wanted = whole(message.param1, 1 << 24)
        return wanted if (self._component, wanted) in self._builders else None


def whole(value: float, limit: int = 256) -> int | None:
    """Return a whole number from 0 to below the limit; None for any other parameter (NaN, 2.5, -1)."""
    return int(value) if 0.0 <= value < limit and value == int(value) else None
