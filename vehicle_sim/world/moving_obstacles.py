"""The obstacles of a mission in the world, and their motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from gcs.mission import Pole, Sphere, Wall, mover, rest_position
from vehicle_sim.world.world import World
from vehicle_sim.world.world_state import Vector


class MovingObstacles:
    """Puts a mission's obstacles into a world, where their motions have them at time 0, and moves those that move."""

    def __init__(self, world: World, obstacles: Sequence[Sphere | Pole | Wall]) -> None:
        """Raises :class:`~vehicle_sim.world.errors.SimulationError` for what the world cannot hold."""
        self._world = world
        self._moving: list[tuple[str, Vector, Callable[[float], Vector]]] = []
        for obstacle in obstacles:
            rest = rest_position(obstacle)
            displacement = None if obstacle.motion is None else mover(obstacle.motion)
            place = rest if displacement is None else _moved(rest, displacement(0.0))
            if isinstance(obstacle, Sphere):
                world.add_obstacle(obstacle.name, "sphere", place, obstacle.radius)
            elif isinstance(obstacle, Pole):
                world.add_obstacle(obstacle.name, "pole", place, obstacle.radius, (0.0, 0.0, obstacle.height))
            else:
                world.add_obstacle(obstacle.name, "wall", place, size=obstacle.size, yaw=math.radians(obstacle.yaw_deg))
            if displacement is not None:
                self._moving.append((obstacle.name, rest, displacement))

    def move(self, time: float) -> None:
        """To where the motions have them ``time`` (s) after they began."""
        for name, rest, displacement in self._moving:
            self._world.move_obstacle(name, _moved(rest, displacement(time)))


def _moved(rest: Vector, by: Vector) -> Vector:
    return rest[0] + by[0], rest[1] + by[1], rest[2] + by[2]
