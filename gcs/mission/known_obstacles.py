"""Obstacles of a mission that the ground knows before the flight."""

from collections.abc import Iterable

import numpy as np

from gcs.mission.fence import boundary_walls
from gcs.mission.model import Mission, Obstacle
from idc_controller.perception.standing_obstacles import MapObstacle


def map_of(mission: Mission) -> list[MapObstacle]:
    """Return the obstacles that a mission marks as known, and the walls of its fence."""
    edges = (edge._replace(is_body=False) for edge in known_obstacles(boundary_walls(mission.boundary)))
    return [*known_obstacles(mission.obstacles), *edges]


def known_obstacles(obstacles: Iterable[Obstacle]) -> list[MapObstacle]:
    """Return those of ``obstacles`` that are marked as known."""
    return [
        MapObstacle(obstacle.name, obstacle.shape, np.array(obstacle.position), obstacle.motion is not None)
        for obstacle in obstacles
        if obstacle.known
    ]
