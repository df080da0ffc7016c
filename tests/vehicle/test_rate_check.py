"""Body rates that contradict the attitude are not used on board."""

import math

import numpy as np
import pytest
from flying import AIRFRAME

from gcs.config.vehicle_settings import LandDetectorSettings, NavigationSettings
from idc_controller.rotations_float import half_rotation, turned
from vehicle_sim.autopilot.navigation import Navigation
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import take_fresh_samples
from vehicle_sim.world.sensors import Measurement
from vehicle_sim.world.state_kernels import STATE_COLUMNS

STEP = 0.004
ATTITUDE_NOISE, RATE_NOISE = math.radians(0.2), 0.005  # standard deviations of the default system


class Flown:
    """Samples of a vehicle that turns to and fro, with its sensors' noise; ``wrong`` of its rates is measured."""

    def __init__(self, seed=1, amplitude=1.0):
        self.arrays = OnboardArrays.of([AIRFRAME], LandDetectorSettings(), ATTITUDE_NOISE)
        self.navigation = Navigation(0.05, AIRFRAME.g, NavigationSettings(), self.arrays)
        self._random, self._amplitude = np.random.default_rng(seed), amplitude
        self.attitude, self.time, self.rates = (1.0, 0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0)

    def run(self, duration, wrong=lambda rates: rates, step=(0.0, 0.0, 0.0), located=True):
        """Return the largest error of the rates that are flown by (rad/s), and the share of samples that were fresh."""
        errors, fresh = [], []
        for _ in range(round(duration / STEP)):
            self.time += STEP
            swing = self._amplitude * math.sin(4.0 * self.time)
            self.rates = (swing, -0.6 * swing, 0.2 * swing)
            self.attitude = turned(self.attitude, self.rates, STEP)
            off = self._random.normal(0.0, ATTITUDE_NOISE, 3)
            rates = wrong(np.array(self.rates)) + self._random.normal(0.0, RATE_NOISE, 3)
            row = np.zeros((1, STATE_COLUMNS))
            row[0, 3:7], row[0, 10:13] = turned(turned(self.attitude, step, 1.0), tuple(off), 1.0), rates
            row[0, :3] = self._random.normal(0.0, 0.02, 3) if located else self.arrays.last_samples[0, :3]
            a = self.arrays
            times = np.array([self.time])
            take_fresh_samples(row, times, self.time, a.last_samples, a.estimates, a.stamps, a.fresh, a.rate_checks)
            fresh.append(bool(a.fresh[0]))
            if not a.fresh[0]:
                self.navigation.update(Measurement.of_row(self.time, row[0].tolist()), (0.0, 0.0, 0.0), self.time)
            errors.append(np.abs(np.subtract(self.navigation.estimate.rates, self.rates)).max())
        return max(errors), float(np.mean(fresh))


@pytest.mark.parametrize("amplitude", [0.0, 1.0, 3.0])
def test_right_rates_are_used_whatever_the_vehicle_does(amplitude):
    error, fresh = Flown(amplitude=amplitude).run(60.0)
    assert fresh == 1.0 and error < 6.0 * RATE_NOISE


@pytest.mark.parametrize(
    "wrong", [lambda rates: -rates, lambda rates: 0.3 * rates, lambda rates: rates + 0.5], ids=["flip", "scale", "bias"]
)
def test_wrong_rates_are_replaced_by_those_that_explain_the_attitude(wrong):
    flown = Flown()
    flown.run(1.0)
    flown.run(1.0, wrong)
    error, fresh = flown.run(5.0, wrong)
    assert fresh < 0.1
    assert error < 0.5


def test_rates_that_are_right_again_are_used_again():
    flown = Flown()
    flown.run(1.0, lambda rates: -rates)
    flown.run(NavigationSettings().rates_refused + 0.2)
    error, fresh = flown.run(2.0)
    assert fresh == 1.0 and error < 6.0 * RATE_NOISE


STEP_OF_ATTITUDE = (0.1, 0.1, 0.1)


def test_step_of_the_attitude_is_no_error_of_the_rates():
    flown = Flown()
    flown.run(1.0)
    error, fresh = flown.run(2.0, step=STEP_OF_ATTITUDE)
    assert fresh == 1.0 and error < 6.0 * RATE_NOISE
    error, fresh = flown.run(2.0)
    assert fresh == 1.0 and error < 6.0 * RATE_NOISE


def error_without_position(**step):
    """Return the error (rad) of the attitude after 10 s without a position, with a ``step`` since shortly before."""
    flown = Flown()
    flown.navigation.specific_force = (0.0, 0.0, -AIRFRAME.g)
    flown.run(2.0)
    flown.run(0.2, **step)
    flown.run(10.0, located=False, **step)
    return 2.0 * math.hypot(*half_rotation(flown.attitude, flown.navigation.estimate.attitude))


def test_vehicle_without_position_goes_on_by_its_rates_where_its_attitude_has_stepped():
    assert error_without_position() < 0.005
    assert error_without_position(step=STEP_OF_ATTITUDE) < 0.01
