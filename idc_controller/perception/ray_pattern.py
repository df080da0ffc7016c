"""The known rays of a range sensor: a spherical Fibonacci lattice over its field of view, turned from scan to scan.

The simulated sensors scan by it, and the ground knows by it which rays of a scan returned nothing.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from idc_controller.arrays import Array

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
"""Share of a turn from each ray of the lattice to the next."""
_TURN = math.sqrt(3.0) - 1.0
"""Share of a turn from each scan to the next: the rays of several scans interleave.

Chosen of several irrational numbers by the largest gap in 1 to 32 successive scans, as it stands in
tests/perception/test_ray_pattern.py; those that the golden ratio generates only repeat the lattice.
"""


def scan_index(time_boot_ms: int, rate: float) -> int:
    """Return the index of the scan with that time stamp (ms, of the vehicle's clock), of a sensor of ``rate`` (Hz)."""
    return round(time_boot_ms * 1e-3 * rate)


@dataclass(frozen=True)
class RayPattern:
    """``rays`` over all azimuths, evenly from ``elevation_min`` to ``elevation_max`` (rad, up) of the body frame."""

    rays: int
    elevation_min: float
    elevation_max: float

    def directions(self, scan: int) -> Array:
        """Return the unit vectors (rays, 3) of the scan with index ``scan``, forward-right-down, the lowest first."""
        angle = math.tau * ((scan * _TURN) % 1.0)
        cosine, sine = math.cos(angle), math.sin(angle)
        turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        return np.asarray(self._lattice @ turn)

    @property
    def spacing(self) -> float:
        """Mean angle between neighbours (rad): the side of the square that is a ray's share of the field of view."""
        return math.sqrt(math.tau * (math.sin(self.elevation_max) - math.sin(self.elevation_min)) / self.rays)

    @cached_property
    def _lattice(self) -> Array:
        """Directions (rays, 3) of the first scan: equal steps of the elevation's sine are equal areas of the sphere."""
        steps = np.arange(self.rays)
        low, high = math.sin(self.elevation_min), math.sin(self.elevation_max)
        up = low + (steps + 0.5) / self.rays * (high - low)
        azimuth, level = math.tau * ((steps * _GOLDEN) % 1.0), np.sqrt(1.0 - up * up)
        return np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), -up])
