"""Points that range sensors found on one obstacle at one moment."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from idc_controller.arrays import Array, Mask


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """n points on the surface of one obstacle, from one or more sensors, at ``time`` (s). World frame, m."""

    time: float
    points: Array
    """(n, 3)"""
    origins: Array
    """Where the sensor of each point was (n, 3)."""
    cut: Mask
    """Whether a point lies at the end of its sensor's range, so that more may lie behind (n,)."""
    noise: float
    """Standard deviation along the line of sight (m)."""
    pose_variance: Array
    """Variance of each point from its sensor's own position and attitude, on every axis (n,) (m2)."""
    sensors: int = 1
    """How many sensors contributed: what of their poses' errors averages out."""
    scatter: float = 0.0
    """Variance of each point on its own beyond that, on every axis (m2): of sensors worse than they should be."""

    @property
    def rays(self) -> Array:
        """Unit vectors from the sensors to the points (n, 3)."""
        ray = self.points - self.origins
        return np.asarray(ray / np.maximum(np.sqrt(np.einsum("ij,ij->i", ray, ray)), 1e-6)[:, None])

    def moved(self, by: Array, time: float, variance: float) -> SurfacePoints:
        """The same points as if measured at ``time``, the obstacle having moved by (3,) (m) until then.

        ``variance`` (m2) of that motion adds to the points'.
        """
        return replace(
            self, time=time, points=self.points + by, origins=self.origins + by,
            pose_variance=self.pose_variance + variance,
        )  # fmt: skip


def joined(parts: list[SurfacePoints]) -> SurfacePoints:
    """Several sensors' points of one obstacle at (nearly) one moment."""
    if len(parts) == 1:
        return parts[0]
    return SurfacePoints(
        max(part.time for part in parts),
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.origins for part in parts]),
        np.concatenate([part.cut for part in parts]),
        parts[0].noise,
        np.concatenate([part.pose_variance for part in parts]),
        len(parts),
    )
