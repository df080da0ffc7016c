"""The range sensor of a vehicle: points on the surfaces around it, gathered by obstacle, each with its own noise.

It reports where points are and which of them belong together, under numbers of the vehicle's own. It does not report
what an obstacle is, how large, how fast, or what it is called.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gcs.config import RangeSensorConfig
from idc_controller.arrays import Array, Indices
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world.obstacle_bodies import Obstacle, ScanTargets
from vehicle_sim.world.range_sensor_kernels import measured, rays_in_reach, scanned

#: Distinguishes these generators from the navigation sensors'.
_STREAM = 1_000_003
_IDS = 0xFFFE  # 0xFFFF says that an id is not known


class RangeSample(NamedTuple):
    """All points of one scan at ``time`` (s); the sensor's largest and least distance (m), and whether it works."""

    time: float
    reach: float
    obstacle_ids: Indices
    """The vehicle's number for the obstacle of each point (n,)."""
    points: Array
    """Places in the body frame, forward-right-down (n, 3) (m)."""
    works: bool = True
    range_min: float = RangeSensorConfig.range_min


class RangeSensor:
    """The same seed and id give the same noise, different ids independent noise."""

    def __init__(self, settings: RangeSensorConfig, seed: int, system_id: int) -> None:
        self._settings = settings
        self._generator = np.random.default_rng([seed, _STREAM, system_id])
        self._ids: dict[str, int] = {}
        self._next_id = 0

    def scan(self, now: float, position: Sequence[float], attitude: Quaternion, targets: ScanTargets) -> RangeSample:
        """Return the scan at ``now`` (s) from ``position`` (3,) (NED, m) with ``attitude`` (body to world)."""
        s, generator = self._settings, self._generator
        pose, limits = np.array([*position, *attitude], dtype=float), np.array([s.range, s.range_min, s.noise])
        parts, begin = [], 0
        for row in [*targets.without_form, len(targets.obstacles)]:
            parts.append(scanned(generator, targets.centres, targets.forms, begin, row, pose, limits))
            if row < len(targets.obstacles):
                points = self._points(targets.obstacles[row], pose)
                parts.append((np.full(len(points), row), points))
            begin = row + 1
        rows, points = (np.concatenate(part) for part in zip(*parts, strict=True))
        numbers = self._numbers(targets.obstacles, rows)
        is_measured = ~np.isnan(points[:, 0])
        return RangeSample(now, s.range, numbers[is_measured], points[is_measured], range_min=s.range_min)

    def _points(self, obstacle: Obstacle, pose: Array) -> Array:
        """Return what is measured of an obstacle without form (n, 3), nan for points too near."""
        s = self._settings
        x, y, z, q_w, q_x, q_y, q_z = pose.tolist()
        if math.dist(obstacle.position_in_world, (x, y, z)) > s.range + obstacle.bounding_radius:
            return np.empty((0, 3))
        rays = visible_rays(obstacle, (x, y, z), s.range, float(self._generator.uniform(0.0, math.pi / 3.0)))
        return measured(rays, s.noise * self._generator.standard_normal(len(rays)), q_w, q_x, q_y, q_z, s.range_min)

    def _numbers(self, obstacles: Sequence[Obstacle], rows: Indices) -> Indices:
        """Return the number of each point's obstacle, given by ``rows`` (n,), in ascending order."""
        numbers, detected = np.zeros(len(obstacles), dtype=np.intp), dict[str, int]()
        for row in np.flatnonzero(np.bincount(rows)).tolist():
            name = obstacles[row].name
            number = self._ids.get(name)
            if number is None:
                number, self._next_id = self._next_id, (self._next_id + 1) % _IDS
            detected[name] = numbers[row] = number
        self._ids = detected  # one that leaves and comes back is a new one to the vehicle
        return numbers[rows]


def visible_rays(obstacle: Obstacle, sensor: Vector, reach: float, turn: float) -> Array:
    """Rays (n, 3) (m) in the world from a sensor to points of the surface within ``reach`` (m), the nearest first.

    An obstacle hides its own far side; it does not hide others.
    """
    x, y, z = obstacle.position_in_world
    offset = (sensor[0] - x, sensor[1] - y, sensor[2] - z)
    return rays_in_reach(obstacle.shape.visible_points(offset, reach, turn), *offset, reach + 1e-9)
