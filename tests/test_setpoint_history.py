"""What vehicles say of the set-points that they fly, and what the history makes of it."""

import numpy as np
import pytest

from idc_controller.estimation.setpoint_history import SetpointHistory

N = 2
SECOND = [2, 3, 5]  # the second vehicle's tilt (north, east) and thrust
WAY = 0.12  # s that set-points should take
SENT = [np.full(3 * N, 0.01 * k) for k in range(5)]


@pytest.fixture
def history():
    history = SetpointHistory(N, least_loss=0.005)
    for k, u in enumerate(SENT):
        history.add(0.05 * k, u, np.full(N, 0.05 * k - WAY))
    return history


def test_what_was_never_told_of_acts_when_it_should(history):
    force = history.in_force(0.10, 0.15)
    assert force.u is SENT[2]
    assert force.change == pytest.approx(SENT[2] - SENT[1])
    assert (force.doubt == 0.005).all()


def test_one_that_came_late_acts_from_then_on(history):
    told = history.confirm(1, 0.12, 0.14, SENT[2][SECOND], spread=0.01)
    assert told is not None and told.as_sent
    assert told.corrected_from == pytest.approx(0.10)
    mean = history.in_force(0.10, 0.15).u
    assert mean[SECOND] == pytest.approx(0.4 * SENT[1][SECOND] + 0.6 * SENT[2][SECOND])
    assert mean[[0, 1, 4]] == pytest.approx(SENT[2][[0, 1, 4]])
    assert history.in_force(0.05, 0.10).u[SECOND] == pytest.approx(SENT[1][SECOND])


def test_one_that_came_early_acts_before_its_time(history):
    told = history.confirm(1, 0.08, 0.11, SENT[2][SECOND], spread=0.02)
    assert told.corrected_from == pytest.approx(0.08)
    mean = history.in_force(0.05, 0.10).u
    assert mean[SECOND] == pytest.approx(0.6 * SENT[1][SECOND] + 0.4 * SENT[2][SECOND])


def test_what_is_told_is_doubted_less(history):
    history.confirm(1, 0.10, 0.14, SENT[2][SECOND], spread=0.01)
    first, second = history.in_force(0.10, 0.15).doubt
    assert second < first
    unknown = history.in_force(0.15, 0.20).doubt
    assert unknown[1] == pytest.approx(0.005 + (0.01 / 0.05) ** 2)  # it may come late by as much


def test_one_that_was_taken_for_lost_may_still_come(history):
    lost = history.confirm(1, 0.05, 0.14, SENT[1][SECOND], spread=0.0)
    assert not lost.as_sent
    assert history.in_force(0.10, 0.15).u[SECOND] == pytest.approx(SENT[1][SECOND])
    assert history.loss[1] > history.loss[0]
    late = history.confirm(1, 0.145, 0.148, SENT[2][SECOND], spread=0.0)
    assert late.as_sent and late.corrected_from == pytest.approx(0.10)
    mean = history.in_force(0.10, 0.15).u
    assert mean[SECOND] == pytest.approx(0.9 * SENT[1][SECOND] + 0.1 * SENT[2][SECOND])


def test_the_same_told_again_changes_nothing(history):
    history.confirm(1, 0.12, 0.13, SENT[2][SECOND], spread=0.01)
    again = history.confirm(1, 0.12, 0.14, SENT[2][SECOND], spread=0.01)
    assert again is not None and again.corrected_from is None


def test_words_of_what_was_never_sent_are_not_believed(history):
    assert history.confirm(1, 0.10, 0.14, np.array([0.3, 0.3, 9.0]), spread=0.0) is None
    assert history.in_force(0.10, 0.15).u is SENT[2]


def test_held_vehicles_fly_nothing(history):
    history.add(0.25, None)
    assert history.in_force(0.26, 0.30).u is None
    assert history.confirm(1, 0.25, 0.28, SENT[4][SECOND], spread=0.0) is not None


def test_what_is_over_is_forgotten_but_for_what_may_still_act(history):
    history.forget(0.19)
    assert history.switches(-1.0, 1.0) == pytest.approx([0.0, 0.05, 0.10, 0.15, 0.20])
    history.add(0.25, SENT[0])
    history.forget(0.26)
    assert history.switches(-1.0, 1.0) == pytest.approx([0.10, 0.15, 0.20, 0.25])


def test_when_one_began_is_told_once(history):
    first = history.confirm(1, 0.12, 0.13, SENT[2][SECOND], spread=0.01)
    assert first.delay == pytest.approx(0.02 + WAY)
    again = history.confirm(1, 0.12, 0.14, SENT[2][SECOND], spread=0.01)
    assert again.delay is None


def test_one_that_comes_long_before_its_time_is_found(history):
    early = history.confirm(1, 0.09, 0.11, SENT[4][SECOND], spread=0.0)
    assert early is not None and early.as_sent is None
    assert early.delay == pytest.approx(WAY - 0.11)
    assert history.in_force(0.10, 0.15).u[SECOND] == pytest.approx(SENT[4][SECOND])


def test_of_equal_ones_it_cannot_be_told_how_long_they_took():
    history = SetpointHistory(N, least_loss=0.005)
    for k in range(5):
        history.add(0.05 * k, SENT[1])
    told = history.confirm(1, 0.10, 0.14, SENT[1][SECOND], spread=0.0)
    assert told is None or told.delay is None


def test_what_left_after_one_that_came_late_is_expected_late():
    history = SetpointHistory(N, least_loss=0.005)
    for k, u in enumerate(SENT):
        history.add(0.05 * k + 0.01, u, np.full(N, 0.05 * k))
    told = history.confirm(1, 0.17, 0.171, SENT[2][SECOND], spread=0.0)
    assert told.delay == pytest.approx(0.07)
    assert told.corrected_from == pytest.approx(0.11)
    mean = history.in_force(0.16, 0.21).u  # where the next one should have acted
    assert mean[SECOND] == pytest.approx(0.2 * SENT[1][SECOND] + 0.8 * SENT[2][SECOND])
    assert mean[[0, 1, 4]] == pytest.approx(SENT[3][[0, 1, 4]])


@pytest.mark.parametrize("since", [0.05, 0.19])
def test_a_beginning_that_cannot_be_is_not_believed(since):
    history = SetpointHistory(N, least_loss=0.005)
    for k, u in enumerate(SENT):
        history.add(0.05 * k + 0.004, u, np.full(N, 0.05 * k))
    told = history.confirm(1, since, 0.11, SENT[2][SECOND], spread=0.0, longest=0.03)
    assert told is None or (told.delay is None and told.corrected_from is None)
    assert history.in_force(0.104, 0.154).u is SENT[2]
