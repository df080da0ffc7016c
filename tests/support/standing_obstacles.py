"""Obstacles that stand still, as a source of predicted obstacles for the tests."""

from collections.abc import Sequence

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import PredictedObstacle, Region
from idc_controller.geometry.shape import Shape


class StandingObstacles:
    """Obstacles that stay where they are and are known exactly."""

    def __init__(self, obstacles: Sequence[tuple[str, Shape, Array]]) -> None:
        """Name, shape and centre (3,) (m, NED) of each."""
        self._obstacles = tuple(obstacles)

    def predict(self, times: Array, region: Region | None = None) -> list[PredictedObstacle]:
        """Return all of them, the same at every one of ``times`` (K,)."""
        K = len(times)
        return [
            PredictedObstacle(name, shape, np.tile(position, (K, 1)), np.zeros(K))
            for name, shape, position in self._obstacles
        ]
