"""Obstacles as the safety filter takes them: convex shapes, their predicted places, and the distances to them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.distance_kernels import distances_of_offsets, distances_of_points
from idc_controller.geometry.shape import ROW, Shape


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
    """Shapes gathered for distances from points to all of them together."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self.count = len(shapes)
        self.rows = np.array([shape.row for shape in shapes]).reshape(self.count, ROW)
        """Rounded boxes as :mod:`idc_controller.geometry.distance_kernels` takes them (B, 14)."""
        self.others = [(i, shape) for i, shape in enumerate(shapes) if shape.rounded_box is None]
        """Bodies that are no rounded boxes, with their index."""

    def distance(self, points: Array, centres: Array) -> Array:
        """Signed distance (m) from ``points`` (n, 3) to the surfaces of bodies at ``centres`` (B, 3): (B, n)."""
        distance = distances_of_points(self.rows, np.ascontiguousarray(points), np.ascontiguousarray(centres))
        for i, shape in self.others:
            distance[i] = shape.distance((points - centres[i]) @ shape.rotation)
        return distance

    def from_offsets(self, offsets: Array) -> Array:
        """Return the same for points relative to each body's centre (B, n, 3)."""
        distance = distances_of_offsets(self.rows, np.ascontiguousarray(offsets))
        for i, shape in self.others:
            distance[i] = shape.distance(offsets[i] @ shape.rotation)
        return distance
