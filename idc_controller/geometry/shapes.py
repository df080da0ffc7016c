"""The kinds of shapes: a new one is its own class and one entry in :data:`SHAPES`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from idc_controller.arrays import Array
from idc_controller.errors import ShapeError
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


class MeshHull(NamedTuple):
    """The convex hull of the mesh in a file: its corners about the middle of its bounding box, in the file's unit."""

    name: str
    corners: tuple[Vector, ...]


@dataclass(frozen=True)
class Mesh(OrientedShape):
    """The hull of a mesh, ``scale`` metres for a unit of the ``file``, whose axes are forward, right and down.

    Its centre is the middle of the mesh's bounding box.
    """

    file: MeshHull = field(metadata={"unit": "file"})
    scale: float = field(default=1.0, kw_only=True, metadata={"unit": "m"})

    kind: ClassVar[str] = "mesh"

    @classmethod
    def from_fields(cls, values: Mapping[str, Any]) -> Self:
        """Return the shape whose fields have these values, as :func:`dataclasses.asdict` and JSON give them."""
        name, corners = values["file"]
        return cls(**{**values, "file": MeshHull(name, tuple((x, y, z) for x, y, z in corners))})

    @property
    def dimensions(self) -> str:
        """Sizes in words."""
        edges = " x ".join(f"{edge:.4g}" for edge in np.ptp(self.corners, axis=0))
        return f"{self.file.name}, {edges} m{self.attitude}"

    @cached_property
    def corners(self) -> Array:
        """The corners of the hull (n, 3)."""
        return self.scale * np.array(self.file.corners)

    @cached_property
    def _geometry(self) -> DistanceShape:
        import coal

        vertices, facets = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
        vertices.extend(list(np.array(self._hull.vertices)))
        for triangle in self._hull.faces:
            facets.append(coal.Triangle(*map(int, triangle)))
        return coal.Convex(vertices, facets)

    def geometry(self) -> DistanceShape:
        """Return the shape for distance queries, in its own frame."""
        return self._geometry

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""
        return CollisionGeometry("mesh", {"vertices": self.corners.tolist()})

    def distance(self, points: Array) -> Array:
        """Signed distance (n,) (m) of ``points`` (n, 3) in the shape's own frame."""
        import coal

        request, result, here = coal.DistanceRequest(), coal.DistanceResult(), coal.Transform3s.Identity()
        # Inside, the nearest of the planes of the faces.
        distance = (points @ self.planes[0].T - self.planes[1]).max(axis=1)
        probe = coal.Sphere(1e-9)
        for i in np.flatnonzero(distance > 0.0).tolist():
            result.clear()
            distance[i] = coal.distance(
                self._geometry, here, probe, coal.Transform3s(np.eye(3), points[i]), request, result
            )
        return np.asarray(distance)


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

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""
        return CollisionGeometry("capsule", {"radius": self.radius, "height": self.length})


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

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine."""
        return CollisionGeometry("cylinder", {"radius": self.radius, "height": self.height})

    @property
    def rounded_box(self) -> RoundedBox:
        """The body: a vertical line rounded horizontally."""
        return RoundedBox(0.0, 0.0, self.height / 2.0, radial=self.radius)


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

    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine."""
        return CollisionGeometry("sphere", {"radius": self.radius})

    @property
    def rounded_box(self) -> RoundedBox:
        """The body: a point rounded in all directions."""
        return RoundedBox(0.0, 0.0, 0.0, ball=self.radius)


SHAPES: dict[str, type[Shape]] = {shape.kind: shape for shape in (Sphere, Pole, Wall, Capsule, Box, Mesh)}


def shape_class(kind: str) -> type[Shape]:
    """Return the class of the shapes of that ``kind``. Raises :class:`ShapeError` for one that does not exist."""
    if kind not in SHAPES:
        raise ShapeError(f"shape is {kind!r}, expected one of {', '.join(SHAPES)}")
    return SHAPES[kind]
