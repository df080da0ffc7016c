"""Assembly of scans: detections of the range sensors become points in the world, by the poses of their vehicles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Set
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.perception.pose_history import PoseHistory
from idc_controller.perception.scan_kernels import grouped, placed_points, possible_points
from idc_controller.perception.settings import ScanSettings
from idc_controller.perception.surfaces.points import SurfacePoints

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


class Detections(NamedTuple):
    """Points of one scan that a vehicle's range sensor detected, as its telemetry reports them."""

    scan: int
    """The same for all points of one scan of a vehicle."""
    obstacles: Indices
    """The vehicle's own number for the obstacle that each point belongs to (n,)."""
    points: Array
    """Positions in the vehicle's body frame, forward-right-down (n, 3) (m)."""
    max_range: Array
    """Range of the sensor, by each message (n,) (m)."""


class Cluster(NamedTuple):
    """Points that one vehicle assigns to one obstacle, under a number of its own: a part of a scan."""

    uav: int
    number: int
    scan: SurfacePoints
    part: slice = slice(None)

    @property
    def surface_points(self) -> SurfacePoints:
        """The points with all that is known of them."""
        return self.scan[self.part]

    @property
    def points(self) -> Array:
        """The points (n, 3) (NED, m)."""
        return self.scan.points[self.part]

    @property
    def pose_variance(self) -> Array:
        """Variance of each point from the sensor's pose, on every axis (n,) (m2)."""
        return self.scan.pose_variance[self.part]

    def shifted(self, by: Array) -> Cluster:
        """Return the cluster with its points shifted ``by`` (3,) (NED, m), detected from the same place."""
        own = self.surface_points
        return Cluster(self.uav, self.number, replace(own, points=own.points + by))


class _Scan:
    """The usable detections of a scan as they come in."""

    def __init__(self, time: float, max_range: float) -> None:
        self.time, self.max_range = time, max_range
        self.count = 0
        self._points: list[Array] = []
        self._numbers: list[Indices] = []

    def add(self, points: Array, numbers: Indices) -> None:
        """Add points (n, 3) and the vehicle's number for the obstacle of each (n,)."""
        self._points.append(points)
        self._numbers.append(numbers)
        self.count += len(points)

    def clusters(self) -> tuple[Array, list[int], list[int]]:
        """Return all points obstacle by obstacle (n, 3), and number and end of each, in the order of their coming."""
        points, numbers = np.concatenate(self._points), np.concatenate(self._numbers)
        order, found, ends = grouped(numbers)
        return points[order], found.tolist(), ends.tolist()


class RangeSensors:
    """Validity of each vehicle's detections over time. Times are the team's (s)."""

    def __init__(self, has_noise: bool, settings: ScanSettings) -> None:
        """``has_noise``: without noise, repeated points are no sign of a stuck sensor."""
        self._has_noise, self._settings = has_noise, settings
        self._valid: dict[int, float] = {}
        self._invalid: dict[int, float] = {}
        self._failed: dict[int, float] = {}
        self._points: dict[int, set[bytes]] = {}

    def set_failed(self, uavs: Set[int], time: float) -> None:
        """Set the vehicles (0 .. N-1) that report a failure of their sensor."""
        self._failed = {uav: self._failed.get(uav, time) for uav in uavs}

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
        return tuple(uav for uav in uavs if not self._is_invalid(uav, now, patience))

    def lost(self, uavs: Iterable[int], now: float) -> bool:
        """Return whether there are ``uavs``, and all their sensors have been invalid for some time."""
        known = tuple(uavs)
        return bool(known) and all(self._is_invalid(uav, now, self._settings.invalid_after) for uav in known)

    def _is_invalid(self, uav: int, now: float, patience: float) -> bool:
        if now - self._failed.get(uav, math.inf) >= patience:
            return True
        invalid, s = self._invalid.get(uav, -math.inf), self._settings
        return now - invalid <= s.recovery and invalid - self._valid.get(uav, -math.inf) > s.invalid_after


class ScanAssembly:
    """Collects detections until their vehicle's pose is known. Times are the team's (s)."""

    def __init__(self, sensors: SensorModel, settings: ScanSettings = ScanSettings()) -> None:
        self._sensors, self._settings = sensors, settings
        self.poses = PoseHistory(self._settings)
        self.range_sensors = RangeSensors(sensors.range_noise > 0.0, self._settings)
        self._waiting: dict[tuple[int, int], _Scan] = {}
        self._waiting_points: dict[int, int] = {}
        self.discarded = 0
        """Detections that were impossible or stuck, or had no pose."""

    def add(self, detections: Detections, uav: int, time: float) -> None:
        """Add detections of UAV ``uav`` (0 .. N-1), made at ``time`` (s)."""
        points, max_range = detections.points, detections.max_range
        waiting = self._waiting_points.get(uav, 0)
        possible = possible_points(points, max_range, self._settings.range_factor)
        usable = possible[: max(self._settings.points_max - waiting, 0)]
        if len(usable) < len(points):
            self.discarded += len(points) - len(usable)
            self.range_sensors.add_invalid(uav, time)
        if not len(usable):
            return
        key = uav, detections.scan
        scan = self._waiting.get(key)
        if scan is None:
            scan = self._waiting[key] = _Scan(time, float(max_range[usable[0]]))
        whole = len(usable) == len(points)
        scan.add(points if whole else points[usable], detections.obstacles if whole else detections.obstacles[usable])
        self._waiting_points[uav] = waiting + len(usable)

    def frames(
        self,
        now: float,
        pose_noise_scale: float = 1.0,
        unusable_positions: frozenset[int] = frozenset(),
        unusable_attitudes: frozenset[int] = frozenset(),
    ) -> list[list[Cluster]]:
        """Return what can be placed, oldest first: the clusters of all vehicles at (nearly) one time.

        Args:
            now: s.
            pose_noise_scale: scale of the poses' standard deviations in :class:`SensorModel`.
            unusable_positions: vehicles whose measured position is not used but the estimated one.
            unusable_attitudes: vehicles whose measured attitude is not.
        """
        s = self._settings
        placed: list[tuple[float, list[Cluster]]] = []
        for key, scan in tuple(self._waiting.items()):
            uav = key[0]
            estimated_attitude = uav in unusable_attitudes
            pose = self.poses.pose(uav, scan.time, uav in unusable_positions, estimated_attitude)
            if pose is None and now - scan.time <= s.pose_wait:
                continue
            del self._waiting[key]
            self._waiting_points[uav] -= scan.count
            if pose is None:
                estimated_attitude = True
                pose = self.poses.pose(uav, scan.time, estimated_position=True, estimated_attitude=True)
            points, numbers, ends = scan.clusters()
            stuck = self.range_sensors.check(uav, scan.time, points)
            if pose is None or stuck:
                self.discarded += scan.count
                continue
            sigma = max(s.estimated_attitude_sigma * estimated_attitude, pose_noise_scale * self._sensors.attitude)
            places = self._placed(scan, points, *pose, pose_noise_scale * self._sensors.position, sigma)
            parts = map(slice, [0, *ends], ends)
            clusters = [Cluster(uav, number, places, part) for number, part in zip(numbers, parts, strict=True)]
            placed.append((scan.time, clusters))
        placed.sort(key=lambda entry: entry[0])
        frames: list[list[Cluster]] = []
        begin = -math.inf
        for time, clusters in placed:
            if time - begin > s.simultaneous:
                begin = time
                frames.append([])
            frames[-1] += clusters
        return frames

    def _placed(
        self, scan: _Scan, body: Array, position: Array, quaternion: Array, position_sigma: float, attitude_sigma: float
    ) -> SurfacePoints:
        """Return the points of a scan, ``body`` (n, 3) in the body frame, in the world."""
        noise = self._sensors.range_noise
        world, cut, variance = placed_points(
            body, np.ascontiguousarray(position), np.ascontiguousarray(quaternion),
            scan.max_range - self._settings.cut_sigmas * noise, position_sigma, attitude_sigma,
        )  # fmt: skip
        return SurfacePoints(scan.time, world, np.tile(position, (len(body), 1)), cut, noise, variance)
