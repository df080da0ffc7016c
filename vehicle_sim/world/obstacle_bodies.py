"""Obstacles in the physics engine: bodies that are static or moved, and push but are never pushed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import pybullet

from idc_controller.errors import ShapeError
from idc_controller.geometry.shape import Shape
from idc_controller.rotations_float import Vector
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.world_state import flipped, quaternion_to_engine


@dataclass(frozen=True)
class Obstacle:
    """An obstacle at one time: its shape, and its centre in the world (NED, m)."""

    name: str
    shape: Shape
    position_in_world: Vector

    def __post_init__(self) -> None:
        try:
            self.shape.check()
        except ShapeError as error:
            raise SimulationError(f"obstacle {self.name}: {error}") from error
        if len(self.position_in_world) != 3 or not all(map(math.isfinite, self.position_in_world)):
            raise SimulationError(f"obstacle {self.name}: position must be three finite numbers")


class ObstacleBodies:
    """The obstacles of one physics client, by name."""

    def __init__(self, client: int) -> None:
        self._client = client
        self._obstacles: dict[str, Obstacle] = {}
        self._bodies: dict[str, int] = {}

    def __len__(self) -> int:
        return len(self._obstacles)

    def all(self) -> tuple[Obstacle, ...]:
        """The obstacles at the current time, in the order of their making."""
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
        primitive, dimensions = obstacle.shape.collision()
        if "vertices" in dimensions:
            dimensions = {"vertices": [flipped(vertex) for vertex in dimensions["vertices"]]}
        collision = pybullet.createCollisionShape(
            getattr(pybullet, f"GEOM_{primitive.upper()}"), **dimensions, physicsClientId=self._client
        )
        body = pybullet.createMultiBody(
            0.0, collision, basePosition=flipped(obstacle.position_in_world),
            baseOrientation=quaternion_to_engine(obstacle.shape.quaternion), physicsClientId=self._client,
        )  # fmt: skip
        self._obstacles[obstacle.name] = obstacle
        self._bodies[obstacle.name] = body

    def move(self, name: str, position_in_world: Sequence[float]) -> None:
        """Put an obstacle elsewhere: its centre (3,) NED (m)."""
        body = self.body(name)
        x, y, z = (float(value) for value in position_in_world)
        new = replace(self._obstacles[name], position_in_world=(x, y, z))
        self._obstacles[name] = new
        pybullet.resetBasePositionAndOrientation(
            body, flipped(new.position_in_world), quaternion_to_engine(new.shape.quaternion),
            physicsClientId=self._client,
        )  # fmt: skip
