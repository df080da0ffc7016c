"""The sockets of a swarm: opened together, and read in turns of bounded length."""

import socket

import pytest

from vehicle_sim.app.swarm_sockets import PORTION, TURNS, SwarmSockets
from vehicle_sim.world.errors import SimulationError


def test_sockets_are_opened_all_or_none():
    with SwarmSockets("127.0.0.1", 0, 4, with_clock=True) as sockets:
        taken = sockets.vehicles[0].getsockname()[1]
        with pytest.raises(SimulationError, match="Address already in use"):
            SwarmSockets("127.0.0.1", taken - 2, 4, with_clock=False)
        with pytest.raises(SimulationError, match="Address already in use"):
            SwarmSockets("127.0.0.1", taken + 1, 2, with_clock=True)
    with SwarmSockets("127.0.0.1", taken, 1, with_clock=False) as again:
        assert again.clock is None
        assert again.vehicles[0].getsockname() == ("127.0.0.1", taken)


@pytest.mark.parametrize(("base_port", "with_clock"), [(65533, False), (1, True), (70000, False)])
def test_invalid_ports_are_refused(base_port, with_clock):
    with pytest.raises(SimulationError, match="there are 1"):
        SwarmSockets("127.0.0.1", base_port, 4, with_clock)


def test_oversized_datagram_is_lost_without_error():
    with SwarmSockets("127.0.0.1", 0, 1, with_clock=False) as sockets:
        sockets.send(1, b"x" * 70_000, sockets.vehicles[0].getsockname())
        assert list(sockets.received()) == []
        sockets.send(1, b"x", sockets.vehicles[0].getsockname())
        assert list(sockets.received()) == [(1, b"x", sockets.vehicles[0].getsockname())]


@pytest.fixture
def flooded():
    """The sockets of two vehicles, and what sends a datagram to one of them (its system id)."""
    with (
        SwarmSockets("127.0.0.1", 0, 2, with_clock=False) as sockets,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
    ):
        yield sockets, lambda vehicle, data: sender.sendto(data, sockets.vehicles[vehicle - 1].getsockname())


@pytest.mark.parametrize(("size", "bounded"), [(1, TURNS), (60, TURNS), (1200, -(-PORTION // 1200)), (8000, 3)])
def test_read_of_one_port_is_bounded_under_an_endless_flood(flooded, size, bounded):
    sockets, send = flooded
    send(1, bytes(size))
    read = 0
    for vehicle, datagram, _ in sockets.received():
        assert (vehicle, len(datagram)) == (1, size)
        read += 1
        send(1, bytes(size))
        assert read <= bounded
    assert read == bounded


def test_ports_are_read_in_turns_so_that_a_flooded_one_delays_no_other(flooded):
    sockets, send = flooded
    for _ in range(100):
        send(1, b"rubbish" * 100)
    for number in range(5):
        send(2, bytes([number]))
    read = list(sockets.received())
    assert [vehicle for vehicle, *_ in read[:10]] == [1, 2] * 5
    assert [datagram for vehicle, datagram, _ in read if vehicle == 2] == [bytes([number]) for number in range(5)]


def test_rest_of_a_flood_is_read_later_in_order(flooded):
    sockets, send = flooded
    sent = [number.to_bytes(2, "big") for number in range(2 * TURNS + 10)]
    for data in sent:
        send(1, data)
    passes = [[datagram for _, datagram, _ in sockets.received()] for _ in range(4)]
    assert [len(one) for one in passes] == [TURNS, TURNS, 10, 0]
    assert [datagram for one in passes for datagram in one] == sent


def test_of_a_very_long_datagram_the_first_bytes_are_read(flooded):
    sockets, send = flooded
    send(1, bytes(range(256)) * 200)
    [(_, datagram, _)] = sockets.received()
    assert datagram == bytes(range(256)) * 32
