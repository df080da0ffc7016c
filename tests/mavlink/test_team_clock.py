"""Team clock, timers of the ground, and the schedule of delayed set-points."""

import math

import pytest

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.setpoint_schedule import SetpointSchedule
from gcs.flight.team_clock import IntervalTimer, StepTimer, TeamClock

S = DEFAULTS.timing


def clock_at(offset, now=1.0):
    clock = TeamClock()
    clock.follow(offset, now, connecting=True)
    return clock


def test_team_time_is_ground_time_until_a_clock_is_known():
    assert TeamClock().time(2.5) == 2.5
    assert clock_at(10.0).time(2.5) == 12.5


def test_clock_that_jumps_is_followed_while_connecting_only():
    clock = clock_at(10.0)
    clock.follow(500.0, 2.0, connecting=True)
    assert clock.offset == 500.0
    for jump in (1.1 * S.clock_step, -1.1 * S.clock_step):
        clock.follow(500.0 + jump, 3.0, connecting=False)
        assert clock.offset == 500.0


def test_clock_held_back_is_followed_at_once_and_one_that_leads_slowly():
    clock = clock_at(10.0)
    clock.follow(9.9, 2.0, connecting=False)
    assert clock.offset == 9.9
    clock.follow(10.0, 2.1, connecting=False)
    assert clock.offset == 10.0
    ahead = clock_at(10.0)
    rise = min(S.lead_limit, 0.5 * S.lead_rate)
    ahead.follow(10.0 + 10.0 * rise, 1.5, connecting=False)
    assert ahead.offset == pytest.approx(10.0 + rise)


def test_interval_timer_is_due_at_first_and_once_an_interval():
    timer = IntervalTimer(0.5)
    due = [now for now in (3.0, 3.2, 3.5, 3.9, 4.6, 5.0, 5.1) if timer.is_due(now)]
    assert due == [3.0, 3.5, 4.6, 5.1]
    assert timer.next == pytest.approx(5.6)


def test_steps_are_on_whole_periods_of_team_time():
    timer, clock = StepTimer(0.05), clock_at(0.012)
    assert timer.is_due(0.0) and timer.begin(0.0, clock, connecting=False)
    assert timer.next == pytest.approx(0.05 - 0.012)
    assert not timer.is_due(timer.next - 0.001)
    assert timer.is_due(timer.next) and timer.begin(timer.next, clock, connecting=False)
    assert timer.next == pytest.approx(0.1 - 0.012)


def test_step_is_omitted_where_team_time_was_set_back():
    timer, clock = StepTimer(0.05), clock_at(0.0, now=0.0)
    assert timer.begin(1.0, clock, connecting=False)
    clock.follow(-0.1, 1.05, connecting=False)
    assert not timer.begin(1.05, clock, connecting=False)
    assert timer.begin(1.05, clock, connecting=True)


def test_set_points_over_short_links_wait_for_the_longest():
    schedule = SetpointSchedule()
    least = S.simultaneous
    waits = schedule.waits([0.1, 0.1 - 2.0 * least, 0.1 - 0.5 * least])
    assert waits == pytest.approx([0.0, 2.0 * least, 0.0])
    assert schedule.next_due == math.inf
    schedule.add(1.2, 0, ["late"])
    schedule.add(1.1, 2, ["early"])
    assert schedule.next_due == 1.1
    assert schedule.take(1.09) == [] and schedule.take(1.1) == [(2, ["early"])]
    assert schedule.next_due == 1.2
    schedule.clear()
    assert schedule.take(9.0) == [] and schedule.next_due == math.inf


def test_compute_latency_is_the_median_of_the_last_steps():
    schedule = SetpointSchedule()
    for duration in (0.001, 0.5, 0.003):
        schedule.add_latency(duration)
    assert schedule.latency == 0.003
    for _ in range(S.latency_steps):
        schedule.add_latency(0.02)
    assert schedule.latency == 0.02
