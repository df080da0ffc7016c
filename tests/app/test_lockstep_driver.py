"""Lockstep driver of the ground: it answers the world's ticks, and notices when none come. The world is scripted."""

from contextlib import closing
from types import SimpleNamespace

import pytest
from scripted_station import VEHICLE, ScriptedStation

from gcs.config.flight_settings import DriverSettings
from gcs.drivers.connection import Connection, LockstepConnection
from gcs.drivers.lockstep import Pace, is_refused, run_in_lockstep
from gcs.flight.failsafe import Failsafe
from gcs.mavlink.lockstep import Done, Tick, decode_done

CLOCK = ("127.0.0.1", 14500)
JOIN, LEAVE = Done(0, None), Done(0, None, leaving=True)
SETTINGS = DriverSettings(join_interval=1.0, tick_timeout=3.0)


def tick(serial, time_us, sender=CLOCK):
    return Tick(serial, time_us).encode(), sender


class World:
    """A connection to a world that sends these batches of datagrams, one whenever the ground waits, then none."""

    def __init__(self, *batches):
        self.batches, self.pending, self.answers, self.commands = list(batches), [], [], []

    def wait(self, timeout):
        if not self.pending and self.batches:
            self.pending = list(self.batches.pop(0))
        return bool(self.pending)

    def receive(self):
        while self.pending:
            yield self.pending.pop(0)

    def send(self, datagram, address):
        if address == CLOCK:
            self.answers.append(decode_done(datagram))
        else:
            self.commands.append((datagram, address))


class Station(ScriptedStation):
    """A ground station that ends its flight after so many ticks, and is due next at ``due`` (s)."""

    def __init__(self, ticks, due=None):
        super().__init__(ticks)
        self.due = due

    def next_timer(self):
        return self.due


def run(world, station, requested=0, end_reason=lambda: None):
    interrupt = SimpleNamespace(requested=requested > 0, requested_again=requested > 1)
    run_in_lockstep(station, world, CLOCK, interrupt, SETTINGS, end_reason=end_reason)


@pytest.mark.parametrize(
    ("due", "next_us"), [(None, None), (0.05, 50_000), (0.1 + 0.2, 300_000), (0.0500004, 50_001), (0.0, 1001)],
    ids=["never", "whole", "whole but for rounding", "rounded up", "past"],
)  # fmt: skip
def test_each_tick_is_answered_with_the_time_of_the_next_timer(due, next_us):
    world, station = World([tick(7, 1000)]), Station(1, due)
    run(world, station)
    assert station.times == [0.001] and world.commands == [(b"command", VEHICLE)]
    assert world.answers == [JOIN, Done(7, next_us, leaving=True), LEAVE]


def test_datagrams_before_a_tick_are_received_at_its_time():
    world = World([(b"a", VEHICLE), tick(1, 1000), (b"b", VEHICLE)], [tick(2, 4000)])
    station = Station(2)
    run(world, station)
    assert station.received == [(b"a", VEHICLE, 0.001), (b"b", VEHICLE, 0.004)]
    assert [answer.serial for answer in world.answers] == [0, 1, 2, 0]
    assert [answer.leaving for answer in world.answers] == [False, False, True, True]


def test_tick_of_another_sender_is_no_tick():
    world, station = World([tick(5, 9000, sender=VEHICLE), (b"noise", CLOCK), tick(1, 1000)]), Station(1)
    run(world, station)
    assert station.times == [0.001] and station.received == [(*tick(5, 9000, VEHICLE), 0.001)]


def test_ground_asks_to_join_until_the_world_answers():
    world, station = World([], [], [tick(1, 1000)], [], [tick(2, 2000)]), Station(2)
    run(world, station)
    assert world.answers == [JOIN, JOIN, JOIN, Done(1, None), Done(2, None, leaving=True), LEAVE]
    assert station.failsafes == []


def test_world_that_stops_answering_is_lost_after_the_timeout():
    world, station = World([], [], [tick(1, 5000)]), Station(9)
    run(world, station)
    [(now, failsafe, reason)] = station.failsafes
    assert (now, failsafe) == (0.005, Failsafe.SIMULATION_LOST)
    assert reason == "the simulated world does not answer for 3 s"
    assert world.answers == [JOIN, JOIN, JOIN, Done(1, None), LEAVE]


def test_end_of_the_world_is_reported_at_once():
    world, station = World(), Station(9)
    run(world, station, end_reason=lambda: "it crashed")
    assert station.failsafes == [(0.0, Failsafe.SIMULATION_LOST, "it crashed")]
    assert world.answers == [JOIN]  # it never joined


def test_interrupt_is_raised_once_at_the_next_tick():
    world, station = World([tick(1, 1000)], [tick(2, 2000)]), Station(2)
    run(world, station, requested=1)
    assert station.failsafes == [(0.001, Failsafe.INTERRUPTED, "interrupted")]


@pytest.mark.parametrize(("answers", "time"), [([], 0.0), ([[tick(1, 1000)]], 0.001)])
def test_second_interrupt_ends_control_whether_the_world_answers_or_not(answers, time):
    world, station = World(*answers), Station(2)
    run(world, station, requested=2)
    (failsafe,) = station.failsafes
    assert failsafe[:2] == (time, Failsafe.INTERRUPTED_TWICE)
    assert not station.received and not station.ended
    assert world.answers == ([JOIN, LEAVE] if answers else [JOIN])


def test_tick_alone_ends_a_wait_and_comes_behind_the_datagrams_of_the_vehicles():
    with closing(Connection()) as ground, closing(Connection()) as clock, closing(Connection()) as vehicle:
        clock_address, ground_address = clock.socket.getsockname(), ground.socket.getsockname()
        with closing(LockstepConnection(ground, clock_address)) as connection:
            connection.send(b"join", clock_address)
            connection.send(b"heartbeat", vehicle.socket.getsockname())
            assert list(vehicle.receive()) == [(b"heartbeat", ground_address)]
            [(join, joined_from)] = clock.receive()
            assert join == b"join" and joined_from != ground_address

            vehicle.send(b"telemetry", ground_address)
            assert not connection.wait(0.0)
            clock.send(b"tick", joined_from)
            assert connection.wait(0.0)
            vehicle.send(b"more", ground_address)
            sent_by_vehicle = [(data, vehicle.socket.getsockname()) for data in (b"telemetry", b"more")]
            assert list(connection.receive()) == [*sent_by_vehicle, (b"tick", clock_address)]
            assert not connection.wait(0.0) and list(connection.receive()) == []


def test_closed_port_of_a_clock_is_refused_and_an_open_one_is_not():
    with closing(Connection()) as world:
        clock_address = world.socket.getsockname()
        assert not is_refused(clock_address)
        assert [decode_done(datagram) for datagram, _ in world.receive()] == [Done(0, None, leaving=True)]
    assert is_refused(clock_address)


def test_pace_waits_for_what_is_early_and_does_not_make_up_for_what_is_late():
    wall, waits = [100.0], []

    def sleep(duration):
        waits.append(duration)
        wall[0] += duration

    pace = Pace(2.0, clock=lambda: wall[0], sleep=sleep)
    pace.hold(30.0)  # of a world that has served another ground before
    for simulated, spent in ((0.5, 0.05), (1.0, 0.05), (1.5, 3.0), (2.0, 0.05)):
        wall[0] += spent
        pace.hold(30.0 + simulated)
    assert waits == pytest.approx([0.2, 0.2, 0.2]) and wall[0] == pytest.approx(103.75)
