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


def test_setpoint_counted_as_lost_may_still_arrive(history):
    lost = history.confirm(1, 0.05, 0.14, SENT[1][SECOND], jitter=0.0)
    assert not lost.as_sent
    assert history.in_force(0.10, 0.15).u[SECOND] == pytest.approx(SENT[1][SECOND])
    assert history.loss[1] > history.loss[0]
    late = history.confirm(1, 0.145, 0.148, SENT[2][SECOND], jitter=0.0)
    assert late.as_sent and late.corrected_from == pytest.approx(0.10)
    mean = history.in_force(0.10, 0.15).u
    assert mean[SECOND] == pytest.approx(0.9 * SENT[1][SECOND] + 0.1 * SENT[2][SECOND])


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


def test_delay_of_setpoints_that_come_two_periods_late_is_measured():
    history, shift = SetpointHistory(N), 0.1
    delays = []  # each is overdue, and seems to be lost, when the one before is reported
    for k in range(8):
        history.add(0.05 * k, np.full(3 * N, 0.01 * k), np.full(N, 0.05 * k))
        if k >= 2:  # of the one that was sent two periods ago and acts now; its report comes a moment later
            since = 0.05 * (k - 2) + shift
            found = history.confirm(1, since, since + 0.03, np.full(3, 0.01 * (k - 2)), jitter=0.0, latency_max=0.2)
            delays.append(found.delay)
        if k > 3:
            assert found.late  # what makes the loss that was counted before undone
    assert delays.count(pytest.approx(shift)) >= 3
