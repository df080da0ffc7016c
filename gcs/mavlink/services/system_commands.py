"""Commands about the system itself: prearm checks, storage of parameters, restart."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import newer_messages
from gcs.mavlink.services.aircraft import Aircraft
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied
from gcs.mavlink.services.dispatcher import Command, Dispatcher, Request
from gcs.mavlink.services.parameter_table import ParameterTable
from gcs.mavlink.services.streams import StreamRequests

_NOTHING = -1.0
_READ, _WRITE, _RESET = 0.0, 1.0, 2.0


class SystemCommands:
    """Commands to the autopilot beside those of flight."""

    def __init__(self, aircraft: Aircraft, parameters: ParameterTable, streams: StreamRequests) -> None:
        self._aircraft = aircraft
        self._parameters = parameters
        self._streams = streams

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the commands of this service."""
        sending = self._streams.sending
        dispatcher.register_commands(
            {
                mavlink.MAV_CMD_GET_HOME_POSITION: sending(mavlink.MAVLINK_MSG_ID_HOME_POSITION),
                mavlink.MAV_CMD_REQUEST_PROTOCOL_VERSION: sending(newer_messages.PROTOCOL_VERSION),
                mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: sending(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
                mavlink.MAV_CMD_RUN_PREARM_CHECKS: self._run_prearm_checks,
                mavlink.MAV_CMD_PREFLIGHT_STORAGE: self._storage,
                mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: self._reboot,
            }
        )

    def _run_prearm_checks(self, message: Command, request: Request) -> Answer:
        """Run the prearm checks, and say by STATUSTEXT what is wrong."""
        problem = self._aircraft.arming_problem(request.now)
        if problem is None:
            request.peer.send_statustext("Preflight OK", mavlink.MAV_SEVERITY_INFO)
        else:
            request.peer.send_statustext(f"Preflight Fail: {problem}")
        return ACCEPTED

    def _storage(self, message: Command, request: Request) -> Answer:
        """Parameters (param1): read what was saved (0), save (1), set to defaults (2); kept until the program ends."""
        if message.param2 not in (0.0, _NOTHING) and not math.isnan(message.param2):
            return denied("Storage denied: missions are not saved", 2)
        if message.param1 == _READ:
            self._parameters.restore()
        elif message.param1 == _WRITE:
            self._parameters.save()
        elif message.param1 == _RESET:
            self._parameters.reset()
        elif message.param1 != _NOTHING:
            return denied(f"Storage denied: action {message.param1:g} is none of 0, 1, 2", 1)
        return ACCEPTED

    def _reboot(self, message: Command, request: Request) -> Answer:
        """Deny: one vehicle of a simulated world does not start anew alone."""
        if message.param1 == 0.0:
            return ACCEPTED
        return denied("Reboot denied: a simulated vehicle starts with its world; start vehicle-sim anew", 1)
