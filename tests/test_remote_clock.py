"""A vehicle's clock as the ground knows it, and the stamps of what is sent to it."""

from itertools import pairwise

import pytest

from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.vehicle_link import VehicleLink


def test_a_clock_that_is_set_back_is_followed_at_once_and_late_datagrams_are_not_taken_for_it():
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
def test_a_clock_that_is_set_is_told_from_one_whose_datagrams_are_late(step):
    clock = RemoteClock()
    for k in range(100):
        clock.add_stamp(10.0 + 0.04 * k, 0.04 * k + (0.05 if k % 7 == 0 else 0.0), in_order=True)
    assert clock.jumped_at < 0.1  # when it was heard first
    for k in range(100, 150):
        clock.add_stamp(10.0 + step + 0.04 * k, 0.04 * k, in_order=True)
    assert clock.jumped_at == pytest.approx(4.0)


def test_stamps_of_setpoints_do_not_go_back_with_the_clock():
    link = VehicleLink(1, None)
    before = []
    for k in range(10):
        link.clock.add_stamp(10.0 + 0.05 * k, 0.05 * k, in_order=True)
        before.append(link.stamp(0.05 * k))
    assert before == pytest.approx([10.0 + 0.05 * k for k in range(10)])
    link.clock.add_stamp(10.1, 0.5, in_order=True)
    after = [link.stamp(0.5 + 0.05 * k) for k in range(20)]
    assert after[0] > before[-1]
    assert all(b > a for a, b in pairwise(after))
    assert after[-1] == pytest.approx(0.5 + 0.05 * 19 + 9.6)


def asked_and_answered(clock, trips, until):
    """Round trips that take ``trips(asked)`` (s), asked for every 0.1 s; the answers until then, in their order."""
    answers = sorted((0.1 * k + trips(0.1 * k), clock.request(0.1 * k)) for k in range(round(until / 0.1)))
    for arrival, ts1 in answers:
        if arrival <= until:
            clock.add_answer(ts1, arrival)
    return clock


def test_a_way_that_gets_longer_and_longer_is_told_soon():
    clock = asked_and_answered(RemoteClock(), lambda asked: 2.0 * max(asked - 1.0, 0.0), until=2.0)
    assert clock.least_delay(0.3, 2.0) > 0.11 > clock.delay
    assert RemoteClock().least_delay(0.3, 2.0) == 0.0


def test_nothing_for_a_moment_and_then_all_at_once_is_no_longer_way():
    clock = asked_and_answered(RemoteClock(), lambda asked: max(1.45 - asked, 0.0) if asked > 1.0 else 0.0, until=1.47)
    assert clock.least_delay(0.3, 1.47) == 0.0
