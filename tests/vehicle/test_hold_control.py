"""HOLD and LAND: attitude and thrust that follow from the plan, from what is measured, and from the limits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcs.config.vehicle_settings import HoldSettings
from idc_controller.rotations import rotation_from_quaternion
from idc_controller.trajectory.settings import BrakingSettings
from vehicle_sim.autopilot.hold_control import HoldController, HoldPlan
from vehicle_sim.world.sensors import Measurement

GAINS = HoldSettings()
G = 9.81
HOVER, LEAST = 20.0, 12.0
"""N: thrust that carries the vehicle and its share of the payload, and the vehicle alone."""
CALM = (0.0, 0.0)
"""Lean against no wind."""
HERE = (3.0, -2.0, -6.0)
STAY = HoldPlan(0.0, 1.0, (HERE,) * 5, 0.4)


def measured(position=HERE, velocity=(0.0, 0.0, 0.0)):
    return Measurement(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), tuple(position), tuple(velocity))


def force_of(command):
    """Force (3,) in the world (NED, N) of an attitude and a thrust."""
    attitude, thrust = command
    return -thrust * rotation_from_quaternion(np.array(attitude))[:, 2]


def bounded(vector, limit):
    size = np.linalg.norm(vector)
    return vector if size <= limit else vector * (limit / size)


class PlainHold:
    """The force of a hold by vectors: PID horizontally, PD vertically, each part of it bounded."""

    def __init__(self, plan, integral_max):
        self.plan, self.integral_max = plan, integral_max
        self.integral, self.last, self.stands_at = np.zeros(2), plan.start, None
        self.stands_since, self.thrust, self.handed_over = 0.0, HOVER, HOVER

    def force(self, sample, now, supported):
        position, velocity = np.array(sample.position), np.array(sample.velocity)
        if supported:
            if self.stands_at is None:
                self.stands_at, self.stands_since, self.handed_over = position, now, self.thrust
            share = max(1.0 - (now - self.stands_since) / GAINS.unload_time, 0.0)
            wanted, carried = (self.stands_at, np.zeros(3), np.zeros(3)), LEAST + share * (self.handed_over - LEAST)
        else:
            self.stands_at = None
            wanted, carried = tuple(map(np.array, self.plan.at(now))), HOVER
        step = min(max(now - self.last, 0.0), GAINS.step_max)
        self.last = now
        error, drift = wanted[0] - position, wanted[1] - velocity
        integral = bounded(self.integral + GAINS.horizontal_ki * step * error[:2], self.integral_max)
        if not supported:
            self.integral = integral
        up = wanted[2][2] + GAINS.vertical_kp * error[2] + GAINS.vertical_kd * drift[2]
        up = np.clip(up, -GAINS.vertical_max * G, (1.0 - LEAST / HOVER) * G)
        tension = np.clip((carried * (G - up) / G - LEAST) / (HOVER - LEAST), 0.0, 1.0)
        integral = tension * (self.integral if supported else integral)
        level = wanted[2][:2] + GAINS.horizontal_kp * error[:2] + GAINS.horizontal_kd * drift[:2]
        level = bounded(level + integral, GAINS.horizontal_max * G)
        force = carried / G * np.array([*level, up - G])
        force = bounded(force, carried) if supported else force
        self.thrust = max(np.linalg.norm(force), LEAST)
        return force


@settings(deadline=None, derandomize=True, max_examples=20)
@given(seed=st.integers(0, 10**6), spread=st.sampled_from([0.1, 1.0, 30.0]), integral_max=st.sampled_from([0.02, 2.5]))
def test_force_follows_from_plan_and_measurement(seed, spread, integral_max):
    random = np.random.default_rng(seed)
    descent = () if random.random() < 0.5 else (1.5, 0.6, 0.8)
    plan = HoldPlan.to_rest(0.5, HERE, (1.5, -1.0, 0.4), 0.4, BrakingSettings(), *descent)
    gains = replace(GAINS, integral_max=integral_max)
    controller, plain = HoldController(plan, HOVER, CALM, LEAST, G, gains), PlainHold(plan, integral_max)
    now = 0.4
    for _ in range(40):
        sample = measured(np.array(plan.at(now).position) + spread * random.normal(size=3), random.normal(size=3))
        supported = bool(random.random() < 0.3)
        expected = plain.force(sample, now, supported)
        attitude, thrust = controller.command(sample, now, supported)
        assert thrust == pytest.approx(max(np.linalg.norm(expected), LEAST), rel=1e-9)
        np.testing.assert_allclose(
            force_of((attitude, thrust)) / thrust, expected / np.linalg.norm(expected), atol=1e-9
        )
        now += random.choice([-0.02, 0.004, 0.05, 0.3])


def test_vehicle_at_its_place_hovers_with_the_yaw_of_the_plan():
    attitude, thrust = HoldController(STAY, HOVER, CALM, LEAST, G, GAINS).command(measured(), 1.0)
    assert attitude == pytest.approx((math.cos(0.2), 0.0, 0.0, math.sin(0.2)))
    assert thrust == pytest.approx(HOVER)


@pytest.mark.parametrize(("aside", "down"), [((50.0, 0.0), 0.0), ((-30.0, 40.0), 0.0), ((0.0, 0.0), -50.0)])
def test_far_from_its_place_acceleration_is_at_its_limit_towards_it(aside, down):
    position = np.add(HERE, (*aside, down))
    force = force_of(HoldController(STAY, HOVER, CALM, LEAST, G, GAINS).command(measured(position), 0.0)) / HOVER
    size = np.hypot(*aside)
    level = np.zeros(2) if size == 0.0 else -GAINS.horizontal_max * np.array(aside) / size
    vertical = -LEAST / HOVER if down < 0.0 else -1.0
    np.testing.assert_allclose(force, [*level, vertical], atol=1e-9)


def test_vehicle_leans_against_the_wind_of_the_stop_plan_at_once():
    force = force_of(HoldController(STAY, HOVER, (0.1, -0.05), LEAST, G, GAINS).command(measured(), 0.0)) / HOVER
    np.testing.assert_allclose(force, [0.1, -0.05, -1.0], atol=1e-9)


def test_error_by_dead_reckoning_is_followed_at_first_and_not_for_good():
    controller = HoldController(STAY, HOVER, CALM, LEAST, G, GAINS)
    beside = measured(np.add(HERE, (0.5, 0.0, 0.0)), (0.0, 0.2, 0.0))
    forces = [force_of(controller.command(beside, 0.02 * k, reckoned=True)) for k in range(1501)]
    wanted = -HOVER / G * np.array([0.5 * GAINS.horizontal_kp, 0.2 * GAINS.horizontal_kd])
    np.testing.assert_allclose(forces[0][:2], wanted, rtol=0.02)
    integral = HOVER / G * GAINS.horizontal_ki * 0.5 * GAINS.reckoning_washout  # that of the error while it lasted
    np.testing.assert_allclose(forces[-1][:2], [-integral, 0.0], rtol=0.02, atol=1e-3)


def test_drift_of_a_dead_reckoning_is_forgotten_with_the_next_position():
    controller = HoldController(STAY, HOVER, CALM, LEAST, G, replace(GAINS, horizontal_ki=0.0))
    for k in range(100):
        controller.command(measured(np.add(HERE, (0.5, 0.0, 0.0)), (0.2, 0.0, 0.0)), 0.02 * k, reckoned=True)
    controller.command(measured(), 2.0)
    assert force_of(controller.command(measured(), 2.02, reckoned=True))[:2] == pytest.approx((0.0, 0.0), abs=1e-9)


def test_thrust_is_never_less_than_the_least_in_the_air():
    above = np.array(HERE) - [0.0, 0.0, 50.0]
    assert HoldController(STAY, HOVER, CALM, 15.0, G, GAINS).command(measured(above), 0.0)[1] == 15.0


def test_vehicle_of_a_standing_payload_stays_where_it_was_then():
    """It hands the payload over with what holds its link, and forgets nothing that it has learned of the wind."""
    controller = HoldController(STAY, HOVER, CALM, LEAST, G, GAINS)
    for k in range(14, 20):
        before = controller.command(measured((2.0, -2.0, -6.0)), 0.1 * k)
    beside, handed_over = measured((9.0, 9.0, -3.0)), before[1]
    tilts = []
    for share in (1.0, 0.5, 0.25):
        command = controller.command(beside, 2.0 + (1.0 - share) * GAINS.unload_time, supported=True)
        assert command[1] == pytest.approx(LEAST + share * (handed_over - LEAST))
        tilts.append(force_of(command)[:2] / command[1] / share)
    assert np.linalg.norm(tilts[0]) > 0.01
    np.testing.assert_allclose(tilts, [tilts[0]] * 3, rtol=0.05, atol=1e-9)  # but for what it lifted above the hover
    end = 2.0 + GAINS.unload_time
    attitude, thrust = controller.command(beside, end, supported=True)
    assert thrust == pytest.approx(LEAST) and attitude[1:3] == pytest.approx((0.0, 0.0))
    moved = controller.command(measured((9.1, 9.0, -3.0)), end, supported=True)
    assert force_of(moved)[0] == pytest.approx(-0.1 * GAINS.horizontal_kp / G * LEAST, rel=1e-3)
    np.testing.assert_allclose(force_of(controller.command(measured((2.0, -2.0, -6.0)), end)), force_of(before))


def test_stop_ends_at_rest_where_braking_at_the_limit_leads():
    """Along the horizontal velocity, within the limit of deceleration, at the altitude of the start."""
    braking = BrakingSettings()
    for speed in (0.2, 5.0):
        velocity = (0.6 * speed, -0.8 * speed, 0.5)
        plan = HoldPlan.to_rest(10.0, HERE, velocity, 0.1, braking)
        assert plan.at(9.0) == plan.at(10.0)
        start, end = plan.at(10.0), plan.at(10.0 + plan.duration)
        np.testing.assert_allclose([*start.position, *start.velocity], [*HERE, *velocity[:2], 0.0], atol=1e-12)
        np.testing.assert_allclose([*end.velocity, *end.acceleration], 0.0, atol=1e-12)
        assert end.position[2] == HERE[2]
        sizes = [math.hypot(*plan.at(10.0 + t).acceleration) for t in np.linspace(0.0, plan.duration, 201)]
        assert plan.duration >= braking.time and max(sizes) <= braking.deceleration * (1.0 + 1e-9)
        assert plan.duration == braking.time or max(sizes) == pytest.approx(braking.deceleration, rel=1e-3)


def test_descent_gains_its_speed_evenly_and_keeps_it():
    plan = HoldPlan(0.0, 1.0, (HERE,) * 5, 0.0, 5.0, 0.6, 2.0)
    assert [plan.is_descending(t) for t in (5.0, 5.01)] == [False, True]
    assert [plan.is_at_descent_speed(t) for t in (7.0, 7.01)] == [False, True]
    for after, (depth, speed, acceleration) in {
        0.0: (0.0, 0.0, 0.0), 1.0: (0.15, 0.3, 0.3), 1.9: (0.5415, 0.57, 0.3), 2.5: (0.9, 0.6, 0.0),
    }.items():  # fmt: skip
        state = plan.at(5.0 + after)
        assert (state.position[2] - HERE[2], state.velocity[2], state.acceleration[2]) == pytest.approx(
            (depth, speed, acceleration)
        )
