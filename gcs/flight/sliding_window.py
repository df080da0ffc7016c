"""Sliding windows over the last seconds: counts of events, range of a quantity."""

from collections import defaultdict, deque
from collections.abc import Hashable
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)


class EventCounter(Generic[Key]):
    """Counts events of the last seconds by a key."""

    def __init__(self, window: float) -> None:
        """``window``: how long an event counts (s)."""
        self._window = window
        self._times: dict[Key, deque[float]] = defaultdict(deque)

    def add(self, key: Key, time: float, count: int = 1) -> None:
        """Add ``count`` events at ``time`` (s)."""
        self._times[key].extend([time] * count)

    def recent(self, time: float) -> dict[Key, int]:
        """Return the number of events in the window before ``time`` (s), where there are any."""
        found = {}
        for key, times in self._times.items():
            while times and time - times[0] > self._window:
                times.popleft()
            if times:
                found[key] = len(times)
        return found


class SlidingRange:
    """Range of a quantity over the last seconds; its times must never step back."""

    def __init__(self, window: float) -> None:
        """``window``: its length (s)."""
        self._window = window
        # Values that a later one has not exceeded, and not undercut: the first is the greatest, and the least.
        self._falling: deque[tuple[float, float]] = deque()
        self._rising: deque[tuple[float, float]] = deque()

    def add(self, time: float, value: float) -> float:
        """Add the value at ``time`` (s); return the greatest value of the window less the least."""
        while self._falling and self._falling[-1][1] <= value:
            self._falling.pop()
        while self._rising and self._rising[-1][1] >= value:
            self._rising.pop()
        for extremes in (self._falling, self._rising):
            extremes.append((time, value))
            while time - extremes[0][0] > self._window:
                extremes.popleft()
        return self._falling[0][1] - self._rising[0][1]
