"""The alarm record: what was noticed, when, of whom; each trouble once, however long it lasts."""

from __future__ import annotations

import math
from collections import defaultdict, deque
from dataclasses import dataclass

QUIET = 2.0
"""A trouble that is not seen for so long is over, and a new alarm when it comes back (s)."""


@dataclass(frozen=True)
class Alarm:
    """One row of the record."""

    time: float
    """When it was noticed (s, team time)."""
    source: str
    """Of whom: ``vehicle 3``, ``payload``, ``team``, or an obstacle's name."""
    what: str
    detail: str


class AlarmBook:
    """All alarms of a flight, in the order in which they were noticed."""

    def __init__(self) -> None:
        self.alarms: list[Alarm] = []
        self._seen: dict[tuple[str, str], float] = {}

    def tell(self, time: float, source: str, what: str, detail: str = "") -> None:
        """Something is wrong at ``time``: a new alarm, unless it has been so for a while."""
        if time - self._seen.get((source, what), -math.inf) > QUIET:
            self.alarms.append(Alarm(time, source, what, detail))
        self._seen[source, what] = time


class Events:
    """Counts of what happened lately, by source and what it was."""

    def __init__(self, window: float) -> None:
        """``window``: how long an event counts (s)."""
        self._window = window
        self._times: dict[tuple[str, str], deque[float]] = defaultdict(deque)

    def add(self, key: tuple[str, str], time: float, count: int = 1) -> None:
        """It happened ``count`` times at ``time``."""
        self._times[key].extend([time] * count)

    def recent(self, time: float) -> dict[tuple[str, str], int]:
        """How often each happened in the window before ``time``; those that did at all."""
        found = {}
        for key, times in self._times.items():
            while times and time - times[0] > self._window:
                times.popleft()
            if times:
                found[key] = len(times)
        return found
