"""Requests that the ground sends a vehicle once, for its log: AUTOPILOT_VERSION and all parameters."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink import px4
from gcs.mavlink.messages import Message
from gcs.mavlink.settings import LinkSettings

_VERSION = float(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
_AT_ONCE = 20
"""Parameters that are requested at once, of those that did not come with the list."""


class LogRequests:
    """Requests AUTOPILOT_VERSION and the list of parameters, what is lost again, and after some tries no more.

    Nothing waits for the answers, and nothing of them is kept.
    """

    def __init__(self, system_id: int, settings: LinkSettings) -> None:
        self._target = system_id, px4.AUTOPILOT_COMPONENT
        self._settings = settings
        self._tries = 0
        self._due = math.inf
        """When to look what is missing (s); inf: not wanted, complete or given up."""
        self._has_version = False
        self._count: int | None = None
        self._indices: set[int] = set()
        self._has_come = False
        """True if parameters have come since the last look: the list is on its way."""

    def want(self) -> None:
        """Send the requests, the first time that this is called."""
        if self._tries == 0 and self._due == math.inf:
            self._due = -math.inf

    def due(self, now: float) -> list[Message]:
        """Return the requests that are to be sent at ``now`` (s)."""
        if now < self._due:
            return []
        missing = self._missing()
        if (self._has_version and missing == []) or self._tries >= self._settings.tries:
            self._due = math.inf
            return []
        self._due = now + self._settings.retry_interval
        messages: list[Message] = []
        if not self._has_version:
            command = mavlink.MAV_CMD_REQUEST_MESSAGE
            messages.append(
                mavlink.MAVLink_command_long_message(*self._target, command, self._tries, _VERSION, 0, 0, 0, 0, 0, 0)
            )
        if missing is None:
            messages.append(mavlink.MAVLink_param_request_list_message(*self._target))
        elif not self._has_come:
            messages += [
                mavlink.MAVLink_param_request_read_message(*self._target, b"", index) for index in missing[:_AT_ONCE]
            ]
        if messages:
            self._tries += 1
        self._has_come = False
        return messages

    def take_version(self, message: mavlink.MAVLink_autopilot_version_message) -> None:
        """Take what the vehicle is."""
        self._has_version = True

    def take_value(self, message: mavlink.MAVLink_param_value_message) -> None:
        """Take a parameter: any but the hash of all counts, while they are waited for."""
        if self._due < math.inf and message.param_index < message.param_count:
            self._count = message.param_count
            self._indices.add(message.param_index)
            self._has_come = True

    def _missing(self) -> list[int] | None:
        """Return the indices of the parameters that have not come; None: none has."""
        if self._count is None:
            return None
        return [index for index in range(self._count) if index not in self._indices]
