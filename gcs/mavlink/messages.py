"""MAVLink messages as types: the classes that pymavlink generates, each with who sent it and to whom.

A message is recognised by its class (``isinstance``), so that its fields have types. The classes are those of
ArduPilot's dialect, which holds the common one; a class of another dialect is another class. What comes with every
sample is recognised by its message id instead, and its fields are read without a message object.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.layout import Layout

Message = mavlink.MAVLink_message

BROADCAST = 0
"""System or component id that addresses everybody."""


class Received(NamedTuple):
    """A message that has come in, with its sender and its addressee (:data:`BROADCAST` where it names none)."""

    layout: Layout
    payload: bytes
    run: int
    """Number of messages: more than one only for a run, see :meth:`gcs.mavlink.codec.Codec.read`."""
    system: int
    component: int
    sequence: int
    target_system: int
    target_component: int
    time_boot_ms: int
    """The stamp (ms) in its first field, where OBSTACLE_DISTANCE has microseconds; of a message without one nothing."""

    @property
    def message_id(self) -> int:
        """Id of the kind of message."""
        return self.layout.message_id

    @property
    def message(self) -> Message:
        """The message as pymavlink has it; read anew each time."""
        message = self.layout.message(self.payload)
        header = message.get_header()
        header.seq, header.srcSystem, header.srcComponent = self.sequence, self.system, self.component
        return message

    @property
    def fields(self) -> tuple[Any, ...]:
        """The fields in the order of the wire, arrays number by number."""
        return self.layout.fields(self.payload)

    def split(self) -> list[Received]:
        """Return the messages of a run one by one, as they are received elsewhere."""
        size = len(self.payload) // self.run
        return [
            self._replace(payload=self.payload[k * size : (k + 1) * size], sequence=(self.sequence + k) & 0xFF, run=1)
            for k in range(self.run)
        ]

    def is_for(self, system: int, component: int | None = None) -> bool:
        """Return True if it is addressed to a component (None: to any) of a system, or to everybody."""
        return self.target_system in (BROADCAST, system) and (
            component is None or self.target_component in (BROADCAST, component)
        )
