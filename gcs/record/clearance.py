"""Clearance: the distance between the flying formation and the true surface of the obstacles.

The formation is the convex hull of the payload and of the UAVs' discs. Discs enter as regular polygons
of :data:`RIM_VERTICES` corners, scaled to lie as far outside the rim at their corners as they lie inside it
between them. A convex hull never moves more than its parts do, so the clearance is wrong by at most

    disc_radius (1 - cos(pi / RIM_VERTICES)) / (1 + cos(pi / RIM_VERTICES)),

0.18 mm for a disc of 0.3 m, plus the 0.001 mm to which GJK is run. Obstacles are exact.
The hull is built and the distance taken by ``coal`` (Gilbert-Johnson-Keerthi on its support functions).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import coal
import numpy as np
from numpy.typing import ArrayLike

from gcs.errors import UnusableInput
from idc_controller.arrays import Array
from idc_controller.errors import ShapeError
from idc_controller.geometry.formation import formation_points
from idc_controller.geometry.shape import Shape
from idc_controller.payload_hull import PayloadHull

RIM_VERTICES = 64

_DISTANCE_TOLERANCE = 1e-6  # m

DEFAULT_PAYLOAD = PayloadHull.box((1.0, 1.0, 0.5))


@dataclass(frozen=True, eq=False)
class ObstacleTrack:
    """One obstacle over time: its shape, and its centre ``position`` (T, 3) at each of the T times. NED, m.

    Raises :class:`UnusableInput` for a shape whose lengths are not positive.
    """

    name: str
    shape: Shape
    position: Array

    def __post_init__(self) -> None:
        try:
            self.shape.check()
        except ShapeError as error:
            raise UnusableInput(f"obstacle {self.name}: {error}") from error


def clearance_over_time(
    payload_position_in_world: ArrayLike,
    payload_quaternion: ArrayLike,
    uav_position_in_world: ArrayLike,
    uav_quaternion: ArrayLike,
    obstacles: Sequence[ObstacleTrack],
    payload_vertices: ArrayLike = DEFAULT_PAYLOAD.vertices,
    disc_radius: float = 0.3,
) -> Array:
    """Return the distance between formation and obstacles (T, number of obstacles) (m); 0 where they meet.

    Shapes: (T, 3), w-first (T, 4), (T, N, 3), w-first (T, N, 4), (V, 3), NED, quaternions body to world. A row or an
    obstacle position that is not finite gives NaN.
    """
    payload_position = np.asarray(payload_position_in_world, dtype=float)
    payload_quaternion = np.asarray(payload_quaternion, dtype=float)
    uav_position = np.asarray(uav_position_in_world, dtype=float)
    uav_quaternion = np.asarray(uav_quaternion, dtype=float)
    shapes = [obstacle.shape.geometry() for obstacle in obstacles]
    rotations = [obstacle.shape.rotation for obstacle in obstacles]
    request = coal.DistanceRequest()
    request.gjk_tolerance = _DISTANCE_TOLERANCE
    request.gjk_max_iterations = 1000
    identity = coal.Transform3s.Identity()
    corners = np.asarray(payload_vertices, dtype=float)
    angle = 2.0 * np.pi * np.arange(RIM_VERTICES) / RIM_VERTICES
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(RIM_VERTICES)])
    rim *= disc_radius * 2.0 / (1.0 + np.cos(np.pi / RIM_VERTICES))
    clearance = np.full((len(payload_position), len(obstacles)), np.nan)
    for t in range(len(payload_position)):
        states = (payload_position[t], payload_quaternion[t], uav_position[t], uav_quaternion[t])
        present = [j for j, obstacle in enumerate(obstacles) if np.all(np.isfinite(obstacle.position[t]))]
        if not present or not all(np.all(np.isfinite(state)) for state in states):
            continue
        # About the payload, so that the last digits do not depend on where in the world the flight is.
        from_payload = states[2] - states[0]
        hull = _coal_hull(formation_points(corners, rim, np.zeros(3), states[1], from_payload, states[3]))
        for j in present:
            placement = coal.Transform3s(rotations[j], obstacles[j].position[t] - states[0])
            result = coal.DistanceResult()
            distance = coal.distance(hull, identity, shapes[j], placement, request, result)
            clearance[t, j] = max(distance, 0.0)
    return clearance


def _coal_hull(points: Array) -> coal.ConvexBase:
    vertices = coal.StdVec_Vec3s()
    vertices.extend(list(points))
    return coal.ConvexBase.convexHull(vertices, False, "")
