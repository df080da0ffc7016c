"""Closest points of hull and obstacle at each stage of a plan, and the plane that separates them there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import coal
import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.safety.planner_kernels import within_reach

_IDENTITY = coal.Transform3s.Identity()
_BROAD = 0.5
"""Distance (m) beyond the asked one up to which bounds of hull and obstacle let distances be computed."""


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
    indices, far, offsets, directions = within_reach(
        points, np.ascontiguousarray(position), obstacles.centres, obstacles.growth, obstacles.reach,
        obstacles.upright, within + _BROAD,
    )  # fmt: skip
    hulls: dict[int, coal.ShapeBase] = {}
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    found = []
    for index, apart, offset, normals in zip(indices.tolist(), far, offsets, directions, strict=True):
        obstacle = obstacles[index]
        geometry, placed = obstacle.shape.geometry(), coal.Transform3s(obstacle.shape.rotation, offset[0])
        near = np.flatnonzero(apart - obstacle.growth < within + _BROAD)
        distances, measured = [], np.empty((len(near), 3))
        for row, k in zip(measured, near.tolist(), strict=True):
            hull = hulls.get(k)
            if hull is None:
                hull = hulls[k] = formation.hull(points[k], k)
            placed.setTranslation(offset[k])
            result.clear()
            distances.append(coal.distance(hull, _IDENTITY, geometry, placed, request, result))
            row[:] = result.normal
        distance = np.maximum(apart, within)
        distance[near] = distances
        if np.min(distance - obstacle.growth) < within:
            _set_normals(normals, near, measured)
            found.append(Separation(obstacle, distance, normals))
    return found


def _set_normals(normals: Array, stages: NDArray[np.int_], measured: Array) -> None:
    """Set ``normals`` (K + 1, 3) at ``stages`` (M,) to those ``measured`` (M, 3), where the bodies have one."""
    norms = np.sqrt(np.einsum("ij,ij->i", measured, measured))
    given = norms > 0.5
    normals[stages[given]] = measured[given] / norms[given, None]


def _reach(obstacle: PredictedObstacle) -> float:
    """Return the largest distance of the surface from the centre, of upright shapes in plan view (m)."""
    shape = obstacle.shape
    return shape.horizontal_reach if shape.is_upright else shape.reach
