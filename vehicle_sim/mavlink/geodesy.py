"""Conversions from a sample in the north-east-down frame to what MAVLink's integer and geodetic fields hold."""

import math

import pymap3d

from gcs.mission.model import Home
from vehicle_sim.world.sensors import Measurement

Place = tuple[int, int, int]
"""Latitude and longitude (1e-7 deg), altitude (mm)."""


def place_of_home(home: Home) -> Place:
    """Return the place of the frame's origin, on the ground."""
    return round(home.latitude * 1e7), round(home.longitude * 1e7), round(home.altitude * 1e3)


def place_of(measured: Measurement, home: Home) -> Place:
    """Return the place of a sample."""
    latitude, longitude, altitude = pymap3d.ned2geodetic(
        *measured.position, home.latitude, home.longitude, home.altitude
    )
    return clamp(latitude * 1e7, 32), clamp(longitude * 1e7, 32), clamp(altitude * 1e3, 32)


def is_finite(measured: Measurement) -> bool:
    """Return True if every number of a sample is finite."""
    return math.isfinite(sum(measured.attitude) + sum(measured.rates) + sum(measured.position) + sum(measured.velocity))


def clamp(value: float, bits: int) -> int:
    """Return the nearest integer of so many bits: a value out of range must not stop the telemetry."""
    limit = (1 << (bits - 1)) - 1
    return round(min(max(value, -limit), limit))
