"""Measurement history: in order of time, whatever the order of arrival."""

import numpy as np

from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.estimation.replay import MeasurementHistory


def position(time, source=0):
    return Position(time, source, np.zeros(3), np.zeros(3))


def test_history_orders_moments_and_joins_simultaneous_measurements():
    history = MeasurementHistory(0.002)
    for time in (0.3, 0.1, 0.2, 0.1015):
        history.add(position(time, source=round(1e4 * time)), applied=0.0)
    assert [moment.time for moment in history.after(0.0)] == [0.1, 0.2, 0.3]
    assert len(history.after(0.0)[0].measurements) == 2
    assert [moment.time for moment in history.after(0.1)] == [0.2, 0.3]


def test_history_returns_time_of_moment_to_replay_from():
    history = MeasurementHistory(0.002)
    assert history.add(position(0.1), applied=0.0) == 0.1
    assert history.add(position(0.1015, source=1), applied=0.2) == 0.1
    assert history.add(position(0.05), applied=0.2) == 0.05


def test_history_ignores_relay_of_applied_payload_sample():
    history = MeasurementHistory(0.002)
    assert history.add(position(0.1, PAYLOAD), applied=0.0) == 0.1
    assert history.add(position(0.1, PAYLOAD), applied=0.0) == 0.1
    assert history.add(position(0.1, PAYLOAD), applied=0.1) is None
    (moment,) = history.after(0.0)
    assert len(moment.measurements[PAYLOAD, Position]) == 2


def test_history_discards_moments_until_time():
    history = MeasurementHistory(0.002)
    for time in (0.1, 0.2, 0.3):
        history.add(position(time), applied=0.0)
    history.forget(0.2)
    assert [moment.time for moment in history.after(0.0)] == [0.3]
    assert history.has((0, Position), since=0.2) and not history.has((0, Position), since=0.3)
    assert not history.has((0, Attitude), since=0.0)
