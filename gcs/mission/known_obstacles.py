"""Obstacles of the mission file as shapes in the world, for the ground that knows them."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from gcs.mission.fence import boundary_walls
from gcs.mission.model import Mission, Pole, Sphere, Wall
from gcs.mission.motion import rest_position
from idc_controller.geometry.shapes import Shape
from idc_controller.perception.obstacle_map import MapObstacle


def map_of(mission: Mission) -> list[MapObstacle]:
    """Return the obstacles that a mission marks as known, and the walls of its fence."""
    fence = boundary_walls(mission.boundary) if mission.boundary is not None else ()
    return known_obstacles((*mission.obstacles, *fence))


def known_obstacles(obstacles: Iterable[Sphere | Pole | Wall]) -> list[MapObstacle]:
    """Return those of ``obstacles`` that are marked as known."""
    return [
        MapObstacle(
            obstacle.name, _shape(obstacle), np.array(rest_position(obstacle), dtype=float), obstacle.motion is not None
        )
        for obstacle in obstacles
        if obstacle.known
    ]


def _shape(obstacle: Sphere | Pole | Wall) -> Shape:
    if isinstance(obstacle, Sphere):
        return Shape("sphere", obstacle.radius)
    if isinstance(obstacle, Pole):
        return Shape("pole", obstacle.radius, (0.0, 0.0, obstacle.height))
    return Shape("wall", 0.0, obstacle.size, math.radians(obstacle.yaw_deg))
