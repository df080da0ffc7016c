"""Reading UDP sockets, for both ends of the wire."""

import socket
from collections.abc import Iterator

from gcs.mavlink.address import Address

RECEIVE_BUFFER = 4 << 20  # bytes requested: a whole team's telemetry during a control step; the system may give less
DATAGRAM_MAX = 65535
DATAGRAMS_AT_ONCE = 4096


def arrived(endpoint: socket.socket) -> Iterator[tuple[bytes, Address]]:
    """Return the datagrams that a non-blocking socket holds, in order; no more than DATAGRAMS_AT_ONCE.

    A sender that is faster than the reader must not keep it from everything else.
    """
    for _ in range(DATAGRAMS_AT_ONCE):
        try:
            yield endpoint.recvfrom(DATAGRAM_MAX)
        except BlockingIOError:
            return
        except OSError:  # the echo of a datagram to a closed port: no datagram of anybody
            continue
