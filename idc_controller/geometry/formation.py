"""The formation's hull in flat coordinates: poses of payload and discs for a payload position and acceleration.

With the payload level and the links along g e3 - a, UAV i is at r + p_i - l_i e3 + lever_i a_xy, lever_i = l_i / (g
- a_z): when the payload accelerates the hull does not just translate, it shears.
"""

from __future__ import annotations

from itertools import product

import coal
import numpy as np
from scipy.spatial import ConvexHull

from idc_controller.arrays import Array, Indices
from idc_controller.geometry.formation_kernels import hull_points
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import rotation_from_quaternion

_LINEAR_SEARCH = 32
"""Up to so many points the distance library looks at all of them, so that their order and facets do not matter."""
_NO_AREA = 1e-12
"""Up to such an area (m2) a triangle between points on one plane of the hull is none."""
_MOST_CORNERS = 16
"""Corners, at most, of a payload's hull that is planned with as it is: the rest of the linear search is for discs."""


def outward_facets(points: Array) -> Indices:
    """Return the triangles of the hull of ``points`` (P, 3): indices (F, 3), anticlockwise seen from outside."""
    hull = ConvexHull(points, qhull_options="QbB Pp Qt")  # in the unit cube, without warnings, triangles only
    a, b, c = points[hull.simplices].swapaxes(0, 1)
    double_area = np.einsum("fk,fk->f", np.cross(b - a, c - a), hull.equations[:, :3])  # negative: clockwise
    facets = np.where(double_area[:, None] < 0.0, hull.simplices[:, ::-1], hull.simplices)
    return np.asarray(facets[np.abs(double_area) > _NO_AREA], dtype=np.intp)


class Formation:
    """Payload and UAV discs, for planning."""

    def __init__(self, parameters: SystemParameters) -> None:
        self.g = parameters.g
        self.payload = parameters.payload
        self.disc_radius = parameters.disc_radius
        self.lengths = parameters.l.copy()
        self.hover_offsets = parameters.p - np.outer(parameters.l, [0.0, 0.0, 1.0])
        """UAVs from the payload's centre in hover (N, 3) (m)."""
        vertices, bounds = self.payload.vertices, self.payload.bounds
        self.corners = np.array(vertices if len(vertices) <= _MOST_CORNERS else list(product(*bounds.T)))
        """Points about the payload's centre whose hull holds the payload: of one with many corners, its box (C, 3)."""
        n = parameters.number_of_uavs
        # The rims' outward points alone can lie on the hull.
        rim = max(1, min(6, (_LINEAR_SEARCH - len(self.corners)) // n))
        bearing = np.arctan2(parameters.p[:, 1], parameters.p[:, 0])
        spread = np.linspace(-np.pi / 2, np.pi / 2, rim) if rim > 1 else np.zeros(1)
        angle = bearing[:, None] + spread
        self.rims = self.disc_radius * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
        """Points on the rims of the discs about their centres (N, R, 3) (m)."""
        # The facets of the hull in hover give the distance library the neighbours of each point; the shear of an
        # accelerated flight hardly changes them.
        self._hull: coal.Convex | None = None
        self._facets = coal.StdVec_Triangle()
        for triangle in outward_facets(self.hull_points(np.zeros((1, 3)))[0]):
            self._facets.append(coal.Triangle(*map(int, triangle)))

    def hull_points(self, acceleration: Array) -> Array:
        """Points about the payload's centre whose hull is the formation (K, P, 3) (m), rims coarsely.

        ``acceleration`` of the payload (K, 3).
        """
        return hull_points(
            self.corners, self.rims, self.hover_offsets, self.lengths, self.g, np.ascontiguousarray(acceleration)
        )

    def points_in_world(self, position: Array, quaternion: Array, uav_position: Array, uav_quaternion: Array) -> Array:
        """Return the points whose hull is the formation in a given state (P, 3), NED (m), rims coarsely.

        Args:
            position, quaternion: of the payload, (3,) (m) and w-first (4,), payload to world.
            uav_position, uav_quaternion: (N, 3) (m) and w-first (N, 4), body to world.
        """
        payload = self.corners @ rotation_from_quaternion(quaternion).T + position
        discs = self.rims @ np.swapaxes(rotation_from_quaternion(uav_quaternion), -1, -2) + uav_position[:, None, :]
        return np.vstack([payload, discs.reshape(-1, 3)])

    def hull(self, points: Array) -> coal.ShapeBase:
        """The hull of ``points`` (P, 3) for distance queries, until the next call."""
        if self._hull is None:
            vertices = coal.StdVec_Vec3s()
            vertices.extend(list(points))
            self._hull = coal.Convex(vertices, self._facets)
        # Its vertices are moved: to make it anew takes ten times as long.
        self._hull.points()[:] = points
        return self._hull
