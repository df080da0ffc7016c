"""Placement of scans: what a range sensor returned, and what it did not, in the world by the pose of its vehicle."""

import math
from collections import defaultdict, deque
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.pose_history import PoseHistory
from idc_controller.perception.range_sensors import RangeSensors, RayOffset, RayPattern, SensorModel, scan_index
from idc_controller.perception.scan_placement_kernels import free_ends, placed_returns
from idc_controller.perception.settings import ScanSettings
from idc_controller.rotations import rotation_from_quaternion
from idc_controller.rotations_float import into_body

_OFF_RAY = 0.25
"""Share of the mean angle between rays by which a return may lie off the next one, to be that ray's surely."""
_SCATTER_MEMORY = 0.8
"""Share of the last scans' returns in the mean distance from the rays that remains with each scan that has returns."""
_GROUND_SIGMAS = 3.0
"""Standard deviations of a place at the end of the range by which free rays end above the ground."""
_REMEMBERED = 16
"""Scans of a vehicle that wait at most, and that have been placed and of which late messages are recognised."""


class SensorRays(NamedTuple):
    """What is known of the rays of every range sensor."""

    pattern: RayPattern
    rate: float
    """Scans a second (Hz)."""
    ground_height: float
    """Height above the ground up to which a vehicle leaves returns out (m)."""

    def are_towards(self, point: Array, place: Array, attitude: Array) -> bool:
        """Return whether a ``point`` (3,) lies within their elevations.

        From a vehicle at a ``place`` (3,) (NED, m) with an ``attitude`` (4,), body to world.
        """
        (w, x, y, z), (north, east, down) = attitude.tolist(), (point - place).tolist()
        forward, right, below = into_body((w, x, y, z), (north, east, down))
        elevation = math.atan2(-below, math.hypot(forward, right))
        return self.pattern.elevation_min <= elevation <= self.pattern.elevation_max


class Returns(NamedTuple):
    """Returns of one scan of a vehicle, all of them or a part, as its telemetry reports them."""

    stamp: int
    """Time stamp of the scan, by the vehicle's clock (ms)."""
    points: Array
    """Positions in the vehicle's body frame, forward-right-down (n, 3) (m)."""
    max_range: Array
    """Range of the sensor, by each message (n,) (m)."""


class ScanEnd(NamedTuple):
    """The end of a scan, as telemetry reports it behind the returns; also of a scan that has none."""

    stamp: int
    """Time stamp of the scan, by the vehicle's clock (ms)."""
    max_range: float
    """Range of the sensor (m)."""
    is_complete: bool
    """Whether no message of the scan is missing."""


class _Waiting:
    """What has come of a scan."""

    def __init__(self, stamp: int, time: float, since: float) -> None:
        self.stamp, self.time, self.since = stamp, time, since
        self.parts: list[Array] = []
        self.count = 0
        self.max_range: float | None = None
        self.is_complete = False
        """Whether all of its returns have come, all of them possible."""
        self.is_spoilt = False
        """Whether there was an impossible one."""


class _Scatter:
    """How far the returns of a vehicle lie off the rays."""

    def __init__(self) -> None:
        self._squares = self._count = 0.0

    def add(self, square: float, count: int) -> float:
        """Return the standard deviation (m) on every axis across the ray.

        That of this scan, or of the last ones, whichever is larger: a scan may have few returns.

        Args:
            square: mean square of the distances of a scan's returns from their rays (m2).
            count: number of its returns.
        """
        if not count:
            return 0.0
        self._squares = _SCATTER_MEMORY * self._squares + square * count
        self._count = _SCATTER_MEMORY * self._count + count
        return math.sqrt(0.5 * max(square, self._squares / self._count))


class ScanPlacement:
    """Collects returns until all of a scan and its vehicle's pose are known. Times are the team's (s)."""

    def __init__(self, sensors: SensorModel, rays: SensorRays, settings: ScanSettings = ScanSettings()) -> None:
        self._sensors, self._rays, self._settings = sensors, rays, settings
        self.poses = PoseHistory(settings)
        self.range_sensors = RangeSensors(sensors.range_noise > 0.0, settings)
        self._waiting = defaultdict[int, dict[int, _Waiting]](dict)
        """Scans of each vehicle by stamp."""
        self._points_max = max(settings.points_max, _REMEMBERED * rays.pattern.rays)
        self._placed = defaultdict[int, deque[int]](lambda: deque(maxlen=_REMEMBERED))
        """Stamps of the last scans of each vehicle that have been placed or discarded."""
        self._scatter = defaultdict[int, _Scatter](_Scatter)
        self._offsets = defaultdict[int, RayOffset](lambda: RayOffset(settings))
        self.discarded = 0
        """Returns that were impossible, stuck, displaced, too late or too many, or had no pose."""

    def add(self, returns: Returns, uav: int, time: float, now: float) -> None:
        """Add returns of UAV ``uav`` (0 .. N-1) of a scan made at ``time``, that came at ``now`` (s)."""
        points = returns.points
        self.range_sensors.add_scan(uav, time)
        scan = self._scan(uav, returns.stamp, time, now)
        if scan is None:
            self.discarded += len(points)
            return
        distance = np.sqrt(points[:, 0] ** 2 + points[:, 1] ** 2 + points[:, 2] ** 2)
        reach = self._settings.range_factor * returns.max_range
        possible = np.flatnonzero((distance > 0.0) & (distance < reach) & np.isfinite(reach))
        waiting = sum(other.count for other in self._waiting[uav].values())
        usable = possible[: max(self._points_max - waiting, 0)]
        if len(usable) < len(points):
            self.discarded += len(points) - len(usable)
            self.range_sensors.add_invalid(uav, time)
            scan.is_spoilt = True
            points = points[usable]
        scan.parts.append(points)
        scan.count += len(points)

    @property
    def sigma_along(self) -> float:
        """Usual standard deviation of a return along its ray (m)."""
        return math.hypot(self._sensors.range_noise, self._sensors.position)

    def free_height(self, reach: float, position: float | None = None, attitude: float | None = None) -> float:
        """Return the height above the ground (m) at which rays of a ``reach`` (m) end that return nothing.

        By the standard deviations of a pose's ``position`` (m) and ``attitude`` (rad); None: the usual ones.
        """
        sensors = self._sensors
        anywhere = sensors.position if position is None else position
        turning = sensors.attitude if attitude is None else attitude
        spread = math.hypot(sensors.range_noise, anywhere, turning * reach)
        return self._rays.ground_height + _GROUND_SIGMAS * spread

    def end(self, end: ScanEnd, uav: int, time: float, now: float) -> None:
        """Add the end of a scan of UAV ``uav`` made at ``time``, that came at ``now`` (s)."""
        self.range_sensors.add_scan(uav, time)
        scan = self._scan(uav, end.stamp, time, now)
        if scan is not None and end.max_range > 0.0:
            scan.max_range, scan.is_complete = end.max_range, end.is_complete

    def scans(
        self,
        now: float,
        pose_noise_scale: float = 1.0,
        unusable_positions: frozenset[int] = frozenset(),
        unusable_attitudes: frozenset[int] = frozenset(),
    ) -> list[PlacedScan]:
        """Return the scans that can be placed, oldest first.

        A complete scan is placed at once, and another one when no part of it is likely to come any more: until then
        those of its moment and later ones wait. So what several see of a body is one fit of it, in the order of time.

        Args:
            now: s.
            pose_noise_scale: scale of the poses' standard deviations in :class:`SensorModel`.
            unusable_positions: vehicles whose measured position is not used but the estimated one.
            unusable_attitudes: vehicles whose measured attitude is not.
        """
        s = self._settings
        self.range_sensors.update_silent(self.poses, now)
        placed: list[PlacedScan] = []
        waiting = [(uav, scan) for uav, scans in self._waiting.items() for scan in scans.values()]
        unfinished = [scan.time for _, scan in waiting if not scan.is_complete and now - scan.since < s.assembly]
        before = min(unfinished, default=math.inf) - s.simultaneous
        for uav, scan in waiting:
            if scan.time >= before:
                continue
            estimated_attitude = uav in unusable_attitudes
            pose = self.poses.pose(uav, scan.time, uav in unusable_positions, estimated_attitude)
            if pose is None and now - scan.time <= s.pose_wait:
                continue
            if pose is None:
                estimated_attitude = True
                pose = self.poses.pose(uav, scan.time, estimated_position=True, estimated_attitude=True)
            del self._waiting[uav][scan.stamp]
            self._placed[uav].append(scan.stamp)
            points = np.concatenate([np.empty((0, 3)), *scan.parts])
            stuck = bool(scan.count) and self.range_sensors.check(uav, scan.time, points)
            directions = self._rays.pattern.directions(scan_index(scan.stamp, self._rays.rate))
            if self._is_displaced(uav, scan.time, points, directions) or pose is None or stuck:
                self.discarded += scan.count
                continue
            sigma = max(s.estimated_attitude_sigma * estimated_attitude, pose_noise_scale * self._sensors.attitude)
            sigmas = pose_noise_scale * self._sensors.position, sigma
            placed.append(self._place(uav, scan, (points, directions), pose, sigmas))
        placed.sort(key=lambda scan: scan.time)
        return placed

    def _scan(self, uav: int, stamp: int, time: float, now: float) -> _Waiting | None:
        """Return the scan with a ``stamp`` that waits; None: it has been placed, or too many wait."""
        waiting = self._waiting[uav]
        scan = waiting.get(stamp)
        if scan is None and stamp not in self._placed[uav] and len(waiting) < _REMEMBERED:
            scan = waiting[stamp] = _Waiting(stamp, time, now)
        return scan

    def _place(
        self,
        uav: int,
        scan: _Waiting,
        measured: tuple[Array, Array],
        pose: tuple[Array, Array],
        sigmas: tuple[float, float],
    ) -> PlacedScan:
        """Return the scan by its returns (n, 3) and rays (m, 3) in the body frame, and ``sigmas`` of the pose."""
        points, directions = measured
        along, (anywhere, turning) = self._sensors.range_noise, sigmas
        place, rotation = np.ascontiguousarray(pose[0]), rotation_from_quaternion(pose[1])
        returns, rays, (square, angle) = placed_returns(points, directions, place, rotation)
        # Returns lie on the sensor's rays: how far they are off shows an error beyond its noise.
        off = self._scatter[uav].add(float(square), len(returns))
        free = np.empty((0, 3))
        is_sure = scan.is_complete and not scan.is_spoilt and angle <= _OFF_RAY * self._rays.pattern.spacing
        if is_sure and scan.max_range is not None:
            reach = scan.max_range
            free = free_ends(directions, rays, place, rotation, reach, self.free_height(reach, anywhere, turning))
        sigma = math.hypot(anywhere, off)
        return PlacedScan(scan.time, place, returns, along, sigma, turning, free, uav, up=-rotation[:, 2])

    def _is_displaced(self, uav: int, time: float, points: Array, directions: Array) -> bool:
        """Take a vehicle's returns ``points`` (n, 3); return whether they are displaced from its rays."""
        offset = self._offsets[uav]
        if len(points):
            offset.add(time, points, directions)
            self.range_sensors.set_displaced(uav, offset.is_detected, time)
        return offset.is_detected
