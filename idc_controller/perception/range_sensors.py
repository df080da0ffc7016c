"""Validity of the vehicles' range sensors: failures they report, impossible detections, and stuck scans."""

import math
from collections.abc import Iterable, Set

from idc_controller.perception.settings import ScanSettings

Point = tuple[float, float, float]


class RangeSensors:
    """Validity of each vehicle's detections over time. Times are the team's (s)."""

    def __init__(self, has_noise: bool, settings: ScanSettings) -> None:
        """``has_noise``: without noise, repeated points are no sign of a stuck sensor."""
        self._has_noise, self._settings = has_noise, settings
        self._valid: dict[int, float] = {}
        self._invalid: dict[int, float] = {}
        self._failed: dict[int, float] = {}
        self._points: dict[int, set[Point]] = {}

    def set_failed(self, uavs: Set[int], time: float) -> None:
        """Set the vehicles (0 .. N-1) that report a failure of their sensor."""
        self._failed = {uav: self._failed.get(uav, time) for uav in uavs}

    def add_invalid(self, uav: int, time: float) -> None:
        """Note an impossible detection of a vehicle."""
        self._invalid[uav] = time

    def check(self, uav: int, time: float, points: Set[Point]) -> bool:
        """Take the points of a scan; return whether the sensor is stuck.

        It is where most points repeat earlier ones to the digit: what has noise never does. Not all of them need do so:
        how many points there are may still follow the field of view.
        """
        before = self._points.get(uav, set())
        stuck = self._has_noise and 2 * len(points & before) > len(points)
        # While it is stuck, points that are out of view now may be repeated later.
        self._points[uav] = {*points, *before} if stuck and len(before) < self._settings.points_max else set(points)
        (self._invalid if stuck else self._valid)[uav] = time
        return stuck

    def valid(self, uavs: Iterable[int], now: float, patience: float = 0.0) -> tuple[int, ...]:
        """Return those of ``uavs`` whose sensors are valid; a failure counts after ``patience`` (s)."""
        s = self._settings

        def is_invalid(uav: int) -> bool:
            if now - self._failed.get(uav, math.inf) >= patience:
                return True
            invalid = self._invalid.get(uav, -math.inf)
            return now - invalid <= s.recovery and invalid - self._valid.get(uav, -math.inf) > s.invalid_after

        return tuple(uav for uav in uavs if not is_invalid(uav))

    def lost(self, uavs: Iterable[int], now: float) -> bool:
        """Return whether there are ``uavs``, and all their sensors have been invalid for some time."""
        known = tuple(uavs)
        return bool(known) and not self.valid(known, now, self._settings.invalid_after)
