"""The capsule: a cylinder with round ends, in any attitude."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import LENGTH, CollisionGeometry, DistanceShape, RoundedBox


@dataclass(frozen=True)
class Capsule(OrientedShape):
    """All within ``radius`` of a line of ``length`` (m) along the shape's z axis; upright unless it is turned."""

    radius: float = field(metadata=LENGTH)
    length: float = field(metadata=LENGTH)

    kind: ClassVar[str] = "capsule"

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        return f"radius {self.radius:g} m, {self.length:g} m between its round ends{self.attitude}"

    @cached_property
    def corners(self) -> Array:
        """The ends of the line (2, 3)."""
        return np.array([[0.0, 0.0, -self.length / 2.0], [0.0, 0.0, self.length / 2.0]])

    @property
    def rounding(self) -> float:
        """The radius (m)."""
        return self.radius

    @property
    def rounded_box(self) -> RoundedBox:
        """The body: a line rounded in all directions."""
        return RoundedBox(0.0, 0.0, self.length / 2.0, ball=self.radius)

    def geometry(self) -> DistanceShape:
        """Return the shape for distance queries, in its own frame."""
        import coal

        return coal.Capsule(self.radius, self.length)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""
        return CollisionGeometry("capsule", {"radius": self.radius, "height": self.length})
