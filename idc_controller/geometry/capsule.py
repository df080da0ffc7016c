"""The capsule: a cylinder with round ends, in any attitude."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import LENGTH, CollisionGeometry, RoundedBox

if TYPE_CHECKING:
    import coal

_RINGS, _AROUND = 5, 12
"""Samples of the surface: circles over the length, points on each; the ends have as many circles."""


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

    def geometry(self) -> coal.ShapeBase:
        """Return the shape for distance queries, in its own frame."""
        import coal

        return coal.Capsule(self.radius, self.length)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""
        return CollisionGeometry("capsule", {"radius": self.radius, "height": self.length})

    def surface_samples(self) -> tuple[Array, Array]:
        """Return points all over the surface (n, 3) and its outward normals there (n, 3), in the shape's own frame."""
        levels = np.linspace(-self.length / 2.0, self.length / 2.0, _RINGS)
        slopes = np.linspace(0.0, np.pi / 2.0, _RINGS)
        level = np.concatenate([levels, np.full(_RINGS, levels[0]), np.full(_RINGS, levels[-1])])
        slope = np.concatenate([np.zeros(_RINGS), -slopes, slopes])
        around = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)[:, None]
        up = np.broadcast_to(np.sin(slope), (_AROUND, len(slope)))
        normals = np.stack([np.cos(around) * np.cos(slope), np.sin(around) * np.cos(slope), up], axis=-1).reshape(-1, 3)
        centres = np.zeros((_AROUND, len(level), 3))
        centres[:, :, 2] = level
        return centres.reshape(-1, 3) + self.radius * normals, normals
