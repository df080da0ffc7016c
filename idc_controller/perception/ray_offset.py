"""Offset of a vehicle's returns from the rays of its range sensor: returns lie on those, whatever the sensor measures.

Its noise is along the rays. Points that lie beside them, all in one direction, are displaced: they show the world where
it is not, and no comparison with other vehicles is needed to know it, nor a map.
"""

import math
from collections import deque

import numpy as np
from scipy.special import fdtri

from idc_controller.arrays import Array
from idc_controller.perception.scan_placement_kernels import rays_of_returns
from idc_controller.perception.settings import ScanSettings

_MEMORY = 0.8
"""Share of the last scans that remains with each scan that has returns."""
_ROUNDING = 2e-3
"""Distances from the rays (m) that telemetry's rounding explains, with much to spare."""
_FIT = 0.02
"""Scatter about the corrected rays (m) up to which a constant offset explains where the returns are."""
_DRIFT = 0.07
"""The same of one that drifts by 0.1 m/s on every axis, over the memory."""
_SEARCHED, _ITERATIONS = 1.5, 4
"""Offsets that are searched (m); fits of each candidate."""
_SCANS, _FEWEST, _MOST = 10, 8, 48
"""Last scans whose returns are searched; least and largest number of those."""
_CHANCE = 0.1
"""Share of the distance between rays up to which the scatter is not that of points anywhere between them."""
_FREEDOM = 3


class RayOffset:
    """Offset of one vehicle's returns, in its body frame. Times are the team's (s).

    A least-squares fit of the last scans' distances from the next rays; what it leaves is their scatter. An offset
    counts if it is large and the scatter does not explain it (F test), for some time. A sudden one may be larger than
    the rays are apart: it is searched. It ends once the returns lie on the rays again.
    """

    def __init__(self, settings: ScanSettings) -> None:
        self._settings = settings
        self._recent = deque[tuple[Array, Array]](maxlen=_SCANS)
        """Returns and rays of the last scans that have some."""
        self._clear()
        self._mean, self._scatter = np.zeros(3), 0.0
        self._since = self._agreeing_since = math.inf
        self._search_from = -math.inf
        self.is_detected = False

    @property
    def correction(self) -> Array:
        """Detected offset (3,) (m); 0 if there is none, or none that explains where the returns are."""
        return self._mean if self.is_detected and self._explains else np.zeros(3)

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
        is_tracked = math.isfinite(self._since)
        if not is_tracked and mean_square < _ROUNDING**2:
            self._clear()
            self._recent.clear()
            return
        self._recent.append((points, directions))
        if not is_near and not (is_tracked and self._explains) and time >= self._search_from:
            self._search_from = time + s.recovery
            found = self._searched()
            if found is not None and float(np.linalg.norm(found)) > s.ray_offset_min:
                self._clear()
                self._mean, self._since, is_tracked = found, min(self._since, time), True
        if is_tracked:
            nearest, _ = rays_of_returns(points - self._mean, directions)
        self._add(points, directions[nearest])
        self._test(time)
        self._agreeing_since = min(self._agreeing_since, time) if is_near else math.inf
        if self.is_detected and time - self._agreeing_since >= s.recovery:
            self.is_detected, self._since = False, math.inf
            self._clear()

    @property
    def _explains(self) -> bool:
        return self._scatter < _DRIFT**2

    def _clear(self) -> None:
        self._information, self._vector = np.zeros((3, 3)), np.zeros(3)
        self._square = self._count = 0.0

    def _add(self, points: Array, rays: Array) -> None:
        """Take points (n, 3) with the unit vectors of their rays (n, 3)."""
        information, vector, square = _sums(points, rays)
        self._information = _MEMORY * self._information + information
        self._vector = _MEMORY * self._vector + vector
        self._square = _MEMORY * self._square + square
        self._count = _MEMORY * self._count + len(points)

    def _test(self, time: float) -> None:
        s, freedom = self._settings, 2.0 * self._count - _FREEDOM
        if freedom < 1.0:
            return
        mean, self._scatter = _fit(self._information, self._vector, self._square, freedom)
        ratio = float(mean @ self._information @ mean) / (_FREEDOM * max(self._scatter, _ROUNDING**2))
        is_off = float(np.linalg.norm(mean)) > s.ray_offset_min
        if is_off and ratio > float(fdtri(_FREEDOM, freedom, 1.0 - s.ray_offset_false_alarm)):
            self._since = min(self._since, time)
            self.is_detected |= time - self._since >= s.ray_offset_duration
            self._mean = mean
        elif not self.is_detected:
            self._since = math.inf

    def _searched(self) -> Array | None:
        """Return an offset (3,) that brings the last scans' returns onto their rays, a small one; None: none does.

        Candidates are those that bring the nearest return onto a ray: there they are closest to each other. What lies
        beside it is fitted first: of that, it does not matter how far the offset is along the rays.
        """
        points = np.concatenate([points for points, _ in self._recent])
        first = int(np.argmin(np.linalg.norm(points, axis=1)))
        order = np.argsort(np.linalg.norm(points - points[first], axis=1))[:_MOST]
        scans = np.repeat(np.arange(len(self._recent)), [len(points) for points, _ in self._recent])[order]
        points, directions = points[order], np.array([directions for _, directions in self._recent])[scans]
        if len(points) < _FEWEST:
            return None
        rays = directions[0]
        height = float(rays[0, 2] - rays[-1, 2])
        apart = math.sqrt(math.tau * height / len(rays)) * float(np.linalg.norm(points[0]))
        limit = min(_FIT, _CHANCE * apart) ** 2
        along = rays @ points[0]
        offsets = points[0] - along[along > 0.0, None] * rays[along > 0.0]
        sizes = np.linalg.norm(offsets, axis=1)
        for candidate in offsets[np.argsort(sizes)][: np.count_nonzero(sizes < _SEARCHED)]:
            mean, count, scatter = candidate, _FEWEST, 0.0
            while scatter < limit:
                near, around = points[:count], directions[:count]
                for _ in range(_ITERATIONS):
                    nearest = np.einsum("nrk,nk->nr", around, near - mean).argmax(axis=1)
                    sums = _sums(near, around[np.arange(len(near)), nearest])
                    mean, scatter = _fit(*sums, 2.0 * len(near) - _FREEDOM)
                if scatter < limit and count >= len(points):
                    return np.asarray(mean)
                count *= 2
        return None


def _sums(points: Array, rays: Array) -> tuple[Array, Array, float]:
    """Return information (3, 3), vector (3,) and square (m2) of points (n, 3) beside rays, unit vectors (n, 3)."""
    beside = points - np.einsum("ni,ni->n", points, rays)[:, None] * rays
    information = len(points) * np.eye(3) - rays.T @ rays
    return information, np.asarray(beside.sum(axis=0)), float(np.sum(beside**2))


def _fit(information: Array, vector: Array, square: float, freedom: float) -> tuple[Array, float]:
    """Return the offset (3,) (m) and the scatter about it (m2); along rays that are all parallel it is 0."""
    mean = np.asarray(np.linalg.solve(information + 1e-6 * np.eye(3), vector))
    return mean, max((square - float(vector @ mean)) / freedom, 0.0)
