"""Bounds of the offset of a vehicle's clock, whatever its link does, and stamps of 32 bits made continuous."""

import math
from collections import deque
from typing import NamedTuple

STAMP_WRAP = 2**32 * 1e-3
"""Time (s) after which stamps of 32 bits of ms begin anew."""


class OffsetBounds(NamedTuple):
    """Bounds (s) of vehicle time less ground time by one datagram: it was sent before it arrived."""

    arrival: float
    """Ground time (s)."""
    lower: float
    upper: float
    """Of a TIMESYNC answer, which was sent after its request; of a stamp inf."""


class ClockBounds:
    """Bounds by all datagrams, from when TIMESYNC has been heard: before, nothing bounds the offset from above.

    Stamps of 32 bits of ms begin anew after 49.7 days, and a clock that is set back to before its zero reads as many
    days: both are taken for the time nearest to the last stamp, which is no step, and a small one.
    """

    def __init__(self, kept: int, epoch: float) -> None:
        """``kept``: bounds kept until they are taken; ``epoch`` (s): clocks that differ by more have another zero."""
        self._epoch = epoch
        self._bounds: deque[OffsetBounds] = deque(maxlen=kept)
        self._last: float | None = None
        self._zero: float | None = None
        self.sent = math.nan
        """Vehicle time (s) at which the last stamp or answer was sent."""

    @property
    def known(self) -> bool:
        """True once the offset is bounded from both sides."""
        return self._zero is not None

    def unwrapped(self, boot_time: float) -> float:
        """Return the time (s) nearest to the last stamp that a stamp of 32 bits of ms reads as ``boot_time`` (s)."""
        if self._last is None:
            return boot_time
        return boot_time - round((boot_time - self._last) / STAMP_WRAP) * STAMP_WRAP

    def add_stamp(self, boot_time: float, arrival: float) -> None:
        """Take an unwrapped stamp (s, vehicle) that arrived at ``arrival`` (s, ground)."""
        self._last = self.sent = boot_time
        if self.known:
            self._bounds.append(OffsetBounds(arrival, boot_time - arrival, math.inf))

    def add_answer(self, time: float, sent: float, arrival: float, reached: float) -> None:
        """Take a TIMESYNC answer of vehicle ``time`` (s) to the request of ``sent``, that came at ``arrival`` (s).

        ``reached``: the greatest offset (s) by the stamps of late, and how much the latency varies. A vehicle that
        cannot compute for a while reads late, which no latency shows: its clock is set back only once all stamps of
        late say so, by more than they vary.
        """
        if self._last is None:
            return
        boot_time = self.unwrapped(time)
        if self._zero is None:
            apart = boot_time - arrival - reached
            self._zero = apart if abs(apart) > self._epoch else 0.0
        boot_time -= self._zero
        self.sent = boot_time
        self._bounds.append(OffsetBounds(arrival, boot_time - arrival, max(boot_time - sent, reached)))

    def take(self) -> list[OffsetBounds]:
        """Return the bounds that have come since the last call, in the order in which they came."""
        taken = [*self._bounds]
        self._bounds.clear()
        return taken
