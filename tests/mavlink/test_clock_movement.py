"""A clock that moves is told from a link whose latency changes, whatever else is wrong with the link."""

import math
import re

import numpy as np
import pytest
from clock_scene import TimedLink, constant, random_latency, stepped

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.clock_movement import ClockMovement
from gcs.flight.detectors import MonitorAlarm
from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.clock_bounds import OffsetBounds
from gcs.mavlink.settings import ClockSettings

LIMIT = DEFAULTS.monitor.clock_error
WRAP = 2**32 * 1e-3


def clock_errors(alarms):
    return [time for code, time in alarms if code is MonitorAlarm.CLOCK_ERROR]


def codes(alarms):
    return {code for code, _ in alarms}


def step_of(step, at=10.0):
    return lambda t: 100.0 + t + (step if t >= at else 0.0)


@pytest.mark.parametrize("step", [0.05, -0.05, 0.02, -0.02, 0.5, -0.5, 30.0, -30.0])
def test_step_of_a_clock_is_reported_within_a_second_on_a_fast_link(step):
    found = clock_errors(TimedLink(step_of(step)).run(12.0))
    assert 10.0 <= found[0] <= (10.11 if abs(step) >= 0.05 or step > 0.0 else 11.2)


@pytest.mark.parametrize("step", [0.5, -0.5, 0.2, -0.2, 0.05, -0.05, 0.02, -0.02])
def test_step_of_a_clock_is_reported_beside_the_latency_on_a_slow_link(step):
    alarms = TimedLink(step_of(step), constant(0.06), constant(0.06)).run(15.0)
    assert codes(alarms) == {MonitorAlarm.LINK_LATENCY, MonitorAlarm.CLOCK_ERROR}
    found = clock_errors(alarms)
    assert 10.0 <= found[0] <= (10.11 if step >= 0.2 else 12.3)


@pytest.mark.parametrize("step", [0.5, -0.5, 0.15, -0.15])
@pytest.mark.parametrize("seed", range(3))
def test_step_of_a_clock_is_reported_beside_the_jitter(seed, step):
    link = TimedLink(step_of(step), random_latency(seed, 0.05, 0.03), random_latency(seed + 50, 0.05, 0.03))
    alarms = link.run(15.0)
    assert {MonitorAlarm.LINK_JITTER, MonitorAlarm.LINK_LATENCY, MonitorAlarm.CLOCK_ERROR} >= codes(alarms)
    assert MonitorAlarm.LINK_JITTER in codes(alarms)
    assert 10.0 <= clock_errors(alarms)[0] <= 12.3


@pytest.mark.parametrize("rate", [0.01, -0.01, 0.02, -0.02])
@pytest.mark.parametrize("latency", [0.0, 0.06])
def test_clock_that_drifts_is_reported(rate, latency):
    link = TimedLink(lambda t: 50.0 + t + rate * max(t - 10.0, 0.0), constant(latency), constant(latency))
    found = clock_errors(link.run(16.0))
    assert 10.0 < found[0] <= (11.15 if latency == 0.0 and rate > 0.0 else 14.5)


@pytest.mark.parametrize("rate", [0.0, 5e-4, -5e-4])
@pytest.mark.parametrize("latency", [0.0, 0.06])
def test_bad_quartz_raises_no_alarm(rate, latency):
    link = TimedLink(lambda t: 50.0 + (1.0 + rate) * t, constant(latency), constant(latency))
    assert clock_errors(link.run(60.0)) == []


@pytest.mark.parametrize(
    ("out", "back"),
    [
        (stepped(10.0, 0.0, 0.1), stepped(10.0, 0.0, 0.1)),
        (stepped(10.0, 0.1, 0.0), stepped(10.0, 0.1, 0.0)),
        (stepped(10.0, 0.0, 0.1), constant(0.0)),
        (constant(0.0), stepped(10.0, 0.0, 0.1)),
        (stepped(10.0, 0.1, 0.0), constant(0.02)),
        (constant(0.02), stepped(10.0, 0.1, 0.0)),
        (constant(0.1), constant(0.0)),
        (constant(0.0), constant(0.1)),
        (stepped(10.0, 0.03, 0.09), stepped(14.0, 0.02, 0.08)),
        (lambda t: 0.02 * max(t - 10.0, 0.0), lambda t: 0.02 * max(t - 10.0, 0.0)),
        (constant(0.01), lambda t: 0.02 * max(t - 10.0, 0.0)),
    ],
)
def test_latency_that_changes_or_is_not_the_same_both_ways_moves_no_clock(out, back):
    assert clock_errors(TimedLink(lambda t: 20.0 + t, out, back).run(20.0)) == []


@pytest.mark.parametrize("spread", [0.01, 0.05, 0.2])
@pytest.mark.parametrize("least", [0.0, 0.06])
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2, 3))])
def test_jitter_moves_no_clock(seed, spread, least):
    link = TimedLink(out=random_latency(seed, spread, least), back=random_latency(seed + 50, spread, least))
    assert clock_errors(link.run(60.0)) == []


@pytest.mark.parametrize("seed", range(4))
def test_queues_that_come_and_go_on_either_way_move_no_clock(seed):
    generator = np.random.default_rng(seed)
    ends = np.sort(generator.uniform(0.0, 60.0, (2, 40)), axis=1)
    depths = 0.2 * generator.random((2, 41))

    def queue(way):
        return lambda t: depths[way, np.searchsorted(ends[way], t)]

    assert clock_errors(TimedLink(out=queue(0), back=queue(1)).run(60.0)) == []


@pytest.mark.parametrize("step", [0.0, 0.5])
@pytest.mark.parametrize("loss", [0.3, 0.7])
def test_lost_timesync_answers_neither_hide_a_step_nor_make_one(loss, step):
    generator = np.random.default_rng(5)
    link = TimedLink(step_of(step), constant(0.06), constant(0.06), lost=lambda t: generator.random() < loss)
    found = clock_errors(link.run(15.0))
    assert (len(found) > 0) == (step > 0.0)
    assert all(10.0 <= time <= 15.0 for time in found)


@pytest.mark.parametrize("uptime", [0.0, 14.0, 60.0, 3600.0, WRAP - 5.0, WRAP - 0.02])
@pytest.mark.parametrize("latency", [0.0, 0.06])
def test_ground_that_joins_vehicles_that_have_been_up_raises_no_alarm_of_a_clock(uptime, latency):
    def reading(t):
        return uptime + t

    for first in (0.0, 0.3, 2.0):
        link = TimedLink(reading, constant(latency), constant(latency), timesync_from=first)
        assert clock_errors(link.run(12.0, in_air_from=2.5)) == []
        assert link.link.clock.offset == pytest.approx(uptime, abs=1e-3)
        assert link.link.clock.set_back == 0.0


def test_clock_is_not_judged_before_timesync_is_heard():
    link = TimedLink(step_of(-5.0, at=3.0), timesync_from=30.0)
    assert link.run(20.0) == []


@pytest.mark.parametrize("timesync_wraps", [False, True])
def test_clock_of_32_bits_that_begins_anew_after_49_days_is_no_step(timesync_wraps):
    link = TimedLink(lambda t: WRAP - 10.0 + t)
    if timesync_wraps:
        reading, link.clock = link.clock, lambda t: reading(t) % WRAP
    assert link.run(20.0) == []
    assert link.link.clock.set_back == 0.0
    assert link.link.clock.jumped_at < 1.0  # at its first datagram


def test_clock_set_back_to_before_its_zero_is_set_back_by_as_much():
    link = TimedLink(lambda t: t - (15.0 if t >= 10.0 else 0.0))
    found = clock_errors(link.run(12.0))
    assert found[0] <= 10.11
    assert link.texts[0] == "clock was set back by 15000 ms or more"
    assert link.link.clock.set_back == pytest.approx(15.0, abs=1e-3)
    assert link.link.clock.offset == pytest.approx(-15.0, abs=1e-3)


def test_vehicle_that_boots_anew_is_reported():
    link = TimedLink(lambda t: 300.0 + t if t < 10.0 else t - 10.0, constant(0.01), constant(0.01))
    assert 10.0 <= clock_errors(link.run(12.0))[0] <= 10.2
    assert "set back by 310" in link.texts[0]


def test_stamps_of_an_earlier_time_are_reported():
    link = TimedLink(lambda t: 20.0 + t, stamp=lambda reading: reading - (0.1 if reading >= 30.0 else 0.0))
    assert 10.0 <= clock_errors(link.run(12.0))[0] <= 10.11


def test_timesync_of_another_zero_than_the_stamps_is_no_error_and_its_step_is():
    for step in (0.0, 0.5):
        link = TimedLink(
            lambda t, step=step: 1.7e9 + t + (step if t >= 10.0 else 0.0), stamp=lambda r: r - 1.7e9 + 20.0
        )
        assert (len(clock_errors(link.run(14.0))) > 0) == (step > 0.0)


def test_world_that_cannot_compute_for_a_while_and_catches_up_moves_no_clock():
    def reading(t):
        """It stands for 0.4 s, and catches up in another 0.4 s."""
        return 20.0 + t - (max(min(t - 10.0, 0.4, 10.8 - t), 0.0) if t > 10.0 else 0.0)

    assert clock_errors(TimedLink(reading).run(20.0)) == []


def test_opposite_changes_of_both_ways_that_leave_the_round_trip_are_a_displacement():
    """The limit of what can be told: neither stamps nor round trips differ from those of a step of the clock."""
    out, back = stepped(10.0, 0.06, 0.11), stepped(10.0, 0.06, 0.01)
    assert clock_errors(TimedLink(out=out, back=back).run(15.0)) != []
    assert clock_errors(TimedLink(out=out, back=back).run(9.9)) == []


@pytest.mark.parametrize("rate", [5400.0, 6500.0, 9000.0, 11520.0])
@pytest.mark.parametrize("latency", [0.0, 0.06])
def test_congestion_is_named_as_such_and_is_no_error_of_the_clock(rate, latency):
    link = TimedLink(lambda t: 20.0 + t, constant(latency), constant(latency), rate=rate)
    alarms = link.run(12.0)
    assert clock_errors(alarms) == []
    named = [time for code, time in alarms if code is MonitorAlarm.LINK_CONGESTION]
    assert 5.0 < named[0] <= 8.0
    [text] = [alarm.text for alarm in link.log.alarms if alarm.code is MonitorAlarm.LINK_CONGESTION][:1]
    # The first two seconds hold datagrams from before the rate was low.
    assert float(re.search(r"over a link of ([\d.]+) kB/s", text)[1]) == pytest.approx(rate / 1e3, rel=0.2)
    assert link.link.clock.queue.fit().rate == pytest.approx(rate, rel=0.05)


def test_congestion_does_not_hide_a_step_of_the_clock():
    assert 10.0 <= clock_errors(TimedLink(step_of(0.3), rate=11520.0).run(12.0))[0] <= 10.2


@pytest.mark.parametrize("rate", [0.02, -0.02])
def test_drift_of_a_clock_is_no_congestion(rate):
    drifting = TimedLink(lambda t: 50.0 + (1.0 + rate) * t)
    assert MonitorAlarm.LINK_CONGESTION not in codes(drifting.run(20.0))


@pytest.mark.parametrize("seed", range(4))
def test_jitter_is_no_congestion(seed):
    link = TimedLink(out=random_latency(seed, 0.05), back=random_latency(seed + 50, 0.05))
    assert MonitorAlarm.LINK_CONGESTION not in codes(link.run(30.0))


def exchanges(movement, start, offset, number=10):
    movement.add(OffsetBounds(start + 0.1 * k, offset - 0.06, offset + 0.06) for k in range(number))


@pytest.mark.parametrize("number", [DEFAULTS.monitor.clock_exchanges - 1, DEFAULTS.monitor.clock_exchanges])
def test_displacement_needs_exchanges_in_both_segments(number):
    movement = ClockMovement(DEFAULTS.monitor)
    exchanges(movement, 0.0, 5.0)
    exchanges(movement, 1.0, 5.05, number)
    exchanges(movement, 2.0, 5.05, 1)
    enough = number >= DEFAULTS.monitor.clock_exchanges
    assert movement.displacement(2.0) == pytest.approx(0.05 if enough else 0.0)
    assert movement.displacement(2.0 + 1.1 * DEFAULTS.monitor.clock_window) == 0.0
    assert movement.contradiction(2.0) == 0.0


def test_contradiction_is_signed_and_ends_with_the_window():
    for step in (0.3, -0.3):
        movement = ClockMovement(DEFAULTS.monitor)
        exchanges(movement, 0.0, 5.0)
        exchanges(movement, 1.0, 5.0 + step)
        assert movement.contradiction(2.0) == pytest.approx(step - math.copysign(0.12, step))
        assert movement.contradiction(2.0 + DEFAULTS.monitor.clock_window) == 0.0


def test_bounds_are_handed_over_once_and_only_when_timesync_has_been_heard():
    clock = RemoteClock()
    for k in range(ClockSettings.round_trips):
        clock.add_stamp(14.0 + 0.1 * k, 0.02 + 0.1 * k, in_order=True)
        assert clock.bounds.take() == [] and not clock.bounds.known
        clock.add_answer(clock.request(0.1 * k), 0.1 * k + 0.04, round(1e9 * (14.02 + 0.1 * k)))
    clock.add_stamp(15.0, 1.02, in_order=True)
    answer, stamp = clock.bounds.take()
    assert answer == pytest.approx(OffsetBounds(0.94, 13.98, 14.02))
    assert stamp == pytest.approx(OffsetBounds(1.02, 13.98, math.inf))
    assert clock.bounds.take() == []
