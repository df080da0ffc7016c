"""Movement of a vehicle's clock that the latency of its link cannot explain."""

import math
from collections import deque
from collections.abc import Iterable

from gcs.config.flight_settings import MonitorSettings
from gcs.flight.sliding_window import SlidingMaximum
from gcs.mavlink.clock_bounds import OffsetBounds


class _Exchanges:
    """Bounds of the offset by the TIMESYNC exchanges of one segment of time (s)."""

    def __init__(self, begin: float) -> None:
        self.begin = begin
        self._lower: list[float] = []
        self._upper: list[float] = []

    def __len__(self) -> int:
        return len(self._lower)

    def add(self, bounds: OffsetBounds) -> None:
        self._lower.append(bounds.lower)
        self._upper.append(bounds.upper)

    def ahead_of(self, other: "_Exchanges") -> float:
        """Return by how much (s) both bounds of every exchange here are above those of every one of ``other``."""
        return min(min(self._lower) - max(other._lower), min(self._upper) - max(other._upper))

    @property
    def round_trips(self) -> list[float]:
        """All round trips (s): what each leaves unknown of the offset."""
        return [upper - lower for upper, lower in zip(self._upper, self._lower, strict=True)]


class ClockMovement:
    """Two tests of one clock within a window. Their results are signed: positive is ahead (s).

    *Contradiction*: every datagram bounds the offset, whatever its latency: it was sent before it arrived, and an
    answer after its request. Where a lower bound is above an upper one, the clock has moved by at least as much. That
    holds for any latency, jitter, loss or asymmetry: apart from drift there is no false alarm. What moves the bounds by
    less than the shortest round trip is not found.

    *Displacement*: both bounds of all exchanges of a segment are beyond those of an earlier one, in one direction, by
    more than the round trips of all exchanges from the one to the other differ. A latency that changes, on one way or
    both, moves the bounds apart or together, and changes the round trip by as much. Of latencies that vary at random, n
    exchanges in each segment, the lower bounds are in such an order once in C(2n, n), and so are the upper ones: once
    in 6e4 comparisons with the fewest exchanges, in 3e10 at the usual rate. Left is a link whose two ways change
    between two exchanges by the same amount in opposite directions: that looks as a step of the clock does.
    """

    def __init__(self, settings: MonitorSettings) -> None:
        self._settings = settings
        self._lower = SlidingMaximum(settings.clock_window)
        self._upper = SlidingMaximum(settings.clock_window)  # of the negative: the least
        self._segments: deque[_Exchanges] = deque()
        self._displacement = 0.0

    def add(self, observed: Iterable[OffsetBounds]) -> None:
        """Take bounds in the order in which they came."""
        for bounds in observed:
            self._lower.add(bounds.arrival, bounds.lower)
            if math.isfinite(bounds.upper):
                self._upper.add(bounds.arrival, -bounds.upper)
                self._add_exchange(bounds)

    def contradiction(self, now: float) -> float:
        """Return the least movement (s) within the window before ``now`` (s, ground) for any latency."""
        (lower_at, lower), (upper_at, upper) = self._lower.at(now), self._upper.at(now)
        beyond = max(lower + upper, 0.0)
        return beyond if lower_at >= upper_at else -beyond

    def displacement(self, now: float) -> float:
        """Return the displacement (s) of the last complete segment from an earlier one, the largest."""
        last = self._segments[-1] if self._segments else None
        stale = last is None or now - last.begin > self._settings.clock_window
        return 0.0 if stale else self._displacement

    def _add_exchange(self, bounds: OffsetBounds) -> None:
        segments = self._segments
        if not segments or bounds.arrival - segments[-1].begin >= self._settings.clock_segment:
            while segments and bounds.arrival - segments[0].begin > self._settings.clock_window:
                segments.popleft()
            self._compare()
            segments.append(_Exchanges(bounds.arrival))
        segments[-1].add(bounds)

    def _compare(self) -> None:
        """Compare the last segment, which is complete, with those before."""
        self._displacement = 0.0
        if not self._segments:
            return
        *before, last = self._segments
        trips = last.round_trips
        for earlier in reversed(before):
            trips += earlier.round_trips
            if min(len(earlier), len(last)) < self._settings.clock_exchanges:
                continue
            ahead, back = last.ahead_of(earlier), earlier.ahead_of(last)
            beyond = max(ahead, back) - (max(trips) - min(trips))
            if beyond > abs(self._displacement):
                self._displacement = math.copysign(beyond, ahead - back)
