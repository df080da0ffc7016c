import socket
from itertools import count
from types import SimpleNamespace

from gcs.mavlink.udp import DATAGRAMS_AT_ONCE, arrived


def test_datagrams_are_read_in_order_of_arrival() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as here,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as there,
    ):
        for end in (here, there):
            end.bind(("127.0.0.1", 0))
            end.setblocking(False)
        for i in range(5):
            there.sendto(bytes([i]), here.getsockname())
        assert list(arrived(here)) == [(bytes([i]), there.getsockname()) for i in range(5)]
        assert list(arrived(here)) == []


def test_read_is_bounded_under_flood() -> None:
    numbers = count()
    endless = SimpleNamespace(recvfrom=lambda size: (next(numbers), ("10.0.0.66", 1)))
    assert [datagram for datagram, _ in arrived(endless)] == list(range(DATAGRAMS_AT_ONCE))
