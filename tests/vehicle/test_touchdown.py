"""A vehicle on its own disarms where it stands, and nowhere else: other loads, vertical air, sensors lost on board."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from autopilot_flight import Flight
from flying import AIRFRAME, GRAVITY, PHYSICS_STEP, Body

from vehicle_sim.world.sensors import Measurement, SensorNoise

CARRIED = 0.775  # kg, its share of the payload
NOISE = SensorNoise(0.02, math.radians(0.2), 0.02, 0.005)


class Disturbed(Body):
    """A body with a vertical force of its surroundings (N, up), and sensors whose samples are changed."""

    lift = 0.0
    floor = math.inf
    """Height (m) below which something carries it; inf: the ground alone."""

    def __init__(self) -> None:
        super().__init__(CARRIED, NOISE)
        self.seen: Callable[[Measurement], Measurement] = lambda sample: sample

    def measure(self) -> Measurement:
        return self.seen(super().measure())

    def advance(self) -> None:
        self.velocity = self.velocity - GRAVITY / AIRFRAME.g * (PHYSICS_STEP * self.lift / self.mass)
        super().advance()
        if math.isfinite(self.floor) and -self.position[2] < self.floor:
            self.position[2], self.velocity[2] = -self.floor, min(self.velocity[2], 0.0)


@pytest.fixture
def holding() -> Flight:
    """A vehicle that has lost its ground, brakes and holds at 6 m."""
    flight = Flight()
    flight.body = Disturbed()
    flight.take_off()
    flight.ground_is_there = False
    flight.run(1.0)
    assert flight.pilot.failsafe
    return flight


def descend(flight: Flight, longest: float = 60.0) -> float:
    """Fly until it is disarmed, which must be on the ground; return its largest speed downwards (m/s)."""
    fastest, end = 0.0, flight.body.now + longest
    while flight.pilot.armed and flight.body.now < end:
        flight.run(0.02)
        fastest = max(fastest, float(flight.body.velocity[2]))
        assert flight.pilot.armed or flight.body.position[2] == 0.0, f"disarmed at {-flight.body.position[2]:.1f} m"
    assert not flight.pilot.armed
    return fastest


@pytest.mark.parametrize("carried", [1.0, 0.5, 0.275])
def test_vehicle_whose_load_has_changed_disarms_on_the_ground(holding: Flight, carried: float) -> None:
    holding.body.mass = AIRFRAME.mass + carried
    assert descend(holding) < 1.0


@pytest.mark.parametrize("carried", [0.15, 0.05, 0.0])
@pytest.mark.parametrize("begun", [0.0, 4.5])
def test_vehicle_that_has_lost_nearly_all_its_load_stays_armed_in_the_air(
    holding: Flight, carried: float, begun: float
) -> None:
    holding.run(begun)
    holding.body.mass = AIRFRAME.mass + carried
    while holding.body.position[2] < -0.01 and holding.body.now < 40.0:
        holding.run(0.02)
        assert holding.pilot.armed


@pytest.mark.parametrize("lift", [-2.0, 2.0, 4.0])
def test_vehicle_in_vertical_air_disarms_on_the_ground(holding: Flight, lift: float) -> None:
    holding.body.lift = lift
    assert descend(holding) < 1.0


@pytest.mark.parametrize("rate", [-0.15, 0.15])
def test_vehicle_whose_altitude_drifts_disarms_on_the_ground(holding: Flight, rate: float) -> None:
    begun = holding.body.now

    def drifting(sample: Measurement) -> Measurement:
        x, y, z = sample.position
        return sample._replace(position=(x, y, z + rate * (sample.time - begun)))

    holding.body.seen = drifting
    assert descend(holding) < 1.0


@pytest.mark.parametrize("channels", [("velocity",), ("position",), ("position", "velocity")])
@pytest.mark.parametrize("carried", [CARRIED, 0.275])
def test_vehicle_is_not_disarmed_in_the_air_by_what_repeats(
    holding: Flight, channels: tuple[str, ...], carried: float
) -> None:
    at_rest = holding.body.measure()._replace(velocity=(0.01, 0.0, 0.01))
    stuck = {channel: getattr(at_rest, channel) for channel in channels}
    holding.body.seen = lambda sample: sample._replace(**stuck)
    holding.body.mass = AIRFRAME.mass + carried
    while holding.body.position[2] < -0.01 and holding.body.now < 40.0:
        holding.run(0.02)
        assert holding.pilot.armed


def test_vehicle_that_its_neighbours_carry_must_stand_longer(holding: Flight) -> None:
    limits = holding.pilot.state.settings.land_detector
    holding.body.floor = 3.0
    while -holding.body.position[2] > 3.01:
        holding.run(0.02)
    holding.run(limits.time_elsewhere)
    assert holding.pilot.armed
    holding.run(4.0)  # its plan goes on, until its thrust is below its weight
    assert not holding.pilot.armed


def test_standing_vehicle_carries_less_than_its_own_weight(holding: Flight) -> None:
    thrusts = []
    while holding.pilot.armed:
        holding.run(0.02)
        thrusts.append(holding.pilot.state.actuation.thrust)
    last = np.array(thrusts[-20:-2]) / (AIRFRAME.mass * AIRFRAME.g)
    assert last.max() < 1.0
