"""Sliding windows of the flight monitor: counts of events, range of a quantity."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.alarms import AlarmLog
from gcs.flight.detectors import LinkTiming, MonitorAlarm
from gcs.flight.monitor_step import MonitorStep
from gcs.flight.sliding_window import EventCounter, SlidingRange


def test_event_counter_forgets_events_after_its_window():
    events, key = EventCounter(2.0), ("vehicle 1", MonitorAlarm.MESSAGES_LOST)
    events.add(key, 0.0)
    events.add(key, 1.0, 2)
    assert events.recent(1.5) == {key: 3}
    assert events.recent(2.5) == {key: 2}
    assert events.recent(9.0) == {}


def test_sliding_range_is_greatest_less_least_value_of_the_window():
    values = np.random.default_rng(3).normal(size=200)
    sliding = SlidingRange(0.95)
    for k, value in enumerate(values):
        window = values[max(0, k - 9) : k + 1]
        assert sliding.add(0.1 * k, value) == pytest.approx(window.max() - window.min())


def test_moved_clock_is_reported_for_its_window_though_team_time_steps_back():
    settings = replace(DEFAULTS.monitor, hold_time=-math.inf)  # every step that raises it counts
    log = AlarmLog(settings=settings)
    clock = SimpleNamespace(offset=0.0, delay=0.0, spread=0.0)
    flight = SimpleNamespace(system=SimpleNamespace(team=SimpleNamespace(links=(SimpleNamespace(clock=clock),))))
    detector, reported = LinkTiming(settings, 0.05, 1), []
    for k in range(round(5.0 * settings.clock_window / 0.05)):
        now = 0.05 * k
        # The clock moves once; so does team time, which follows it.
        clock.offset = -2.0 * settings.clock_window if now >= settings.clock_window else 0.0
        step = MonitorStep(
            now + clock.offset, now, flight, None, log, None, True, ("vehicle 1", "payload"), clear=True, steady=True
        )
        number = len(log.alarms)
        detector(step)
        if len(log.alarms) > number:
            reported.append(now)
    assert reported[0] == pytest.approx(settings.clock_window)
    assert reported[-1] == pytest.approx(2.0 * settings.clock_window, abs=0.15)
