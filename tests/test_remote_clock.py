"""A vehicle's clock as the ground knows it, and the stamps of what is sent to it."""

from itertools import pairwise

import pytest

from gcs.vehicle_link import VehicleLink
from gcs.wire.clock import RemoteClock


def test_a_clock_that_is_set_back_is_followed_at_once_and_late_datagrams_are_not_taken_for_it():
    clock = RemoteClock()
    for k in range(50):
        clock.stamped(10.0 + 0.04 * k, 0.04 * k + (0.05 if k % 7 == 0 else 0.0), in_order=True)
    assert clock.offset == pytest.approx(10.0) and clock.set_back == 0.0
    clock.stamped(10.0 + 0.04 * 48, 2.0, in_order=False)  # overtaken
    assert clock.offset == pytest.approx(10.0) and clock.set_back == 0.0
    for k in range(50, 60):
        clock.stamped(9.8 + 0.04 * k, 0.04 * k, in_order=True)
        assert clock.offset == pytest.approx(9.8) and clock.set_back == pytest.approx(0.2)


def test_stamps_of_setpoints_do_not_go_back_with_the_clock():
    link = VehicleLink(1, None)
    before = []
    for k in range(10):
        link.clock.stamped(10.0 + 0.05 * k, 0.05 * k, in_order=True)
        before.append(link.stamp(0.05 * k))
    assert before == pytest.approx([10.0 + 0.05 * k for k in range(10)])
    link.clock.stamped(10.1, 0.5, in_order=True)
    after = [link.stamp(0.5 + 0.05 * k) for k in range(20)]
    assert after[0] > before[-1]
    assert all(b > a for a, b in pairwise(after))
    assert after[-1] == pytest.approx(0.5 + 0.05 * 19 + 9.6)
