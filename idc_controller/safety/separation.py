"""Closest points of hull and obstacle at each stage of a plan, and the plane that separates them there.

Also of a formation at rest: the obstacle that is nearest to it, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import coal
import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.gjk_kernels import measure_distances
from idc_controller.geometry.obstacles import ObstacleSource, PredictedObstacle
from idc_controller.geometry.shape import Shape
from idc_controller.safety.planner_kernels import within_reach

_IDENTITY = coal.Transform3s.Identity()
_BROAD = 0.5
"""Distance (m) beyond the requested one up to which bounds of hull and obstacle let distances be computed."""


@dataclass(frozen=True, eq=False)
class Separation:
    """One obstacle against the hull at stages 0 .. K."""

    obstacle: PredictedObstacle
    distance: Array
    """Hull to the obstacle's surface, negative when they overlap; inf where it is far (K + 1,) (m)."""
    normals: Array
    """Unit vectors from hull to obstacle (K + 1, 3)."""

    @property
    def clearance(self) -> float:
        """Least distance over the stages, less the growth (m)."""
        return float(np.min(self.distance - self.obstacle.growth))

    def one_sided(self) -> Self:
        """Return the separation with planes that do not change sides where the hull leads through the obstacle.

        Of a hull inside an obstacle the normal is that of the nearest way out. Where it turns round from one stage to
        the next, the hull would come out on the other side, which planes on both sides would let it do; from there on
        the plane stays as it was before.
        """
        turned = (self.normals[1:] * self.normals[:-1]).sum(axis=1) < 0.0
        turned &= np.minimum(self.distance[1:], self.distance[:-1]) < 0.0
        if not turned.any():
            return self
        first = int(turned.argmax())
        normals = self.normals.copy()
        normals[first + 1 :] = normals[first]
        return replace(self, normals=normals)


class PredictedObstacles:
    """The obstacles of one step, gathered for distances to all of them together."""

    def __init__(self, obstacles: Sequence[PredictedObstacle], extra_growth: Array | float = 0.0) -> None:
        """``extra_growth`` (K + 1,) (m) is added to the growth of each."""
        self._obstacles = obstacles
        self.count = len(obstacles)
        if obstacles:
            self.centres = np.array([obstacle.positions for obstacle in obstacles])
            self.growth = np.array([obstacle.growth for obstacle in obstacles]) + extra_growth
            self.upright = np.array([obstacle.shape.is_upright for obstacle in obstacles])
            self.reach = np.array([_reach(obstacle) for obstacle in obstacles])
            self.rows = np.array([obstacle.shape.row for obstacle in obstacles])
            self.rounded = np.array([obstacle.shape.rounded_box is not None for obstacle in obstacles])

    def shape(self, index: int) -> Shape:
        """Return the shape of one obstacle."""
        return self._obstacles[index].shape

    def __getitem__(self, index: int) -> PredictedObstacle:
        """Return one obstacle with all of its growth."""
        obstacle = self._obstacles[index]
        return replace(obstacle, growth=self.growth[index])


def separations(
    formation: Formation,
    position: Array,
    acceleration: Array,
    obstacles: PredictedObstacles,
    within: float,
) -> list[Separation]:
    """The obstacles nearer than ``within`` (m) to a hull at ``position`` (K + 1, 3) under ``acceleration``."""
    if not obstacles.count:
        return []
    points = formation.hull_points(acceleration)
    # Most obstacles are far at all stages: bounds of hull and obstacles show it.
    indices, far, offsets, normals = within_reach(
        points, np.ascontiguousarray(position), obstacles.centres, obstacles.growth, obstacles.reach,
        obstacles.upright, within + _BROAD,
    )  # fmt: skip
    distances, missing = measure_distances(
        points, indices, offsets, far, normals, obstacles.growth, obstacles.rows, obstacles.rounded, within,
        within + _BROAD,
    )  # fmt: skip
    numbers = indices.tolist()
    if missing.any():
        for i, number in enumerate(numbers):
            shape = obstacles.shape(number)
            _measure_by_library(formation, points, shape, offsets[i], distances[i], normals[i], missing[i])
    near = (distances - obstacles.growth[indices]).min(axis=1, initial=np.inf) < within
    return [Separation(obstacles[numbers[i]], distances[i], normals[i]) for i in np.flatnonzero(near).tolist()]


def _measure_by_library(
    formation: Formation, points: Array, shape: Shape, offsets: Array, distances: Array, normals: Array, stages: Mask
) -> None:
    """Set ``distances`` (K + 1,) and ``normals`` (K + 1, 3) at some ``stages`` (K + 1,), also where bodies overlap."""
    geometry, placed = shape.geometry(), coal.Transform3s(shape.rotation, offsets[0])
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    for k in np.flatnonzero(stages).tolist():
        placed.setTranslation(offsets[k])
        result.clear()
        distances[k] = coal.distance(formation.hull(points[k]), _IDENTITY, geometry, placed, request, result)
        norm = float(np.linalg.norm(result.normal))
        if norm > 0.5:  # the library has one
            normals[k] = result.normal / norm


def _reach(obstacle: PredictedObstacle) -> float:
    """Return the largest distance of the surface from the centre, of upright shapes in plan view (m)."""
    shape = obstacle.shape
    return shape.horizontal_reach if shape.is_upright else shape.reach


class Obstruction(NamedTuple):
    """An obstacle, and its distance (m) from the hull as it is known; negative: it reaches into it."""

    name: str
    distance: float

    def lacking(self, keep: float) -> str:
        """Return in words how much nearer it is than ``keep`` (m)."""
        if self.distance <= 0.0:
            missing = f", {keep - self.distance:.2f} m are missing" if keep > 0.0 else ""
            return f"{self.name} reaches {-self.distance:.2f} m into the formation there{missing}"
        missing = f"{self.distance:.2f} m from the formation there, {keep - self.distance:.2f} m are missing"
        return f"{self.name} is {missing}"


def obstruction(
    formation: Formation, obstacles: ObstacleSource, time: float, place: Array, within: float
) -> Obstruction | None:
    """Return what is nearer than ``within`` (m) to a ``formation`` at rest at ``place`` (3,) at ``time`` (s)."""
    predicted = PredictedObstacles(obstacles.predict(np.array([time])))
    near = separations(formation, place.reshape(1, 3), np.zeros((1, 3)), predicted, within)
    found = [Obstruction(each.obstacle.name, float(each.distance[0])) for each in near]
    return min((each for each in found if each.distance < within), key=lambda each: each.distance, default=None)
