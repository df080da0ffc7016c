"""The vehicles' range sensors: their rays and standard deviations, and whether they are valid.

The simulated sensors scan by the known rays, and the ground knows by them which rays of a scan returned nothing.
Returns lie on the rays, whatever the sensor measures: its noise is along them. Points that lie beside them, all in one
direction, are displaced; no comparison with other vehicles is needed to know it, nor a map.
"""

import math
from collections.abc import Iterable, Set
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import fdtri

from idc_controller.arrays import Array
from idc_controller.perception.pose_history import PoseHistory
from idc_controller.perception.scan_placement_kernels import rays_of_returns
from idc_controller.perception.settings import ScanSettings

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
    """A spherical Fibonacci lattice, turned from scan to scan.

    ``rays`` over all azimuths, evenly from ``elevation_min`` to ``elevation_max`` (rad, up) of the body frame."""

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


_POINT_BYTES = "V24"
"""A row of three numbers as one value."""


@dataclass(frozen=True)
class SensorModel:
    """Standard deviations of the sensors by which points are placed."""

    range_noise: float
    """Standard deviation along the line of sight (m)."""
    position: float
    """Standard deviation of a vehicle's position, every axis (m)."""
    attitude: float
    """Standard deviation of its attitude, every axis (rad)."""


class RangeSensors:
    """Validity of each vehicle's detections over time. Times are the team's (s)."""

    def __init__(self, has_noise: bool, settings: ScanSettings) -> None:
        """``has_noise``: without noise, repeated points are no sign of a stuck sensor."""
        self._has_noise, self._settings = has_noise, settings
        self._valid: dict[int, float] = {}
        self._invalid: dict[int, float] = {}
        self._failed: dict[int, float] = {}
        self._heard: dict[int, float] = {}
        self.silent: dict[int, float] = {}
        """Vehicles whose sensor sends no scans, since when (s)."""
        self.displaced: dict[int, float] = {}
        """Vehicles whose returns lie beside the rays of their sensor, since when (s)."""
        self._points: dict[int, set[bytes]] = {}

    def set_failed(self, uavs: Set[int], time: float) -> None:
        """Set the vehicles (0 .. N-1) that report a failure of their sensor."""
        self._failed = {uav: self._failed.get(uav, time) for uav in uavs}

    def set_displaced(self, uav: int, is_displaced: bool, time: float) -> None:
        """Set whether the returns of a vehicle lie beside the rays of its sensor."""
        if not is_displaced:
            self.displaced.pop(uav, None)
        else:
            self.displaced.setdefault(uav, time)

    def add_scan(self, uav: int, time: float) -> None:
        """Note that telemetry of a scan made at ``time`` has come."""
        self._heard[uav] = max(time, self._heard.get(uav, -math.inf))

    def update_silent(self, poses: PoseHistory, time: float) -> None:
        """Find the sensors of which nothing comes while poses of their vehicle do; none before the first scan of any.

        Lost telemetry loses both, and a scan's messages are not all lost by chance.
        """
        count = self._settings.silent
        silent = {
            uav for uav in poses.uavs if self._heard and poses.has_since(uav, self._heard.get(uav, -math.inf), count)
        }
        self.silent = {uav: self.silent.get(uav, time) for uav in silent}

    def add_invalid(self, uav: int, time: float) -> None:
        """Note an impossible detection of a vehicle."""
        self._invalid[uav] = time

    def check(self, uav: int, time: float, scan: Array) -> bool:
        """Take the points of a scan (n, 3); return whether the sensor is stuck.

        It is where most points repeat earlier ones to the digit: what has noise never does. Not all of them need do so:
        how many points there are may still follow the field of view.
        """
        # As bytes, in which 0 has no sign.
        points = set((scan + 0.0).view(_POINT_BYTES).ravel().tolist())
        before = self._points.get(uav, set())
        stuck = self._has_noise and 2 * len(points & before) > len(points)
        # While it is stuck, points that are out of view now may be repeated later.
        self._points[uav] = points | before if stuck and len(before) < self._settings.points_max else points
        (self._invalid if stuck else self._valid)[uav] = time
        return stuck

    def valid(self, uavs: Iterable[int], now: float, patience: float = 0.0) -> tuple[int, ...]:
        """Return those of ``uavs`` whose sensors are valid; a failure counts after ``patience`` (s)."""
        s = self._settings

        def is_invalid(uav: int) -> bool:
            since = min(of.get(uav, math.inf) for of in (self._failed, self.silent, self.displaced))
            if now - since >= patience:
                return True
            invalid = self._invalid.get(uav, -math.inf)
            return now - invalid <= s.recovery and invalid - self._valid.get(uav, -math.inf) > s.invalid_after

        return tuple(uav for uav in uavs if not is_invalid(uav))

    def lost(self, uavs: Iterable[int], now: float) -> bool:
        """Return whether there are ``uavs``, and all their sensors have been invalid for some time."""
        known = tuple(uavs)
        return bool(known) and not self.valid(known, now, self._settings.invalid_after)


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
