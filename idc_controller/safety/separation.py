"""Closest points of hull and obstacle at each stage of a plan, and the plane that separates them there."""

from dataclasses import dataclass

import coal
import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import PredictedObstacle

_IDENTITY = coal.Transform3s.Identity()


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


def separations(
    formation: Formation,
    position: Array,
    acceleration: Array,
    obstacles: list[PredictedObstacle],
    within: float,
) -> list[Separation]:
    """The obstacles nearer than ``within`` (m) to a hull at ``position`` (K + 1, 3) under ``acceleration``."""
    if not obstacles:
        return []
    points = formation.hull_points(acceleration)
    centre = (points.max(axis=1) + points.min(axis=1)) / 2.0
    about = points - centre[:, None]
    # Most obstacles are far at all stages: a ball about the hull, for upright ones a cylinder, shows it.
    upright = np.array([obstacle.shape.is_upright for obstacle in obstacles])
    offsets = np.stack([obstacle.positions for obstacle in obstacles]) - position
    directions = offsets - centre
    directions[upright, :, 2] = 0.0
    bound = np.where(
        upright[:, None],
        np.max(np.linalg.norm(about[:, :, :2], axis=2), axis=1),
        np.max(np.linalg.norm(about, axis=2), axis=1),
    )
    away = np.linalg.norm(directions, axis=2)
    far_of_all = away - bound - np.array([_reach(obstacle) for obstacle in obstacles])[:, None]
    near_of_all = far_of_all - np.stack([obstacle.growth for obstacle in obstacles]) < within + 0.5
    hulls: dict[int, coal.ShapeBase] = {}
    request = coal.DistanceRequest()
    result = coal.DistanceResult()
    found = []
    for i in np.flatnonzero(near_of_all.any(axis=1)).tolist():
        obstacle, offset, far, near = obstacles[i], offsets[i], far_of_all[i], np.flatnonzero(near_of_all[i])
        shape = obstacle.shape
        geometry = shape.geometry()
        rotation = shape.rotation
        distance = np.maximum(far, within)
        normals = directions[i] / np.maximum(away[i, :, None], 1e-9)
        for k in near.tolist():
            hull = hulls.get(k)
            if hull is None:
                hull = hulls[k] = formation.hull(points[k], k)
            result.clear()
            distance[k] = coal.distance(
                hull, _IDENTITY, geometry, coal.Transform3s(rotation, offset[k]), request, result
            )
            normal = result.normal
            norm = float(np.linalg.norm(normal))
            if norm > 0.5:
                normals[k] = normal / norm
        if np.min(distance - obstacle.growth) < within:
            found.append(Separation(obstacle, distance, normals))
    return found


def _reach(obstacle: PredictedObstacle) -> float:
    """Return the largest distance of the surface from the centre, of upright shapes in plan view (m)."""
    shape = obstacle.shape
    return shape.horizontal_reach if shape.is_upright else shape.reach
