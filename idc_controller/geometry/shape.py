"""The interface of an obstacle's shape: a convex body about its centre, everything that depends on its kind a method.

A kind of shape is one class, entered in :data:`idc_controller.geometry.shapes.SHAPES`. SI units, NED.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

import numpy as np

from idc_controller.arrays import Array
from idc_controller.errors import ShapeError

if TYPE_CHECKING:
    import shapely

Vector = tuple[float, float, float]
DistanceShape = Any
"""A ``coal.ShapeBase``; coal is imported where one is made, as that takes long."""

_CIRCLE_SEGMENTS = 32
"""Segments of a quarter of a circle, where a plan view is drawn as a polygon."""


ROW = 14
"""Numbers of a body in arrays of bodies, see :attr:`Shape.row`."""

_UPRIGHT = np.eye(3)  # of all upright shapes: never written to

LENGTH: Mapping[str, str] = {"unit": "m"}
"""Metadata of a shape's field that is a length, or a tuple of lengths (m): positive; a key of the mission file."""
ANGLE: Mapping[str, str] = {"unit": "rad"}
"""Metadata of a field that is an angle (rad); in the mission file its key ends in ``_deg``."""


class Columns(NamedTuple):
    """A shape in the tables of a run: radius (m), edges of its upright bounding box (m), yaw (rad); 0 where none."""

    radius: float
    size: Vector
    yaw: float


class CollisionGeometry(NamedTuple):
    """A body for a physics engine: a primitive with its dimensions in the engine's words, or a hull of vertices."""

    primitive: str
    """sphere, cylinder, capsule or box, their axis along z; mesh: the convex hull of ``vertices``."""
    dimensions: Mapping[str, Any]


class UprightBounds(NamedTuple):
    """A box turned about the vertical, rounded horizontally by ``radial`` and in all directions by ``ball`` (m).

    It holds the body; of shapes that are such a box it is the body.
    """

    half_x: float
    half_y: float
    half_z: float
    radial: float
    ball: float
    cosine: float
    sine: float


class RoundedBox(NamedTuple):
    """A box about the centre, in the shape's own frame, rounded as in :class:`UprightBounds`.

    ``half_x`` and ``half_y``, or ``radial``, are zero.
    """

    half_x: float
    half_y: float
    half_z: float
    radial: float = 0.0
    ball: float = 0.0


class PlanView(NamedTuple):
    """A shape seen from above: all that is within ``radius`` (m) of ``core``; north and east from the centre (m)."""

    core: shapely.Geometry
    radius: float

    def contains(self, place: tuple[float, float]) -> bool:
        """Return whether a place (north, east) about the centre (m) lies within."""
        import shapely

        return bool(self.core.distance(shapely.Point(place)) <= self.radius)

    def outline(self) -> Array:
        """Return the corners (n, 2) of the outline; a circle is drawn by many."""
        whole = self.core.buffer(self.radius, quad_segs=_CIRCLE_SEGMENTS) if self.radius else self.core
        return np.array(whole.exterior.coords)[:-1]


@dataclass(frozen=True)
class Shape(ABC):
    """A convex body about its centre, in its attitude."""

    kind: ClassVar[str]
    """The name of the shape in mission files and tables."""
    round_axes: ClassVar[Vector | None] = None
    """Axes (0 or 1) on which the surface is one radius from the centre; None: it is not round about any centre."""
    is_upright: ClassVar[bool] = False
    """True if it is tall enough that distant ones are discriminated by their plan view alone."""
    in_columns: ClassVar[bool] = True
    """True if :attr:`columns` hold all of the shape; otherwise a run has it in ``obstacle_shapes.json``."""
    is_grounded: ClassVar[bool] = False
    """True if it stands on the ground, so that its place is (north, east)."""

    def check(self) -> None:
        """Raise :class:`ShapeError` for lengths that are not positive and angles that are not finite."""
        for part in fields(self):
            value = getattr(self, part.name)
            if part.metadata.get("unit") == "rad":
                if not math.isfinite(value):
                    raise ShapeError(f"{part.name} must be finite, got {value}")
            elif part.metadata.get("unit") == "m":
                several = isinstance(value, tuple)
                for axis, edge in zip("xyz", value if several else (value,), strict=False):
                    if not (math.isfinite(edge) and edge > 0.0):
                        raise ShapeError(f"{part.name}{f'_{axis}' * several} must be positive, got {edge}")

    @property
    def rotation(self) -> Array:
        """Shape frame to world (3, 3)."""
        return _UPRIGHT

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """Shape frame to world, w first."""
        return 1.0, 0.0, 0.0, 0.0

    @cached_property
    def columns(self) -> Columns:
        """The shape as the tables hold it, by its fields ``radius``, ``size``, ``height`` (of the size) and ``yaw``."""
        own = vars(self)
        size = own.get("size", (0.0, 0.0, own.get("height", 0.0)))
        return Columns(own.get("radius", 0.0), size, own.get("yaw", 0.0))

    @classmethod
    def from_fields(cls, values: Mapping[str, Any]) -> Self:
        """Return the shape whose fields have these values, as :func:`dataclasses.asdict` and JSON give them."""
        return cls(**{key: tuple(value) if isinstance(value, list) else value for key, value in values.items()})

    @classmethod
    def from_columns(cls, columns: Columns) -> Self:
        """Return the shape that the tables hold. Raises :class:`ShapeError` where they do not hold all of it."""
        if not cls.in_columns:
            raise ShapeError(f"a {cls.kind} needs the run's obstacle_shapes.json")
        values = {**columns._asdict(), "height": columns.size[2]}
        return cls(**{part.name: values[part.name] for part in fields(cls)})

    @property
    @abstractmethod
    def dimensions(self) -> str:
        """Sizes in words, for the operator."""

    def geometry(self) -> DistanceShape:
        """Return the shape for distance queries, in its own frame: by default that of :meth:`collision`."""
        import coal

        primitive, dimensions = self.collision()
        return getattr(coal, primitive.capitalize())(*dimensions.values())

    @abstractmethod
    def collision(self) -> CollisionGeometry:
        """Return the shape for a physics engine, in its own frame."""

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body about its centre, for unit ``directions`` (..., 3) -> (...)."""
        box, own = self.rounded_box, directions @ self.rotation
        assert box is not None
        return np.asarray(np.abs(own) @ np.array(box[:3]) + box.radial * np.hypot(own[..., 0], own[..., 1]) + box.ball)

    @property
    def rounded_box(self) -> RoundedBox | None:
        """The body, if it is a rounded box; None: its distances are those of :meth:`distance`."""
        return None

    def distance(self, points: Array) -> Array:
        """Signed distance (n,) (m) of ``points`` (n, 3) in the shape's own frame, of a body that is no rounded box."""
        raise NotImplementedError

    @property
    def planes(self) -> tuple[Array, Array]:
        """Outward normals of the faces (f, 3), shape's own frame, and their distances from the centre (f,) (m).

        Of a body that is no rounded box.
        """
        raise NotImplementedError

    @cached_property
    def row(self) -> Array:
        """:attr:`rounded_box` and :attr:`rotation` in one row (14,), for arrays of bodies; of other bodies zeros."""
        box = self.rounded_box
        return np.zeros(ROW) if box is None else np.array([*box, *self.rotation.ravel().tolist()])

    @cached_property
    def reach(self) -> float:
        """Radius of the ball about the centre that holds the body (m)."""
        bounds = self.upright_bounds
        return math.hypot(math.hypot(bounds.half_x, bounds.half_y) + bounds.radial, bounds.half_z) + bounds.ball

    @cached_property
    def horizontal_reach(self) -> float:
        """Radius of the upright cylinder about the centre that holds the body (m)."""
        bounds = self.upright_bounds
        return math.hypot(bounds.half_x, bounds.half_y) + bounds.radial + bounds.ball

    @property
    def upright_bounds(self) -> UprightBounds:
        """The rounded upright box about the centre that holds the body: by default the body itself."""
        box, yaw = self.rounded_box, self.columns.yaw
        assert box is not None
        return UprightBounds(*box, math.cos(yaw), math.sin(yaw))

    @property
    def half_height(self) -> float:
        """Distance from the centre up and down to the ends of the upright bounds (m)."""
        return self.upright_bounds.half_z + self.upright_bounds.ball

    @property
    def plan_view(self) -> PlanView:
        """The body seen from above; of what is round about its centre a circle."""
        import shapely

        assert self.round_axes is not None
        return PlanView(shapely.Point(0.0, 0.0), self.columns.radius)
