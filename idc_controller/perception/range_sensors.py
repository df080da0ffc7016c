"""The vehicles' range sensors: their standard deviations, and whether they are valid."""

import math
from collections.abc import Iterable, Set
from dataclasses import dataclass

from idc_controller.arrays import Array
from idc_controller.perception.pose_history import PoseHistory
from idc_controller.perception.settings import ScanSettings

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
        self._silent: dict[int, float] = {}
        self._displaced: dict[int, float] = {}
        self._points: dict[int, set[bytes]] = {}

    def set_failed(self, uavs: Set[int], time: float) -> None:
        """Set the vehicles (0 .. N-1) that report a failure of their sensor."""
        self._failed = {uav: self._failed.get(uav, time) for uav in uavs}

    def set_displaced(self, uav: int, is_displaced: bool, time: float) -> None:
        """Set whether the returns of a vehicle lie beside the rays of its sensor."""
        if not is_displaced:
            self._displaced.pop(uav, None)
        else:
            self._displaced.setdefault(uav, time)

    @property
    def displaced(self) -> frozenset[int]:
        """Vehicles whose returns lie beside the rays of their sensor."""
        return frozenset(self._displaced)

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
        self._silent = {uav: self._silent.get(uav, time) for uav in silent}

    @property
    def silent(self) -> frozenset[int]:
        """Vehicles whose sensor sends no scans."""
        return frozenset(self._silent)

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
            since = min(of.get(uav, math.inf) for of in (self._failed, self._silent, self._displaced))
            if now - since >= patience:
                return True
            invalid = self._invalid.get(uav, -math.inf)
            return now - invalid <= s.recovery and invalid - self._valid.get(uav, -math.inf) > s.invalid_after

        return tuple(uav for uav in uavs if not is_invalid(uav))

    def lost(self, uavs: Iterable[int], now: float) -> bool:
        """Return whether there are ``uavs``, and all their sensors have been invalid for some time."""
        known = tuple(uavs)
        return bool(known) and not self.valid(known, now, self._settings.invalid_after)
