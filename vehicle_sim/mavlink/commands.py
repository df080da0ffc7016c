"""MAVLink commands to a vehicle: who may give them, what each does, and the answer."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.common as mavlink

from gcs.mavlink import px4
from vehicle_sim.autopilot.autopilot import ACCEPTED, Answer, Autopilot
from vehicle_sim.mavlink.control_owner import ControlOwner, Sender
from vehicle_sim.mavlink.peers import Peer
from vehicle_sim.mavlink.telemetry import Telemetry

INTERVAL_MIN = 0.004  # s; a faster stream than the onboard loop has nothing to tell

#: Commands that only ask, or concern the asker's own link: anybody may give them.
_HARMLESS = (
    mavlink.MAV_CMD_REQUEST_MESSAGE,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES,
)

_DENIED: int = mavlink.MAV_RESULT_DENIED
_UNSUPPORTED: int = mavlink.MAV_RESULT_UNSUPPORTED

Handler = Callable[[Any, Sender, Peer, float], None]


class CommandServer:
    """COMMAND_LONG, COMMAND_INT and SET_MODE."""

    def __init__(self, autopilot: Autopilot, owner: ControlOwner, telemetry: Telemetry) -> None:
        self._autopilot = autopilot
        self._owner = owner
        self._telemetry = telemetry
        self._commands: dict[int, Callable[[Any, Sender, Peer, float], Answer]] = {
            mavlink.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            mavlink.MAV_CMD_DO_SET_MODE: self._do_set_mode,
            mavlink.MAV_CMD_NAV_LAND: self._land,
            mavlink.MAV_CMD_NAV_TAKEOFF: self._take_off,
            mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: self._return,
            mavlink.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_message_interval,
            mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: self._request_capabilities,
        }
        self.handlers: dict[int, Handler] = {
            mavlink.MAVLINK_MSG_ID_COMMAND_LONG: self._on_command,
            mavlink.MAVLINK_MSG_ID_COMMAND_INT: self._on_command,
            mavlink.MAVLINK_MSG_ID_SET_MODE: self._on_set_mode,
        }

    def _on_command(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        run = self._commands.get(message.command)
        if message.command not in _HARMLESS and self._owner.is_stranger(sender, now):
            answer = Answer(_DENIED, "Command denied: another ground station is in control")
        elif run is None:
            answer = Answer(_UNSUPPORTED)
        else:
            answer = run(message, sender, peer, now)
        _explain(answer, peer)
        peer.reply(
            mavlink.MAVLink_command_ack_message(
                message.command, answer.result, 0, 0, sender[1], message.get_srcComponent()
            )
        )

    def _on_set_mode(self, message: Any, sender: Sender, peer: Peer, now: float) -> None:
        if self._owner.is_stranger(sender, now):
            answer = Answer(_DENIED, "Mode denied: another ground station is in control")
        elif not message.base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            answer = Answer(_DENIED, "Mode denied: only custom modes are known")
        else:
            answer = self._enter_mode(message.custom_mode, sender, now)
        _explain(answer, peer)

    def _enter_mode(self, custom_mode: int, sender: Sender, now: float) -> Answer:
        if custom_mode == px4.MODE_OFFBOARD:
            return self._owner.enter_offboard(sender, now)
        return self._autopilot.enter_mode(custom_mode, now)

    def _arm_disarm(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        force = message.param2 == px4.FORCE_ARM_DISARM
        if message.param1 == 1.0:
            return self._autopilot.arm(now, force)
        if message.param1 == 0.0:
            return self._autopilot.disarm(force)
        return Answer(_DENIED, f"Arming denied: param1 {message.param1} is neither 0 nor 1")

    def _do_set_mode(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        base_mode, main = _whole(message.param1), _whole(message.param2)
        sub = 0 if math.isnan(message.param3) else _whole(message.param3)
        if base_mode is None or main is None or sub is None:
            return Answer(_DENIED, "Mode denied: parameters are not whole numbers")
        if not base_mode & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return Answer(_DENIED, "Mode denied: only custom modes are known")
        if main != px4.MainMode.AUTO:
            sub = 0
        return self._enter_mode(px4.encode_custom_mode(main, sub), sender, now)

    def _land(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        return self._autopilot.enter_mode(px4.MODE_LAND, now)

    def _take_off(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        return self._autopilot.enter_mode(px4.MODE_TAKEOFF, now)

    def _return(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        return self._autopilot.enter_mode(px4.MODE_RETURN, now)

    def _request_message(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        wanted = _whole(message.param1, 1 << 24)
        if wanted is None or not self._telemetry.knows(px4.AUTOPILOT_COMPONENT, wanted):
            return Answer(_UNSUPPORTED)
        built = self._telemetry.build(px4.AUTOPILOT_COMPONENT, wanted, now)
        if built is None:
            return Answer(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
        peer.reply(built)
        return ACCEPTED

    def _set_message_interval(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        wanted = _whole(message.param1, 1 << 24)
        if wanted is None or not self._telemetry.knows(px4.AUTOPILOT_COMPONENT, wanted):
            return Answer(_UNSUPPORTED)
        if self._owner.is_stranger_at_its_address(sender, now):
            return Answer(_DENIED, "Interval denied: another ground station flies by this link")
        microseconds = message.param2
        if microseconds == -1.0:
            peer.set_interval(wanted, math.inf)
        elif microseconds == 0.0:
            peer.set_interval(wanted, 0.0)
        elif INTERVAL_MIN * 1e6 <= microseconds <= 3.6e9:
            peer.set_interval(wanted, microseconds * 1e-6)
        else:
            return Answer(_DENIED)
        return ACCEPTED

    def _request_capabilities(self, message: Any, sender: Sender, peer: Peer, now: float) -> Answer:
        peer.reply(self._telemetry.build(px4.AUTOPILOT_COMPONENT, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION, now))
        return ACCEPTED


def _explain(answer: Answer, peer: Peer) -> None:
    """Why, to the one who asked."""
    if answer.text:
        peer.tell(answer.text)


def _whole(value: float, limit: int = 256) -> int | None:
    """A parameter that must be a whole number from 0 to below the limit; None if it is not (NaN, 2.5, -1)."""
    return int(value) if 0.0 <= value < limit and value == int(value) else None
