"""Delayed set-points: those to vehicles with short links wait, so that all vehicles act simultaneously."""

import math
from collections import deque
from collections.abc import Sequence
from statistics import median

from gcs.config.flight_settings import DEFAULTS, TimingSettings
from gcs.flight.team_clock import TOLERANCE
from gcs.mavlink.layout import Packed


class SetpointSchedule:
    """Times at which set-points are sent and take effect; times are the ground's (s)."""

    def __init__(self, settings: TimingSettings = DEFAULTS.timing) -> None:
        self._simultaneous = settings.simultaneous
        self._latencies: deque[float] = deque(maxlen=settings.latency_steps)
        self.latency = 0.0
        """Compute latency: from the beginning of a control step until its set-points are sent."""
        self._waiting: list[tuple[float, int, list[Packed]]] = []
        """Time at which they are due, the vehicle's index, the messages."""

    def add_latency(self, duration: float) -> None:
        """Take the compute latency of one control step."""
        self._latencies.append(duration)
        self.latency = median(self._latencies)

    def waits(self, delays: Sequence[float]) -> list[float]:
        """Return how long the set-points of each vehicle wait, for the ``delays`` of the N links."""
        longest = max(delays)
        return [wait if (wait := longest - delay) >= self._simultaneous else 0.0 for delay in delays]

    def add(self, due: float, vehicle: int, messages: list[Packed]) -> None:
        """Let ``messages`` to a vehicle (0 .. N-1) wait until ``due``."""
        self._waiting.append((due, vehicle, messages))

    def take(self, now: float) -> list[tuple[int, list[Packed]]]:
        """Return what is due at ``now``, with the vehicle's index."""
        if not self._waiting:
            return []
        due = [(i, messages) for time, i, messages in self._waiting if time <= now + TOLERANCE]
        self._waiting = [entry for entry in self._waiting if entry[0] > now + TOLERANCE]
        return due

    def clear(self) -> None:
        """Discard what waits."""
        self._waiting.clear()

    @property
    def next_due(self) -> float:
        """Time at which the next message is due; inf: none waits."""
        return min(due for due, _, _ in self._waiting) if self._waiting else math.inf
