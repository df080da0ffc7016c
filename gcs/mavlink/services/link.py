"""TIMESYNC and PING: answers by which others measure an aircraft's clock and the link to it."""

from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.services.dispatcher import Dispatcher, Request

_TIMESYNC = LAYOUTS[mavlink.MAVLINK_MSG_ID_TIMESYNC]


class LinkServices:
    """Answers requests of both protocols; answers of others are ignored."""

    def __init__(self, clock: Callable[[float], float]) -> None:
        """``clock`` is what the aircraft's clock shows at a time."""
        self._clock = clock

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of these services."""
        dispatcher.register_fields(mavlink.MAVLink_timesync_message, self._on_timesync)
        dispatcher.register(mavlink.MAVLink_ping_message, self._on_ping)

    def _on_timesync(self, fields: tuple[Any, ...], request: Request) -> None:
        tc1, ts1, *_ = fields
        if tc1 == 0:  # a request
            request.peer.reply_packed(_TIMESYNC.pack(round(self._clock(request.now) * 1e9), ts1))

    def _on_ping(self, message: mavlink.MAVLink_ping_message, request: Request) -> None:
        if message.target_system == 0:  # a request
            request.peer.reply(
                mavlink.MAVLink_ping_message(message.time_usec, message.seq, request.system, request.component)
            )
