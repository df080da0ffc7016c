"""Sliding windows of the flight monitor: counts of events, the greatest value of a quantity."""

import math

import numpy as np

from gcs.flight.detectors import MonitorAlarm
from gcs.flight.sliding_window import EventCounter, SlidingMaximum


def test_event_counter_forgets_events_after_its_window():
    events, key = EventCounter(2.0), ("vehicle 1", MonitorAlarm.MESSAGES_LOST)
    events.add(key, 0.0)
    events.add(key, 1.0, 2)
    assert events.recent(1.5) == {key: 3}
    assert events.recent(2.5) == {key: 2}
    assert events.recent(9.0) == {}


def test_sliding_maximum_is_the_greatest_value_of_the_window_with_its_time():
    values = np.random.default_rng(3).normal(size=200)
    sliding = SlidingMaximum(0.95)
    assert sliding.at(0.0) == (-math.inf, -math.inf)
    for k, value in enumerate(values):
        first = max(0, k - 9)
        greatest = first + int(np.argmax(values[first : k + 1]))
        sliding.add(0.1 * k, value)
        assert sliding.at(0.1 * k) == (0.1 * greatest, values[greatest])
    assert sliding.at(30.0) == (-math.inf, -math.inf)
