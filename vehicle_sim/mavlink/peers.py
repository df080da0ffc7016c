"""The peers of a vehicle: added when they send valid MAVLink, removed after a timeout."""

import math
from collections.abc import Callable, Iterator

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.address import Address
from vehicle_sim.mavlink.peer import TIME_TOLERANCE, Peer
from vehicle_sim.mavlink.telemetry import Telemetry
from vehicle_sim.mavlink.telemetry_sample import TelemetrySample


class Peers:
    """Every address that has sent valid MAVLink lately, up to a bounded number, and the ground to offer itself to."""

    def __init__(
        self, new_peer: Callable[[Address], Peer], ground_address: Address | None, settings: VehicleLinkSettings
    ) -> None:
        """``new_peer`` makes the peer of an address; ``ground_address``: where the vehicle offers itself."""
        self._new_peer = new_peer
        self._ground_address = ground_address
        self._settings = settings
        self._peers: dict[Address, Peer] = {}
        if ground_address is not None:
            self._add(ground_address).offer()

    def __iter__(self) -> Iterator[Peer]:
        return iter(self._peers.values())

    def receive_from(self, address: Address, now: float) -> Peer | None:
        """Return the peer of an address that sent valid MAVLink, streaming from now on; None: there are too many."""
        peer = self._peers.get(address)
        if peer is None:
            self._remove_silent(now)
            if len(self._peers) >= self._settings.peers_max + (self._ground_address is not None):
                return None
            peer = self._add(address)
        if not peer.is_streaming:
            peer.start_streams()
        peer.heard_at = now
        return peer

    def datagrams_to_send(self, telemetry: Telemetry, now: float) -> list[tuple[bytes, Address]]:
        """Return all that is due at ``now`` (s), each with its address."""
        out: list[tuple[bytes, Address]] = []
        latest = now + TIME_TOLERANCE
        if self.next_due > latest:
            return out
        sample = TelemetrySample(telemetry, now)
        for peer in [peer for peer in self._peers.values() if peer.next_due <= latest]:
            if self._is_silent(peer, now):
                self._remove_silent(now)
                if peer.address not in self._peers:
                    continue
            out += [(datagram, peer.address) for datagram in peer.datagrams(sample, now)]
        return out

    @property
    def next_due(self) -> float:
        """Time at which something is to be sent (s); -inf: at once, inf: never."""
        due = math.inf
        for peer in self._peers.values():
            if peer.next_due < due:
                due = peer.next_due
        return due

    def repeat(self, *message_ids: int) -> None:
        """Send these messages to all at once, and repeatedly: their content has changed."""
        for peer in self._peers.values():
            peer.repeat(*message_ids)

    def send_statustext(self, text: str) -> None:
        """Send a text to all that get the streams."""
        for peer in self._peers.values():
            if peer.is_streaming:
                peer.send_statustext(text)

    def _add(self, address: Address) -> Peer:
        peer = self._peers[address] = self._new_peer(address)
        return peer

    def _is_silent(self, peer: Peer, now: float) -> bool:
        return peer.is_streaming and now - peer.heard_at > self._settings.peer_timeout

    def _remove_silent(self, now: float) -> None:
        for address, peer in tuple(self._peers.items()):
            if self._is_silent(peer, now):
                if address == self._ground_address:
                    peer.offer()
                else:
                    del self._peers[address]
