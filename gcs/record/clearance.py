"""Clearance: the distance between the flying formation and the true surface of the obstacles.

The formation is the convex hull of the payload and of the UAVs' discs. Both it and the obstacles are exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gcs.errors import UnusableInput
from gcs.record.clearance_kernels import clearance
from idc_controller.arrays import Array
from idc_controller.errors import ShapeError
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import Shape
from idc_controller.payload_hull import PayloadHull
from idc_controller.rotations import rotation_from_quaternion

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
    uav_rotation = rotation_from_quaternion(np.asarray(uav_quaternion, dtype=float))
    # About the payload, so that the last digits do not depend on where in the world the flight is.
    discs = np.asarray(uav_position_in_world, dtype=float) - payload_position[:, None]
    formation = (
        np.array(payload_vertices, dtype=float),
        np.ascontiguousarray(rotation_from_quaternion(np.asarray(payload_quaternion, dtype=float))),
        np.ascontiguousarray(discs),
        np.ascontiguousarray(uav_rotation[..., 2]),
        disc_radius,
    )
    found = np.empty((len(payload_position), len(obstacles)))
    for j, obstacle in enumerate(obstacles):
        found[:, j] = clearance(*formation, *_body(obstacle.shape), obstacle.position - payload_position)
    return found


def _body(shape: Shape) -> tuple[Array, Array, Array]:
    """Return corners (C, 3), what they are widened by (5,), and the rotation to the world (3, 3) of an obstacle."""
    rotation = np.ascontiguousarray(shape.rotation)
    if isinstance(shape, OrientedShape):
        return np.ascontiguousarray(shape.corners), np.array([0.0, 0.0, 0.0, 0.0, shape.rounding]), rotation
    if shape.rounded_box is None:
        raise NotImplementedError(f"clearance from a {shape.kind}")
    return np.zeros((1, 3)), np.array(shape.rounded_box), rotation
