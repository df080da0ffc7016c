"""The UDP sockets of a swarm: one of each vehicle, and one of the clock in lockstep."""

import contextlib
import select
import socket
from collections.abc import Iterator

from gcs.mavlink.address import Address
from gcs.mavlink.udp import RECEIVE_BUFFER
from vehicle_sim.world.errors import SimulationError

TURNS = 256
"""Datagrams that are read of one port at once: of a flood of 20,000/s what comes in 13 ms."""
PORTION = 1 << 14
"""Bytes behind which no further datagram of one port is read at once: requests in them take 25 ms to answer."""
_READ_MAX = 1 << 13
"""Bytes that are read of a datagram: no MAVLink program sends longer ones."""


class SwarmSockets(contextlib.ExitStack):
    """Opens all sockets or, with a :class:`SimulationError`, none.

    Vehicle i listens on ``base_port + i - 1``, the clock on ``base_port - 1``; with ``base_port`` 0 each takes
    whatever port is free.
    """

    def __init__(self, host: str, base_port: int, vehicles: int, with_clock: bool) -> None:
        """``host`` is a name or an IPv4 address of this machine."""
        first = base_port - 1 if with_clock else base_port
        if base_port and not (first > 0 and base_port + vehicles - 1 <= 65535):
            last = base_port + vehicles - 1
            raise SimulationError(
                f"--base-port {base_port}: needs the ports {first} .. {last}, and there are 1 .. 65535"
            )
        super().__init__()
        with contextlib.ExitStack() as opened:
            self.clock = opened.enter_context(bound(host, base_port and base_port - 1)) if with_clock else None
            self.vehicles = [opened.enter_context(bound(host, base_port and base_port + i)) for i in range(vehicles)]
            self.push(opened.pop_all())
        self._poll = select.poll()
        self._endpoint_at = {endpoint.fileno(): (i, endpoint) for i, endpoint in enumerate(self.vehicles, start=1)}
        for number in self._endpoint_at:
            self._poll.register(number, select.POLLIN)

    def send(self, vehicle: int, datagram: bytes, address: Address) -> None:
        """Send from the endpoint of a vehicle (its system id). What cannot be sent is lost, as may be over UDP."""
        try:
            self.vehicles[vehicle - 1].sendto(datagram, address)
        except OSError:
            return

    def received(self) -> Iterator[tuple[int, bytes, Address]]:
        """Yield all that has arrived: the vehicle's system id, bytes, sender; each vehicle's in order.

        In turns, one of every vehicle that has any: to look at all at once costs less than to find each one empty.
        No more than TURNS turns, and PORTION bytes of each: a sender that is faster must not keep the reader from all
        else.
        """
        left = dict.fromkeys(self._endpoint_at, PORTION)
        for _ in range(TURNS):
            # In the order in which they were registered, which is the vehicles'.
            ready = [number for number, _ in self._poll.poll(0) if left[number] > 0]
            if not ready:
                return
            for number in ready:
                vehicle, endpoint = self._endpoint_at[number]
                try:
                    datagram, sender = endpoint.recvfrom(_READ_MAX)
                except OSError:  # the echo of a datagram to a closed port: no datagram of anybody
                    continue
                left[number] -= len(datagram)
                yield vehicle, datagram, sender


def url(endpoint: socket.socket) -> str:
    """Return the address at which the socket listens."""
    host, port = endpoint.getsockname()
    return f"udp://{host}:{port}"


def bound(host: str, port: int) -> socket.socket:
    """Return a non-blocking UDP socket that listens there. Raises :class:`SimulationError`."""
    endpoint = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        endpoint.setblocking(False)
        endpoint.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
        # No address is shared: two swarms on one port would each get a part of what is sent.
        endpoint.bind((host, port))
    except OSError as error:
        endpoint.close()
        raise SimulationError(f"cannot listen on udp://{host}:{port}: {error.strerror or error}") from None
    return endpoint
