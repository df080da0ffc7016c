"""Inputs that an aircraft does not fly by: it says so, instead of ignoring them without a word."""

import math
from collections.abc import Mapping
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.address import Address
from gcs.mavlink.messages import Message
from gcs.mavlink.services.dispatcher import Dispatcher, Request

_NO_STICKS = "Manual control is ignored: sticks are not read"
STICKS: Mapping[type[Message], str] = {
    mavlink.MAVLink_manual_control_message: _NO_STICKS,
    mavlink.MAVLink_rc_channels_override_message: _NO_STICKS,
}
"""Messages of a remote control, and what is said of them."""

_REMINDER = 10.0  # s; between texts to one peer
_REMEMBERED = 32  # peers and topics


class Reminders:
    """Texts about what comes many times a second, each sent to a peer now and then."""

    def __init__(self) -> None:
        self._said: dict[tuple[Address, str], float] = {}
        """When a text about a topic was sent to a peer last (s)."""

    def send(self, text: str, topic: str, request: Request) -> None:
        """Send a text to the sender of a message, unless one about the ``topic`` was sent a moment ago."""
        key = request.peer.address, topic
        if request.now - self._said.get(key, -math.inf) < _REMINDER:
            return
        self._said.pop(key, None)
        if len(self._said) >= _REMEMBERED:
            del self._said[next(iter(self._said))]
        self._said[key] = request.now
        request.peer.send_statustext(text)


class UnservedInputs:
    """Answers messages that come many times a second with a text now and then."""

    def __init__(self, system: int, texts: Mapping[type[Message], str]) -> None:
        """``system``: the aircraft's id; ``texts``: what is said of each kind of message."""
        self._system = system
        self._texts = texts
        self._reminders = Reminders()

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages that no service has taken: to be called last."""
        for kind in self._texts:
            if kind not in dispatcher.messages:
                dispatcher.register(kind, self._on_message)

    def _on_message(self, message: Any, request: Request) -> None:
        # MANUAL_CONTROL names its addressee in a field of its own.
        if getattr(message, "target", self._system) in (0, self._system):
            text = self._texts[type(message)]
            self._reminders.send(text, text, request)
