"""The barrier that lets a world and a ground station share one virtual clock over UDP.

The world owns the time. At every moment at which anything is due it first sends the vehicles' datagrams and then, from
its clock port to the socket from which the ground has joined, a :class:`Tick`. Loopback UDP keeps the order of arrival,
so all that was sent before the tick is there with it. The ground answers all of it at that time, and last of all, to
the clock port, with :class:`Done`, which names the next moment at which it wants to be called. When vehicles have
something to say to what they received, the world ticks again at the same time; otherwise it lets time go on to the
earliest of what is due on either side.

The barrier carries only time and stands outside MAVLink, so that no fault on a link can stop the clock.
"""

import struct
from typing import NamedTuple

_TICK = struct.Struct("<4sIQ")
_DONE = struct.Struct("<4sIQB")
_TICK_MAGIC = b"CLTK"
_DONE_MAGIC = b"CLDN"
_NEVER = 2**64 - 1


class Tick(NamedTuple):
    """All datagrams of this time have been sent."""

    serial: int
    time_us: int

    def encode(self) -> bytes:
        """Return it as one datagram."""
        return _TICK.pack(_TICK_MAGIC, self.serial, self.time_us)


class Done(NamedTuple):
    """The ground has answered a tick. Serial 0: a request to join."""

    serial: int
    next_us: int | None
    """Latest time of the ground's next call (us); None: only when something arrives."""
    leaving: bool = False
    """The ground will not answer again."""

    def encode(self) -> bytes:
        """Return it as one datagram."""
        next_us = _NEVER if self.next_us is None else self.next_us
        return _DONE.pack(_DONE_MAGIC, self.serial, next_us, self.leaving)


def decode_tick(datagram: bytes) -> Tick | None:
    """Return the tick; None: the datagram is something else."""
    if len(datagram) != _TICK.size or not datagram.startswith(_TICK_MAGIC):
        return None
    _, serial, time_us = _TICK.unpack(datagram)
    return Tick(serial, time_us)


def decode_done(datagram: bytes) -> Done | None:
    """Return the answer; None: the datagram is something else."""
    if len(datagram) != _DONE.size or not datagram.startswith(_DONE_MAGIC):
        return None
    _, serial, next_us, leaving = _DONE.unpack(datagram)
    return Done(serial, None if next_us == _NEVER else next_us, bool(leaving))
