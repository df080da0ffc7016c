"""What a vehicle flies by while a sensor on board fails: attitude and rates of a body that turns."""

import math

import numpy as np
import pytest

from idc_controller.rotations import quaternion_product
from vehicle_sim.autopilot.navigation import Navigation
from vehicle_sim.autopilot.settings import NavigationSettings
from vehicle_sim.world.sensors import Measurement

STEP, LAG, NOISE = 0.004, 0.05, math.radians(0.2)
NAN = (math.nan,) * 3


class Turning:
    """A body whose angular acceleration follows what is asked with the motors' lag; (attitude, rates, asked)."""

    def __init__(self, seed=0, noise=NOISE):
        self.rng, self.noise = np.random.default_rng(seed), noise
        self.time, self.attitude = 0.0, np.array([1.0, 0.0, 0.0, 0.0])
        self.rates, self.acceleration, self.asked = np.zeros(3), np.zeros(3), np.zeros(3)

    def step(self):
        self.time += STEP
        self.asked = 6.0 * np.array([math.sin(7.0 * self.time), math.cos(5.0 * self.time), 0.2])
        self.acceleration += (1.0 - math.exp(-STEP / LAG)) * (self.asked - self.acceleration)
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
    """[(believed, body's attitude, body's rates)] of samples of which ``wrong(sample)`` is off after a while."""
    body, navigation, found = Turning(), Navigation(LAG, NavigationSettings()), []
    while body.time < duration:
        body.step()
        sample = body.sample()
        known = navigation.update(sample if body.time < healthy else wrong(sample), tuple(body.asked), body.time)
        if body.time > healthy + 0.1:
            found.append((known, body.attitude, body.rates, navigation.reported))
    return found


def frozen(channel):
    first = []

    def wrong(sample):
        first.append(getattr(sample, channel))
        return sample._replace(**{channel: first[0]})

    return wrong


def test_sound_samples_are_taken_as_they_are():
    navigation, body = Navigation(LAG, NavigationSettings()), Turning()
    for _ in range(10):
        body.step()
        sample = body.sample()
        assert navigation.update(sample, (0.0, 0.0, 0.0), sample.time) == sample == navigation.reported


@pytest.mark.parametrize("wrong", [lambda s: s._replace(rates=NAN), frozen("rates")])
def test_without_rates_those_are_flown_by_that_explain_the_attitude(wrong):
    found = flown(wrong)
    off = [np.linalg.norm(np.subtract(known.rates, rates)) for known, _, rates, _ in found]
    assert np.sqrt(np.mean(np.square(off))) < 0.1
    assert max(np.linalg.norm(rates) for _, _, rates, _ in found) > 0.5
    assert all(math.isnan(told.rates[0]) and math.isfinite(told.attitude[0]) for *_, told in found)


@pytest.mark.parametrize("wrong", [lambda s: s._replace(attitude=(math.nan,) * 4), frozen("attitude")])
def test_without_attitude_it_goes_on_with_the_rates(wrong):
    assert max(angle(known.attitude, attitude) for known, attitude, _, _ in flown(wrong, duration=2.0)) < 0.03


def test_without_either_it_takes_itself_to_stay_as_it_is():
    known = [k for k, *_ in flown(lambda s: s._replace(attitude=(math.nan,) * 4, rates=NAN))]
    assert {k.attitude for k in known} == {known[0].attitude}
    assert {k.rates for k in known} == {(0.0, 0.0, 0.0)}


def test_position_and_velocity_stay_what_they_were():
    known = [k for k, *_ in flown(lambda s: s._replace(position=NAN, velocity=(math.inf,) * 3))]
    assert len({k.position for k in known}) == len({k.velocity for k in known}) == 1
    assert math.isfinite(sum(known[0].position) + sum(known[0].velocity))


def test_a_sensor_that_comes_back_is_believed_again():
    body, navigation = Turning(), Navigation(LAG, NavigationSettings())
    for k in range(200):
        body.step()
        sample = body.sample(**({"rates": NAN} if 50 <= k < 150 else {}))
        known = navigation.update(sample, tuple(body.asked), body.time)
    assert known == sample == navigation.reported


def test_before_the_first_sound_sample_nothing_is_known():
    navigation = Navigation(LAG, NavigationSettings())
    assert navigation.update(Turning().sample(rates=NAN), (0.0, 0.0, 0.0), 0.0) is None
    assert navigation.reported is None


def test_a_body_at_rest_without_noise_is_not_taken_for_a_broken_sensor():
    rest = Measurement(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -0.5), (0.0, 0.0, 0.0))
    navigation = Navigation(LAG, NavigationSettings())
    for k in range(3 * NavigationSettings.stuck_after):
        sample = rest._replace(time=k * STEP)
        assert navigation.update(sample, (0.0, 0.0, 0.0), sample.time) == sample == navigation.reported
