"""State estimate on board while a sensor fails: attitude and rates of a turning body."""

import math

import numpy as np
import pytest
from flying import AIRFRAME
from quaternions import quaternion_product

from gcs.config.vehicle_settings import LandDetectorSettings, NavigationSettings
from vehicle_sim.autopilot.navigation import Navigation
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import THRUST
from vehicle_sim.world.sensors import Measurement

STEP, LAG, NOISE = 0.004, 0.05, math.radians(0.2)
NAN = (math.nan,) * 3


def navigation_alone():
    """The navigation of a team of one, whose samples all come to ``update``."""
    return Navigation(LAG, AIRFRAME.g, NavigationSettings(), OnboardArrays.of([AIRFRAME], LandDetectorSettings()))


class Turning:
    """A body whose angular acceleration follows the command with motor lag; (attitude, rates, commanded)."""

    def __init__(self, seed=0, noise=NOISE):
        self.rng, self.noise = np.random.default_rng(seed), noise
        self.time, self.attitude = 0.0, np.array([1.0, 0.0, 0.0, 0.0])
        self.rates, self.acceleration, self.commanded = np.zeros(3), np.zeros(3), np.zeros(3)

    def step(self):
        self.time += STEP
        self.commanded = 6.0 * np.array([math.sin(7.0 * self.time), math.cos(5.0 * self.time), 0.2])
        self.acceleration += (1.0 - math.exp(-STEP / LAG)) * (self.commanded - self.acceleration)
        self.rates = self.rates + STEP * (self.acceleration - 0.5 * self.rates)
        self.attitude = quaternion_product(self.attitude, np.append(1.0, 0.5 * STEP * self.rates))
        self.attitude /= np.linalg.norm(self.attitude)

    def sample(self, **wrong):
        error = np.append(1.0, 0.5 * self.rng.normal(0.0, self.noise, 3))
        measured = quaternion_product(self.attitude, error)
        return Measurement(
            self.time, tuple(measured / np.linalg.norm(measured)), tuple(self.rates + self.rng.normal(0.0, 0.01, 3)),
            tuple(self.rng.normal(0.0, 0.02, 3)), tuple(self.rng.normal(0.0, 0.02, 3)),
        )._replace(**wrong)  # fmt: skip


def angle(a, b):
    return 2.0 * math.acos(min(abs(float(np.dot(a, b))), 1.0))


def flown(wrong, duration=4.0, healthy=0.5):
    """[(estimated, true attitude, true rates, reported)] of samples of which ``wrong(sample)`` is off after a while."""
    body, navigation, found = Turning(), navigation_alone(), []
    while body.time < duration:
        body.step()
        sample = body.sample()
        estimated = navigation.update(
            sample if body.time < healthy else wrong(sample), tuple(body.commanded), body.time
        )
        if body.time > healthy + 0.1:
            found.append((estimated, body.attitude, body.rates, navigation.reported))
    return found


def stuck(channel):
    first = []

    def wrong(sample):
        first.append(getattr(sample, channel))
        return sample._replace(**{channel: first[0]})

    return wrong


def test_valid_samples_are_used_unchanged():
    navigation, body = navigation_alone(), Turning()
    for _ in range(10):
        body.step()
        sample = body.sample()
        assert navigation.update(sample, (0.0, 0.0, 0.0), sample.time) == sample == navigation.reported


@pytest.mark.parametrize("wrong", [lambda s: s._replace(rates=NAN), stuck("rates")])
def test_rates_are_estimated_from_attitude_when_rates_are_lost(wrong):
    found = flown(wrong)
    off = [np.linalg.norm(np.subtract(estimated.rates, rates)) for estimated, _, rates, _ in found]
    assert np.sqrt(np.mean(np.square(off))) < 0.1
    assert max(np.linalg.norm(rates) for _, _, rates, _ in found) > 0.5
    assert all(math.isnan(reported.rates[0]) and math.isfinite(reported.attitude[0]) for *_, reported in found)


@pytest.mark.parametrize("wrong", [lambda s: s._replace(attitude=(math.nan,) * 4), stuck("attitude")])
def test_attitude_is_integrated_from_rates_when_attitude_is_lost(wrong):
    assert max(angle(estimated.attitude, attitude) for estimated, attitude, _, _ in flown(wrong, duration=2.0)) < 0.03


def test_attitude_is_constant_when_attitude_and_rates_are_lost():
    estimated = [k for k, *_ in flown(lambda s: s._replace(attitude=(math.nan,) * 4, rates=NAN))]
    assert {k.attitude for k in estimated} == {estimated[0].attitude}
    assert {k.rates for k in estimated} == {(0.0, 0.0, 0.0)}


def test_last_valid_position_and_velocity_are_kept_when_lost():
    estimated = [k for k, *_ in flown(lambda s: s._replace(position=NAN, velocity=(math.inf,) * 3))]
    assert len({k.position for k in estimated}) == len({k.velocity for k in estimated}) == 1
    assert math.isfinite(sum(estimated[0].position) + sum(estimated[0].velocity))


def test_recovered_rates_are_used_again():
    body, navigation = Turning(), navigation_alone()
    for k in range(200):
        body.step()
        sample = body.sample(**({"rates": NAN} if 50 <= k < 150 else {}))
        estimated = navigation.update(sample, tuple(body.commanded), body.time)
    assert estimated == sample == navigation.reported


def test_navigation_has_no_state_before_first_valid_sample():
    navigation = navigation_alone()
    assert navigation.update(Turning().sample(rates=NAN), (0.0, 0.0, 0.0), 0.0) is None
    assert navigation.reported is None


def test_constant_samples_without_noise_are_not_stuck():
    rest = Measurement(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -0.5), (0.0, 0.0, 0.0))
    navigation = navigation_alone()
    for k in range(3 * NavigationSettings.stuck_after):
        sample = rest._replace(time=k * STEP)
        assert navigation.update(sample, (0.0, 0.0, 0.0), sample.time) == sample == navigation.reported


def test_sensor_counts_as_stuck_after_so_many_samples_equal_to_the_digit():
    """Until then its samples are flown; another value ends it at once."""
    limit = NavigationSettings().stuck_after
    body, navigation = Turning(), navigation_alone()
    body.step()
    first = body.sample()
    navigation.update(first, (0.0,) * 3, body.time)
    for k in range(1, limit + 3):
        body.step()
        repeated = body.sample(rates=first.rates)
        navigation.update(repeated, (0.0,) * 3, body.time)
        assert (navigation.reported.rates == first.rates) == (k < limit), k
    body.step()
    alive = body.sample()
    navigation.update(alive, (0.0,) * 3, body.time)
    assert navigation.reported.rates == alive.rates


@pytest.mark.parametrize("attitude", [(0.0,) * 4, (0.5, 0.0, 0.0, 0.0)])
def test_attitude_that_is_no_rotation_is_taken_for_lost(attitude):
    """A quaternion of zeros has no direction: what is turned by it would be divided by zero."""
    found = flown(lambda s: s._replace(attitude=attitude), duration=2.0)
    assert max(angle(estimated.attitude, truth) for estimated, truth, *_ in found) < 0.03
    steps = iter(range(10**6))
    lost = {0: {"rates": NAN}, 1: {"rates": NAN, "attitude": (math.nan,) * 4}, 2: {}}
    for estimated, *_ in flown(lambda s: s._replace(attitude=attitude)._replace(**lost[next(steps) % 3])):
        assert math.hypot(*estimated.attitude) == pytest.approx(1.0)
    assert navigation_alone().update(Turning().sample(attitude=attitude), (0.0,) * 3, 0.0) is None


def test_rates_are_observed_anew_after_they_were_back():
    """While they are back the body turns on: what was observed before says nothing of it."""
    body, navigation, off = Turning(), navigation_alone(), []
    for k in range(700):
        body.step()
        lost = 100 <= k < 200 or k >= 500
        sample = body.sample(**({"rates": NAN} if lost else {}), **({"position": NAN} if k >= 100 else {}))
        estimated = navigation.update(sample, tuple(body.commanded), body.time)
        if lost:
            off.append(np.linalg.norm(np.subtract(estimated.rates, body.rates)))
    assert max(off[100:]) < 2.0 * max(off[:100]) < 0.6


def moving(forces, thrust, duration, lost=0.5, level=(1.0, 0.0, 0.0, 0.0)):
    """[(estimate, true position, true velocity)] of a level body, the sensor of whose position sticks at ``lost`` (s).

    ``forces(time)``: acceleration (m/s2, NED) other than by gravity and support.
    """
    rng, navigation, found = np.random.default_rng(3), navigation_alone(), []
    navigation.arrays.targets[0, THRUST] = thrust
    position, velocity, time, stuck = np.zeros(3), np.array([0.3, -0.2, 0.1]), 0.0, None
    while time < duration:
        acceleration = np.array(forces(time))
        velocity = velocity + STEP * acceleration
        position, time = position + STEP * velocity, time + STEP
        navigation.specific_force = (*acceleration[:2], acceleration[2] - AIRFRAME.g)
        noisy = Measurement(
            time, level, tuple(rng.normal(0.0, 0.005, 3)), tuple(position + rng.normal(0.0, 0.02, 3)),
            tuple(velocity + rng.normal(0.0, 0.02, 3)),
        )  # fmt: skip
        if time > lost:
            stuck = stuck or noisy
            noisy = noisy._replace(position=stuck.position, velocity=stuck.velocity)
        found.append((navigation.update(noisy, (0.0, 0.0, 0.0), time), position, velocity))
    return found


def test_position_that_is_no_longer_measured_goes_on_with_the_specific_force():
    weight = AIRFRAME.mass * AIRFRAME.g
    found = moving(lambda time: (math.sin(time), 0.5 * math.cos(2.0 * time), -0.1), thrust=1.5 * weight, duration=10.0)
    estimate, position, velocity = found[-1]
    assert np.linalg.norm(np.array(estimate.velocity) - velocity) < 0.08  # as at the loss: its noise
    assert np.linalg.norm(np.array(estimate.position) - position) < 0.08 * 9.5 + 0.06
    assert np.linalg.norm(position - found[120][1]) > 5.0


@pytest.mark.parametrize(("share", "stands"), [(0.9, True), (1.0, False)])
def test_vehicle_without_position_that_nothing_accelerates_stands_if_its_thrust_is_below_its_weight(share, stands):
    # At constant velocity in the air, its thrust is its weight.
    found = moving(lambda time: (0.0, 0.0, 0.0), thrust=share * AIRFRAME.mass * AIRFRAME.g, duration=2.0)
    assert (found[-1][0].velocity == (0.0, 0.0, 0.0)) is stands


def test_time_that_a_vehicle_has_stood_begins_anew_after_its_velocity_was_measured():
    rng, navigation, time = np.random.default_rng(5), navigation_alone(), 0.0
    navigation.arrays.targets[0, THRUST] = 0.9 * AIRFRAME.mass * AIRFRAME.g
    navigation.specific_force = (0.0, 0.0, -AIRFRAME.g)
    velocities = []
    for sinking, duration in ((0.0, 0.02), (0.0, 1.0), (0.4, 0.1), (0.4, 0.1)):
        sample = Measurement(time, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, sinking))
        for _ in range(round(duration / STEP)):
            time += STEP
            sample = sample._replace(time=time, rates=tuple(rng.normal(0.0, 0.005, 3)))
            if len(velocities) % 2 == 0:  # else the position is stuck
                sample = sample._replace(position=tuple(rng.normal(0.0, 0.02, 3)))
            velocity = navigation.update(sample, (0.0, 0.0, 0.0), time).velocity
        velocities.append(velocity[2])
    assert velocities == pytest.approx([0.0, 0.0, 0.4, 0.4], abs=1e-3)


def test_impact_ends_the_velocity_of_a_vehicle_without_position():
    def impact(time):
        return (0.0, 0.0, -100.0) if 1.0 <= time < 1.0 + 0.9 * STEP else (0.0, 0.0, 0.0)

    found = moving(impact, thrust=2.0 * AIRFRAME.mass * AIRFRAME.g, duration=1.2)
    assert np.linalg.norm(found[-1][0].velocity) < 0.01 < np.linalg.norm(found[200][0].velocity)
