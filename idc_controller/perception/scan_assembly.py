"""Assembly of scans: detections of the range sensors become points in the world, by the poses of their vehicles."""

import math
from collections.abc import Iterable, Set
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.perception.pose_history import PoseHistory
from idc_controller.perception.scan_kernels import placed_points
from idc_controller.perception.settings import ScanSettings
from idc_controller.perception.surfaces.points import SurfacePoints
from idc_controller.rotations import rotation_from_quaternion

Point = tuple[float, float, float]


@dataclass(frozen=True)
class SensorModel:
    """Standard deviations of the sensors by which points are placed."""

    range_noise: float
    """Standard deviation along the line of sight (m)."""
    position: float
    """Standard deviation of a vehicle's position, every axis (m)."""
    attitude: float
    """Standard deviation of its attitude, every axis (rad)."""


class Detection(NamedTuple):
    """One point that a vehicle's range sensor detected, as its telemetry reports it."""

    scan: int
    """The same for all points of one scan of a vehicle."""
    obstacle: int
    """The vehicle's own number for the obstacle that the point belongs to."""
    point: Point
    """Position in the vehicle's body frame, forward-right-down (m)."""
    max_range: float
    """Range of the sensor (m)."""


@dataclass(frozen=True, eq=False)
class Cluster:
    """Points that one vehicle assigns to one obstacle, under a number of its own."""

    uav: int
    number: int
    surface_points: SurfacePoints


@dataclass(eq=False)
class _Scan:
    time: float
    max_range: float
    points: dict[int, list[Point]] = field(default_factory=dict)
    count: int = 0


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

    def add(self, detection: Detection, uav: int, time: float) -> None:
        """Add a detection of UAV ``uav`` (0 .. N-1), made at ``time`` (s)."""
        point, max_range = detection.point, detection.max_range
        waiting = self._waiting_points.get(uav, 0)
        if (
            not math.isfinite(sum(point) + max_range)
            or not 0.0 < math.hypot(*point) < self._settings.range_factor * max_range
            or waiting >= self._settings.points_max
        ):
            self.discarded += 1
            self.range_sensors.add_invalid(uav, time)
            return
        key = uav, detection.scan
        scan = self._waiting.get(key)
        if scan is None:
            scan = self._waiting[key] = _Scan(time, max_range)
        scan.points.setdefault(detection.obstacle, []).append(point)
        scan.count += 1
        self._waiting_points[uav] = waiting + 1

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
            stuck = self.range_sensors.check(uav, scan.time, {p for points in scan.points.values() for p in points})
            if pose is None or stuck:
                self.discarded += scan.count
                continue
            sigma = max(s.estimated_attitude_sigma * estimated_attitude, pose_noise_scale * self._sensors.attitude)
            placed.append((scan.time, self._placed(uav, scan, *pose, pose_noise_scale * self._sensors.position, sigma)))
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
        self, uav: int, scan: _Scan, position: Array, quaternion: Array, position_sigma: float, attitude_sigma: float
    ) -> list[Cluster]:
        noise = self._sensors.range_noise
        body = np.array([point for points in scan.points.values() for point in points])
        world, cut, variance = placed_points(
            body, np.ascontiguousarray(position), rotation_from_quaternion(quaternion),
            scan.max_range - self._settings.cut_sigmas * noise, position_sigma, attitude_sigma,
        )  # fmt: skip
        origins = np.tile(position, (len(body), 1))
        clusters, end = [], 0
        for number, points in scan.points.items():
            own = slice(end, end + len(points))
            end = own.stop
            placed = SurfacePoints(scan.time, world[own], origins[own], cut[own], noise, variance[own])
            clusters.append(Cluster(uav, number, placed))
        return clusters
