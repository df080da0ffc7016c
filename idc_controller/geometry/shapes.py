"""Obstacles as the safety filter sees them: convex shapes, where they will be, and how sure that is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import coal
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Shape:
    """A convex body about its centre; SI units, NED.

    ``kind`` sphere: ``radius``. ``kind`` pole: an upright cylinder of ``radius`` and ``size[2]`` height.
    ``kind`` wall: a box of edges ``size`` (x, y, z), turned by ``yaw`` (rad) from north towards east.
    """

    kind: str
    radius: float = 0.0
    size: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0

    @property
    def rotation(self) -> Array:
        """Shape frame to world (3, 3)."""
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])

    def geometry(self) -> coal.ShapeBase:
        """The shape for distance queries, in its own frame."""
        if self.kind == "sphere":
            return coal.Sphere(self.radius)
        if self.kind == "pole":
            return coal.Cylinder(self.radius, self.size[2])
        return coal.Box(*self.size)

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body about its centre, for unit ``directions`` (..., 3) -> (...)."""
        if self.kind == "sphere":
            return np.full(directions.shape[:-1], self.radius)
        if self.kind == "pole":
            lateral = np.hypot(directions[..., 0], directions[..., 1])
            return self.radius * lateral + self.size[2] / 2.0 * np.abs(directions[..., 2])
        return np.abs(directions @ self.rotation) @ (np.array(self.size) / 2.0)

    @property
    def reach(self) -> float:
        """Radius of the ball about the centre that holds the body (m)."""
        if self.kind == "sphere":
            return self.radius
        if self.kind == "pole":
            return float(np.hypot(self.radius, self.size[2] / 2.0))
        return float(np.linalg.norm(self.size)) / 2.0


@dataclass(frozen=True, eq=False)
class PredictedObstacle:
    """One obstacle at K moments."""

    name: str
    """The same from step to step."""
    shape: Shape
    positions: Array
    """Centres in the world (K, 3) (m)."""
    growth: Array
    """By how much the body is to be taken larger at each moment, for what is not known (K,) (m)."""


class ObstacleSource(Protocol):
    """Whatever knows the obstacles: a map, a tracker of detections, or both."""

    def predict(self, times: Array) -> Sequence[PredictedObstacle]:
        """All obstacles at ``times`` (K,) (s)."""
        ...


class StandingObstacles:
    """Obstacles that stay where they are and are known exactly."""

    def __init__(self, obstacles: Sequence[tuple[str, Shape, Array]]) -> None:
        """Name, shape and centre (3,) (m, NED) of each."""
        self._obstacles = tuple(obstacles)

    def predict(self, times: Array) -> list[PredictedObstacle]:
        """All of them, at every one of ``times`` (K,)."""
        K = len(times)
        return [
            PredictedObstacle(name, shape, np.tile(position, (K, 1)), np.zeros(K))
            for name, shape, position in self._obstacles
        ]
