"""What is measured: of each UAV and of the payload, pose and motion, each with the time it was true."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PAYLOAD = -1
"""``source`` of measurements of the payload's navigation unit; UAVs are 0 .. N-1."""


@dataclass(frozen=True, eq=False)
class Attitude:
    """Attitude and body rates of a UAV or of the payload."""

    time: float
    """When it was true (s)."""
    source: int
    """UAV index or :data:`PAYLOAD`."""
    quaternion: Array
    """Body to world, w first (4,)."""
    rates: Array
    """Body frame (3,) (rad/s)."""

    def agrees(self, other: object) -> bool:
        """Whether both tell the same."""
        if not isinstance(other, Attitude):
            return False
        return bool((self.quaternion == other.quaternion).all() and (self.rates == other.rates).all())


@dataclass(frozen=True, eq=False)
class Position:
    """Position and velocity of a UAV or of the payload's centre."""

    time: float
    """When it was true (s)."""
    source: int
    """UAV index or :data:`PAYLOAD`."""
    position: Array
    """World, NED (3,) (m)."""
    velocity: Array
    """World, NED (3,) (m/s)."""

    def agrees(self, other: object) -> bool:
        """Whether both tell the same."""
        if not isinstance(other, Position):
            return False
        return bool((self.position == other.position).all() and (self.velocity == other.velocity).all())


Measurement = Attitude | Position


@dataclass(frozen=True)
class MeasurementNoise:
    """Standard deviations of the white noise on each channel (m, rad, m/s, rad/s)."""

    position: float = 0.02
    attitude: float = float(np.radians(0.2))
    uav_velocity: float = 0.02
    uav_rates: float = 0.005
    payload_velocity: float = 0.008
    payload_rates: float = 0.008
