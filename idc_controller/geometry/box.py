"""Boxes: the wall, which stands upright, and the box in any attitude."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import (
    ANGLE,
    LENGTH,
    CollisionGeometry,
    DistanceShape,
    PlanView,
    RoundedBox,
    Shape,
    Vector,
)


class _BoxBody:
    """What a box is in its own frame, whatever its attitude."""

    size: Vector

    @property
    def rounded_box(self) -> RoundedBox:
        """The body itself."""
        x, y, z = self.size
        return RoundedBox(x / 2.0, y / 2.0, z / 2.0)

    def geometry(self) -> DistanceShape:
        """Return the shape for distance queries, in its own frame."""
        import coal

        return coal.Box(*self.size)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""
        return CollisionGeometry("box", {"halfExtents": [edge / 2 for edge in self.size]})


@dataclass(frozen=True)
class Wall(_BoxBody, Shape):
    """An upright box of edges ``size`` (x, y, z) (m), its x edge turned by ``yaw`` (rad) from north towards east."""

    size: Vector = field(metadata=LENGTH)
    yaw: float = field(default=0.0, metadata=ANGLE)

    kind: ClassVar[str] = "wall"
    is_upright: ClassVar[bool] = True

    @property
    def rotation(self) -> Array:
        """Shape frame to world (3, 3)."""
        cosine, sine = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """Shape frame to world, w first."""
        return math.cos(self.yaw / 2), 0.0, 0.0, math.sin(self.yaw / 2)

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        edges = " x ".join(f"{edge:.4g}" for edge in self.size)
        return f"{edges} m, heading {math.degrees(self.yaw):.1f} deg"

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body, for unit ``directions`` (..., 3) -> (...)."""
        return np.asarray(np.abs(directions @ self.rotation) @ (np.array(self.size) / 2.0))

    @property
    def plan_view(self) -> PlanView:
        """A rectangle."""
        import shapely

        signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
        return PlanView(shapely.Polygon(signs * (np.array(self.size[:2]) / 2.0) @ self.rotation[:2, :2].T), 0.0)


@dataclass(frozen=True)
class Box(_BoxBody, OrientedShape):
    """A box of edges ``size`` (x, y, z) (m)."""

    size: Vector = field(metadata=LENGTH)

    kind: ClassVar[str] = "box"

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        return " x ".join(f"{edge:.4g}" for edge in self.size) + f" m{self.attitude}"

    @cached_property
    def corners(self) -> Array:
        """The corners (8, 3)."""
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return np.asarray(signs * np.array(self.size) / 2.0)
