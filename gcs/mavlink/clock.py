"""The clock of one vehicle as the ground sees it: its boot time in the ground's time, and how far away it is."""

from __future__ import annotations

import math
from collections import deque
from statistics import median

WINDOW = 10  # round trips that are remembered: as long as the stamps, so that both tell of one time
SLICE = 0.25  # s of which only the greatest lead is remembered
SLICES = 4  # few, because a simulated world that has stalled does not catch up
RECENT = 4  # round trips
OPEN_REQUESTS = 100  # TIMESYNC requests whose answers are waited for
SET_BACK = 0.005  # s; a later stamp that is earlier by more: the clock has been set back
JUMP = 0.02  # s; an offset that changes by more at once does not creep
REBOOT = 1.0  # s; a boot time that falls behind by more belongs to another boot


class RemoteClock:
    """Offset and delay of a vehicle from TIMESYNC round trips and from the stamps of its telemetry.

    A stamp arrives after a delay that is never negative, so the largest ``stamp - arrival`` seen in the last seconds is
    nearest to the truth; half of the shortest round trip is the part of the delay that is always there.
    """

    def __init__(self) -> None:
        self._leads: deque[list[float]] = deque(maxlen=SLICES)  # [beginning of the slice, greatest lead in it]
        self._lead = -math.inf
        self._newest = -math.inf
        self.set_back = 0.0
        """By how much it has been set back in all (s)."""
        self.jumped = -math.inf
        """When its offset last changed at once (s, ground): it was set, or datagrams come otherwise than before."""
        self.lag = 0.0
        """By how much later (s) the last stamp came than the soonest of the last second."""
        self._asked: deque[int] = deque(maxlen=OPEN_REQUESTS)
        self._round_trips: deque[float] = deque(maxlen=WINDOW)
        self._arrivals: deque[float] = deque(maxlen=WINDOW)
        self._shortest = 0.0

    def stamped(self, boot_time: float, arrival: float, in_order: bool = False) -> None:
        """Telemetry stamped ``boot_time`` (s, vehicle) arrived at ``arrival`` (s, ground).

        ``in_order``: it was sent after all that came before.
        """
        lead, before = boot_time - arrival, self._lead
        if in_order and boot_time < self._newest - SET_BACK:
            self.set_back += self._lead - lead
            self._leads.clear()
        elif lead < self._lead - REBOOT:
            self._leads.clear()
        if in_order:
            self._newest = boot_time
        if not self._leads or arrival - self._leads[-1][0] >= SLICE:
            self._leads.append([arrival, lead])
            self._lead = max(greatest for _, greatest in self._leads)
        elif lead > self._leads[-1][1]:
            self._leads[-1][1] = lead
            self._lead = max(self._lead, lead)
        self.lag = self._lead - lead
        if abs(self._lead - before) > JUMP:
            self.jumped = arrival

    def ask(self, now: float) -> int:
        """``ts1`` (ns) of a TIMESYNC request that goes out at ``now`` (s, ground)."""
        self._asked.append(round(now * 1e9))
        return self._asked[-1]

    def answered(self, ts1: int, arrival: float) -> None:
        """A TIMESYNC answer to ``ts1`` (ns) came at ``arrival`` (s, ground).

        Counted once, and only if :meth:`ask` gave it: others may ask from the ground's address, too.
        """
        if ts1 in self._asked:
            self._asked.remove(ts1)
            self._round_trips.append(max(arrival - ts1 * 1e-9, 0.0))
            self._arrivals.append(arrival)
            self._shortest = min(self._round_trips)

    @property
    def known(self) -> bool:
        """Whether the vehicle's time can be told at all."""
        return bool(self._leads)

    @property
    def offset(self) -> float:
        """Vehicle boot time less ground time (s)."""
        return self._lead + self._shortest / 2.0 if self._leads else 0.0

    @property
    def spread(self) -> float:
        """By how much that time varies (s), apart from the worst quarter."""
        trips = sorted(self._round_trips)
        return (trips[3 * (len(trips) - 1) // 4] - trips[0]) / 2.0 if trips else 0.0

    @property
    def longest_trip(self) -> float:
        """The longest of the last few round trips (s): there and back, neither way takes longer."""
        return max(list(self._round_trips)[-RECENT:], default=math.inf)

    def least_delay(self, duration: float, now: float) -> float:
        """Time one way (s) that no datagram has undercut for ``duration`` (s) until ``now``; 0 before that is known.

        Tells sooner than :attr:`delay` that a way gets longer. After a moment in which nothing passed all answers come
        together, the last of them soon after it was asked for.
        """
        least = math.inf
        for arrival, trip in zip(reversed(self._arrivals), reversed(self._round_trips), strict=True):
            least = min(least, trip)
            if arrival <= now - duration:
                return least / 2.0
        return 0.0

    @property
    def delay(self) -> float:
        """Time that a datagram takes one way (s): half of the usual round trip."""
        return median(self._round_trips) / 2.0 if self._round_trips else 0.0
