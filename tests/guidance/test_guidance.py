"""Guidance without obstacles: progress rate in wind, and what is stopped at."""

import numpy as np
import pytest
from avoidance_scene import avoidance, straight
from paper_system import system

from idc_controller.model.drag import Air
from idc_controller.trajectory.spline import SUPPORT
from idc_controller.trajectory.trajectory import RestTrajectory, ScaledReference

STEP = 0.05
SPEED = 1.5
WEIGHT = system().m_0 * system().g


@pytest.fixture
def guidance():
    return avoidance([]).guidance


def rate_after(guidance, seconds, air, deviation=None, begin=8.0):
    """Progress rate after a while of a long straight mission at its cruise speed."""
    mission = straight(400.0, SPEED)
    guidance.restart(0.0, begin)
    for k in range(round(seconds / STEP)):
        guidance.reference(STEP * k, mission)
        guidance.observe(RestTrajectory(np.zeros(3)), 0.0, deviation, air)
    return guidance.rate


def headwind(share):
    """Air that makes a drag of that share of the limit on a payload that flies the mission at full rate."""
    wind = 6.0
    limit, relative = share * avoidance([]).guidance.settings.drag_limit * WEIGHT, wind + SPEED
    one = np.linalg.norm(Air(np.array([-wind, 0.0, 0.0]), np.ones(3), 0.0).on_payload(np.array([SPEED, 0.0, 0.0])))
    assert relative > 0.0
    return Air(np.array([-wind, 0.0, 0.0]), np.ones(3) * limit / one, 0.0)


@pytest.mark.parametrize(("share", "slowed"), [(0.99, False), (1.01, True)])
def test_progress_is_slowed_where_drag_exceeds_its_limit(guidance, share, slowed):
    rate = rate_after(guidance, 20.0, headwind(share))
    assert (rate < 1.0) is slowed
    if slowed:  # to the next of the rates that are tried
        assert rate > 1.0 - 1.01 * (1.0 - guidance.settings.slowest_in_wind) / 7.0


def test_progress_in_a_storm_is_the_slowest_and_recovers_without_wind(guidance):
    slowest = guidance.settings.slowest_in_wind
    assert rate_after(guidance, 30.0, headwind(4.0)) == pytest.approx(slowest)
    assert rate_after(guidance, 30.0, None) == 1.0


def test_wind_from_behind_does_not_slow(guidance):
    air = headwind(1.01)
    assert rate_after(guidance, 20.0, Air(-air.wind / 4.0, air.payload, air.uav)) == 1.0


def test_deflection_against_the_wind_counts(guidance):
    deviation = np.zeros((len(guidance._stages), 5, 3))
    deviation[10, 1, 0] = 1.0
    assert rate_after(guidance, 20.0, headwind(0.95)) == 1.0
    assert rate_after(guidance, 20.0, headwind(0.95), deviation) < 1.0


def test_mission_is_stopped_on_unless_the_payload_is_deflected(guidance):
    mission, tracked = straight(40.0, SPEED), straight(40.0, SPEED)
    assert guidance.stopping_trajectory(3.0, mission) == (mission, 3.0)
    guidance.reference(5.0, mission)
    guidance.observe(tracked, 0.0, None, None)
    followed, progress = guidance.stopping_trajectory(6.0, mission)
    assert followed is mission and progress == pytest.approx(6.0)


def test_deflected_payload_is_stopped_ahead_of_where_it_is(guidance):
    mission, tracked = straight(40.0, SPEED), straight(40.0, SPEED, altitude=7.0)
    guidance.reference(5.0, mission)
    guidance.observe(tracked, 0.0, np.zeros((len(guidance._stages), 5, 3)), None)
    rest, progress = guidance.stopping_trajectory(8.0, mission)
    position, velocity = tracked.derivatives(np.array([8.0]), 1)[:, 0]
    assert velocity[0] == pytest.approx(SPEED) and progress == rest.start == 8.0
    ahead = position + 0.5 * guidance.navigator.settings.limits.stopping_time(SPEED) * velocity
    assert rest.position(8.0) == pytest.approx(ahead) == rest.position(100.0)


def test_held_up_payload_is_stopped_ahead_of_where_it_is(guidance):
    mission = tracked = straight(40.0, SPEED)
    for k in range(40):
        guidance.reference(5.0 + STEP * k, mission)
        guidance.observe(tracked, 10.0, np.zeros((len(guidance._stages), 5, 3)), None)
    assert guidance.rate < 1.0
    rest, _ = guidance.stopping_trajectory(7.0, mission)
    assert isinstance(rest, RestTrajectory)


def test_slow_mission_is_stopped_from_the_speed_and_place_that_it_has(guidance):
    mission = tracked = straight(40.0, SPEED)
    guidance.speed_limit = 0.5 * SPEED
    for k in range(40):
        reference = guidance.reference(5.0 + STEP * k, mission)
        guidance.observe(tracked, 0.0, None, None)
    assert reference.rate == pytest.approx(0.5)
    time = reference.start + 0.5 * STEP
    followed, progress = guidance.stopping_trajectory(time, mission)
    stop = followed.stop(progress)
    assert stop.derivatives([progress])[:, 0] == pytest.approx(reference.derivatives(np.array([time]))[:, 0], abs=1e-9)
    assert 0.0 < stop.position(stop.end)[0] - stop.position(progress)[0] < SPEED


@pytest.mark.parametrize(("rate", "most"), [(1e-2, 128), (9e-3, 0), (1e-6, 0)])
def test_almost_resting_mission_is_stopped_as_at_rest_however_slow_it_is(guidance, rate, most):
    mission = straight(40.0, SPEED)
    guidance.reference(5.0, mission)
    guidance.observe(RestTrajectory(mission.position(8.0)), 0.0, None, None)
    guidance._current = ScaledReference(mission, 5.0, 8.0, rate)
    followed, _ = guidance.stopping_trajectory(5.0, mission)
    planned = len(mission._spline(8.0).control_points)  # at rest twice the support is added before each halving
    assert len(getattr(followed, "control_points", ())) <= most * (planned + 4 * SUPPORT)
    end = followed.stop(5.0).position(1e3)
    assert np.linalg.norm(end - mission.position(8.0)) < 0.05


@pytest.mark.parametrize(("share", "rate"), [(0.0, 1.0), (0.45, 1.0), (0.75, 0.5), (1.0, 0.0), (3.0, 0.0)])
def test_progress_slows_down_for_a_plan_that_misses_the_margin_and_rests_for_one_that_misses_all(guidance, share, rate):
    mission, missed = straight(400.0, SPEED), share * guidance.navigator.settings.margin
    for k in range(60):
        guidance.reference(8.0 + STEP * k, mission)
        guidance.observe(RestTrajectory(np.zeros(3)), 0.0, None, None, missed)
    assert guidance.rate == pytest.approx(rate, abs=1e-9)
