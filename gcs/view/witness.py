"""Witness points of the clearance: the two points, of hull and obstacle, between which the distance is least."""

from typing import NamedTuple

import coal
import numpy as np

from gcs.record.clearance import Formation, ObstacleTrack
from idc_controller.arrays import Array
from idc_controller.rotations import rotation_from_quaternion

_CORNERS = 720
"""Corners in place of a disc's rim: they lie 3 micrometres outside of the inscribed polygon's edges at 0.3 m."""


class Witness(NamedTuple):
    """Points (3,) of the hull and of the obstacle (NED, m), and the distance between them (m), 0 where they meet."""

    hull: Array
    obstacle: Array
    distance: float


def hull_points(formation: Formation, row: int) -> Array:
    """Return points (P, 3) whose convex hull is the formation in ``row``, about the payload, world axes (m)."""
    rotation = rotation_from_quaternion(formation.payload_quaternion[row])
    angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
    rim = formation.disc_radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    discs = np.einsum("nij,kj->nki", rotation_from_quaternion(formation.uav_quaternion[row]), rim)
    discs += (formation.uav_position[row] - formation.payload_position[row])[:, None]
    return np.vstack([formation.payload.vertices @ rotation.T, discs.reshape(-1, 3)])


def witness(formation: Formation, obstacle: ObstacleTrack, row: int) -> Witness:
    """Return the witness points of the distance between the formation and an obstacle in ``row``."""
    origin = formation.payload_position[row]
    points = coal.StdVec_Vec3s()
    points.extend(list(hull_points(formation, row)))
    hull = coal.ConvexBase.convexHull(points, False, "")
    place = coal.Transform3s(np.ascontiguousarray(obstacle.shape.rotation), obstacle.position[row] - origin)
    result = coal.DistanceResult()
    distance = coal.distance(
        hull, coal.Transform3s.Identity(), obstacle.shape.geometry(), place, coal.DistanceRequest(True), result
    )
    on_hull, on_obstacle = (np.array(result.getNearestPoint1()), np.array(result.getNearestPoint2()))
    if distance <= 0.0:  # they meet: one point that is in both
        on_hull = on_obstacle = (on_hull + on_obstacle) / 2.0
    return Witness(on_hull + origin, on_obstacle + origin, max(float(distance), 0.0))
