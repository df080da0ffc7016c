"""The obstacles of a mission in the world, and their motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from gcs.mission import Obstacle, mover
from idc_controller.rotations_float import Vector
from vehicle_sim.world.world import World


class MovingObstacles:
    """Puts a mission's obstacles into a world, where their motions have them at time 0, and moves those that move."""

    def __init__(self, world: World, obstacles: Sequence[Obstacle]) -> None:
        """Raises :class:`~vehicle_sim.world.errors.SimulationError` for what the world cannot hold."""
        self._world = world
        self._moving: list[tuple[str, Vector, Callable[[float], Vector]]] = []
        for obstacle in obstacles:
            place, displacement = obstacle.position, None if obstacle.motion is None else mover(obstacle.motion)
            if displacement is not None:
                self._moving.append((obstacle.name, place, displacement))
                place = _moved(place, displacement(0.0))
            world.add_obstacle(obstacle.name, obstacle.shape, place)

    def move(self, time: float) -> None:
        """Move them to where the motions have them ``time`` (s) after they began."""
        for name, rest, displacement in self._moving:
            self._world.move_obstacle(name, _moved(rest, displacement(time)))


def _moved(rest: Vector, by: Vector) -> Vector:
    return rest[0] + by[0], rest[1] + by[1], rest[2] + by[2]
