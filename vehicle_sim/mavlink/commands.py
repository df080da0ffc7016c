"""MAVLink commands to a vehicle: the ground that may send them, their execution, and the answer."""

import math
from collections.abc import Callable

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink import px4
from vehicle_sim.autopilot.answer import ACCEPTED, Answer
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.mavlink.control_owner import ControlOwner, Sender
from vehicle_sim.mavlink.dispatcher import Dispatcher, Request
from vehicle_sim.mavlink.peer import Peer
from vehicle_sim.mavlink.telemetry import Telemetry

#: Requests of information, or about the sender's own link: every ground may send them.
_HARMLESS = (
    mavlink.MAV_CMD_REQUEST_MESSAGE,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES,
)

_DENIED: int = mavlink.MAV_RESULT_DENIED
_UNSUPPORTED: int = mavlink.MAV_RESULT_UNSUPPORTED

Command = mavlink.MAVLink_command_long_message | mavlink.MAVLink_command_int_message


class CommandServer:
    """COMMAND_LONG, COMMAND_INT and SET_MODE."""

    def __init__(
        self, autopilot: Autopilot, owner: ControlOwner, telemetry: Telemetry, settings: VehicleLinkSettings
    ) -> None:
        self._interval_min = settings.interval_min
        self._autopilot = autopilot
        self._owner = owner
        self._telemetry = telemetry
        self._commands: dict[int, Callable[[Command, Request], Answer]] = {
            mavlink.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            mavlink.MAV_CMD_DO_SET_MODE: self._do_set_mode,
            mavlink.MAV_CMD_NAV_LAND: self._land,
            mavlink.MAV_CMD_NAV_TAKEOFF: self._take_off,
            mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: self._return,
            mavlink.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_message_interval,
            mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: self._request_capabilities,
        }

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        dispatcher.register(mavlink.MAVLink_command_long_message, self._on_command)
        dispatcher.register(mavlink.MAVLink_command_int_message, self._on_command)
        dispatcher.register(mavlink.MAVLink_set_mode_message, self._on_set_mode)

    def _on_command(self, message: Command, request: Request) -> None:
        run = self._commands.get(message.command)
        if message.command not in _HARMLESS and self._owner.is_stranger(request.sender, request.now):
            answer = Answer(_DENIED, "Command denied: another ground station is in control")
        elif run is None:
            answer = Answer(_UNSUPPORTED)
        else:
            answer = run(message, request)
        _explain(answer, request.peer)
        request.peer.reply(
            mavlink.MAVLink_command_ack_message(message.command, answer.result, 0, 0, request.system, request.component)
        )

    def _on_set_mode(self, message: mavlink.MAVLink_set_mode_message, request: Request) -> None:
        if self._owner.is_stranger(request.sender, request.now):
            answer = Answer(_DENIED, "Mode denied: another ground station is in control")
        elif not message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            answer = Answer(_DENIED, "Mode denied: only custom modes are known")
        else:
            answer = self._enter_mode(message.custom_mode, request.sender, request.now)
        _explain(answer, request.peer)

    def _enter_mode(self, custom_mode: int, sender: Sender, now: float) -> Answer:
        if custom_mode == px4.MODE_OFFBOARD:
            return self._owner.enter_offboard(sender, now)
        return self._autopilot.enter_mode(custom_mode, now)

    def _arm_disarm(self, message: Command, request: Request) -> Answer:
        force = message.param2 == px4.FORCE_ARM_DISARM
        if message.param1 == 1.0:
            return self._autopilot.arm(request.now, force)
        if message.param1 == 0.0:
            return self._autopilot.disarm(force)
        return Answer(_DENIED, f"Arming denied: param1 {message.param1} is neither 0 nor 1")

    def _do_set_mode(self, message: Command, request: Request) -> Answer:
        base_mode, main = _whole(message.param1), _whole(message.param2)
        sub = 0 if math.isnan(message.param3) else _whole(message.param3)
        if base_mode is None or main is None or sub is None:
            return Answer(_DENIED, "Mode denied: parameters are not whole numbers")
        if not base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return Answer(_DENIED, "Mode denied: only custom modes are known")
        if main != px4.MainMode.AUTO:
            sub = 0
        return self._enter_mode(px4.encode_custom_mode(main, sub), request.sender, request.now)

    def _land(self, message: Command, request: Request) -> Answer:
        return self._autopilot.enter_mode(px4.MODE_LAND, request.now)

    def _take_off(self, message: Command, request: Request) -> Answer:
        return self._autopilot.enter_mode(px4.MODE_TAKEOFF, request.now)

    def _return(self, message: Command, request: Request) -> Answer:
        return self._autopilot.enter_mode(px4.MODE_RETURN, request.now)

    def _request_message(self, message: Command, request: Request) -> Answer:
        wanted = _whole(message.param1, 1 << 24)
        if wanted is None or not self._telemetry.knows(px4.AUTOPILOT_COMPONENT, wanted):
            return Answer(_UNSUPPORTED)
        built = self._telemetry.build(request.now, px4.AUTOPILOT_COMPONENT, wanted)
        if not built:
            return Answer(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
        request.peer.reply_packed(*built)
        return ACCEPTED

    def _set_message_interval(self, message: Command, request: Request) -> Answer:
        wanted = _whole(message.param1, 1 << 24)
        if wanted is None or not self._telemetry.knows(px4.AUTOPILOT_COMPONENT, wanted):
            return Answer(_UNSUPPORTED)
        if self._owner.is_stranger_at_its_address(request.sender, request.now):
            return Answer(_DENIED, "Interval denied: another ground station flies by this link")
        microseconds = message.param2
        if microseconds == -1.0:
            request.peer.set_interval(wanted, math.inf)
        elif microseconds == 0.0:
            request.peer.set_interval(wanted, 0.0)
        elif self._interval_min * 1e6 <= microseconds <= 3.6e9:
            request.peer.set_interval(wanted, microseconds * 1e-6)
        else:
            return Answer(_DENIED)
        return ACCEPTED

    def _request_capabilities(self, message: Command, request: Request) -> Answer:
        version = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
        request.peer.reply_packed(*self._telemetry.build(request.now, px4.AUTOPILOT_COMPONENT, version))
        return ACCEPTED


def _explain(answer: Answer, peer: Peer) -> None:
    """Send the reason of an answer, if it has one, as a text."""
    if answer.text:
        peer.send_statustext(answer.text)


def _whole(value: float, limit: int = 256) -> int | None:
    """Return a whole number from 0 to below the limit; None for any other parameter (NaN, 2.5, -1)."""
    return int(value) if 0.0 <= value < limit and value == int(value) else None
