"""Obstacles of a mission that the ground knows before the flight."""

from collections.abc import Iterable

import numpy as np

from gcs.mission.fence import boundary_walls
from gcs.mission.model import Mission, Obstacle
from idc_controller.perception.standing_obstacles import MapObstacle


def map_of(mission: Mission) -> list[MapObstacle]:
    """Return the obstacles that a mission marks as known, and the walls of its fence."""
    fence = boundary_walls(mission.boundary) if mission.boundary is not None else ()
    return [*known_obstacles(mission.obstacles), *(o._replace(is_body=False) for o in known_obstacles(fence))]


def known_obstacles(obstacles: Iterable[Obstacle]) -> list[MapObstacle]:
    """Return those of ``obstacles`` that are marked as known."""
    return [
        MapObstacle(obstacle.name, obstacle.shape, np.array(obstacle.position), obstacle.motion is not None)
        for obstacle in obstacles
        if obstacle.known
    ]
