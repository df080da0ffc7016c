"""The peers of an aircraft: added when they send valid MAVLink, removed after a timeout; clients' ports stay."""

import math
from collections.abc import Callable, Iterator, Mapping

from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.services.aircraft import MessageSource, Sample
from gcs.mavlink.services.peer import TIME_TOLERANCE, Peer
from gcs.mavlink.settings import PeerSettings

NewPeer = Callable[[Address, bool], Peer]
"""Makes the peer of an address, with all streams or with those of the aircraft alone."""


class Peers:
    """Every address that has sent valid MAVLink lately, up to a bounded number, beside the ports of clients.

    A client's port gets the streams from the start and for ever, whether anybody answers there or not. Any other gets
    them once it has answered (:attr:`.Peer.answered`). When there are as many as are served, a newcomer takes the place
    of the one that was silent longest, of one that has not answered first; a ground that sends its HEARTBEAT every
    second keeps its place.
    """

    def __init__(self, new_peer: NewPeer, clients: Mapping[Address, bool], settings: PeerSettings) -> None:
        """``clients``: the ports of clients, and whether all streams go there."""
        self._new_peer = new_peer
        self._settings = settings
        self._clients = frozenset(clients)
        self.listeners = set(clients)
        """Ports of clients from which nothing has come yet."""
        self._peers = {address: new_peer(address, with_payload) for address, with_payload in clients.items()}
        for peer in self._peers.values():
            peer.answered = True

    def __iter__(self) -> Iterator[Peer]:
        return iter(self._peers.values())

    def receive_from(self, address: Address, now: float) -> Peer | None:
        """Return the peer of an address that sent valid MAVLink; None: there are too many."""
        peer = self._peers.get(address)
        if peer is None:
            if not self._has_room(now):
                return None
            peer = self._peers[address] = self._new_peer(address, True)
        peer.heard_at = now
        self.listeners.discard(address)
        return peer

    def datagrams_to_send(self, source: MessageSource, now: float) -> list[tuple[bytes, Address]]:
        """Return all that is due at ``now`` (s), each with its address."""
        out: list[tuple[bytes, Address]] = []
        latest = now + TIME_TOLERANCE
        if self.next_due > latest:
            return out
        sample = Sample(source, now)
        for peer in [peer for peer in self._peers.values() if peer.next_due <= latest]:
            if self._is_gone(peer, now):
                del self._peers[peer.address]
            else:
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

    def repeat(self, *message_ids: int, component: int = px4.AUTOPILOT_COMPONENT) -> None:
        """Send these messages to all at once, and repeatedly: their content has changed."""
        for peer in self._peers.values():
            peer.repeat(*message_ids, component=component)

    def send_statustext(self, text: str) -> None:
        """Send a text to all."""
        for peer in self._peers.values():
            peer.send_statustext(text)

    def _is_gone(self, peer: Peer, now: float) -> bool:
        return now - peer.heard_at > self._settings.peer_timeout and peer.address not in self._clients

    def _has_room(self, now: float) -> bool:
        """Return True if there is room for one more, or room was made."""
        others = [peer for address, peer in self._peers.items() if address not in self._clients]
        if len(others) < self._settings.peers_max:
            return True
        last = min(others, key=lambda peer: (peer.answered, peer.heard_at))
        if last.answered and now - last.heard_at <= self._settings.peer_silence:
            return False
        del self._peers[last.address]
        return True
