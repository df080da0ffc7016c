"""MAVLink messages as types: the classes that pymavlink generates, each with who sent it and to whom.

A message is recognised by its class (``isinstance``), so that its fields have types. The classes are those of
ArduPilot's dialect, which holds the common one; a class of another dialect is another class.
"""

from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

Message = mavlink.MAVLink_message

BROADCAST = 0
"""System or component id that addresses everybody."""


class Received(NamedTuple):
    """A message that has come in, with its sender and its addressee (:data:`BROADCAST` where it names none)."""

    message: Message
    system: int
    component: int
    sequence: int
    target_system: int = BROADCAST
    target_component: int = BROADCAST

    def is_for(self, system: int, component: int | None = None) -> bool:
        """Return True if it is addressed to a component (None: to any) of a system, or to everybody."""
        return self.target_system in (BROADCAST, system) and (
            component is None or self.target_component in (BROADCAST, component)
        )
