"""The barrier that lets a world and a ground station share one virtual clock over UDP.

The world owns the time. At every moment at which anything is due it first sends the vehicles' datagrams and then, from
its clock port to the socket from which the ground has joined, a :class:`Tick`. Loopback UDP keeps the order of arrival,
so all that was sent before the tick is there with it. The ground answers all of it at that time, and last of all, to
the clock port, with :class:`Done`, which names the next moment at which it wants to be called. When vehicles have
something to say to what they received, the world ticks again at the same time; otherwise it lets time go on to the
earliest of what is due on either side.

The barrier carries only time and stands outside MAVLink, so that no fault on a link can stop the clock.
"""

import math
import struct
from typing import NamedTuple

_TICK = struct.Struct("<4sIQ")
_DONE = struct.Struct("<4sIQB")
_TICK_MAGIC = b"CLTK"
_DONE_MAGIC = b"CLDN"
_NEVER = 2**64 - 1

STRIDE_US = 100_000  # of free time between looks at the world
# Ticks at one moment after which time goes on: two who always have an answer for each other must not stop it.
TICKS_AT_ONE_TIME = 1000


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


class LockstepTime:
    """The time of a world in lockstep, in whole microseconds (``us``), and how it goes on."""

    def __init__(self, start: float) -> None:
        """``start`` in s."""
        self.us = round(start * 1e6)
        self._ticks = 0

    @property
    def world(self) -> float:
        """The time (s) as the world computes it."""
        return self.us / 1e6

    @property
    def ground(self) -> float:
        """The time (s) as the ground computes it from a tick; the last bit can be another one."""
        return self.us * 1e-6

    def advance(self, timer: float | None, next_us: int | None) -> None:
        """Go on after a tick, to the world's ``timer`` (s) or to the ground's next call, whichever is earlier.

        It may remain at the same time, as vehicles may have something to say to what they received.
        """
        self._ticks += 1
        due = [us for us in (_whole_us(timer), next_us) if us is not None]
        then = max(min(due, default=self.us + STRIDE_US), self.us)
        if then == self.us and self._ticks >= TICKS_AT_ONE_TIME:
            then += 1000
        if then > self.us:
            self._ticks = 0
            self.us = then

    def run_free(self, timer: float | None) -> None:
        """Go on without a ground, to the world's ``timer`` (s) but by no more than a stride."""
        due, stride = _whole_us(timer), self.us + STRIDE_US
        self.us = stride if due is None else min(max(due, self.us + 1), stride)
        self._ticks = 0


def _whole_us(timer: float | None) -> int | None:
    return None if timer is None else round(timer * 1e6)


def next_call_us(timer: float | None, time_us: int) -> int | None:
    """Return when a ground wants its next call (us) whose ``timer`` (s) is due next, after a tick at ``time_us``."""
    return None if timer is None else max(math.ceil(timer * 1e6 - 1e-3), time_us + 1)


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
