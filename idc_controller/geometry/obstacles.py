"""Obstacles as the safety filter takes them: convex shapes, where they will be, and how uncertain that is."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape


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
