"""Clearance: the distance between the flying formation and the true surface of the obstacles.

The formation is the convex hull of the payload and of the UAVs' discs. Both it and the obstacles are exact.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gcs.errors import UnusableInput
from gcs.record.clearance_kernels import lower_clearance
from idc_controller.arrays import Array
from idc_controller.errors import ShapeError
from idc_controller.geometry.oriented import OrientedShape
from idc_controller.geometry.shape import Shape
from idc_controller.parameters import PayloadHull
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


@dataclass(frozen=True, eq=False)
class Formation:
    """The formation at T times, of N UAVs. NED, m, quaternions body to world, w first."""

    payload_position: Array  # (T, 3)
    payload_quaternion: Array  # (T, 4)
    uav_position: Array  # (T, N, 3)
    uav_quaternion: Array  # (T, N, 4)
    payload: PayloadHull = DEFAULT_PAYLOAD
    disc_radius: float = 0.3

    def clearance(self, obstacles: Sequence[ObstacleTrack]) -> Array:
        """Return the distance to the nearest of the obstacles (T,) (m); 0 where they meet, NaN where none is known.

        A row or an obstacle's position that is not finite counts as unknown.
        """
        rotation = np.ascontiguousarray(rotation_from_quaternion(self.payload_quaternion))
        axes = np.ascontiguousarray(rotation_from_quaternion(self.uav_quaternion)[..., 2])
        # About the payload, so that the last digits do not depend on where in the world the flight is.
        discs = np.ascontiguousarray(self.uav_position - self.payload_position[:, None])
        vertices = np.array(self.payload.vertices)
        formation = vertices, rotation, discs, axes, self.disc_radius
        # No point of the hull goes farther from row to row than its payload's or its discs'.
        turned = np.linalg.norm(np.diff(rotation, axis=0), axis=(1, 2)) * np.linalg.norm(vertices, axis=1).max()
        step = np.linalg.norm(np.diff(self.payload_position, axis=0), axis=1) + turned
        discs_step = np.linalg.norm(np.diff(self.uav_position, axis=0), axis=2)
        discs_step += self.disc_radius * np.linalg.norm(np.diff(axes, axis=0), axis=2)
        step = np.max(discs_step, axis=1, initial=0.0).clip(step)
        least = np.full(len(rotation), np.inf)
        for obstacle in obstacles:
            moved = np.linalg.norm(np.diff(obstacle.position, axis=0), axis=1)
            way = np.concatenate([[0.0], np.cumsum(step + moved)])
            offsets = obstacle.position - self.payload_position
            lower_clearance(*formation, *_body(obstacle.shape), offsets, way, least)
        return np.where(np.isinf(least), np.nan, least)

    def clearances(self, obstacles: Sequence[ObstacleTrack]) -> Array:
        """Return the distance to each of the obstacles (T, number of them) (m), otherwise as :meth:`clearance`."""
        each = [self.clearance([obstacle]) for obstacle in obstacles]
        return np.stack(each, axis=1) if each else np.empty((len(self.payload_position), 0))


def _body(shape: Shape) -> tuple[Array, Array, Array]:
    """Return corners (C, 3), what they are widened by (5,), and the rotation to the world (3, 3) of an obstacle."""
    rotation = np.ascontiguousarray(shape.rotation)
    if isinstance(shape, OrientedShape):
        return np.ascontiguousarray(shape.corners), np.array([0.0, 0.0, 0.0, 0.0, shape.rounding]), rotation
    if shape.rounded_box is None:
        raise NotImplementedError(f"clearance from a {shape.kind}")
    return np.zeros((1, 3)), np.array(shape.rounded_box), rotation
