"""What a driver runs: a ground station, or what presents a team as one aircraft."""

from collections.abc import Sequence
from typing import Protocol

from gcs.drivers.interrupt import Interrupt
from gcs.flight.failsafe import Failsafe
from gcs.mavlink.address import Address

INTERRUPTED_TWICE = "interrupted twice: the vehicles land autonomously"


class Participant(Protocol):
    """A participant on the wire without socket and clock; times in s."""

    @property
    def ended(self) -> bool:
        """True if there is nothing left to do."""

    def raise_failsafe(self, now: float, failsafe: Failsafe, reason: str) -> None:
        """React to an event that ends the flight."""

    def receive_all(self, datagrams: Sequence[tuple[bytes, Address]], now: float) -> None:
        """Take datagrams, each with its sender."""

    def datagrams_to_send(self, now: float) -> list[tuple[bytes, Address]]:
        """Return all that is due, each with its address."""

    def next_timer(self) -> float | None:
        """Return when :meth:`datagrams_to_send` is to be called again; None: never."""

    def resume(self) -> None:
        """End an idle time."""

    def sent(self) -> None:
        """Take note that all was sent."""

    def add_latency(self, duration: float) -> None:
        """Take the compute latency (s) of what was sent last."""


class InterruptWatch:
    """Obeys the signals that come while ``participant`` runs."""

    def __init__(self, interrupt: Interrupt, participant: Participant) -> None:
        self._interrupt, self._participant = interrupt, participant
        self._landing = False

    def ends(self, now: float) -> bool:
        """Raise the failsafe of a signal that has come at ``now`` (s); return True if control is to end."""
        if self._interrupt.requested_again:
            self._participant.raise_failsafe(now, Failsafe.INTERRUPTED_TWICE, INTERRUPTED_TWICE)
        elif self._interrupt.requested and not self._landing:
            self._landing = True
            self._participant.raise_failsafe(now, Failsafe.INTERRUPTED, "interrupted")
        return self._interrupt.requested_again
