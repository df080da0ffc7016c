"""Witness points of the clearance: the two points, of hull and obstacle, between which the distance is least."""

from typing import Any, NamedTuple

import coal
import numpy as np

from gcs.record.clearance import Formation
from gcs.record.landing import in_air
from gcs.record.run_data import RunData
from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape
from idc_controller.rotations import rotation_from_quaternion

_CORNERS = 720
"""Corners in place of a disc's rim: they lie 3 micrometres outside of the inscribed polygon's edges at 0.3 m."""


class Nearest(NamedTuple):
    """The least distance to an obstacle: points (3,) of hull and obstacle (NED, m), one where they meet."""

    distance: float
    point_hull: Array
    point_obstacle: Array
    obstacle: str
    row: int
    time: float

    @property
    def header(self) -> dict[str, Any]:
        """What the page has of it."""
        return {"min": self.distance, **{name: getattr(self, name) for name in self._fields[1:]}}


def hull_points(formation: Formation) -> Array:
    """Return points (P, 3) whose convex hull is the formation in its first row, about the payload, world axes (m)."""
    rotation = rotation_from_quaternion(formation.payload_quaternion[0])
    angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
    rim = formation.disc_radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    discs = np.einsum("nij,kj->nki", rotation_from_quaternion(formation.uav_quaternion[0]), rim)
    discs += (formation.uav_position[0] - formation.payload_position[0])[:, None]
    return np.vstack([formation.payload.vertices @ rotation.T, discs.reshape(-1, 3)])


def least_clearance(run: RunData) -> Nearest | None:
    """Return the least clearance from lift-off to touch-down, and where it is; None where none is known."""
    air = in_air(run) if run.barriers and run.number_of_uavs else slice(0)
    clearance = run.clearance[air] if run.barriers else np.empty(0)
    if not np.isfinite(clearance).any():
        return None
    row = (air.start or 0) + int(np.nanargmin(clearance))
    formation, time = run.formation(slice(row, row + 1)), float(run.time[row])
    found = [
        Nearest(*witness(formation, barrier.shape, barrier.position[row]), barrier.name, row, time)
        for barrier in run.barriers
        if np.isfinite(barrier.position[row]).all()
    ]
    return min(found, key=lambda each: each.distance)


def witness(formation: Formation, shape: Shape, place: Array) -> tuple[float, Array, Array]:
    """Return distance and witness points between the formation's first row and a shape at ``place`` (3,) (NED, m)."""
    origin = formation.payload_position[0]
    points = coal.StdVec_Vec3s()
    points.extend(list(hull_points(formation)))
    hull = coal.ConvexBase.convexHull(points, False, "")
    there = coal.Transform3s(np.ascontiguousarray(shape.rotation), place - origin)
    result = coal.DistanceResult()
    distance = coal.distance(
        hull, coal.Transform3s.Identity(), shape.geometry(), there, coal.DistanceRequest(True), result
    )
    on_hull, on_obstacle = (np.array(result.getNearestPoint1()), np.array(result.getNearestPoint2()))
    if distance <= 0.0:  # they meet: one point that is in both
        on_hull = on_obstacle = (on_hull + on_obstacle) / 2.0
    return max(float(distance), 0.0), on_hull + origin, on_obstacle + origin
