"""Queue of a link of limited rate: whether it explains how long the datagrams of a vehicle take."""

import math
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array

_RATES = np.geomspace(300.0, 1e6, 43)
"""Rates of links that are tried first (bytes/s): twelve a decade."""
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
_REFINEMENTS = 12
_RESOLUTION = 1e-3
"""Resolution of stamps (s): latencies that vary by less are equal."""


class QueueFit(NamedTuple):
    """The queue that explains the latencies best."""

    rate: float
    """What the link passes (bytes/s)."""
    load: float
    """What has come (bytes/s)."""
    explained: float
    """Share of how the latencies differ from one datagram to the next: 1 all, 0 or less none."""


class LinkQueue:
    """Latencies and sizes of a vehicle's datagrams of the last seconds."""

    def __init__(self, window: float) -> None:
        """``window``: their time (s)."""
        self._window = window
        self._datagrams: deque[tuple[float, float, int]] = deque()
        """Arrival (s, ground), time of sending (s, vehicle), size (bytes)."""
        self._least = math.inf

    def __len__(self) -> int:
        return len(self._datagrams)

    def add(self, size: int, sent: float, arrival: float) -> None:
        """Take a datagram of ``size`` bytes, sent at ``sent`` (s, vehicle), that arrived at ``arrival`` (s, ground)."""
        if not math.isfinite(sent):
            return
        datagrams = self._datagrams
        datagrams.append((arrival, sent, size))
        while arrival - datagrams[0][0] > self._window:
            datagrams.popleft()
        self._least = min(self._least, arrival - sent)

    def clear(self) -> None:
        """Forget all: the vehicle's clock has moved."""
        self._datagrams.clear()
        self._least = math.inf

    @property
    def wait(self) -> float:
        """Median latency (s) beyond the least that there has been."""
        if not self._datagrams:
            return 0.0
        return float(np.median([arrival - sent for arrival, sent, _ in self._datagrams])) - self._least

    def fit(self) -> QueueFit:
        """Return the queue that explains the latencies best, of a link that passes one datagram after the other.

        A datagram leaves once those before it have, and takes its size over the link's rate. From one datagram to the
        next, because latencies that grow or shrink for any reason do so as those of some queue do.
        """
        arrivals, sent, sizes = np.array(self._datagrams).T
        latencies = arrivals - sent
        differences = np.diff(latencies)
        variance, load = float(np.square(differences).mean()), float(sizes.sum() / self._window)
        if variance < _RESOLUTION**2:
            return QueueFit(math.inf, load, 0.0)
        best, rate = math.inf, math.inf
        # Before the first there was no queue when all began, or when the least of these was sent.
        for backlog in {float(latencies[0] - least) for least in (self._least, latencies.min())}:

            def unexplained(log_rate: float, backlog: float = backlog) -> float:
                rate = math.exp(log_rate)
                waits = _waits(sent, sizes, rate, min(backlog, load * self._window / rate))
                return float(np.square(differences - np.diff(waits)).mean())

            found, log_rate = _least(unexplained)
            if found < best:
                best, rate = found, math.exp(log_rate)
        return QueueFit(rate, load, 1.0 - best / variance)


def _waits(sent: Array, sizes: Array, rate: float, backlog: float) -> Array:
    """Return how long datagrams (n,) take on a link of a rate (bytes/s): to wait, and to be passed (s).

    ``backlog``: that of the first (s).
    """
    passed = np.cumsum(sizes) / rate
    begins = sent - (passed - sizes / rate)
    begins[0] += max(backlog - sizes[0] / rate, 0.0)
    waits: Array = passed + np.maximum.accumulate(begins) - sent
    return waits


def _least(function: Callable[[float], float]) -> tuple[float, float]:
    """Return the least value of a function of the logarithm of the rate, and where it is: by search, then refined."""
    grid = np.log(_RATES)
    values = [function(x) for x in grid]
    at = int(np.argmin(values))
    low, high = grid[max(at - 1, 0)], grid[min(at + 1, len(grid) - 1)]
    best = values[at], float(grid[at])
    for _ in range(_REFINEMENTS):
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        at_left, at_right = function(left), function(right)
        best = min(best, (at_left, float(left)), (at_right, float(right)))
        if at_left < at_right:
            high = right
        else:
            low = left
    return best
