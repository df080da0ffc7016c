"""Modes: entered on command, and reported by AVAILABLE_MODES and CURRENT_MODE as by PX4."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import newer_messages, px4
from gcs.mavlink.layout import LAYOUTS, Packed
from gcs.mavlink.services.aircraft import Aircraft, Control
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied
from gcs.mavlink.services.dispatcher import Command, Dispatcher, Request
from gcs.mavlink.services.streams import whole

_AVAILABLE_MODES = LAYOUTS[newer_messages.AVAILABLE_MODES]
_ADVANCED = (px4.MODE_OFFBOARD,)
"""Modes that PX4 marks as such."""


class ModeCommands:
    """DO_SET_MODE, DO_SET_STANDARD_MODE and SET_MODE, and AVAILABLE_MODES on request."""

    def __init__(self, aircraft: Aircraft, control: Control) -> None:
        self._aircraft = aircraft
        self._control = control

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages, commands and requests of this service."""
        dispatcher.register(mavlink.MAVLink_set_mode_message, self._on_set_mode)
        dispatcher.register_commands(
            {
                mavlink.MAV_CMD_DO_SET_MODE: self._set_mode,
                mavlink.MAV_CMD_DO_SET_STANDARD_MODE: self._set_standard_mode,
            }
        )
        dispatcher.requests[newer_messages.AVAILABLE_MODES] = self._send_available

    def _send_available(self, message: Command, request: Request) -> Answer:
        """Send AVAILABLE_MODES of one mode (param2, from 1), or of all (0)."""
        modes = self._aircraft.modes
        index = 0 if math.isnan(message.param2) else whole(message.param2, len(modes) + 1)
        if index is None:
            return denied(f"AVAILABLE_MODES denied: there are {len(modes)} modes", 2)
        numbers = range(1, len(modes) + 1) if index == 0 else (index,)
        request.peer.reply_packed(*(_available(modes[number - 1], number, len(modes)) for number in numbers))
        return ACCEPTED

    def _set_mode(self, message: Command, request: Request) -> Answer:
        """Enter one of PX4's custom modes: main mode in param2, sub-mode in param3."""
        base_mode, main = whole(message.param1), whole(message.param2)
        sub = 0 if math.isnan(message.param3) else whole(message.param3)
        if base_mode is None or main is None or sub is None:
            return denied("Mode denied: parameters are not whole numbers")
        if not base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return denied("Mode denied: only custom modes are known", 1)
        if main != px4.MainMode.AUTO:
            sub = 0
        return self._aircraft.enter_mode(px4.encode_custom_mode(main, sub), request.sender, request.now)

    def _set_standard_mode(self, message: Command, request: Request) -> Answer:
        """Enter the mode that is a standard one (param1)."""
        for mode, standard in px4.STANDARD_MODES.items():
            if standard == message.param1:
                return self._aircraft.enter_mode(mode, request.sender, request.now)
        return denied(f"Mode denied: no mode is standard mode {message.param1:g}", 1)

    def _on_set_mode(self, message: mavlink.MAVLink_set_mode_message, request: Request) -> None:
        if self._control.is_stranger(request.sender, request.now):
            answer = denied("Mode denied: another ground station is in control")
        elif message.target_system != 0 or self._aircraft.obeys_broadcasts:
            answer = self._enter(message, request)
        else:
            answer = denied("Mode denied: sent to all systems; on a payload each vehicle is commanded by its own id")
        if answer.text:
            request.peer.send_statustext(answer.text)

    def _enter(self, message: mavlink.MAVLink_set_mode_message, request: Request) -> Answer:
        if not message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return denied("Mode denied: only custom modes are known")
        return self._aircraft.enter_mode(message.custom_mode, request.sender, request.now)


def _available(mode: int, number: int, count: int) -> Packed:
    """Return AVAILABLE_MODES of a custom mode, the ``number`` (from 1) of ``count``."""
    properties = newer_messages.MODE_PROPERTY_ADVANCED if mode in _ADVANCED else 0
    name = px4.MODE_LABELS.get(mode, px4.mode_name(mode)).encode()
    return _AVAILABLE_MODES.pack(mode, properties, count, number, px4.standard_mode(mode), name)
