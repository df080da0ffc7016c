"""Team time: the boot time of the first vehicle, and the control steps on whole periods of it."""

import math
from collections import deque
from itertools import pairwise
from statistics import median

from gcs.config.flight_settings import DEFAULTS, TimingSettings

TOLERANCE = 1e-6
"""Tolerance of timers that are sums of periods (s)."""


class TeamClock:
    """Team time against the ground's (s)."""

    def __init__(self, settings: TimingSettings = DEFAULTS.timing) -> None:
        self._settings = settings
        self.offset = 0.0
        """Team time less ground time; 0 until a vehicle's clock is known."""
        self._lead = 0.0
        self._led_at = -math.inf

    def time(self, now: float) -> float:
        """Return team time at ground time ``now``."""
        return now + self.offset

    def follow(self, offset: float, now: float, *, connecting: bool) -> None:
        """Follow the ``offset`` of the first vehicle's clock; in flight a jump is a reboot, and time goes on.

        Late datagrams, and a simulated world that has stalled, hold that clock back against the ground's for a while.
        Only a wrong clock gets ahead of where it has been, and is followed slowly.
        """
        s = self._settings
        if connecting:
            self.offset = self._lead = offset
        elif abs(offset - self.offset) < s.clock_step:
            allowed = self._lead + min(s.lead_limit, s.lead_rate * (now - self._led_at))
            self.offset = min(offset, allowed)
        if self.offset >= self._lead:
            self._lead, self._led_at = self.offset, now


class IntervalTimer:
    """Due every ``interval`` (s)."""

    def __init__(self, interval: float) -> None:
        self._interval = interval
        self.next = -math.inf

    def is_due(self, now: float) -> bool:
        """Return whether it is due at ``now`` (s); if so, it is due next an interval later."""
        due = now >= self.next - TOLERANCE
        if due:
            self.next = now + self._interval
        return due


class StepIntervals:
    """Intervals of the last control steps: single ones may be late, of a busy machine most are."""

    def __init__(self, number: int = 8) -> None:
        self._times: deque[float] = deque(maxlen=number + 1)

    def add(self, time: float) -> None:
        """Take a step at ``time`` (s)."""
        self._times.append(time)

    @property
    def usual(self) -> float:
        """Their median (s); 0: there have been too few."""
        times = self._times
        return median(b - a for a, b in pairwise(times)) if len(times) == times.maxlen else 0.0


class StepTimer:
    """Due on whole control periods (s) of team time."""

    def __init__(self, period: float) -> None:
        self._period = period
        self.next = -math.inf
        """Ground time (s)."""
        self._last = -math.inf

    def is_due(self, now: float) -> bool:
        """Return whether a step is due at ground time ``now`` (s)."""
        return now >= self.next - TOLERANCE

    def begin(self, now: float, clock: TeamClock, *, connecting: bool) -> bool:
        """Set the next step; return whether this one is to be made: not where ``clock`` was set back a little."""
        time = clock.time(now)
        self.next = (math.floor(time / self._period + 0.5) + 1) * self._period - clock.offset
        if not connecting and time <= self._last:
            return False
        self._last = time
        return True
