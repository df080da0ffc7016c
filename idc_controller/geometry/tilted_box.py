"""The box in any attitude."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import coal
import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.box import distance_of_gaps
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import LENGTH, CollisionGeometry, Vector


@dataclass(frozen=True)
class Box(OrientedShape):
    """A box of edges ``size`` (x, y, z) (m)."""

    size: Vector = field(metadata=LENGTH)

    kind: ClassVar[str] = "box"

    @property
    def dimensions(self) -> str:
        """Its sizes in words."""
        return " x ".join(f"{edge:.4g}" for edge in self.size) + f" m{self.attitude}"

    @cached_property
    def corners(self) -> Array:
        """The corners (8, 3)."""
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return np.asarray(signs * np.array(self.size) / 2.0)

    def geometry(self) -> coal.ShapeBase:
        """Return the shape for distance queries, in its own frame."""
        return coal.Box(*self.size)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""
        return CollisionGeometry("box", {"halfExtents": [edge / 2 for edge in self.size]})

    def distance(self, points: Array) -> Array:
        """Signed distance (n,) (m) of ``points`` (n, 3) in the shape's own frame."""
        x, y, z = (np.abs(points) - np.array(self.size) / 2.0).T
        return distance_of_gaps(x, y, z)
