"""A convex body from a mesh, in any attitude."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import CollisionGeometry, DistanceShape, Vector


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
