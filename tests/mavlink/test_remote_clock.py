"""Estimate of a vehicle's clock on the ground, and stamps of what is sent to the vehicle."""

import math
import random
from itertools import pairwise

import pytest

from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.vehicle_link import VehicleLink


def test_clock_set_back_is_followed_at_once_and_late_datagram_is_no_step():
    clock = RemoteClock()
    for k in range(50):
        clock.add_stamp(10.0 + 0.04 * k, 0.04 * k + (0.05 if k % 7 == 0 else 0.0), in_order=True)
    assert clock.offset == pytest.approx(10.0) and clock.set_back == 0.0
    clock.add_stamp(10.0 + 0.04 * 48, 2.0, in_order=False)  # overtaken
    assert clock.offset == pytest.approx(10.0) and clock.set_back == 0.0
    for k in range(50, 60):
        clock.add_stamp(9.8 + 0.04 * k, 0.04 * k, in_order=True)
        assert clock.offset == pytest.approx(9.8) and clock.set_back == pytest.approx(0.2)


@pytest.mark.parametrize("step", [0.1, -0.1])
def test_clock_step_is_distinguished_from_late_datagrams(step):
    clock = RemoteClock()
    for k in range(100):
        clock.add_stamp(10.0 + 0.04 * k, 0.04 * k + (0.05 if k % 7 == 0 else 0.0), in_order=True)
    assert clock.jumped_at < 0.1  # at its first datagram
    for k in range(100, 150):
        clock.add_stamp(10.0 + step + 0.04 * k, 0.04 * k, in_order=True)
    assert clock.jumped_at == pytest.approx(4.0)


def test_setpoint_stamps_stay_monotonic_after_clock_step():
    link = VehicleLink(1, None)
    before = []
    for k in range(10):
        link.clock.add_stamp(10.0 + 0.05 * k, 0.05 * k, in_order=True)
        before.append(link.setpoints.stamp(0.05 * k))
    assert before == pytest.approx([10.0 + 0.05 * k for k in range(10)])
    link.clock.add_stamp(10.1, 0.5, in_order=True)
    after = [link.setpoints.stamp(0.5 + 0.05 * k) for k in range(20)]
    assert after[0] > before[-1]
    assert all(b > a for a, b in pairwise(after))
    assert after[-1] == pytest.approx(0.5 + 0.05 * 19 + 9.6)


def clock_after_round_trips(clock, trips, until):
    """Clock after round trips of ``trips(sent)`` (s) begun every 0.1 s, with the answers until ``until`` in order."""
    answers = sorted((0.1 * k + trips(0.1 * k), clock.request(0.1 * k)) for k in range(round(until / 0.1)))
    for arrival, ts1 in answers:
        if arrival <= until:
            clock.add_answer(ts1, arrival)
    return clock


def test_growing_link_latency_is_detected_before_answers_arrive():
    clock = clock_after_round_trips(RemoteClock(), lambda sent: 2.0 * max(sent - 1.0, 0.0), until=1.8)
    assert clock.least_delay(0.3, 1.8) > 0.09 > clock.delay
    assert RemoteClock().least_delay(0.3, 2.0) == 0.0


def test_stalled_answers_released_together_are_no_link_latency():
    clock = clock_after_round_trips(
        RemoteClock(), lambda sent: max(1.45 - sent, 0.0) if sent > 1.0 else 0.0, until=1.47
    )
    assert clock.least_delay(0.3, 1.47) == 0.0


def test_clock_before_its_first_answer_has_neither_latency_nor_spread_nor_a_bound():
    clock = RemoteClock()
    assert (clock.delay, clock.spread, clock.round_trip_max) == (0.0, 0.0, math.inf)
    assert not clock.known and clock.offset == 0.0


def test_equal_round_trips_are_latency_without_spread():
    clock = clock_after_round_trips(RemoteClock(), lambda sent: 0.04, until=2.0)
    assert clock.delay == pytest.approx(0.02) and clock.round_trip_max == pytest.approx(0.04)
    assert clock.spread == pytest.approx(0.0, abs=1e-9)


def test_spread_of_latency_is_that_of_the_round_trips_apart_from_the_worst_quarter():
    trips = [0.02, 0.03, 0.04, 0.05, 0.3]
    clock = clock_after_round_trips(RemoteClock(), lambda sent: trips[round(sent / 0.1) % 5], until=1.0)
    assert clock.spread == pytest.approx((0.05 - 0.02) / 2.0)


@pytest.mark.parametrize("latency", [0.0, 0.01, 0.04])
def test_offset_is_that_of_the_clocks_where_latency_is_the_same_both_ways(latency):
    clock = clock_after_round_trips(RemoteClock(), lambda sent: 2.0 * latency, until=2.0)
    for k in range(50):
        clock.add_stamp(10.0 + 0.04 * k, 0.04 * k + latency, in_order=True)
    assert clock.offset == pytest.approx(10.0, abs=1e-6)


@pytest.mark.parametrize("answered", [0.3, 0.5])
def test_offset_is_right_while_the_latency_of_a_link_that_loses_answers_grows(answered):
    for seed in range(10):
        lucky, clock = random.Random(seed), RemoteClock()
        events = []  # arrival, stamp of telemetry or request of an answer
        for k in range(150):
            sent = 0.04 * k
            events.append((sent + latency_of(sent), sent + 10.0, None))
        for k in range(60):
            sent = 0.1 * k
            if lucky.random() < answered or k % 8 == 0:
                there = sent + latency_of(sent)
                events.append((there + latency_of(there), None, clock.request(sent)))
        errors = []
        for arrival, stamp, request in sorted(events, key=lambda event: event[0]):
            if stamp is None:
                clock.add_answer(request, arrival)
            else:
                clock.add_stamp(stamp, arrival, in_order=True)
            errors.append(abs(clock.offset - 10.0))
        assert clock.delay == pytest.approx(0.1)
        assert sum(error > 0.03 for error in errors) * 0.03 < 0.3, (seed, max(errors))


def latency_of(time):
    """Return the latency (s) of what is sent at ``time`` (s)."""
    return 0.1 if time > 2.0 else 0.0
