"""Measurements in order of time, whatever the order of arrival, and the snapshots from which they are replayed."""

import math

import numpy as np
import pytest

from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.estimation.replay import MeasurementHistory, ReplayBuffer, Snapshot


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


DURATION = 0.5


def snapshot(time):
    return Snapshot(time, np.zeros(1), np.eye(1), None)


@pytest.fixture
def replay():
    """A buffer that began at 1 s, with the measurements until 1.4 s applied."""
    buffer = ReplayBuffer(DURATION, 0.002)
    assert buffer.time == -math.inf
    buffer.start(snapshot(1.0))
    for time in (1.1, 1.2, 1.3, 1.4):
        assert buffer.add(position(time)) and [moment.time for moment in buffer.pending()] == [time]
        buffer.snapshots.append(snapshot(time))
    return buffer


def times(replay):
    return [moment.time for moment in replay.pending()]


def test_later_measurement_is_pending_and_returns_to_no_snapshot(replay):
    assert replay.time == 1.4 and times(replay) == []
    assert replay.add(position(1.5)) and replay.time == 1.4 and times(replay) == [1.5]


@pytest.mark.parametrize(
    ("time", "before", "pending"),
    [(1.25, 1.2, [1.25, 1.3, 1.4]), (1.3, 1.2, [1.3, 1.4]), (1.4, 1.3, [1.4]), (1.01, 1.0, [1.01, 1.1, 1.2, 1.3, 1.4])],
)
def test_late_measurement_returns_to_the_snapshot_before_it(replay, time, before, pending):
    assert replay.add(position(time, source=1))
    assert replay.time == before and times(replay) == pending


def test_measurement_until_the_first_snapshot_is_too_old(replay):
    for time in (0.9, 1.0):
        assert not replay.add(position(time)) and replay.time == 1.4 and times(replay) == []


def test_measurement_older_than_the_duration_is_refused(replay):
    for time in (1.6, 1.7):
        replay.add(position(time))
        replay.snapshots.append(snapshot(time))
    assert not replay.add(position(1.7 - 1.01 * DURATION)) and replay.time == 1.7
    assert replay.add(position(1.7 - 0.99 * DURATION)) and replay.time == 1.2


def test_relay_of_an_applied_sample_of_the_payload_returns_to_no_snapshot(replay):
    assert replay.add(position(1.35, PAYLOAD)) and replay.time == 1.3
    replay.snapshots += [snapshot(1.35), snapshot(1.4)]
    assert replay.add(position(1.35, PAYLOAD)) and replay.time == 1.4 and times(replay) == []


def test_first_snapshot_is_never_lost(replay):
    replay.rewind(0.0)
    assert replay.time == 1.0 and times(replay) == [1.1, 1.2, 1.3, 1.4]


def test_forgetting_keeps_a_snapshot_from_which_the_whole_duration_can_be_replayed(replay):
    assert replay.forget() == 1.0
    for time in (1.65, 1.75):
        replay.add(position(time))
        replay.snapshots.append(snapshot(time))
    assert replay.forget() == 1.2
    replay.rewind(0.0)
    assert replay.time == 1.2 and times(replay) == [1.3, 1.4, 1.65, 1.75]
    replay.start(snapshot(9.0))
    assert replay.time == 9.0 and times(replay) == []
