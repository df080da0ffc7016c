"""A link between any two MAVLink programs, sans-I/O: its two ends, and the impairments of each direction."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import Any, Literal, Self

import numpy as np

from gcs.faults import link as kinds
from gcs.mavlink.address import Address
from vehicle_sim.faults.active import TOLERANCE, Activity, Moment, Schedule
from vehicle_sim.faults.impairment import Datagram, Impairment, LinkImpairment, OrderedImpairment
from vehicle_sim.faults.link import BandwidthCap
from vehicle_sim.faults.link_profiles import LinkDirection, LinkProfile, TimeDivision

End = Literal["listen", "forward"]
ENDS: tuple[End, End] = ("listen", "forward")

PEER_TIMEOUT = 10.0
"""Silence (s) after which a sender gets nothing more, as at pymavlink's ``udpin``."""
PEERS_MAX = 32
"""Senders to an end that get what comes from the other one."""
_STREAM = 2_000_011  # separates these generators from those of a flight's faults


class TransmitWindows(OrderedImpairment):
    """Queue in front of a radio that passes bytes in its own windows only: a slow line in the time that they make."""

    def __init__(self, activity: Activity, turns: TimeDivision, start: float, generator: np.random.Generator) -> None:
        """``start`` of a window (s)."""
        super().__init__(activity, generator)
        self._turns, self._start = turns, start
        self._free_at = -math.inf

    def _disturb(self, datagram: Datagram, moment: Moment, now: float, out: list[Datagram]) -> bool:
        settings: kinds.BandwidthCap = self.fault.settings
        open_time = self._open_time(now)
        begin = max(open_time, self._free_at)
        if (begin - open_time) * settings.rate + len(datagram[0]) > settings.queue:
            return True
        self._free_at = begin + len(datagram[0]) / settings.rate
        self.delay_in_order(datagram, self._time_of(self._free_at))
        return True

    def _open_time(self, now: float) -> float:
        """Return the sum of the windows until ``now`` (s)."""
        rounds, within = divmod(now - self._start, self._turns.round)
        return rounds * self._turns.window + min(within, self._turns.window)

    def _time_of(self, open_time: float) -> float:
        """Return when the sum of the windows reaches ``open_time`` (s)."""
        rounds = math.ceil(open_time / self._turns.window - TOLERANCE) - 1  # the end of a window is in it
        return self._start + rounds * (self._turns.round - self._turns.window) + open_time


class _Entry(tuple[str, int]):
    """The sender of a datagram, with the datagram's number and arrival (s): impairments pass it on as it is."""

    number: int
    arrival: float

    @classmethod
    def of(cls, sender: Address, number: int, arrival: float) -> Self:
        entry = cls(sender)
        entry.number, entry.arrival = number, arrival
        return entry


@dataclasses.dataclass
class LinkCounts:
    """Datagrams of a direction. ``overflowed``: lost because the queue was full; ``lost``: in any other way.

    ``late``: waited for others or for a window, or were overtaken, so that latency, jitter and their own transmission
    do not explain the delay. ``reordered``: forwarded behind one that had come later (RFC 4737).
    """

    received: int = 0
    forwarded: int = 0
    lost: int = 0
    overflowed: int = 0
    late: int = 0
    reordered: int = 0
    without_receiver: int = 0
    """Forwarded to an end at which nobody has been heard of."""


class ImpairedDirection:
    """One direction of a link: each datagram passes its impairments in turn, which have random numbers of their own."""

    def __init__(self, settings: LinkDirection, seeds: Sequence[int], start: float, *, second: bool = False) -> None:
        """``seeds`` of the generators; ``start`` (s); ``second``: it has the second window of each round."""
        self.counts = LinkCounts()
        self._settings = settings
        self._stages = _stages(settings, seeds, start, second)
        self._newest = -1
        self._leaving: list[bytes] = []

    def receive(self, datagram: bytes, sender: Address, now: float) -> None:
        """Take a datagram that has come ``now`` (s)."""
        self._catch_up(now)
        entry = _Entry.of(sender, self.counts.received, now)
        self.counts.received += 1
        self._pass_on([(datagram, entry)], now)

    def datagrams_to_send(self, now: float) -> list[bytes]:
        """Return those that leave until ``now`` (s), in order."""
        self._catch_up(now)
        leaving, self._leaving = self._leaving, []
        return leaving

    def next_timer(self) -> float | None:
        """Return when the next delayed datagram is due (s)."""
        return min((due for stage in self._stages if (due := stage.next_timer()) is not None), default=None)

    def _catch_up(self, now: float) -> None:
        """Pass on each delayed datagram at the time that it is due, however late the caller is."""
        while (due := self.next_timer()) is not None and due <= now + TOLERANCE:
            self._pass_on([], due)

    def _pass_on(self, datagrams: list[Datagram], now: float) -> None:
        for stage in self._stages:
            before = len(datagrams) + stage.waiting
            datagrams = stage.pass_on(datagrams, now)
            gone = before - len(datagrams) - stage.waiting
            if isinstance(stage, BandwidthCap | TransmitWindows):
                self.counts.overflowed += gone
            else:
                self.counts.lost += gone
        for datagram, entry in datagrams:
            assert isinstance(entry, _Entry)
            self._count(datagram, entry, now)
            self._leaving.append(datagram)

    def _count(self, datagram: bytes, entry: _Entry, now: float) -> None:
        settings, counts = self._settings, self.counts
        explained = settings.latency + settings.jitter
        if settings.rate is not None:
            explained += len(datagram) / settings.rate
        counts.forwarded += 1
        counts.late += now - entry.arrival > explained + 2.0 * TOLERANCE
        counts.reordered += entry.number < self._newest
        self._newest = max(self._newest, entry.number)


def _stages(settings: LinkDirection, seeds: Sequence[int], start: float, second: bool) -> list[LinkImpairment]:
    """Return the impairments: radio with its queue, losses, propagation."""
    schedule = Schedule(0.0)
    schedule.origin = start

    def generator(number: int) -> np.random.Generator:
        return np.random.default_rng([*seeds, _STREAM, number])

    def stage(number: int, parameters: Any) -> LinkImpairment:
        made = Impairment.of_kind[type(parameters)]
        assert issubclass(made, LinkImpairment)
        return made(Activity(settings=parameters, schedule=schedule), generator(number))

    stages: list[LinkImpairment] = []
    if settings.rate is not None:
        radio = kinds.BandwidthCap(rate=settings.rate, queue=settings.queue)
        if (turns := settings.time_division) is None:
            stages.append(stage(0, radio))
        else:
            window = start + turns.round / 2.0 if second else start
            stages.append(TransmitWindows(Activity(settings=radio, schedule=schedule), turns, window, generator(0)))
    if settings.loss >= 1.0 or (settings.loss and not settings.burst):
        stages.append(stage(1, kinds.PacketLoss(probability=settings.loss)))
    elif settings.loss:
        gap = settings.burst * (1.0 - settings.loss) / settings.loss
        stages.append(stage(1, kinds.BurstLoss(burst=settings.burst, gap=gap)))
    if settings.latency:
        stages.append(stage(2, kinds.Latency(delay=settings.latency)))
    if settings.jitter:
        stages.append(stage(3, kinds.Jitter(spread=settings.jitter)))
    if settings.reordering:
        stages.append(stage(4, kinds.Reordering(probability=settings.reordering, delay=settings.reordering_delay)))
    return stages


class _Peers:
    """The programs at an end: one address, or whoever has sent to it lately."""

    def __init__(self, address: Address | None) -> None:
        """``address`` that is called; None: the end listens."""
        self._address = address
        self._heard: dict[Address, float] = {}  # the last one heard is the last one

    def receive_from(self, sender: Address, now: float) -> bool:
        """Return whether the sender's datagrams are those of this end."""
        if self._address is not None:
            return sender == self._address
        self._heard.pop(sender, None)
        if len(self._heard) >= PEERS_MAX:
            del self._heard[next(iter(self._heard))]
        self._heard[sender] = now
        return True

    def receivers(self, now: float) -> list[Address]:
        """Return who gets what leaves at this end ``now`` (s): if all have been silent, the last one."""
        if self._address is not None:
            return [self._address]
        latest = list(self._heard.items())
        return [address for address, heard in latest if now - heard <= PEER_TIMEOUT] or [a for a, _ in latest[-1:]]


class ImpairedLink:
    """A link with two ends; what comes at one leaves at the other, late or never."""

    def __init__(
        self,
        profile: LinkProfile,
        seeds: Sequence[int],
        *,
        forward: Address | None,
        vehicle: End = "listen",
        start: float = 0.0,
    ) -> None:
        """``forward``: address of the end ``forward``; None: it listens, too. ``vehicle``: the end of the vehicle."""
        telemetry = ImpairedDirection(profile.telemetry, [*seeds, 0], start)
        command = ImpairedDirection(profile.command, [*seeds, 1], start, second=True)
        self.counts = {"telemetry": telemetry.counts, "command": command.counts}
        self._peers = {"listen": _Peers(None), "forward": _Peers(forward)}
        other: End = "forward" if vehicle == "listen" else "listen"
        self._from = {vehicle: telemetry, other: command}

    def receive(self, end: End, datagram: bytes, sender: Address, now: float) -> None:
        """Take a datagram that has come at an end ``now`` (s); strangers to an end with an address are ignored."""
        if self._peers[end].receive_from(sender, now):
            self._from[end].receive(datagram, sender, now)

    def datagrams_to_send(self, now: float) -> Iterator[tuple[End, bytes, Address]]:
        """Yield what leaves until ``now`` (s): the end, the bytes and the receiver."""
        for came, leaves in (ENDS, ENDS[::-1]):
            direction = self._from[came]
            if leaving := direction.datagrams_to_send(now):
                receivers = self._peers[leaves].receivers(now)
                if not receivers:
                    direction.counts.without_receiver += len(leaving)
                yield from ((leaves, datagram, receiver) for datagram in leaving for receiver in receivers)

    def next_timer(self) -> float | None:
        """Return when the next delayed datagram is due (s)."""
        timers = (direction.next_timer() for direction in self._from.values())
        return min((timer for timer in timers if timer is not None), default=None)
