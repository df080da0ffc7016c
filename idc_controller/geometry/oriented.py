"""Shapes in any attitude: the convex hull of corners, rounded by a radius, turned by roll, pitch and yaw."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import ANGLE, Columns, PlanView, Shape, UprightBounds
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion

if TYPE_CHECKING:
    import trimesh

_HEADINGS = np.radians(np.arange(0.0, 90.0, 5.0))
"""Headings tried for the upright box that is to hold a body: the smallest plan view is taken."""


@dataclass(frozen=True)
class OrientedShape(Shape):
    """A convex body turned by ``yaw`` (rad, from north towards east), then ``pitch`` (nose up), then ``roll``."""

    roll: float = field(default=0.0, kw_only=True, metadata=ANGLE)
    pitch: float = field(default=0.0, kw_only=True, metadata=ANGLE)
    yaw: float = field(default=0.0, kw_only=True, metadata=ANGLE)

    in_columns: ClassVar[bool] = False

    @property
    @abstractmethod
    def corners(self) -> Array:
        """Points (n, 3) in the shape's own frame whose hull, rounded by :attr:`rounding`, is the body (m)."""

    @property
    def rounding(self) -> float:
        """Radius by which the hull of the corners is rounded (m)."""
        return 0.0

    @property
    def attitude(self) -> str:
        """Angles in words, empty if there are none."""
        angles = {name: math.degrees(getattr(self, name)) for name in ("roll", "pitch", "yaw")}
        return "".join(f", {name} {angle:.1f} deg" for name, angle in angles.items() if angle)

    @cached_property
    def rotation(self) -> Array:
        """Shape frame to world (3, 3)."""
        return rotation_from_quaternion(np.array(self.quaternion))

    @cached_property
    def quaternion(self) -> tuple[float, float, float, float]:
        """Shape frame to world, w first."""
        w, x, y, z = quaternion_from_euler(self.roll, self.pitch, self.yaw).tolist()
        return w, x, y, z

    @cached_property
    def columns(self) -> Columns:
        """Rounding radius, edges of the box along north, east and down about the centre that holds it, no yaw."""
        x, y, z = (2.0 * (np.abs(self._in_world).max(axis=0) + self.rounding)).tolist()
        return Columns(self.rounding, (x, y, z), 0.0)

    def support(self, directions: Array) -> Array:
        """Largest ``direction . y`` over the body about its centre, for unit ``directions`` (..., 3) -> (...)."""
        return np.asarray((directions @ self._in_world.T).max(axis=-1) + self.rounding)

    @cached_property
    def reach(self) -> float:
        """Radius of the ball about the centre that holds the body (m)."""
        return float(np.linalg.norm(self.corners, axis=1).max()) + self.rounding

    @cached_property
    def horizontal_reach(self) -> float:
        """Radius of the upright cylinder about the centre that holds the body (m)."""
        return float(np.hypot(self._in_world[:, 0], self._in_world[:, 1]).max()) + self.rounding

    @cached_property
    def upright_bounds(self) -> UprightBounds:
        """The rounded upright box about the centre that holds the body, of the heading with the smallest plan view."""
        x, y, z = self._in_world.T
        headings = np.append(_HEADINGS, self.yaw)
        along = np.abs(np.outer(np.cos(headings), x) + np.outer(np.sin(headings), y)).max(axis=1)
        across = np.abs(np.outer(np.cos(headings), y) - np.outer(np.sin(headings), x)).max(axis=1)
        best = int(np.argmin((along + self.rounding) * (across + self.rounding)))
        return UprightBounds(
            float(along[best]), float(across[best]), float(np.abs(z).max()), 0.0, self.rounding,
            math.cos(headings[best]), math.sin(headings[best]),
        )  # fmt: skip

    @property
    def plan_view(self) -> PlanView:
        """The hull of the corners, rounded."""
        import shapely

        return PlanView(shapely.MultiPoint(self._in_world[:, :2]).convex_hull, self.rounding)

    @cached_property
    def _hull(self) -> trimesh.Trimesh:
        import trimesh  # half a second, spent only where there is such a body

        hull: trimesh.Trimesh = trimesh.convex.convex_hull(self.corners)
        return hull

    @cached_property
    def planes(self) -> tuple[Array, Array]:
        """Outward normals of the faces of the hull of the corners (f, 3), and their distances from the centre (f,) (m).

        What range sensors measure of a body that is no rounded box.
        """
        normals = np.array(self._hull.face_normals)
        return normals, np.einsum("ij,ij->i", normals, self._hull.triangles[:, 0])

    @cached_property
    def _in_world(self) -> Array:
        """The corners about the centre in the axes of the world (n, 3)."""
        return self.corners @ self.rotation.T
