"""Land detector: which motion and thrust, for how long, are taken for lift-off, touchdown and rest on the ground."""

from __future__ import annotations

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
        self.now, self.height = 0.0, 0.0

    def run(self, seconds: float, thrust: float = HOVER, climb: float = 0.0, learn: bool = True) -> LandDetector:
        """Climb at so many m/s with a thrust (N)."""
        for _ in range(round(seconds / STEP)):
            self.now += STEP
            self.height += climb * STEP
            arrays = self.arrays
            arrays.estimates[0] = [0.0, 0.0, -self.height, *LEVEL, 0.0, 0.0, -climb, 0.0, 0.0, 0.0]
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
    assert bench.fly().hover_thrust == pytest.approx(HOVER)
    assert bench.run(SETTINGS.hover_filter, 1.2 * HOVER).hover_thrust == pytest.approx(
        (1.2 - 0.2 / 2.718) * HOVER, rel=0.01
    )
    held = bench.detector.hover_thrust
    assert bench.run(1.0, HOVER, learn=False).hover_thrust == held
    assert bench.run(20.0, 0.2 * WEIGHT, climb=-1.0).hover_thrust == pytest.approx(WEIGHT, rel=0.01)
    bench.detector.lift(2.0 * THRUST_MAX)
    assert bench.detector.hover_thrust == THRUST_MAX and bench.detector.in_air


def test_touchdown_is_detected_when_a_sinking_vehicle_has_been_stopped_for_the_settled_time() -> None:
    bench = Bench()
    bench.fly()
    low = 0.9 * SETTINGS.touchdown_thrust * HOVER
    assert not bench.run(3.0, low, climb=-0.5, learn=False).touching  # it sinks, with a thrust below that in hover
    bench.run(4.0 * SETTINGS.velocity_filter, low, learn=False)
    assert bench.detector.touching
    bench.run(0.05, HOVER, learn=False)
    assert not bench.detector.touching
    bench.run(0.8 * SETTINGS.time, low, learn=False)
    assert bench.detector.touching and not bench.detector.touched_down
    bench.run(0.3 * SETTINGS.time, low, learn=False)
    assert bench.detector.touched_down and bench.detector.in_air  # it still carries something


def test_vehicle_is_on_the_ground_after_it_has_carried_nothing_at_rest_for_the_settled_time() -> None:
    bench = Bench()
    bench.fly()
    assert bench.run(2.0, 0.5 * WEIGHT, climb=-0.5, learn=False).in_air  # it sinks
    assert bench.run(2.0, HOVER, learn=False).in_air  # it carries the payload
    assert bench.run(0.8 * SETTINGS.time, 0.5 * WEIGHT, learn=False).in_air
    assert not bench.run(0.3 * SETTINGS.time, 0.5 * WEIGHT, learn=False).in_air
    assert not bench.detector.touching
