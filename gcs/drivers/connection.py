"""The ground's socket."""

import select
import socket
from collections.abc import Iterator
from itertools import chain

from gcs.errors import UnusableInput
from gcs.mavlink.address import Address
from gcs.mavlink.udp import RECEIVE_BUFFER, arrived


class Connection:
    """One UDP socket for all vehicles, so that datagrams are read in the order in which they came."""

    def __init__(self, local: Address = ("127.0.0.1", 0)) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
        try:
            self.socket.bind(local)
        except OSError as error:
            self.socket.close()
            raise UnusableInput(f"udp://{local[0]}:{local[1]}: {error.strerror}") from None
        self.socket.setblocking(False)

    def send(self, datagram: bytes, address: Address) -> None:
        """Send, or lose: a full buffer or a closed port is what a lossy link looks like."""
        try:
            self.socket.sendto(datagram, address)
        except OSError:
            return

    def receive(self) -> Iterator[tuple[bytes, Address]]:
        """Return the datagrams that have come."""
        return arrived(self.socket)

    def wait(self, timeout: float) -> bool:
        """Wait until something can be received, at most ``timeout`` (s); return False if nothing can."""
        return bool(select.select([self.socket], [], [], timeout)[0])

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()


class LockstepConnection:
    """A connection to vehicles in lockstep, with a socket of its own for the world's clock: its ticks alone end a wait.

    The world ticks after it has sent the datagrams of all vehicles. A ground that waits for those is woken by the first
    of them, and takes the processor from a world that is still sending.
    """

    def __init__(self, vehicles: Connection, clock_address: Address) -> None:
        self._vehicles, self._clock_address = vehicles, clock_address
        self._clock = Connection((vehicles.socket.getsockname()[0], 0))

    def send(self, datagram: bytes, address: Address) -> None:
        """Send as :meth:`Connection.send`."""
        (self._clock if address == self._clock_address else self._vehicles).send(datagram, address)

    def receive(self) -> Iterator[tuple[bytes, Address]]:
        """Return the datagrams that have come, those of the clock last."""
        return chain(self._vehicles.receive(), self._clock.receive())

    def wait(self, timeout: float) -> bool:
        """Wait for the clock, at most ``timeout`` (s); return False if it is silent."""
        return self._clock.wait(timeout)

    def close(self) -> None:
        """Close the socket of the clock."""
        self._clock.close()
