"""The pole: an upright cylinder that stands on the ground."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import LENGTH, CollisionGeometry, DistanceShape, RoundedBox, Shape, Vector


@dataclass(frozen=True)
class Pole(Shape):
    """An upright cylinder of ``radius`` and ``height`` (m) about its middle."""

    radius: float = field(metadata=LENGTH)
    height: float = field(metadata=LENGTH)

    kind: ClassVar[str] = "pole"
    round_axes: ClassVar[Vector | None] = (1.0, 1.0, 0.0)
    is_upright: ClassVar[bool] = True
    is_grounded: ClassVar[bool] = True

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        return f"radius {self.radius:.4g} m, {self.height:g} m high"

    def geometry(self) -> DistanceShape:
        """Return the shape for distance queries."""
        import coal

        return coal.Cylinder(self.radius, self.height)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine."""
        return CollisionGeometry("cylinder", {"radius": self.radius, "height": self.height})

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body, for unit ``directions`` (..., 3) -> (...)."""
        lateral = np.hypot(directions[..., 0], directions[..., 1])
        return np.asarray(self.radius * lateral + self.height / 2.0 * np.abs(directions[..., 2]))

    @property
    def rounded_box(self) -> RoundedBox:
        """The body: a vertical line rounded horizontally."""
        return RoundedBox(0.0, 0.0, self.height / 2.0, radial=self.radius)
