"""The range sensor of a vehicle: points on the surfaces around it, gathered by obstacle, each with its own noise.

It reports where points are and which of them belong together, under numbers of the vehicle's own. It does not report
what an obstacle is, how large, how fast, or what it is called.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from gcs.config import RangeSensorConfig
from idc_controller.arrays import Array
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world.obstacle_bodies import Obstacle, bounding_radius
from vehicle_sim.world.range_sensor_kernels import measured, rays_in_reach

#: Distinguishes these generators from the navigation sensors'.
_STREAM = 1_000_003
_IDS = 0xFFFE  # 0xFFFF says that an id is not known


class Detection(NamedTuple):
    """One point: the vehicle's number for the obstacle, and the place in the body frame, forward-right-down (m)."""

    obstacle_id: int
    position_in_body: Vector


class RangeSample(NamedTuple):
    """All points of one scan at ``time`` (s); the sensor's largest and least distance (m), and whether it works."""

    time: float
    reach: float
    detections: tuple[Detection, ...]
    works: bool = True
    range_min: float = RangeSensorConfig.range_min


class RangeSensor:
    """The same seed and id give the same noise, different ids independent noise."""

    def __init__(self, settings: RangeSensorConfig, seed: int, system_id: int) -> None:
        self._settings = settings
        self._generator = np.random.default_rng([seed, _STREAM, system_id])
        self._ids: dict[str, int] = {}
        self._next_id = 0

    @property
    def reach(self) -> float:
        """Largest distance of what it detects (m)."""
        return self._settings.range

    def scan(
        self, now: float, position: Sequence[float], attitude: Quaternion, obstacles: Iterable[Obstacle]
    ) -> RangeSample:
        """Return the scan at ``now`` (s) from ``position`` (3,) (NED, m) with ``attitude`` (body to world)."""
        s = (float(position[0]), float(position[1]), float(position[2]))
        reach, nearest = self._settings.range, self._settings.range_min
        rays, errors, numbers = [np.empty((0, 3))], [np.empty(0)], list[int]()
        detected: dict[str, int] = {}
        for obstacle in obstacles:
            if _is_beyond(obstacle, s, reach):
                continue
            found = visible_rays(obstacle, s, reach, float(self._generator.uniform(0.0, math.pi / 3.0)))
            if not len(found):
                continue
            number = self._ids.get(obstacle.name)
            if number is None:
                number, self._next_id = self._next_id, (self._next_id + 1) % _IDS
            detected[obstacle.name] = number
            rays.append(found)
            errors.append(self._generator.standard_normal(len(found)))
            numbers += [number] * len(found)
        self._ids = detected  # one that leaves and comes back is a new one to the vehicle
        noise = self._settings.noise * np.concatenate(errors)
        places = measured(np.concatenate(rays), noise, *attitude, nearest).tolist()
        detections = tuple(
            Detection(number, (x, y, z)) for number, (x, y, z) in zip(numbers, places, strict=True) if not math.isnan(x)
        )
        return RangeSample(now, reach, detections, range_min=nearest)


def visible_rays(obstacle: Obstacle, sensor: Vector, reach: float, turn: float) -> Array:
    """Rays (n, 3) (m) in the world from a sensor to points of the surface within ``reach`` (m), the nearest first.

    An obstacle hides its own far side; it does not hide others.
    """
    x, y, z = obstacle.position_in_world
    offset = (sensor[0] - x, sensor[1] - y, sensor[2] - z)
    return rays_in_reach(obstacle.shape.visible_points(offset, reach, turn), *offset, reach + 1e-9)


def _is_beyond(obstacle: Obstacle, sensor: Vector, reach: float) -> bool:
    """Return True for an obstacle that is surely out of reach: a cheap check before the others."""
    return math.dist(obstacle.position_in_world, sensor) > reach + bounding_radius(obstacle.shape)
