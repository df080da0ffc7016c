"""Bodies as the rays of range sensors meet them: all in arrays."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.geometry.shape import ROW, Shape
from idc_controller.rotations_float import Vector


class RayBodies(NamedTuple):
    """Arrays as :func:`vehicle_sim.world.ray_cast_kernels.first_hits` takes them."""

    centres: Array
    """NED (B, 3) (m)."""
    rows: Array
    """:attr:`idc_controller.geometry.shape.Shape.row` of each (B, 14)."""
    bounds: Array
    """Radius of the ball, and of the upright cylinder, that holds each (B, 2) (m)."""
    planes: Array
    """Faces of bodies without a row: outward normals in world axes, distances from the centre (P, 4) (m)."""
    starts: Indices
    """Row of the first plane of each body, then P (B + 1,)."""

    @classmethod
    def of(cls, bodies: Iterable[tuple[Shape, Vector]]) -> RayBodies:
        """Return shapes with their centres (NED, m)."""
        none = cls(np.empty((0, 3)), np.empty((0, ROW)), np.empty((0, 2)), np.empty((0, 4)), np.zeros(1, np.int64))
        for shape, centre in bodies:
            none = none.and_body(shape, centre)
        return none

    def and_body(self, shape: Shape, centre: Vector) -> RayBodies:
        """Return these bodies and one more at ``centre`` (NED, m)."""
        planes = np.empty((0, 4))
        if shape.rounded_box is None:
            normals, distances = shape.planes
            planes = np.column_stack([normals @ shape.rotation.T, distances])
        return RayBodies(
            np.vstack([self.centres, centre]),
            np.vstack([self.rows, shape.row]),
            np.vstack([self.bounds, (shape.reach, shape.horizontal_reach)]),
            np.vstack([self.planes, planes]),
            np.append(self.starts, self.starts[-1] + len(planes)),
        )
