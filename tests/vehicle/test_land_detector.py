"""Land detector: which motion and thrust, for how long, are taken for lift-off, touchdown and rest on the ground."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from flying import AIRFRAME

from gcs.config.vehicle_settings import LandDetectorSettings
from vehicle_sim.autopilot.land_detector import LandDetector
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import THRUST, detect_landings

SETTINGS = LandDetectorSettings()
WEIGHT, THRUST_MAX, HOVER = 7.0, 30.0, 14.0  # N; it carries as much again
STEP = 0.004
LEVEL = (1.0, 0.0, 0.0, 0.0)


class Bench:
    """A detector, and the motion that it is shown."""

    def __init__(self) -> None:
        airframe = replace(AIRFRAME, mass=WEIGHT / AIRFRAME.g, rotors=replace(AIRFRAME.rotors, thrust_max=THRUST_MAX))
        self.arrays = OnboardArrays.of([airframe], SETTINGS)
        self.detector = LandDetector(self.arrays)
        self.now, self.height, self.velocity = 0.0, 0.0, math.nan
        """``velocity`` (m/s, down) is that of the sensor; NaN: the true one."""
        self.noise = 1e-9

    def run(self, seconds: float, thrust: float = HOVER, climb: float = 0.0, learn: bool = True) -> LandDetector:
        """Climb at so many m/s with a thrust (N)."""
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            self.height += climb * STEP
            arrays = self.arrays
            self.noise = -self.noise
            velocity = -climb if math.isnan(self.velocity) else self.velocity
            z = -self.height + self.noise
            arrays.estimates[0] = [0.0, 0.0, z, *LEVEL, 0.0, 0.0, velocity, 1e-3, 0.0, 0.0]
            arrays.targets[0, THRUST], arrays.learns[0] = thrust, learn
            detect_landings(
                arrays.detectors, arrays.estimates, arrays.targets, arrays.learns, self.now, arrays.landings,
                arrays.idle_until,
            )  # fmt: skip
        return self.detector

    def fly(self) -> LandDetector:
        """Lift off, climb by 1 m, and hover."""
        self.run(0.1)
        self.detector.start()
        self.run(1.0, climb=1.0)
        return self.run(5.0)


def test_vehicle_is_in_the_air_when_it_has_risen_from_where_it_was_armed() -> None:
    bench = Bench()
    bench.run(0.1)
    bench.detector.start()
    assert not bench.run(1.0).in_air
    assert not bench.run((SETTINGS.lifted - 0.03) / 0.5, climb=0.5).in_air
    assert bench.run(0.2, climb=0.5).in_air


def test_hover_thrust_is_low_passed_and_between_own_weight_and_largest_thrust() -> None:
    bench = Bench()
    assert bench.fly().hover_thrust == pytest.approx(HOVER, rel=0.01)
    assert bench.run(SETTINGS.hover_filter, 1.2 * HOVER).hover_thrust == pytest.approx(
        (1.2 - 0.2 / 2.718) * HOVER, rel=0.01
    )
    held = bench.detector.hover_thrust
    assert bench.run(1.0, HOVER, learn=False).hover_thrust == held
    assert bench.run(30.0, 0.2 * WEIGHT, climb=-1.0).hover_thrust == pytest.approx(WEIGHT, rel=0.01)
    bench.detector.lift(2.0 * THRUST_MAX)
    assert bench.detector.hover_thrust == THRUST_MAX and bench.detector.in_air


def test_hover_thrust_is_that_of_the_mass_which_thrust_and_acceleration_show() -> None:
    bench = Bench()
    bench.run(0.5)
    bench.detector.start()
    for k in range(round(1.0 / STEP)):  # a jump of the load: 5 m/s2 upwards with a thrust that held it before
        bench.run(STEP, HOVER, climb=5.0 * k * STEP)
    held = HOVER / (1.0 + 5.0 / AIRFRAME.g)
    assert bench.detector.in_air and bench.detector.hover_thrust == pytest.approx(held, rel=0.03)


def test_vehicle_touches_when_it_does_not_sink_with_less_than_its_hover_thrust_until_it_does() -> None:
    bench = Bench()
    bench.fly()
    low = 0.9 * SETTINGS.touchdown_thrust * HOVER
    assert not bench.run(3.0, low, climb=-0.5, learn=False).touching  # it sinks, with a thrust below that in hover
    bench.run(5.0 * SETTINGS.velocity_filter, low, learn=False)
    assert bench.detector.touching
    assert bench.run(1.0, HOVER, learn=False).touching
    assert not bench.run(5.0 * SETTINGS.velocity_filter, low, climb=-0.5, learn=False).touching
    assert bench.run(3.0, low, learn=False).touching and bench.detector.in_air  # it still carries something
    assert not bench.run(0.1, low, learn=True).touching  # the ground flies it


@pytest.mark.parametrize("learn", [False, True])
def test_vehicle_stands_after_rest_for_a_time_with_less_thrust_than_its_weight(learn: bool) -> None:
    bench = Bench()
    bench.fly()
    bench.run(2.0, HOVER, climb=-0.5, learn=learn)
    assert bench.run(2.0, 0.9 * WEIGHT, climb=-0.2, learn=learn).in_air  # it sinks
    assert bench.run(6.0, 1.01 * WEIGHT, learn=learn).in_air  # it may carry a light payload
    assert bench.run(0.5 * SETTINGS.time, 0.9 * WEIGHT, learn=learn).in_air
    assert not bench.run(6.0, 0.9 * WEIGHT, learn=learn).in_air
    assert not bench.detector.touching


@pytest.mark.parametrize(("learn", "below", "time"), [
    (True, 0.0, SETTINGS.time), (False, 0.0, SETTINGS.time_elsewhere),
    (False, 1.2 - SETTINGS.altitude_tolerance, SETTINGS.time), (False, 2.0, SETTINGS.time_elsewhere),
])  # fmt: skip
def test_vehicle_on_its_own_must_stand_longer_elsewhere(learn: bool, below: float, time: float) -> None:
    bench = Bench()
    bench.fly()  # 1 m above the ground
    bench.run(below / 0.5 + STEP, HOVER, climb=-0.5, learn=learn)
    bench.run(2.0, HOVER, learn=learn)
    assert bench.run(0.95 * time, 0.9 * WEIGHT, learn=learn).in_air
    assert not bench.run(0.1 * time, 0.9 * WEIGHT, learn=learn).in_air


def test_altitude_that_sinks_contradicts_a_velocity_of_rest() -> None:
    bench = Bench()
    bench.fly()
    bench.velocity = 0.0
    assert bench.run(2.0, 0.9 * WEIGHT, climb=-0.4, learn=False).in_air
    assert not bench.detector.touching


def test_repeated_position_and_velocity_are_no_evidence_unless_the_vehicle_is_known_to_stand() -> None:
    bench = Bench()
    bench.fly()
    bench.noise, bench.velocity = 0.0, 0.01
    bench.run(0.1, HOVER, learn=False)
    assert bench.run(10.0, 0.9 * WEIGHT, learn=False).in_air
    assert not bench.detector.touching
    bench.velocity = 0.0  # at rest without noise, or by a zero-velocity update
    assert not bench.run(SETTINGS.time_elsewhere + 0.1, 0.9 * WEIGHT, learn=False).in_air
