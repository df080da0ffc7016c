"""Detections of the range sensors become points in the world, by the poses of the vehicles that made them."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Set
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.measurements import Attitude, Measurement, Position
from idc_controller.perception.surfaces.points import SurfacePoints
from idc_controller.rotations import quaternion_product, rotation_from_quaternion

Array = NDArray[np.float64]
_Pose = TypeVar("_Pose", Attitude, Position)

POSE_GAP = 0.1  # s between a scan and the pose by which it is placed
PATIENCE = 0.3  # s for which a scan waits for its pose
TOGETHER = 0.02  # s within which scans of several vehicles count as one frame
ESTIMATED_ATTITUDE = 0.03
"""Standard deviation of an attitude that is estimated, not told (rad): in hard manoeuvres models are off by as much."""
BLIND_AFTER = 0.5  # s in which a vehicle tells nothing, or what can not be, or the same to the digit
BLIND_FOR = 1.0  # s after the last of it
_POSES = 30
_CUT = 4.0  # standard deviations from the sensor's range at which a point may have been cut off by it
_POINTS_MAX = 2000  # of a vehicle that wait at a time


@dataclass(frozen=True)
class SensorModel:
    """What is known of the sensors: standard deviations."""

    range_noise: float
    """m, along the line of sight"""
    position: float
    """m, of a vehicle's position, every axis"""
    attitude: float
    """rad, of its attitude, every axis"""


@dataclass(frozen=True)
class Detection:
    """One point that a vehicle's range sensor detected, as its telemetry reports it."""

    scan: int
    """The same for all points of one scan of a vehicle."""
    obstacle: int
    """The vehicle's own number for the obstacle that the point belongs to."""
    point: tuple[float, float, float]
    """In the vehicle's body frame, forward-right-down (m)."""
    max_range: float
    """Of the sensor (m)."""


@dataclass(frozen=True, eq=False)
class Cluster:
    """The points that one vehicle takes for one obstacle, under a number of its own."""

    uav: int
    number: int
    seen: SurfacePoints


@dataclass(eq=False)
class _Scan:
    time: float
    reach: float
    points: dict[int, list[tuple[float, float, float]]] = field(default_factory=dict)
    count: int = 0


class ScanInbox:
    """Gathers messages until they can be placed. Times are the team's (s)."""

    def __init__(self, sensors: SensorModel) -> None:
        self._sensors = sensors
        self._attitudes: dict[int, deque[Attitude]] = {}
        self._positions: dict[int, deque[Position]] = {}
        self._estimated_attitudes: dict[int, deque[Attitude]] = {}
        self._estimated_positions: dict[int, deque[Position]] = {}
        self._waiting: dict[tuple[int, int], _Scan] = {}
        self._waiting_points: dict[int, int] = {}
        self._told: dict[int, set[tuple[float, float, float]]] = {}
        self._sound: dict[int, float] = {}
        self._nonsense: dict[int, float] = {}
        self._broken: dict[int, float] = {}
        self.refused = 0
        """Messages that made no sense, and scans that no pose was known for."""

    def measured(self, sample: Measurement) -> None:
        """A position or an attitude of a vehicle."""
        if sample.source < 0 or not sample.has_pose:
            return
        if isinstance(sample, Attitude):
            self._attitudes.setdefault(sample.source, deque(maxlen=_POSES)).append(sample)
        else:
            self._positions.setdefault(sample.source, deque(maxlen=_POSES)).append(sample)

    def estimated(self, sample: Measurement) -> None:
        """What the ground thinks of a vehicle's position or attitude: for one that does not know them itself."""
        if isinstance(sample, Attitude):
            self._estimated_attitudes.setdefault(sample.source, deque(maxlen=_POSES)).append(sample)
        else:
            self._estimated_positions.setdefault(sample.source, deque(maxlen=_POSES)).append(sample)

    def detected(self, detection: Detection, uav: int, time: float) -> None:
        """Add a detection of UAV ``uav`` (0 .. N-1), made at ``time``."""
        point, reach = detection.point, detection.max_range
        waiting = self._waiting_points.get(uav, 0)
        if (
            not math.isfinite(sum(point) + reach)
            or not 0.0 < math.hypot(*point) < 2.0 * reach
            or waiting >= _POINTS_MAX
        ):
            self.refused += 1
            self._nonsense[uav] = time
            return
        key = uav, detection.scan
        scan = self._waiting.get(key)
        if scan is None:
            scan = self._waiting[key] = _Scan(time, reach)
        scan.points.setdefault(detection.obstacle, []).append(point)
        scan.count += 1
        self._waiting_points[uav] = waiting + 1

    def broken(self, uavs: Set[int], time: float) -> None:
        """Vehicles whose sensors do not work, as they say."""
        self._broken = {uav: self._broken.get(uav, time) for uav in uavs}

    def position(self, uav: int, time: float, within: float) -> Array | None:
        """Where a vehicle was at ``time`` (3,), if its telemetry told so within that time (s) before."""
        history = self._positions.get(uav)
        if not history or not abs(time - history[-1].time) <= within:
            return None
        return history[-1].position

    @property
    def has_vehicles(self) -> bool:
        """Whether any has told where it is."""
        return bool(self._positions)

    def seeing(self, now: float, patience: float = 0.0) -> tuple[int, ...]:
        """Vehicles that have told where they are, but those whose words of obstacles make no sense.

        And those whose sensors have been broken for longer than ``patience`` (s).
        """

        def is_blind(uav: int) -> bool:
            broken = self._broken.get(uav, math.inf)
            if now - broken >= patience:
                return True
            nonsense = self._nonsense.get(uav, -math.inf)
            return now - nonsense <= BLIND_FOR and nonsense - self._sound.get(uav, -math.inf) > BLIND_AFTER

        return tuple(uav for uav in self._positions if not is_blind(uav))

    def frames(
        self,
        now: float,
        pose_noise: float = 1.0,
        misplaced: frozenset[int] = frozenset(),
        misaligned: frozenset[int] = frozenset(),
    ) -> list[list[Cluster]]:
        """What can be placed, oldest first: the clusters of all vehicles at (nearly) one time.

        ``pose_noise``: factor of the poses' noise over what :class:`SensorModel` says. ``misplaced``: vehicles that are
        not where they say; ``misaligned``: whose attitude is not what they say. They are placed by what is estimated.
        """
        placed: list[tuple[float, list[Cluster]]] = []
        for key, scan in tuple(self._waiting.items()):
            uav = key[0]
            is_misaligned = uav in misaligned
            pose = self._pose(uav, scan.time, uav in misplaced, is_misaligned)
            if pose is None and now - scan.time <= PATIENCE:
                continue
            del self._waiting[key]
            self._waiting_points[uav] -= scan.count
            if pose is None:
                is_misaligned = True
                pose = self._pose(uav, scan.time, misplaced=True, misaligned=True)
            frozen = self._is_frozen(uav, scan)
            if frozen:
                self._nonsense[uav] = scan.time
            else:
                self._sound[uav] = scan.time
            if pose is None or frozen:
                self.refused += scan.count
                continue
            sigma = max(ESTIMATED_ATTITUDE * is_misaligned, pose_noise * self._sensors.attitude)
            placed.append((scan.time, self._placed(uav, scan, *pose, pose_noise * self._sensors.position, sigma)))
        placed.sort(key=lambda entry: entry[0])
        frames: list[list[Cluster]] = []
        begin = -math.inf
        for time, clusters in placed:
            if time - begin > TOGETHER:
                begin = time
                frames.append([])
            frames[-1] += clusters
        return frames

    def _is_frozen(self, uav: int, scan: _Scan) -> bool:
        """Whether most points are, to the digit, what the vehicle has told before: what has noise never is.

        Not all of them need be: how many points there are may still follow what is in sight.
        """
        told = {point for points in scan.points.values() for point in points}
        before = self._told.get(uav, set())
        frozen = self._sensors.range_noise > 0.0 and 2 * len(told & before) > len(told)
        # While it sticks, points that are out of sight now may be told again later.
        self._told[uav] = told | before if frozen and len(before) < _POINTS_MAX else told
        return frozen

    def _placed(
        self, uav: int, scan: _Scan, position: Array, quaternion: Array, position_sigma: float, attitude_sigma: float
    ) -> list[Cluster]:
        rotation = rotation_from_quaternion(quaternion)
        s = self._sensors
        body = np.array([point for points in scan.points.values() for point in points])
        distance = np.sqrt(np.einsum("ij,ij->i", body, body))
        world = position + body @ rotation.T
        origins = np.broadcast_to(position, body.shape)
        cut = distance > scan.reach - _CUT * s.range_noise
        variance = position_sigma**2 + (attitude_sigma * distance) ** 2
        clusters, end = [], 0
        for number, points in scan.points.items():
            own = slice(end, end + len(points))
            end = own.stop
            seen = SurfacePoints(scan.time, world[own], origins[own], cut[own], s.range_noise, variance[own])
            clusters.append(Cluster(uav, number, seen))
        return clusters

    def _pose(self, uav: int, time: float, misplaced: bool, misaligned: bool) -> tuple[Array, Array] | None:
        """Position (3,) and attitude (4,) at ``time``, from the samples next to it, motion told or estimated."""
        attitudes, positions = self._estimated_attitudes.get(uav), self._estimated_positions.get(uav)
        attitude = _nearest(attitudes if misaligned else self._attitudes.get(uav), time)
        position = _nearest(positions if misplaced else self._positions.get(uav), time)
        if attitude is None or position is None:
            return None
        turning = attitude if attitude.has_motion else _nearest(attitudes, time)
        moving = position if position.has_motion else _nearest(positions, time)
        quaternion, place = attitude.quaternion, position.position
        if turning is not None and abs(dt := time - attitude.time) > 1e-4:
            quaternion = quaternion_product(quaternion, np.append(1.0, 0.5 * dt * turning.rates))
            quaternion = quaternion / np.linalg.norm(quaternion)
        if moving is not None:
            place = place + (time - position.time) * moving.velocity
        return place, quaternion


def _nearest(history: deque[_Pose] | None, time: float) -> _Pose | None:
    if not history:
        return None
    found = history[-1]
    for sample in reversed(history):
        if abs(sample.time - time) > abs(found.time - time):
            break
        found = sample
    return found if abs(found.time - time) <= POSE_GAP else None
