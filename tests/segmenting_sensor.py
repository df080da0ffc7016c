"""A range sensor that segments perfectly: few points of each obstacle, under its own numbers, for tests of tracks."""

import math
from typing import NamedTuple

import numpy as np

from idc_controller.rotations import rotation_from_quaternion


class SegmentedSample(NamedTuple):
    """Points (n, 3) in the body frame of one scan at ``time`` (s), each with the number of its obstacle (n,)."""

    time: float
    reach: float
    obstacle_ids: np.ndarray
    points: np.ndarray


class SegmentingSensor:
    def __init__(self, reach, noise, seed, vehicle):
        self._reach, self._noise = reach, noise
        self._generator, self._ids = np.random.default_rng([seed, 1_000_003, vehicle]), {}
        self._next = 0

    def scan(self, time, position, attitude, obstacles):
        ids, parts, detected = [], [np.empty((0, 3))], {}
        for obstacle in obstacles:
            offset = np.asarray(position) - np.array(obstacle.position_in_world)
            if np.linalg.norm(offset) > self._reach + obstacle.shape.reach:
                continue
            turn = self._generator.uniform(0.0, math.pi / 3.0)
            rays = obstacle.shape.visible_points(tuple(offset), self._reach, turn) - offset
            ranges = np.linalg.norm(rays, axis=1)
            rays, ranges = rays[ranges <= self._reach + 1e-9], ranges[ranges <= self._reach + 1e-9]
            if not len(rays):
                continue
            number = self._ids.get(obstacle.name)
            if number is None:
                number, self._next = self._next, self._next + 1
            detected[obstacle.name] = number
            scale = 1.0 + self._noise * self._generator.standard_normal(len(rays)) / ranges
            parts.append(rays * np.maximum(scale, 0.0)[:, None])
            ids += [number] * len(rays)
        self._ids = detected
        points = np.concatenate(parts) @ rotation_from_quaternion(np.array(attitude))
        return SegmentedSample(time, self._reach, np.array(ids, dtype=np.intp), points)
