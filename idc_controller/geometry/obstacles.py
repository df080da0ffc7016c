"""Obstacles as the safety filter takes them: convex shapes, where they will be, and how uncertain that is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.shape import Shape

Array = NDArray[np.float64]


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
    """A source of predicted obstacles: a map, a tracker of detections, or both."""

    def predict(self, times: Array) -> Sequence[PredictedObstacle]:
        """Return all obstacles at ``times`` (K,) (s)."""
        ...


class StandingObstacles:
    """Obstacles that stay where they are and are known exactly."""

    def __init__(self, obstacles: Sequence[tuple[str, Shape, Array]]) -> None:
        """Name, shape and centre (3,) (m, NED) of each."""
        self._obstacles = tuple(obstacles)

    def predict(self, times: Array) -> list[PredictedObstacle]:
        """Return all of them, the same at every one of ``times`` (K,)."""
        K = len(times)
        return [
            PredictedObstacle(name, shape, np.tile(position, (K, 1)), np.zeros(K))
            for name, shape, position in self._obstacles
        ]
