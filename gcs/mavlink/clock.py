"""The clock of one vehicle as the ground estimates it: offset of its boot time, and link latency."""

import math
from bisect import bisect_right
from collections import deque
from operator import itemgetter
from statistics import median
from typing import NamedTuple

from gcs.mavlink.clock_bounds import ClockBounds
from gcs.mavlink.link_queue import LinkQueue
from gcs.mavlink.settings import ClockSettings


class _RoundTrips(NamedTuple):
    """The last round trips (s)."""

    median: float = 0.0
    shortest: float = 0.0
    spread: float = 0.0
    """Upper quartile less the shortest."""
    longest: float = math.inf
    """Of the last few."""


class _Slice:
    """What arrived in a slice of time, which begins with the arrival of a stamp (s)."""

    __slots__ = ("begin", "lead", "trip")

    def __init__(self, begin: float, lead: float) -> None:
        self.begin, self.lead, self.trip = begin, lead, math.inf
        """Its beginning, the greatest lead of a stamp, and the shortest round trip (s); inf: no answer came."""


class RemoteClock:
    """Offset and delay of a vehicle from TIMESYNC round trips and from the stamps of its telemetry.

    A stamp arrives after a delay that is never negative, so the largest ``stamp - arrival`` seen in the last seconds is
    nearest to the truth; half of the shortest round trip is the part of the delay that is always there.
    """

    def __init__(self, settings: ClockSettings | None = None) -> None:
        self._settings = settings = settings or ClockSettings()
        self._slices: deque[_Slice] = deque(maxlen=settings.slices)
        self._lead = -math.inf
        self._offset = 0.0
        self._newest = -math.inf
        self.newest: tuple[float, float] | None = None
        """The last stamp in order (s, vehicle), without steps of the clock, and its arrival (s, ground)."""
        self.set_back = 0.0
        """Sum of all steps back (s)."""
        self.jumped_at = -math.inf
        """Time of its offset's last step (s, ground): it was set, or datagrams come otherwise than before."""
        self.lag = 0.0
        """Delay (s) of the last stamp beyond the least delay of the last second."""
        self._lags: deque[float] = deque(maxlen=settings.recent_stamps)
        self._requests: deque[int] = deque(maxlen=settings.open_requests)
        self._round_trips: list[tuple[float, float]] = []
        """Arrival and round trip of the last answers."""
        self._trips = _RoundTrips()
        self.bounds = ClockBounds(settings.bounds, settings.reboot)
        self.queue = LinkQueue(settings.queue_window)

    def add_stamp(self, boot_time: float, arrival: float, in_order: bool = False) -> None:
        """Take the stamp ``boot_time`` (s, vehicle) of telemetry that arrived at ``arrival`` (s, ground).

        ``in_order``: it was sent after all that came before.
        """
        boot_time = self.bounds.unwrapped(boot_time)
        lead, before = boot_time - arrival, self._lead
        was_set_back = in_order and boot_time < self._newest - self._settings.set_back
        if was_set_back:
            self.set_back += self._lead - lead
        if began_anew := was_set_back or lead < self._lead - self._settings.reboot:
            self._slices.clear()
            self._lags.clear()
        if in_order:
            self._newest = boot_time
            self.newest = boot_time + self.set_back, arrival
        if not self._slices or arrival - self._slices[-1].begin >= self._settings.slice:
            self._slices.append(_Slice(arrival, lead))
            self._lead = max(of.lead for of in self._slices)
            self._set_offset()
        elif lead > self._slices[-1].lead:
            self._slices[-1].lead = lead
            self._lead = max(self._lead, lead)
            self._set_offset()
        self.lag = self._lead - lead
        self._lags.append(self.lag)
        if abs(self._lead - before) > self._settings.jump:
            self.jumped_at = arrival
        if began_anew or self._lead - before > self._settings.jump:
            self.queue.clear()
        self.bounds.add_stamp(boot_time, arrival)

    def request(self, now: float) -> int:
        """Return ``ts1`` (ns) of a TIMESYNC request that goes out at ``now`` (s, ground)."""
        self._requests.append(round(now * 1e9))
        return self._requests[-1]

    def add_answer(self, ts1: int, arrival: float, tc1: int | None = None) -> None:
        """Take the TIMESYNC answer to ``ts1`` (ns) that came at ``arrival`` (s, ground).

        ``tc1``: what the vehicle's clock read (ns); None: of no interest.
        Counted once, and only if it is of a :meth:`request`: others may send some from the ground's address, too.
        """
        if ts1 in self._requests:
            self._requests.remove(ts1)
            sent = ts1 * 1e-9
            self._round_trips.append((arrival, trip := max(arrival - sent, 0.0)))
            del self._round_trips[: -self._settings.round_trips]
            # Where requests or answers are lost, those kept reach back to a latency that may be no more.
            since = arrival - self._settings.slices * self._settings.slice
            newest = [trip for came, trip in self._round_trips if came > since]
            trips, recent = sorted(newest), newest[-self._settings.recent_round_trips :]
            spread = trips[3 * (len(trips) - 1) // 4] - trips[0]
            self._trips = _RoundTrips(median(trips), trips[0], spread, max(recent))
            if tc1 is not None and len(self._round_trips) == self._settings.round_trips:
                self.bounds.add_answer(tc1 * 1e-9, sent, arrival, self._lead + self.spread)
            if self._slices:
                self._slices[-1].trip = min(self._slices[-1].trip, trip)
                self._set_offset()

    def _set_offset(self) -> None:
        """Estimate the offset by the stamps of those slices in which the latency was least.

        On a lossy link few requests are answered: with stamps of a latency that has grown and round trips from before,
        or the other way round, the offset would be wrong by that growth. The newest slice counts before its first
        answer, too: a clock that is set ahead is followed at once.
        """
        answered = [of for of in self._slices if of.trip < math.inf]
        if not answered:
            self._offset = self._lead + (self._round_trips[-1][1] if self._round_trips else 0.0) / 2.0
            return
        shortest = min(of.trip for of in answered)
        near = shortest + self._settings.jump
        leads = [of.lead for of in answered if of.trip <= near]
        if self._slices[-1].trip == math.inf and answered[-1].trip <= near:
            leads.append(self._slices[-1].lead)
        self._offset = max(leads) + shortest / 2.0

    @property
    def known(self) -> bool:
        """True if there is an estimate."""
        return bool(self._slices)

    @property
    def offset(self) -> float:
        """Vehicle boot time less ground time (s)."""
        return self._offset if self._slices else 0.0

    @property
    def answered_at(self) -> float:
        """Time at which the last answer came (s, ground); inf: none has come yet."""
        return self._round_trips[-1][0] if self._round_trips else math.inf

    @property
    def delay(self) -> float:
        """Link latency (s): half of the median round trip."""
        return self._trips.median / 2.0

    @property
    def least_lag(self) -> float:
        """Delay (s) of the last few stamps beyond the least of the last second: of the one that came soonest."""
        return min(self._lags, default=0.0)

    @property
    def spread(self) -> float:
        """Variation of the latency (s), apart from the worst quarter of the round trips."""
        return self._trips.spread / 2.0

    @property
    def round_trip_max(self) -> float:
        """The longest of the last few round trips (s): no latency is longer."""
        return self._trips.longest

    @property
    def round_trip_excess(self) -> float:
        """The longest of the last few round trips (s) beyond the shortest; 0: none is known."""
        return self._trips.longest - self._trips.shortest if self._round_trips else 0.0

    def least_delay(self, duration: float, now: float) -> float:
        """Return the latency (s) that no datagram has undercut for ``duration`` (s) until ``now``; 0: not known yet.

        Shows a growing latency sooner than :attr:`delay`. After an interruption all answers come simultaneously, the
        last of them soon after its request.
        """
        before = bisect_right(self._round_trips, now - duration, key=itemgetter(0))
        return min(trip for _, trip in self._round_trips[before - 1 :]) / 2.0 if before else 0.0
