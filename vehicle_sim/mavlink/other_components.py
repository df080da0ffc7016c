"""Commands that reach a vehicle but are not its autopilot's: to the payload unit, or to a component that is absent."""

from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.messages import BROADCAST, Received
from vehicle_sim.autopilot.answer import UNSUPPORTED, Answer
from vehicle_sim.mavlink.dispatcher import Command, Request
from vehicle_sim.mavlink.stream_requests import StreamRequests

_COMMANDS = (mavlink.MAVLINK_MSG_ID_COMMAND_LONG, mavlink.MAVLINK_MSG_ID_COMMAND_INT)


class OtherComponents:
    """Answers every command, so that nobody waits: the payload unit sends messages, what is absent does nothing."""

    def __init__(self, system_id: int, payload_unit: StreamRequests) -> None:
        """``system_id`` of the vehicle."""
        self._system_id = system_id
        self._of_payload_unit: dict[int, Callable[[Command, Request], Answer]] = {
            mavlink.MAV_CMD_REQUEST_MESSAGE: payload_unit.request_message,
            mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: payload_unit.set_message_interval,
        }

    def handle(self, received: Received, request: Request) -> None:
        """Carry out or refuse a command; the system that it is for answers. What is for nobody here is ignored."""
        if received.message_id not in _COMMANDS:
            return
        if received.target_system == self._system_id:
            self._answer(received, request, UNSUPPORTED, px4.AUTOPILOT_COMPONENT)
        elif received.target_system == px4.PAYLOAD_UNIT_SYSTEM:
            message: Any = received.message
            run = self._of_payload_unit.get(message.command)
            is_present = received.target_component in (BROADCAST, px4.PAYLOAD_UNIT_COMPONENT)
            answer = UNSUPPORTED if run is None or not is_present else run(message, request)
            self._answer(received, request, answer, px4.PAYLOAD_UNIT_COMPONENT)

    def _answer(self, received: Received, request: Request, answer: Answer, component: int) -> None:
        command: Any = received.message
        request.peer.reply(
            mavlink.MAVLink_command_ack_message(
                command.command, answer.result, 0, 0, request.system, request.component
            ),
            component=component,
        )
