"""The sphere."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import LENGTH, CollisionGeometry, DistanceShape, RoundedBox, Shape, Vector


@dataclass(frozen=True)
class Sphere(Shape):
    """A ball of ``radius`` (m)."""

    radius: float = field(metadata=LENGTH)

    kind: ClassVar[str] = "sphere"
    round_axes: ClassVar[Vector | None] = (1.0, 1.0, 1.0)

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        return f"radius {self.radius:g} m"

    def geometry(self) -> DistanceShape:
        """Return the shape for distance queries."""
        import coal

        return coal.Sphere(self.radius)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine."""
        return CollisionGeometry("sphere", {"radius": self.radius})

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body, for unit ``directions`` (..., 3) -> (...)."""
        return np.full(directions.shape[:-1], self.radius)

    @property
    def rounded_box(self) -> RoundedBox:
        """The body: a point rounded in all directions."""
        return RoundedBox(0.0, 0.0, 0.0, ball=self.radius)
