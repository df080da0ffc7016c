"""Sliding windows over the last seconds: counts of events, the greatest value of a quantity."""

import math
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


class SlidingMaximum:
    """Greatest value of the last seconds; times must never step back."""

    def __init__(self, window: float) -> None:
        """``window``: its length (s)."""
        self._window = window
        self._falling: deque[tuple[float, float]] = deque()
        """Values that no later one has reached: the first is the greatest."""

    def add(self, time: float, value: float) -> None:
        """Add a value at ``time`` (s)."""
        while self._falling and self._falling[-1][1] <= value:
            self._falling.pop()
        self._falling.append((time, value))

    def at(self, time: float) -> tuple[float, float]:
        """Return the time (s) and the value of the greatest in the window before ``time`` (s); of none -inf."""
        while self._falling and time - self._falling[0][0] > self._window:
            self._falling.popleft()
        return self._falling[0] if self._falling else (-math.inf, -math.inf)
