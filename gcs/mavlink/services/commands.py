"""MAVLink commands to an aircraft: the ground that may send them, their execution, and the answer."""

import math
from collections.abc import Callable

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.services.aircraft import Aircraft, Control, MessageSource
from gcs.mavlink.services.answer import ACCEPTED, UNSUPPORTED, Answer, denied
from gcs.mavlink.services.dispatcher import Command, Dispatcher, Request
from gcs.mavlink.services.peer import Peer
from gcs.mavlink.services.streams import StreamRequests, whole

#: Requests of information, or about the sender's own link: every ground may send them.
_HARMLESS = (
    mavlink.MAV_CMD_REQUEST_MESSAGE,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES,
)


class CommandServer:
    """COMMAND_LONG, COMMAND_INT and SET_MODE."""

    def __init__(self, aircraft: Aircraft, control: Control, source: MessageSource, streams: StreamRequests) -> None:
        self._aircraft = aircraft
        self._control = control
        self._builders = source.builders
        self._commands: dict[int, Callable[[Command, Request], Answer]] = {
            mavlink.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            mavlink.MAV_CMD_DO_SET_MODE: self._do_set_mode,
            mavlink.MAV_CMD_NAV_LAND: self._entering(px4.MODE_LAND),
            mavlink.MAV_CMD_NAV_TAKEOFF: self._entering(px4.MODE_TAKEOFF),
            mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: self._entering(px4.MODE_RETURN),
            mavlink.MAV_CMD_REQUEST_MESSAGE: streams.request_message,
            mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: streams.set_message_interval,
            mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: self._request_capabilities,
        }

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        dispatcher.register(mavlink.MAVLink_command_long_message, self._on_command)
        dispatcher.register(mavlink.MAVLink_command_int_message, self._on_command)
        dispatcher.register(mavlink.MAVLink_set_mode_message, self._on_set_mode)

    def add(self, command: int, run: Callable[[Command, Request], Answer]) -> None:
        """Carry out a command of another service."""
        self._commands[command] = run

    def _on_command(self, message: Command, request: Request) -> None:
        run = self._commands.get(message.command)
        if message.command not in _HARMLESS and self._control.is_stranger(request.sender, request.now):
            answer = denied("Command denied: another ground station is in control")
        elif run is None:
            answer = UNSUPPORTED
        else:
            answer = run(message, request)
        _explain(answer, request.peer)
        request.peer.reply(
            mavlink.MAVLink_command_ack_message(message.command, answer.result, 0, 0, request.system, request.component)
        )

    def _on_set_mode(self, message: mavlink.MAVLink_set_mode_message, request: Request) -> None:
        if self._control.is_stranger(request.sender, request.now):
            answer = denied("Mode denied: another ground station is in control")
        elif not message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            answer = denied("Mode denied: only custom modes are known")
        else:
            answer = self._aircraft.enter_mode(message.custom_mode, request.sender, request.now)
        _explain(answer, request.peer)

    def _arm_disarm(self, message: Command, request: Request) -> Answer:
        force = message.param2 == px4.FORCE_ARM_DISARM
        if message.param1 == 1.0:
            return self._aircraft.arm(request.now, force)
        if message.param1 == 0.0:
            return self._aircraft.disarm(request.now, force)
        return denied(f"Arming denied: param1 {message.param1} is neither 0 nor 1")

    def _do_set_mode(self, message: Command, request: Request) -> Answer:
        base_mode, main = whole(message.param1), whole(message.param2)
        sub = 0 if math.isnan(message.param3) else whole(message.param3)
        if base_mode is None or main is None or sub is None:
            return denied("Mode denied: parameters are not whole numbers")
        if not base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return denied("Mode denied: only custom modes are known")
        if main != px4.MainMode.AUTO:
            sub = 0
        return self._aircraft.enter_mode(px4.encode_custom_mode(main, sub), request.sender, request.now)

    def _entering(self, mode: int) -> Callable[[Command, Request], Answer]:
        """Return what carries out a command that enters a mode."""
        return lambda message, request: self._aircraft.enter_mode(mode, request.sender, request.now)

    def _request_capabilities(self, message: Command, request: Request) -> Answer:
        version = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
        request.peer.reply_packed(*self._builders[px4.AUTOPILOT_COMPONENT, version](request.now))
        return ACCEPTED


def _explain(answer: Answer, peer: Peer) -> None:
    """Send the reason of an answer, if it has one, as a text."""
    if answer.text:
        peer.send_statustext(answer.text)
