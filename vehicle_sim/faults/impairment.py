"""One fault on one vehicle: on a direction of its link, where datagrams are delayed or lost, or on its samples."""

from __future__ import annotations

import heapq
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar, NamedTuple, Self

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config import SystemConfig
from gcs.faults import Direction
from gcs.mavlink.address import Address
from gcs.mavlink.frames import V2, spans
from vehicle_sim.faults.active import TOLERANCE, ActiveFault, Activity, Moment

_TUNNEL = mavlink.MAVLINK_MSG_ID_TUNNEL
_STAMP = 4
_STAMP_OF_TUNNEL = 13
"""Bytes: payload type, target, length of the content (5); session and number of a stop plan."""

Datagram = tuple[bytes, Address]
"""Bytes, and the address on the other side."""


class Frame(NamedTuple):
    """A frame, from ``start`` to ``end`` in the datagram; ``checksum``: offset of its checksum.

    ``stamp``: what tells messages of a stream apart: the first four bytes of the payload, which in all streamed
    measurements and set-points are a time; of TUNNEL what goes before a stop plan's times, with its number.
    """

    start: int
    end: int
    checksum: int
    system: int
    component: int
    message_id: int
    stamp: bytes


def frames(datagram: bytes) -> Iterator[Frame]:
    """Yield the frames in order; bytes before, between and behind them are skipped."""
    for start, end in spans(datagram):
        if datagram[start] == V2:
            system, component, body = datagram[start + 5], datagram[start + 6], start + 10
            number = int.from_bytes(datagram[start + 7 : body], "little")
        else:
            system, component, number = datagram[start + 3 : start + 6]
            body = start + 6
        length = datagram[start + 1]
        stamp = datagram[body : body + min(length, _STAMP_OF_TUNNEL if number == _TUNNEL else _STAMP)]
        yield Frame(start, end, body + length, system, component, number, stamp)


class Impairment:
    """What one kind of fault does."""

    of_kind: ClassVar[dict[type, type[Impairment]]] = {}
    """The impairment of each kind of fault, by the kind's parameters or their base class."""

    def __init_subclass__(cls, of: type | None = None) -> None:
        """``of``: parameters of the kind of fault, or their base class."""
        if of is not None:
            Impairment.of_kind[of] = cls


class LinkImpairment(Impairment, ABC):
    """What one kind of fault does to datagrams while it is active; else they pass unchanged."""

    direction: ClassVar[Direction | None] = None
    """Direction of a kind that is bound to one; None: the mission's."""

    def __init__(self, fault: Activity, generator: np.random.Generator) -> None:
        self.fault = fault
        self.random = generator.random
        self.generator = generator
        self._delayed: list[tuple[float, int, Datagram]] = []
        self._serial = 0
        self._last_due = -np.inf

    def pass_on(self, datagrams: Sequence[Datagram], now: float) -> list[Datagram]:
        """Return those that go on now, of ``datagrams`` and of what was delayed."""
        out: list[Datagram] = []
        fault = self.fault
        moment = fault.schedule.at(now) if datagrams else None
        if moment is None:
            for datagram in datagrams:
                self.undisturbed(datagram, now, out)
        else:
            for datagram in datagrams:
                fault.seen += 1
                fault.disturbed += self._disturb(datagram, moment, now, out)
        while self._delayed and self._delayed[0][0] <= now + TOLERANCE:
            out.append(heapq.heappop(self._delayed)[2])
        return out

    @property
    def waiting(self) -> int:
        """Return the number of delayed datagrams."""
        return len(self._delayed)

    def next_timer(self) -> float | None:
        """Return when the next delayed datagram is due (s)."""
        return self._delayed[0][0] if self._delayed else None

    @abstractmethod
    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        """Append what goes on now to ``out``, :meth:`delay` the rest; return True for a disturbed datagram."""

    def undisturbed(self, datagram: Datagram, now: float, out: list[Datagram]) -> None:
        """Pass on a datagram while the fault is not active."""
        out.append(datagram)

    def delay(self, datagram: Datagram, due: float) -> None:
        """Let the datagram go on at ``due`` (s)."""
        self._serial += 1
        heapq.heappush(self._delayed, (due, self._serial, datagram))


class DatagramChange(LinkImpairment):
    """An impairment that changes or loses datagrams, each by itself, and delays none."""

    @abstractmethod
    def _changed(self, data: bytes, moment: Moment) -> bytes | None:
        """Return the bytes that go on in place of ``data``, the same object if undisturbed; None: lost."""

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        data, address = datagram
        changed = self._changed(data, moment)
        if changed is not None:
            out.append((changed, address))
        return changed is not data


class OrderedImpairment(LinkImpairment):
    """An impairment that keeps the order of datagrams, also once the fault is over."""

    def delay_in_order(self, datagram: Datagram, due: float) -> None:
        """Let the datagram go on at ``due`` (s), or with the last one before it if that is later."""
        self._last_due = max(self._last_due, due)
        self.delay(datagram, self._last_due)

    def undisturbed(self, datagram: Datagram, now: float, out: list[Datagram]) -> None:
        """Pass on a datagram behind those that are still delayed."""
        if self._delayed:
            self.delay_in_order(datagram, now)
        else:
            out.append(datagram)


class GilbertElliottProcess:
    """Two-state process with exponential times in each state, good and bad. It starts in the good one."""

    def __init__(self, generator: np.random.Generator, mean_good: float, mean_bad: float) -> None:
        """Mean times in each state in s."""
        self._generator = generator
        self._means = (mean_good, mean_bad)
        self._bad = False
        self._until: float | None = None
        self._occurrence = -1

    def is_bad(self, moment: Moment) -> bool:
        """Return the state at a moment not before the last one; every occurrence of the fault begins anew."""
        if moment.occurrence != self._occurrence:
            self._occurrence, self._bad, self._until = moment.occurrence, False, None
        if self._until is None:
            self._until = self._length()
        while moment.elapsed >= self._until:
            self._bad = not self._bad
            self._until += self._length()
        return self._bad

    def _length(self) -> float:
        return self._means[self._bad] * float(self._generator.standard_exponential())


OWN, REPORTED, PAYLOAD, SCAN = "own", "reported", "payload", "scan"
"""Where a fault acts on samples: methods that take a vehicle (its system id), a sample and the moment.

What the vehicle's autopilot gets of its own measurement (None: nothing), what the vehicle reports of itself, what it
relays of the payload's navigation unit (None: nothing), and what it detects in a scan.
"""


class SampleImpairment(Impairment):
    """What one kind of fault does to samples of one vehicle. ``acts_on``: which of its methods change anything."""

    def __init__(self, fault: ActiveFault, vehicle: int, system: SystemConfig) -> None:
        self.fault = fault
        self.acts_on = frozenset(hook for hook in (OWN, REPORTED, PAYLOAD, SCAN) if hasattr(self, hook))

    @classmethod
    def of_vehicles(cls, fault: ActiveFault, system: SystemConfig) -> Mapping[int, Self]:
        """Return the impairment of each vehicle that the fault disturbs."""
        return {vehicle: cls(fault, vehicle, system) for vehicle in fault.vehicles}
