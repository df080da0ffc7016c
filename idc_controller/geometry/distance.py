"""Signed distance from points to many obstacles at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.shapes import Shape

Array = NDArray[np.float64]

_NEVER = -1e6  # m: an axis on which a shape has no end


class Bodies:
    """Shapes as arrays, to be asked together."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self.count = len(shapes)
        self._sphere = np.array([shape.kind == "sphere" for shape in shapes], dtype=bool)[:, None]
        self._wall = np.array([shape.kind == "wall" for shape in shapes], dtype=bool)[:, None]
        self._radius = np.array([shape.radius for shape in shapes])[:, None]
        self._half = np.array([shape.size for shape in shapes]).reshape(-1, 3)[:, None] / 2.0
        yaw = np.array([shape.yaw for shape in shapes])[:, None]
        self._cosine, self._sine = np.cos(yaw), np.sin(yaw)

    def distance(self, points: Array, centres: Array) -> Array:
        """From ``points`` (n, 3) to the surfaces of all bodies at ``centres`` (B, 3): (B, n) (m), negative inside."""
        return self.of(points[None, :, :] - centres[:, None, :])

    def of(self, d: Array) -> Array:
        """The same of points given relative to each body's centre (B, n, 3)."""
        x, y, z = d[..., 0], d[..., 1], np.abs(d[..., 2])
        lateral = np.hypot(x, y)
        half = self._half
        a = np.where(self._wall, np.abs(self._cosine * x + self._sine * y) - half[..., 0], lateral - self._radius)
        a = np.where(self._sphere, np.hypot(lateral, z) - self._radius, a)
        b = np.where(self._wall, np.abs(self._cosine * y - self._sine * x) - half[..., 1], _NEVER)
        c = np.where(self._sphere, _NEVER, z - half[..., 2])
        inside = np.minimum(np.maximum(np.maximum(a, b), c), 0.0)
        a, b, c = np.maximum(a, 0.0), np.maximum(b, 0.0), np.maximum(c, 0.0)
        return np.sqrt(a * a + b * b + c * c) + inside
