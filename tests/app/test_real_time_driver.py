"""Real-time driver of the ground, on a wall clock of the test's own: times, waits, latency, and how a flight ends."""

from types import SimpleNamespace

import pytest
from scripted_station import VEHICLE, ScriptedStation

from gcs.config.flight_settings import DriverSettings
from gcs.drivers.realtime import run_in_real_time
from gcs.flight.failsafe import Failsafe

SETTINGS = DriverSettings(wait_max=0.2)


class Wire:
    """A connection whose waits and whose work (s, each time it receives) let the wall clock pass."""

    def __init__(self, work=0.0, arriving=()):
        self.clock, self.work, self.arriving = 1000.0, work, list(arriving)
        self.waits, self.commands = [], []

    def read_clock(self):
        return self.clock

    def receive(self):
        self.clock += self.work
        return [self.arriving.pop(0)] if self.arriving else []

    def send(self, datagram, address):
        self.commands.append((datagram, address))

    def wait(self, timeout):
        self.waits.append(timeout)
        self.clock += timeout


class Station(ScriptedStation):
    """A ground station with a timer each ``interval`` (s); its flight ends after so many steps."""

    def __init__(self, steps, interval):
        super().__init__(steps)
        self.interval, self.latencies, self.order = interval, [], []

    def next_timer(self):
        return None if self.ended or self.interval is None else self.times[-1] + self.interval

    def add_latency(self, latency):
        self.latencies.append(latency)

    def sent(self):
        self.order.append("sent")

    def resume(self):
        self.order.append("resumed")


def run(wire, station, speed=1.0, requested=0, end_reason=lambda: None):
    interrupt = SimpleNamespace(requested=requested > 0, requested_again=requested > 1)
    run_in_real_time(
        station, wire, interrupt, SETTINGS, speed=speed, clock=wire.read_clock, end_reason=end_reason
    )  # fmt: skip


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_ground_steps_at_its_timers_however_fast_the_wall_clock_passes(speed):
    wire, station = Wire(), Station(5, 0.05)
    run(wire, station, speed)
    assert station.times == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2])
    assert wire.waits == pytest.approx([0.05 / speed] * 4)
    assert wire.commands == [(b"command", VEHICLE)] * 5
    assert station.order == ["sent", "resumed"] * 4 + ["sent"]


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_longest_wait_is_limited_so_that_an_interrupt_is_noticed(speed):
    wire, station = Wire(), Station(4, 100.0)
    run(wire, station, speed)
    assert wire.waits == pytest.approx([SETTINGS.wait_max] * 3)
    assert station.times == pytest.approx([0.2 * speed * k for k in range(4)])


@pytest.mark.parametrize("speed", [1.0, 2.0])
def test_compute_latency_is_reported_in_ground_time_and_a_late_timer_is_not_waited_for(speed):
    wire, station = Wire(work=0.03), Station(3, 0.02)
    run(wire, station, speed)
    assert station.latencies == pytest.approx([0.03 * speed] * 3)
    assert wire.waits == []
    assert station.times == pytest.approx([0.0, 0.03 * speed, 0.06 * speed])


def test_datagrams_are_received_at_the_time_of_their_step():
    wire, station = Wire(arriving=[(b"a", VEHICLE), (b"b", VEHICLE)]), Station(3, 0.05)
    run(wire, station)
    assert station.received == [(b"a", VEHICLE, 0.0), (b"b", VEHICLE, pytest.approx(0.05))]


def test_interrupt_is_raised_once_at_its_time():
    station = Station(3, 0.05)
    run(Wire(), station, requested=1)
    assert station.failsafes == [(0.0, Failsafe.INTERRUPTED, "interrupted")]


def test_second_interrupt_ends_control_at_once():
    station = Station(3, 0.05)
    run(Wire(), station, requested=2)
    (failsafe,) = station.failsafes
    assert failsafe[:2] == (0.0, Failsafe.INTERRUPTED_TWICE)
    assert not station.ended


def test_end_of_the_simulated_world_is_raised_with_its_reason():
    wire, station = Wire(), Station(3, 0.05)
    run(wire, station, speed=2.0, end_reason=lambda: "it crashed" if wire.clock > 1000.03 else None)
    assert station.failsafes == [(pytest.approx(0.1), Failsafe.SIMULATION_LOST, "it crashed")]


def test_datagrams_arrive_no_earlier_than_they_are_read():
    wire, station = Wire(arriving=[(b"a", VEHICLE)], work=0.03), Station(2, 0.05)
    run(wire, station)
    assert station.received == [(b"a", VEHICLE, pytest.approx(0.03))]
