"""Conversions from a sample in the north-east-down frame to what MAVLink's integer and geodetic fields hold."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pymap3d

from vehicle_sim.world.sensors import Measurement


@dataclass(frozen=True)
class Home:
    """The origin of the common north-east-down frame, on the ground: degrees (WGS 84), metres above the ellipsoid."""

    latitude_deg: float = 47.397742
    longitude_deg: float = 8.545594
    altitude: float = 488.0

    @property
    def on_the_wire(self) -> tuple[int, int, int]:
        """Degrees in 1e-7 and millimetres."""
        return round(self.latitude_deg * 1e7), round(self.longitude_deg * 1e7), round(self.altitude * 1e3)

    def geodetic(self, measured: Measurement) -> tuple[int, int, int]:
        """The place of a sample, in degrees (1e-7) and millimetres."""
        latitude, longitude, altitude = pymap3d.ned2geodetic(
            *measured.position, self.latitude_deg, self.longitude_deg, self.altitude
        )
        return clamp(latitude * 1e7, 32), clamp(longitude * 1e7, 32), clamp(altitude * 1e3, 32)


def is_finite(measured: Measurement) -> bool:
    """Whether every number of a sample is finite."""
    return math.isfinite(sum(measured.attitude) + sum(measured.rates) + sum(measured.position) + sum(measured.velocity))


def clamp(value: float, bits: int) -> int:
    """The nearest integer of so many bits: a value out of range must not stop the telemetry."""
    limit = (1 << (bits - 1)) - 1
    return round(min(max(value, -limit), limit))
