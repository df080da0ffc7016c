"""Obstacles as the safety filter takes them: convex shapes, their predicted places, and the distances to them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

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
    """Growth of the body at each moment, for what is not known (K,) (m)."""


class ObstacleSource(Protocol):
    """A source of predicted obstacles: a map, a tracker of detections, or both."""

    def predict(self, times: Array) -> Sequence[PredictedObstacle]:
        """Return all obstacles at ``times`` (K,) (s)."""
        ...


class Bodies:
    """Shapes gathered by kind, for distances from points to all of them together."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self.count = len(shapes)
        kinds = dict.fromkeys(type(shape) for shape in shapes)
        self._groups = [
            (kind, [shape for shape in shapes if type(shape) is kind],
             np.array([i for i, shape in enumerate(shapes) if type(shape) is kind]))
            for kind in kinds
        ]  # fmt: skip

    def distance(self, points: Array, centres: Array) -> Array:
        """Signed distance (m) from ``points`` (n, 3) to the surfaces of bodies at ``centres`` (B, 3): (B, n)."""
        return self.from_offsets(points[None, :, :] - centres[:, None, :])

    def from_offsets(self, offsets: Array) -> Array:
        """Return the same for points relative to each body's centre (B, n, 3)."""
        distance = np.empty(offsets.shape[:-1])
        for kind, shapes, index in self._groups:
            distance[index] = kind.distances(shapes, offsets[index])
        return distance
