"""Obstacles in the physics engine: spheres, poles and walls that stand or are moved, and push but are never pushed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import pybullet

from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.world_state import Vector, flipped

SHAPES = ("sphere", "pole", "wall")


@dataclass(frozen=True)
class Obstacle:
    """An obstacle as it stands, NED.

    ``shape`` is sphere, pole or wall; ``position_in_world`` the centre (m); ``radius`` (m) a sphere's or a pole's, 0
    for a wall; ``size`` (m) a wall's edges, (0, 0, height) for a pole, 0 for a sphere; ``yaw`` (rad) turns a wall
    about the down axis.
    """

    name: str
    shape: str
    position_in_world: Vector
    radius: float = 0.0
    size: Vector = (0.0, 0.0, 0.0)
    yaw: float = 0.0

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise SimulationError(f"obstacle {self.name}: shape {self.shape!r} is not one of {', '.join(SHAPES)}")
        numbers = (*self.position_in_world, self.radius, *self.size, self.yaw)
        if len(numbers) != 8 or not all(math.isfinite(number) for number in numbers):
            raise SimulationError(f"obstacle {self.name}: position, radius, size and yaw must be finite numbers")
        if self.shape != "wall" and self.radius <= 0.0:
            raise SimulationError(f"obstacle {self.name}: radius must be positive, got {self.radius}")
        if self.shape == "pole" and self.size[2] <= 0.0:
            raise SimulationError(f"obstacle {self.name}: height must be positive, got {self.size[2]}")
        if self.shape == "wall" and min(self.size) <= 0.0:
            raise SimulationError(f"obstacle {self.name}: size must be positive, got {list(self.size)}")


class ObstacleBodies:
    """The obstacles of one physics client, by name."""

    def __init__(self, client: int) -> None:
        self._client = client
        self._obstacles: dict[str, Obstacle] = {}
        self._bodies: dict[str, int] = {}

    def __len__(self) -> int:
        return len(self._obstacles)

    def all(self) -> tuple[Obstacle, ...]:
        """The obstacles as they stand now, in the order of their making."""
        return tuple(self._obstacles.values())

    def body(self, name: str) -> int:
        """The engine's handle. Raises :class:`SimulationError` for an unknown name."""
        if name not in self._bodies:
            raise SimulationError(f"no obstacle is called {name!r}")
        return self._bodies[name]

    def add(self, obstacle: Obstacle) -> None:
        """Raises :class:`SimulationError` if the name is taken."""
        if obstacle.name in self._obstacles:
            raise SimulationError(f"obstacle {obstacle.name}: the name is taken")
        if obstacle.shape == "sphere":
            shape = {"shapeType": pybullet.GEOM_SPHERE, "radius": obstacle.radius}
        elif obstacle.shape == "pole":
            shape = {"shapeType": pybullet.GEOM_CYLINDER, "radius": obstacle.radius, "height": obstacle.size[2]}
        else:
            shape = {"shapeType": pybullet.GEOM_BOX, "halfExtents": [edge / 2 for edge in obstacle.size]}
        collision = pybullet.createCollisionShape(**shape, physicsClientId=self._client)
        body = pybullet.createMultiBody(
            0.0, collision, basePosition=flipped(obstacle.position_in_world),
            baseOrientation=_orientation(obstacle.yaw), physicsClientId=self._client,
        )  # fmt: skip
        self._obstacles[obstacle.name] = obstacle
        self._bodies[obstacle.name] = body

    def move(self, name: str, position_in_world: Sequence[float], yaw: float | None = None) -> None:
        """Put an obstacle elsewhere: its centre (3,) NED (m), and a wall's yaw (rad)."""
        body = self.body(name)
        old = self._obstacles[name]
        x, y, z = (float(value) for value in position_in_world)
        new = replace(old, position_in_world=(x, y, z), yaw=old.yaw if yaw is None else float(yaw))
        self._obstacles[name] = new
        pybullet.resetBasePositionAndOrientation(
            body, flipped(new.position_in_world), _orientation(new.yaw), physicsClientId=self._client
        )


def _orientation(yaw: float) -> tuple[float, float, float, float]:
    """The engine's quaternion of a turn by ``yaw`` about the down axis."""
    return 0.0, 0.0, -math.sin(yaw / 2), math.cos(yaw / 2)
