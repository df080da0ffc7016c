"""Signed distance from points to many obstacles at once."""

from collections.abc import Sequence

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape


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
