"""One fault on one way of one vehicle's link: datagrams in, datagrams out, some later, some never."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

import numpy as np

from vehicle_sim.faults.active import ActiveFault
from vehicle_sim.faults.interface import Datagram
from vehicle_sim.faults.schedule import TOLERANCE, Moment


class Stage:
    """Lets everything through; a kind overrides :meth:`disturb`."""

    def __init__(self, fault: ActiveFault, generator: np.random.Generator) -> None:
        self.fault = fault
        self.random = generator.random
        self.generator = generator
        self._held: list[tuple[float, int, Datagram]] = []
        self._serial = 0
        self._last_due = -np.inf

    def pass_on(self, datagrams: Sequence[Datagram], now: float) -> list[Datagram]:
        """Those that go on now, of these and of what was held back."""
        out: list[Datagram] = []
        fault = self.fault
        moment = fault.schedule.at(now) if datagrams else None
        if moment is None:
            for datagram in datagrams:
                self.untouched(datagram, now, out)
        else:
            for datagram in datagrams:
                fault.seen += 1
                fault.disturbed += self.disturb(datagram, moment, now, out)
        while self._held and self._held[0][0] <= now + TOLERANCE:
            out.append(heapq.heappop(self._held)[2])
        return out

    def next_timer(self) -> float | None:
        """When something held back is due (s)."""
        return self._held[0][0] if self._held else None

    def disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Put what goes on now into ``out``, :meth:`hold` the rest; whether the datagram was disturbed."""
        out.append(datagram)
        return False

    def untouched(self, datagram: Datagram, now: float, out: list[Datagram]) -> None:
        """A datagram while the fault is not there."""
        out.append(datagram)

    def hold(self, datagram: Datagram, due: float) -> None:
        """Let it go on at ``due`` (s)."""
        self._serial += 1
        heapq.heappush(self._held, (due, self._serial, datagram))


class OrderedStage(Stage):
    """A stage in which nothing overtakes anything, not even once the fault is over."""

    def hold_in_order(self, datagram: Datagram, due: float) -> None:
        """Let it go on at ``due`` (s), or with the last one before it if that is later."""
        self._last_due = max(self._last_due, due)
        self.hold(datagram, self._last_due)

    def untouched(self, datagram: Datagram, now: float, out: list[Datagram]) -> None:
        """Behind what is still held back."""
        if self._held:
            self.hold_in_order(datagram, now)
        else:
            out.append(datagram)


class OnOff:
    """A state that changes by itself: on and off for exponential times. It starts off."""

    def __init__(self, generator: np.random.Generator, mean_off: float, mean_on: float) -> None:
        """Mean lengths in s."""
        self._generator = generator
        self._means = (mean_off, mean_on)
        self._on = False
        self._until: float | None = None
        self._occurrence = -1

    def is_on(self, moment: Moment) -> bool:
        """At a moment not before the last one that was asked for; every occurrence of the fault begins anew."""
        if moment.occurrence != self._occurrence:
            self._occurrence, self._on, self._until = moment.occurrence, False, None
        if self._until is None:
            self._until = self._length()
        while moment.elapsed >= self._until:
            self._on = not self._on
            self._until += self._length()
        return self._on

    def _length(self) -> float:
        return self._means[self._on] * float(self._generator.standard_exponential())
