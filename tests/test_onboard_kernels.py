"""The kernels of the onboard loop agree with plain Python."""

import math
from dataclasses import dataclass, field

import numpy as np
import pytest
from flying import AIRFRAME

from gcs.config.vehicle_settings import LandDetectorSettings
from vehicle_sim.autopilot.land_detector import LandDetector
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import THRUST, detect_landings, find_ordinary

SETTINGS = LandDetectorSettings()
WEIGHT, THRUST_MAX = AIRFRAME.mass * AIRFRAME.g, AIRFRAME.rotors.thrust_max


@dataclass
class PlainDetector:
    """Landing detection of one vehicle, written for a reader."""

    altitude: float | None = None
    velocity: float = 0.0
    ground: float | None = None
    last_time: float = 0.0
    light_since: float = math.inf
    touching_since: float = math.inf
    in_air: bool = False
    hover_thrust: float | None = field(default=None)

    def start(self):
        self.ground, self.in_air = self.altitude, False
        self.light_since = self.touching_since = math.inf

    def update(self, row, thrust, now, learn):
        step, self.last_time = now - self.last_time, now
        z, v_z = row[2], row[9]
        if self.altitude is None:
            self.altitude = z
            return
        self.altitude += (z - self.altitude) * step / (SETTINGS.altitude_filter + step)
        self.velocity += (v_z - self.velocity) * step / (SETTINGS.velocity_filter + step)
        lift = min(max(thrust * (1.0 - 2.0 * (row[4] ** 2 + row[5] ** 2)), WEIGHT), THRUST_MAX)
        if not self.in_air:
            if self.ground is not None and self.ground - self.altitude > SETTINGS.lifted:
                self.in_air, self.hover_thrust = True, lift
            return
        if learn:
            self.hover_thrust += (lift - self.hover_thrust) * step / (SETTINGS.hover_filter + step)
        slow = abs(self.velocity) < SETTINGS.vertical_speed_max
        if not slow or thrust > WEIGHT + SETTINGS.unloaded_share * (self.hover_thrust - WEIGHT):
            self.light_since = now
        if self.velocity > SETTINGS.touchdown_sinking or thrust > SETTINGS.touchdown_thrust * self.hover_thrust:
            self.touching_since = now
        self.light_since, self.touching_since = min(self.light_since, now), min(self.touching_since, now)
        if now - self.light_since >= SETTINGS.time:
            self.start()


def test_landings_are_detected_for_a_team_as_for_each():
    """Up, along, down, and standing, each vehicle at other heights, thrusts and speeds."""
    rng, seen = np.random.default_rng(3), set()
    arrays = OnboardArrays.of([AIRFRAME] * 3, SETTINGS)
    detectors, plain = [LandDetector(arrays.of_vehicle(i)) for i in range(3)], [PlainDetector() for _ in range(3)]
    for k in range(1, 3000):
        now = 0.004 * k
        for i in range(3):
            phase = now - 0.3 * i
            height = min(max(phase - 1.0, 0.0), 2.0) - min(max(phase - 6.0, 0.0), 2.0)
            climb = 1.0 if 1.0 < phase < 3.0 else -1.0 if 6.0 < phase < 8.0 else 0.0
            tilt = 0.05 * rng.normal(size=2)
            thrust = 0.0 if phase < 0.5 else 0.3 * WEIGHT if phase > 8.2 else (1.6 + 0.1 * i) * WEIGHT
            arrays.estimates[i] = [0.0, 0.0, -height, 1.0, *tilt, 0.0, 0.0, 0.0, 0.02 * rng.normal() - climb, 0, 0, 0]
            arrays.targets[i, THRUST] = thrust
            arrays.learns[i] = phase < 6.0
            if k == 50:
                plain[i].start()
                detectors[i].start()
            plain[i].update(arrays.estimates[i].tolist(), thrust, now, phase < 6.0)
        detect_landings(arrays.detectors, arrays.estimates, arrays.targets, arrays.learns, now, arrays.landings)
        for one, other in zip(detectors, plain, strict=True):
            assert (one.in_air, one.hover_thrust) == (other.in_air, pytest.approx(other.hover_thrust))
            assert one.touching == (other.touching_since < other.last_time)
            assert one.touched_down == (other.last_time - other.touching_since >= SETTINGS.time)
            seen.add((one.in_air, one.touching, one.touched_down))
    assert {in_air for in_air, _, _ in seen} == {True, False} and (True, True, True) in seen


def test_vehicles_without_an_estimate_detect_nothing():
    arrays = OnboardArrays.of([AIRFRAME], SETTINGS)
    before = arrays.landings.copy()
    detect_landings(arrays.detectors, arrays.estimates, arrays.targets, arrays.learns, 1.0, arrays.landings)
    assert np.array_equal(arrays.landings, before, equal_nan=True)


def test_ordinary_samples_are_numbers_that_do_not_repeat():
    good = np.arange(1.0, 14.0)
    good[3:7] = 0.5, -0.5, 0.5, 0.5
    samples, last, ordinary = np.tile(good, (8, 1)), np.tile(-good, (8, 1)), np.zeros(8, dtype=bool)
    samples[1, 4] = np.nan
    samples[2, 0] = np.inf
    samples[3, 8] = 1e7
    last[4, 3:7] = good[3:7]  # a stuck attitude
    last[5, 10:13] = good[10:13]  # stuck rates
    samples[6, 10:13] = last[6, 10:13] = 0.0  # at rest without noise
    samples[7, 3:7] = 0.0  # no rotation
    estimates = np.empty((8, 13))
    find_ordinary(samples, last, estimates, ordinary)
    assert ordinary.tolist() == [True, False, False, False, False, False, True, False]
    assert np.array_equal(last, samples, equal_nan=True) and np.array_equal(estimates, samples, equal_nan=True)
    find_ordinary(samples, last, estimates, ordinary)
    assert not ordinary.any()
