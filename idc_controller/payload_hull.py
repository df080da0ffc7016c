"""The payload's convex hull, and every length and area of the payload that follows from it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.errors import ParameterError


@dataclass(frozen=True, eq=False)
class PayloadHull:
    """``vertices`` (V, 3) of the hull in the payload frame: forward-right-down about the centre of mass (m).

    Raises :class:`ParameterError` for vertices that enclose no volume, and for a centre of mass outside of them.
    """

    vertices: Array

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=float)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise ParameterError("the payload's vertices must be finite, of shape (V, 3)")
        lower, upper = vertices.min(axis=0, initial=np.inf), vertices.max(axis=0, initial=-np.inf)
        if not (np.all(lower < 0.0) and np.all(upper > 0.0)):
            raise ParameterError(f"the payload must enclose its centre of mass; it reaches from {lower} to {upper} m")
        vertices.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)

    @classmethod
    def box(cls, size: ArrayLike) -> PayloadHull:
        """Return the hull of a box with edges ``size`` (3,) (m) about its centre."""
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        return cls(signs * (np.asarray(size, dtype=float) / 2.0))

    @cached_property
    def bounds(self) -> Array:
        """Least and greatest coordinates of the level payload (2, 3) (m)."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def below(self) -> float:
        """Depth of the level payload's lowest point below the centre of mass (m)."""
        return float(self.bounds[1, 2])

    @cached_property
    def above(self) -> float:
        """Height of the level payload's highest point above the centre of mass (m)."""
        return float(-self.bounds[0, 2])

    @cached_property
    def reach(self) -> float:
        """Radius of the ball about the centre of mass that holds the payload (m)."""
        return float(np.linalg.norm(self.vertices, axis=1).max())

    @cached_property
    def horizontal_reach(self) -> float:
        """Radius of the upright cylinder about the centre of mass that holds the level payload (m)."""
        return float(np.hypot(self.vertices[:, 0], self.vertices[:, 1]).max())

    @cached_property
    def areas(self) -> Array:
        """Areas of the silhouettes along the axes x, y, z (3,) (m2)."""
        from scipy.spatial import ConvexHull

        # The volume of a plane hull is its area.
        return np.array([ConvexHull(np.delete(self.vertices, axis, axis=1)).volume for axis in range(3)])

    @cached_property
    def box_edges(self) -> Array | None:
        """Edges (3,) (m) if the hull is a box along the axes about the centre of mass, else None."""
        edges = np.ptp(self.bounds, axis=0)
        is_box = len(self.vertices) == 8 and np.allclose(np.abs(self.vertices), edges / 2.0, rtol=0.0, atol=1e-9)
        return edges if is_box else None
