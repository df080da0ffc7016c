"""``vehicle-sim impair``: links between the UDP sockets of other programs, on the machine's clock."""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Callable, Mapping, Sequence

from gcs.mavlink.address import Address, ConnectionUrl
from gcs.mavlink.udp import arrived
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.impair_arguments import ImpairOptions
from vehicle_sim.app.swarm_sockets import bound, url
from vehicle_sim.faults.impaired_link import ENDS, End, ImpairedLink, LinkCounts

_ANY = "0.0.0.0"


class LinkSockets(contextlib.ExitStack):
    """The sockets at both ends of a link. Raises :class:`SimulationError` if one cannot be opened."""

    def __init__(self, listen: Address, forward: ConnectionUrl) -> None:
        super().__init__()
        with contextlib.ExitStack() as opened:
            at_forward = forward.address if forward.listens else (_ANY, 0)
            self.at: dict[End, socket.socket] = {
                "listen": opened.enter_context(bound(*listen)),
                "forward": opened.enter_context(bound(*at_forward)),
            }
            self.push(opened.pop_all())

    def send(self, end: End, datagram: bytes, receiver: Address) -> None:
        """Send from an end. What cannot be sent is lost, as may be over UDP."""
        with contextlib.suppress(OSError):
            self.at[end].sendto(datagram, receiver)


class LinkDriver:
    """Runs links until the end is requested."""

    def __init__(
        self,
        links: Sequence[tuple[ImpairedLink, LinkSockets]],
        ending: Ending,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._links, self._ending, self._clock = links, ending, clock

    def run(self) -> None:
        """Hand on what comes, when it is due."""
        sockets = [sockets.at[end] for _, sockets in self._links for end in ENDS]
        while not self._ending.requested:
            for link, at in self._links:
                for end in ENDS:
                    for datagram, sender in arrived(at.at[end]):
                        link.receive(end, datagram, sender, self._clock())
                for end, datagram, receiver in link.datagrams_to_send(self._clock()):
                    at.send(end, datagram, receiver)
            timers = [timer for link, _ in self._links if (timer := link.next_timer()) is not None]
            self._ending.wait(sockets, max(min(timers) - self._clock(), 0.0) if timers else None)


def impair(options: ImpairOptions) -> int:
    """Run the links until Ctrl-C or SIGTERM, then print what they did; returns the exit status.

    Raises :class:`SimulationError` for an address at which it cannot listen; nothing is left open.
    """
    with contextlib.ExitStack() as started:
        ending = started.enter_context(contextlib.closing(Ending()))
        started.enter_context(ending.on_signals())
        start = time.monotonic()
        links = [
            (
                ImpairedLink(
                    options.profile, [options.seed, i], start=start, vehicle=options.vehicle,
                    forward=None if forward.listens else forward.address,
                ),
                started.enter_context(LinkSockets(listen, forward)),
            )
            for i, (listen, forward) in enumerate(options.addresses, start=1)
        ]  # fmt: skip
        for i, ((_, sockets), (_, forward)) in enumerate(zip(links, options.addresses, strict=True), start=1):
            print(f"link {i}: {url(sockets.at['listen'])} to {forward}")
        print(f"ready\n({options.name}, seed {options.seed}; Ctrl-C ends)", flush=True)
        LinkDriver(links, ending).run()
        for i, (link, _) in enumerate(links, start=1):
            print("\n".join(counted(i, link.counts)), flush=True)
        return ending.status


def counted(number: int, counts: Mapping[str, LinkCounts]) -> list[str]:
    """Return a line of each direction of a link."""
    return [
        f"link {number}: {direction}: {c.received} received, {c.forwarded} forwarded, {c.lost} lost, "
        f"{c.overflowed} lost at the queue, {c.late} late, {c.reordered} reordered"
        + (f", {c.without_receiver} without a receiver" if c.without_receiver else "")
        for direction, c in counts.items()
    ]
