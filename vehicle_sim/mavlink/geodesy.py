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


def euler(measured: Measurement) -> tuple[float, float, float]:
    """Roll, pitch and yaw (rad)."""
    w, x, y, z = measured.attitude
    return (
        math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        math.asin(min(max(2.0 * (w * y - z * x), -1.0), 1.0)),
        math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    )


def in_body(measured: Measurement) -> tuple[float, float, float]:
    """The velocity in the body frame (m/s)."""
    w, x, y, z = measured.attitude
    v_x, v_y, v_z = measured.velocity
    t_x, t_y, t_z = 2.0 * (v_y * z - v_z * y), 2.0 * (v_z * x - v_x * z), 2.0 * (v_x * y - v_y * x)
    return (
        v_x + w * t_x + t_y * z - t_z * y,
        v_y + w * t_y + t_z * x - t_x * z,
        v_z + w * t_z + t_x * y - t_y * x,
    )
