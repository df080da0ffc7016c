"""Latitude, longitude and altitude of positions near home, against pymap3d."""

import math
import random

import pymap3d
import pytest

from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mission.model import DEFAULT_HOME, Home
from vehicle_sim.world.sensors import Measurement

METRES_PER_DEG = 111_320.0
HOMES = [
    DEFAULT_HOME,
    *(Home(latitude, longitude, altitude)
      for latitude, longitude, altitude in [(0.0, 0.0, 0.0), (-33.9, 18.4, -3.0), (78.2, -179.99999, 900.0),
                                            (52.5, 179.99999, 40.0), (-89.0, 45.0, 2800.0), (12.3, -70.0, 4000.0)]),
]  # fmt: skip


@pytest.mark.parametrize("home", HOMES, ids=str)
@pytest.mark.parametrize("reach", [0.0, 10.0, 500.0, 5e4])
def test_geodetic_position_is_that_of_pymap3d(home: Home, reach: float) -> None:
    frame, rng = LocalFrame(home), random.Random(3)
    tolerance = 2e-8 if reach < 1e3 else 1e-6  # m
    for _ in range(50):
        position = [rng.uniform(-reach, reach), rng.uniform(-reach, reach), rng.uniform(-0.1 * reach, 0.1 * reach)]
        latitude, longitude, altitude = frame.geodetic(*position)
        truth = pymap3d.ned2geodetic(*position, home.latitude, home.longitude, home.altitude)
        assert abs(latitude - truth[0]) * METRES_PER_DEG < tolerance
        east = math.remainder(longitude - truth[1], 360.0) * METRES_PER_DEG * math.cos(math.radians(latitude))
        assert abs(east) < tolerance
        assert abs(altitude - truth[2]) < tolerance


def test_places_are_equal_to_the_digit_and_clamped() -> None:
    frame, rng = LocalFrame(DEFAULT_HOME), random.Random(5)
    different = 0
    for _ in range(1000):
        position = (rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0), rng.uniform(-20.0, 0.0))
        truth = pymap3d.ned2geodetic(*position, DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)
        expected = tuple(round(value * scale) for value, scale in zip(truth, (1e7, 1e7, 1e3), strict=True))
        different += frame.place_of(at(*position)) != expected
    assert different == 0
    assert frame.place_of(at(0.0, 0.0, 0.0)) == frame.origin
    assert frame.place_of(at(1e30, -1e30, 1e30))[2] == 2**31 - 1


def at(north: float, east: float, down: float) -> Measurement:
    return Measurement(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (north, east, down), (0.0, 0.0, 0.0))
