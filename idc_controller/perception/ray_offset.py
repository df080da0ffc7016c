"""Offset of a vehicle's returns from the rays of its range sensor: returns lie on those, whatever the sensor measures.

Its noise is along the rays. Points that lie beside them, all in one direction, are displaced: they show the world where
it is not, and no comparison with other vehicles is needed to know it, nor a map.
"""

import math

import numpy as np
from scipy.special import fdtri

from idc_controller.arrays import Array
from idc_controller.perception.scan_placement_kernels import rays_of_returns
from idc_controller.perception.settings import ScanSettings

_MEMORY = 0.8
"""Share of the last scans that remains with each scan that has returns."""
_ROUNDING = 2e-3
"""Distances from the rays (m) that telemetry's rounding explains, with much to spare."""
_FREEDOM = 3


class RayOffset:
    """Offset of one vehicle's returns, in its body frame. Times are the team's (s).

    A least-squares fit of the last scans' distances from the next rays; what it leaves is their scatter. An offset
    counts if it is large and the scatter does not explain it (F test), for some time; it ends once the returns lie on
    the rays again. What drifts is found so; a sudden offset only where it is less than half of what the rays are apart.
    """

    def __init__(self, settings: ScanSettings) -> None:
        self._settings = settings
        self._clear()
        self._since = self._agreeing_since = math.inf
        self.is_detected = False

    def add(self, time: float, points: Array, directions: Array) -> None:
        """Take the returns of a scan.

        Args:
            time: s.
            points: as the vehicle sent them (n, 3), one or more (m).
            directions: of the sensor's rays (m, 3), see
                :func:`~idc_controller.perception.scan_placement_kernels.rays_of_returns`.
        """
        s = self._settings
        nearest, angles = rays_of_returns(points, directions)
        mean_square = float(np.mean((angles * np.linalg.norm(points, axis=1)) ** 2))
        is_near = mean_square < (0.5 * s.ray_offset_min) ** 2
        if self.is_detected:
            self._agreeing_since = min(self._agreeing_since, time) if is_near else math.inf
            self.is_detected = time - self._agreeing_since < s.recovery
        elif mean_square < _ROUNDING**2:
            self._clear()
        else:
            self._add(points, directions[nearest])
            self._since = min(self._since, time) if self._is_off() else math.inf
            if time - self._since >= s.ray_offset_duration:
                self._clear()
                self.is_detected, self._agreeing_since = True, math.inf

    def _clear(self) -> None:
        self._information, self._vector = np.zeros((3, 3)), np.zeros(3)
        self._square = self._count = 0.0
        self._since = math.inf

    def _add(self, points: Array, rays: Array) -> None:
        """Take points (n, 3) with the unit vectors of their rays (n, 3)."""
        information, vector, square = _sums(points, rays)
        self._information = _MEMORY * self._information + information
        self._vector = _MEMORY * self._vector + vector
        self._square = _MEMORY * self._square + square
        self._count = _MEMORY * self._count + len(points)

    def _is_off(self) -> bool:
        """Return whether the last scans are off their next rays by more than their scatter explains."""
        s, freedom = self._settings, 2.0 * self._count - _FREEDOM
        if freedom < 1.0:
            return False
        mean, scatter = _fit(self._information, self._vector, self._square, freedom)
        ratio = float(mean @ self._information @ mean) / (_FREEDOM * max(scatter, _ROUNDING**2))
        is_large = float(np.linalg.norm(mean)) > s.ray_offset_min
        return is_large and ratio > float(fdtri(_FREEDOM, freedom, 1.0 - s.ray_offset_false_alarm))


def _sums(points: Array, rays: Array) -> tuple[Array, Array, float]:
    """Return information (3, 3), vector (3,) and square (m2) of points (n, 3) beside rays, unit vectors (n, 3)."""
    beside = points - np.einsum("ni,ni->n", points, rays)[:, None] * rays
    information = len(points) * np.eye(3) - rays.T @ rays
    return information, np.asarray(beside.sum(axis=0)), float(np.sum(beside**2))


def _fit(information: Array, vector: Array, square: float, freedom: float) -> tuple[Array, float]:
    """Return the offset (3,) (m) and the scatter about it (m2); along rays that are all parallel it is 0."""
    mean = np.asarray(np.linalg.solve(information + 1e-6 * np.eye(3), vector))
    return mean, max((square - float(vector @ mean)) / freedom, 0.0)
