"""Set-point history: what vehicles report of the set-points they flew."""

import numpy as np
import pytest

from idc_controller.estimation.setpoint_history import SetpointHistory

N = 2
SECOND = [2, 3, 5]  # the second vehicle's tilt (north, east) and thrust
LATENCY = 0.12  # s, nominal, of set-points
SENT = [np.full(3 * N, 0.01 * k) for k in range(5)]


@pytest.fixture
def history():
    history = SetpointHistory(N)
    for k, u in enumerate(SENT):
        history.add(0.05 * k, u, np.full(N, 0.05 * k - LATENCY))
    return history


def test_unconfirmed_setpoint_is_in_force_at_its_nominal_time(history):
    force = history.in_force(0.10, 0.15)
    assert force.u is SENT[2]
    assert force.change == pytest.approx(SENT[2] - SENT[1])
    assert (force.previous == 0.005).all()


def test_late_setpoint_is_in_force_from_reported_time(history):
    found = history.confirm(1, 0.12, 0.14, SENT[2][SECOND], jitter=0.01)
    assert found is not None and found.as_sent
    assert found.corrected_from == pytest.approx(0.10)
    mean = history.in_force(0.10, 0.15).u
    assert mean[SECOND] == pytest.approx(0.4 * SENT[1][SECOND] + 0.6 * SENT[2][SECOND])
    assert mean[[0, 1, 4]] == pytest.approx(SENT[2][[0, 1, 4]])
    assert history.in_force(0.05, 0.10).u[SECOND] == pytest.approx(SENT[1][SECOND])


def test_early_setpoint_is_in_force_from_reported_time(history):
    found = history.confirm(1, 0.08, 0.11, SENT[2][SECOND], jitter=0.02)
    assert found.corrected_from == pytest.approx(0.08)
    mean = history.in_force(0.05, 0.10).u
    assert mean[SECOND] == pytest.approx(0.6 * SENT[1][SECOND] + 0.4 * SENT[2][SECOND])


def test_confirmed_setpoint_is_less_uncertain(history):
    history.confirm(1, 0.10, 0.14, SENT[2][SECOND], jitter=0.01)
    first, second = history.in_force(0.10, 0.15).previous
    assert second < first
    unknown = history.in_force(0.15, 0.20).previous
    assert unknown[1] == pytest.approx(0.005 + (0.01 / 0.05) ** 2)  # it may come late by as much


def test_setpoint_counted_as_lost_may_still_arrive(history):
    lost = history.confirm(1, 0.05, 0.14, SENT[1][SECOND], jitter=0.0)
    assert not lost.as_sent
    assert history.in_force(0.10, 0.15).u[SECOND] == pytest.approx(SENT[1][SECOND])
    assert history.loss[1] > history.loss[0]
    late = history.confirm(1, 0.145, 0.148, SENT[2][SECOND], jitter=0.0)
    assert late.as_sent and late.corrected_from == pytest.approx(0.10)
    mean = history.in_force(0.10, 0.15).u
    assert mean[SECOND] == pytest.approx(0.9 * SENT[1][SECOND] + 0.1 * SENT[2][SECOND])


def test_repeated_report_changes_nothing(history):
    history.confirm(1, 0.12, 0.13, SENT[2][SECOND], jitter=0.01)
    again = history.confirm(1, 0.12, 0.14, SENT[2][SECOND], jitter=0.01)
    assert again is not None and again.corrected_from is None


def test_report_of_unsent_setpoint_is_ignored(history):
    assert history.confirm(1, 0.10, 0.14, np.array([0.3, 0.3, 9.0]), jitter=0.0) is None
    assert history.in_force(0.10, 0.15).u is SENT[2]


def test_no_setpoint_is_in_force_while_vehicles_are_held(history):
    history.add(0.25, None)
    assert history.in_force(0.26, 0.30).u is None
    assert history.confirm(1, 0.25, 0.28, SENT[4][SECOND], jitter=0.0) is not None


def test_history_keeps_setpoints_that_may_still_be_in_force(history):
    history.forget(0.19)
    assert history.switches(-1.0, 1.0) == pytest.approx([0.0, 0.05, 0.10, 0.15, 0.20])
    history.add(0.25, SENT[0])
    history.forget(0.26)
    assert history.switches(-1.0, 1.0) == pytest.approx([0.10, 0.15, 0.20, 0.25])


def test_delay_of_setpoint_is_returned_once(history):
    first = history.confirm(1, 0.12, 0.13, SENT[2][SECOND], jitter=0.01)
    assert first.delay == pytest.approx(0.02 + LATENCY)
    again = history.confirm(1, 0.12, 0.14, SENT[2][SECOND], jitter=0.01)
    assert again.delay is None


def test_setpoint_long_before_its_time_is_found(history):
    early = history.confirm(1, 0.09, 0.11, SENT[4][SECOND], jitter=0.0)
    assert early is not None and early.as_sent is None
    assert early.delay == pytest.approx(LATENCY - 0.11)
    assert history.in_force(0.10, 0.15).u[SECOND] == pytest.approx(SENT[4][SECOND])


def test_equal_setpoints_have_no_delay():
    history = SetpointHistory(N)
    for k in range(5):
        history.add(0.05 * k, SENT[1])
    found = history.confirm(1, 0.10, 0.14, SENT[1][SECOND], jitter=0.0)
    assert found is None or found.delay is None


def test_setpoint_sent_after_a_late_one_is_expected_late():
    history = SetpointHistory(N)
    for k, u in enumerate(SENT):
        history.add(0.05 * k + 0.01, u, np.full(N, 0.05 * k))
    found = history.confirm(1, 0.17, 0.171, SENT[2][SECOND], jitter=0.0)
    assert found.delay == pytest.approx(0.07)
    assert found.corrected_from == pytest.approx(0.11)
    mean = history.in_force(0.16, 0.21).u  # where the next one should have acted
    assert mean[SECOND] == pytest.approx(0.2 * SENT[1][SECOND] + 0.8 * SENT[2][SECOND])
    assert mean[[0, 1, 4]] == pytest.approx(SENT[3][[0, 1, 4]])


@pytest.mark.parametrize("since", [0.05, 0.19])
def test_impossible_time_of_effect_is_ignored(since):
    history = SetpointHistory(N)
    for k, u in enumerate(SENT):
        history.add(0.05 * k + 0.004, u, np.full(N, 0.05 * k))
    found = history.confirm(1, since, 0.11, SENT[2][SECOND], jitter=0.0, latency_max=0.03)
    assert found is None or (found.delay is None and found.corrected_from is None)
    assert history.in_force(0.104, 0.154).u is SENT[2]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_effect_of_equal_setpoints_is_that_of_the_first_of_them(count):
    history, values = SetpointHistory(N), [SENT[0], *[SENT[1]] * count, SENT[2]]
    for k, u in enumerate(values):
        history.add(0.05 * k, u, np.full(N, 0.05 * k - LATENCY))
    found = history.confirm(1, 0.06, 0.05 * count + 0.02, SENT[1][SECOND], jitter=0.01)
    assert found.corrected_from == pytest.approx(0.05)
    assert history.in_force(0.05, 0.10).u[SECOND] == pytest.approx(0.2 * SENT[0][SECOND] + 0.8 * SENT[1][SECOND])
    assert found.delay == (pytest.approx(0.01 + LATENCY) if count == 1 else None)
