"""Boxes: the wall, which stands upright, and the box in any attitude."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import (
    ANGLE,
    LENGTH,
    CollisionGeometry,
    PlanView,
    RoundedBox,
    Shape,
    UprightBounds,
    Vector,
)

if TYPE_CHECKING:
    import coal


@dataclass(frozen=True)
class Wall(Shape):
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

    def geometry(self) -> coal.ShapeBase:
        """Return the shape for distance queries."""
        import coal

        return coal.Box(*self.size)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine."""
        return CollisionGeometry("box", {"halfExtents": [edge / 2 for edge in self.size]})

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body, for unit ``directions`` (..., 3) -> (...)."""
        return np.asarray(np.abs(directions @ self.rotation) @ (np.array(self.size) / 2.0))

    @property
    def rounded_box(self) -> RoundedBox:
        """The body itself."""
        x, y, z = self.size
        return RoundedBox(x / 2.0, y / 2.0, z / 2.0)

    @property
    def upright_bounds(self) -> UprightBounds:
        """The body itself."""
        x, y, z = (edge / 2.0 for edge in self.size)
        return UprightBounds(x, y, z, 0.0, 0.0, math.cos(self.yaw), math.sin(self.yaw))

    @property
    def plan_view(self) -> PlanView:
        """A rectangle."""
        import shapely

        signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
        return PlanView(shapely.Polygon(signs * (np.array(self.size[:2]) / 2.0) @ self.rotation[:2, :2].T), 0.0)

    def visible_points(self, sensor: Vector, reach: float, turn: float) -> Array:
        """Points (n, 3) of the surface that a range sensor hits: corners and middle of the faces in view."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        a, b, c = sensor
        local = (cosine * a + sine * b, cosine * b - sine * a, c)
        points = _visible_points(self.size, local, reach)
        return np.array([(cosine * u - sine * v, sine * u + cosine * v, w) for u, v, w in points]).reshape(-1, 3)


@dataclass(frozen=True)
class Box(OrientedShape):
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

    @property
    def rounded_box(self) -> RoundedBox:
        """The body itself."""
        x, y, z = self.size
        return RoundedBox(x / 2.0, y / 2.0, z / 2.0)

    def geometry(self) -> coal.ShapeBase:
        """Return the shape for distance queries, in its own frame."""
        import coal

        return coal.Box(*self.size)

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""
        return CollisionGeometry("box", {"halfExtents": [edge / 2 for edge in self.size]})


def _visible_points(size: Vector, sensor: Vector, reach: float) -> list[Vector]:
    """Points of a box about its centre, in its own frame, that a ``sensor`` there hits."""
    s, half_size = sensor, (size[0] / 2.0, size[1] / 2.0, size[2] / 2.0)
    visible = [k for k in range(3) if abs(s[k]) > half_size[k]]
    if not visible:
        return []
    nearest = _clamped(s, half_size)
    if math.dist(nearest, s) > reach:
        return []
    # The face that shows most of itself first.
    visible.sort(key=lambda k: -_visible_area(half_size, s, k))
    points = [nearest]
    for rank, axis in enumerate(visible):
        foot = list(nearest)
        foot[axis] = math.copysign(half_size[axis], s[axis])
        corners = [_shortened(s, foot, corner, reach) for corner in _corners(half_size, axis, foot[axis])]
        if rank > 0:  # its near corners are the first face's
            corners = sorted(corners, key=lambda p: -math.dist(p, s))[:2]
        points += corners
        if rank == 0:
            middle = [0.5 * (corners[0][k] + corners[2][k]) for k in range(3)]
            points.append((middle[0], middle[1], middle[2]))
    return points


def _corners(half_size: Vector, axis: int, level: float) -> list[Vector]:
    """Return the corners of the face across ``axis`` at ``level``, in turn."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    corners = []
    for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1)):
        corner = [0.0, 0.0, 0.0]
        corner[axis], corner[j], corner[k] = level, a * half_size[j], b * half_size[k]
        corners.append((corner[0], corner[1], corner[2]))
    return corners


def _visible_area(half_size: Vector, s: Vector, axis: int) -> float:
    """Area of a face times the cosine of the angle of incidence."""
    j, k = (axis + 1) % 3, (axis + 2) % 3
    return half_size[j] * half_size[k] * (abs(s[axis]) - half_size[axis]) / math.dist(s, (0.0, 0.0, 0.0))


def _shortened(s: Vector, start: list[float], end: Vector, reach: float) -> Vector:
    """Return the point from ``start``, which is in reach, towards ``end`` as far as the reach goes."""
    d = [end[k] - start[k] for k in range(3)]
    o = [start[k] - s[k] for k in range(3)]
    a = sum(v * v for v in d)
    b = sum(v * w for v, w in zip(d, o, strict=True))
    c = sum(v * v for v in o) - reach * reach
    share = 1.0
    if a > 0.0:
        share = min(1.0, max(0.0, (-b + math.sqrt(max(b * b - a * c, 0.0))) / a))
    return start[0] + share * d[0], start[1] + share * d[1], start[2] + share * d[2]


def _clamped(s: Vector, half_size: Vector) -> Vector:
    x, y, z = (min(max(value, -half), half) for value, half in zip(s, half_size, strict=True))
    return x, y, z
