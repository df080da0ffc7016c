"""Lockstep within one process: datagrams between a world and a ground station are handed over in memory.

The exchanges are those of :mod:`gcs.mavlink.lockstep`, in the same order and at the same times as over UDP, so that a
flight has the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Generic, Protocol, TypeVar

from gcs.drivers.participant import Participant
from gcs.mavlink.address import THIS_MACHINE, Address
from gcs.mavlink.lockstep import LockstepTime, next_call_us

GROUND: Address = (THIS_MACHINE, 1)
"""Address from which a ground station in this process sends."""


class World(Protocol):
    """A simulated world with its vehicles. Times in s; nothing in it reads a clock."""

    @property
    def addresses(self) -> Sequence[Address]:
        """Addresses of the vehicles of the system ids 1 .. N, in this order."""

    @property
    def time(self) -> float:
        """Time that it has reached (s)."""

    @property
    def at_rest(self) -> bool:
        """True if all vehicles are disarmed and nothing moves."""

    @property
    def landing_timeout(self) -> float:
        """Time (s) after which vehicles without a ground are not waited for."""

    def advance_to(self, now: float) -> None:
        """Let the world go on to ``now``."""

    def datagrams_to_send(self, now: float) -> Sequence[tuple[bytes, Address]]:
        """Return what the vehicles send to :data:`GROUND` at ``now``: bytes, and the address of the vehicle."""

    def receive(self, datagrams: Sequence[tuple[bytes, Address]], now: float) -> None:
        """Take datagrams from :data:`GROUND`, each with the address of the vehicle that it is for."""

    def next_timer(self) -> float | None:
        """Return when :meth:`datagrams_to_send` has something to do next; None: never."""


P = TypeVar("P", bound=Participant)


class InProcessLockstep(Generic[P]):
    """Lets a world and a ground station fly step by step; several of them may take turns in one process."""

    def __init__(self, world: World, station: P) -> None:
        self.world, self.station = world, station
        self._time, self._vehicles = LockstepTime(world.time), frozenset(world.addresses)

    @property
    def now(self) -> float:
        """Time of the next exchange (s)."""
        return self._time.world

    @property
    def ended(self) -> bool:
        """True if the flight is over for the ground station."""
        return self.station.ended

    def let_land(self, timeout: float | None = None) -> bool:
        """Let time go on without the ground station until all is at rest; return whether it is.

        ``timeout`` in s; None: the world's own.
        """
        world, time = self.world, self._time
        give_up = time.us + round((world.landing_timeout if timeout is None else timeout) * 1e6)
        while not world.at_rest and time.us < give_up:
            time.run_free(world.next_timer())
            world.advance_to(time.world)
            world.datagrams_to_send(time.world)
        return world.at_rest

    def step(
        self,
        exchanged: Callable[[list[tuple[bytes, Address]]], None] = lambda sent: None,
        others: Sequence[tuple[bytes, Address]] = (),
    ) -> None:
        """Make one exchange and go on to the time of the next.

        ``exchanged`` is called in between with what the ground station has sent, also to others than the vehicles.
        ``others``: datagrams that it receives from elsewhere, each with its sender.
        """
        world, station, time = self.world, self.station, self._time
        world.advance_to(time.world)
        received = [*world.datagrams_to_send(time.world), *others]
        station.resume()
        station.receive_all(received, time.ground)
        sent = station.datagrams_to_send(time.ground)
        station.sent()
        world.receive([one for one in sent if one[1] in self._vehicles], time.world)
        exchanged(sent)
        if not station.ended:
            time.advance(world.next_timer(), next_call_us(station.next_timer(), time.us))
