"""Obstacles in the physics engine: bodies that stand or move, and push but are never pushed."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import pybullet

from gcs.mission.model import Obstacle as MissionObstacle
from idc_controller.errors import ShapeError
from idc_controller.geometry.shape import Shape
from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.range_sensor import RayBodies
from vehicle_sim.world.world_state import flipped, quaternion_to_engine

_FAR_AWAY = 1e6  # m


class Obstacle(NamedTuple):
    """An obstacle at one time: its shape, and its centre in the world (NED, m)."""

    name: str
    shape: Shape
    position_in_world: Vector


class _Body(NamedTuple):
    """The engine's handle of an obstacle, its attitude there, and its row in arrays of all."""

    handle: int
    attitude: Quaternion
    row: int


class ObstacleBodies:
    """The obstacles of one physics client, by name.

    ``travelled``: length of the paths of all of them (m); one that is added counts as come from far away.
    """

    def __init__(self, client: int) -> None:
        self._client = client
        self._obstacles: dict[str, Obstacle] = {}
        self._bodies: dict[str, _Body] = {}
        self.ray_bodies = RayBodies.of(())
        """The obstacles as rays meet them."""
        self.travelled = 0.0

    def all(self) -> tuple[Obstacle, ...]:
        """Return the obstacles at the current time, in the order in which they were added."""
        return tuple(self._obstacles.values())

    def __getitem__(self, name: str) -> Obstacle:
        """Return an obstacle at the current time."""
        return self._obstacles[name]

    def add(self, name: str, shape: Shape, position_in_world: Sequence[float]) -> None:
        """Add an obstacle, its centre (3,) in NED (m). Raises :class:`SimulationError`."""
        try:
            shape.check()
        except ShapeError as error:
            raise SimulationError(f"obstacle {name}: {error}") from error
        place = _place(name, position_in_world)
        if name in self._obstacles:
            raise SimulationError(f"obstacle {name}: the name is taken")
        primitive, dimensions = shape.collision()
        if "vertices" in dimensions:
            dimensions = {"vertices": [flipped(vertex) for vertex in dimensions["vertices"]]}
        collision = pybullet.createCollisionShape(
            getattr(pybullet, f"GEOM_{primitive.upper()}"), **dimensions, physicsClientId=self._client
        )
        attitude = quaternion_to_engine(shape.quaternion)
        # One rigid body: the engine spends a third on it of what it spends on a base without links.
        handle = pybullet.createMultiBody(
            0.0, collision, basePosition=flipped(place), baseOrientation=attitude, useMaximalCoordinates=1,
            physicsClientId=self._client,
        )  # fmt: skip
        self._bodies[name] = _Body(handle, attitude, len(self._bodies))
        self._obstacles[name] = Obstacle(name, shape, place)
        self.ray_bodies = self.ray_bodies.and_body(shape, place)
        self.travelled += _FAR_AWAY

    def move(self, name: str, position_in_world: Sequence[float]) -> None:
        """Put an obstacle elsewhere, its centre (3,) in NED (m); it counts from the next step on."""
        body, obstacle, place = self._body(name), self._obstacles[name], _place(name, position_in_world)
        if place == obstacle.position_in_world:
            return
        self._obstacles[name] = Obstacle(name, obstacle.shape, place)
        self.ray_bodies.centres[body.row] = place
        self.travelled += math.dist(place, obstacle.position_in_world)
        pybullet.resetBasePositionAndOrientation(body.handle, flipped(place), body.attitude, self._client)

    def _body(self, name: str) -> _Body:
        if name not in self._bodies:
            raise SimulationError(f"no obstacle is called {name!r}")
        return self._bodies[name]


class MovingObstacles:
    """A mission's obstacles: added where their motions have them at time 0, and moved along them.

    ``any_moves``: one has a motion.
    """

    def __init__(self, bodies: ObstacleBodies, obstacles: Sequence[MissionObstacle]) -> None:
        """Raises :class:`~vehicle_sim.world.errors.SimulationError` for what the world cannot hold."""
        self._bodies = bodies
        self._moving: list[tuple[str, Vector, Callable[[float], Vector]]] = []
        for obstacle in obstacles:
            place = obstacle.position
            if obstacle.motion is not None:
                self._moving.append((obstacle.name, place, obstacle.motion.mover()))
                place = _moved(place, self._moving[-1][2](0.0))
            bodies.add(obstacle.name, obstacle.shape, place)
        self.any_moves = bool(self._moving)

    def move(self, time: float) -> None:
        """Move them to where the motions have them ``time`` (s) after they began."""
        for name, rest, displacement in self._moving:
            self._bodies.move(name, _moved(rest, displacement(time)))

    def moving(self) -> list[Obstacle]:
        """Return those that have a motion, at the current time."""
        return [self._bodies[name] for name, *_ in self._moving]


def _moved(rest: Vector, by: Vector) -> Vector:
    return rest[0] + by[0], rest[1] + by[1], rest[2] + by[2]


def _place(name: str, values: Sequence[float]) -> Vector:
    x, y, z = values
    place = float(x), float(y), float(z)
    if not all(map(math.isfinite, place)):
        raise SimulationError(f"obstacle {name}: position must be three finite numbers")
    return place
