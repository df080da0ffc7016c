"""How long set-points take to a vehicle, from what it says."""

import pytest

from gcs.wire.setpoint_way import ENOUGH, REMEMBERED, SetpointWay


def flown(delays, period=0.05, lead=0.06):
    """A way on which set-points take ``delays`` (s); None: lost."""
    way = SetpointWay()
    for k, delay in enumerate(delays):
        time = period * k
        way.sent(time + lead, time)
        if delay is not None:
            way.began(time + lead, time + delay)
    return way


def test_nothing_is_known_before_enough_have_come():
    assert flown([0.01] * (ENOUGH - 1)).delay is None
    assert flown([0.01] * ENOUGH).delay == pytest.approx(0.01)


def test_the_usual_way_counts_not_the_late_ones_nor_the_lost():
    assert flown([0.004, 0.054, None, 0.004, 0.004, None, 0.104, 0.004]).delay == pytest.approx(0.004)


def test_a_way_that_gets_longer_is_followed_soon():
    before = [0.004] * 40
    assert flown(before + [0.064] * (REMEMBERED // 2)).delay == pytest.approx(0.004)
    assert flown(before + [0.064] * (REMEMBERED // 2 + 1)).delay == pytest.approx(0.064)


def test_what_was_never_sent_tells_nothing():
    way = flown([0.01] * ENOUGH)
    way.began(99.0, 99.5)
    assert way.delay == pytest.approx(0.01)
