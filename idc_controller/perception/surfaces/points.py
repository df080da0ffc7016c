"""Points that range sensors found on one obstacle at one moment, and common parts of the fits of shapes to them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception.settings import SurfaceSettings

SCORE_CAP = 16.0
MEDIAN_OF_SQUARE = 0.455  # of a normal variable of variance 1


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """n points on the surface of one obstacle, from one or more sensors, at ``time`` (s). World frame, m."""

    time: float
    points: Array
    """(n, 3)"""
    origins: Array
    """Places of the sensors of each point (n, 3)."""
    cut: Mask
    """Points (n,) at the end of their sensor's range, so that more may lie behind."""
    noise: float
    """Standard deviation along the line of sight (m)."""
    pose_variance: Array
    """Variance of each point from its sensor's own position and attitude, on every axis (n,) (m2)."""
    sensors: int = 1
    """Number of sensors, over which errors of their poses average out."""
    scatter: float = 0.0
    """Variance of each point on its own beyond that, on every axis (m2): of sensors worse than they should be."""

    def __getitem__(self, part: slice) -> SurfacePoints:
        """Return a part of the points."""
        return SurfacePoints(
            self.time, self.points[part], self.origins[part], self.cut[part], self.noise, self.pose_variance[part],
            self.sensors, self.scatter,
        )  # fmt: skip

    @cached_property
    def common_variance(self) -> float:
        """Variance on every axis that the points have in common, of their sensors' poses (m2)."""
        return float(self.pose_variance.mean()) / self.sensors

    @property
    def rays(self) -> Array:
        """Unit vectors from the sensors to the points (n, 3)."""
        ray = self.points - self.origins
        return np.asarray(ray / np.maximum(np.sqrt(np.einsum("ij,ij->i", ray, ray)), 1e-6)[:, None])

    def moved(self, by: Array, time: float, variance: float) -> SurfacePoints:
        """Return the points as if measured at ``time``, the obstacle having moved by (3,) (m) until then.

        ``variance`` (m2) of that motion adds to the points'.
        """
        return replace(
            self, time=time, points=self.points + by, origins=self.origins + by,
            pose_variance=self.pose_variance + variance,
        )  # fmt: skip


def joined(parts: list[SurfacePoints]) -> SurfacePoints:
    """Return several sensors' points of one obstacle at (nearly) one moment."""
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


@dataclass(frozen=True, eq=False)
class Fit:
    """Place of an obstacle's reference point in one frame."""

    position: Array
    """(3,) (m)"""
    variance: Array
    """(3,) (m2)"""
    score: float
    """Mean squared distance of the points to the surface over its variance: about 1 for the right shape."""
    unexplained: float
    """Excess of their squared distances over their variance (m2), by the median: about 0."""


def score(residual: Array, variance: Array) -> float:
    """Return the score of :class:`Fit`; single points that do not belong count for little."""
    return float(np.mean(np.minimum(residual**2 / variance, SCORE_CAP)))


def unexplained(residual: Array, variance: Array, fitted: int) -> float:
    """Return what :class:`Fit` leaves unexplained after ``fitted`` quantities were found; outliers do not count."""
    n = len(residual)
    return float(np.median(residual**2) / MEDIAN_OF_SQUARE * n / max(n - fitted, 1) - np.median(variance))


class EndOfSurface:
    """Extent of a surface in one direction, from its detected points frame by frame."""

    def __init__(self, extension: float, settings: SurfaceSettings) -> None:
        """``extension`` (m) is added while the end itself was not in the sensors' range."""
        self._extension, self._settings = extension, settings
        self._value = -np.inf
        self._is_observed = False

    @property
    def outermost(self) -> float:
        """Coordinate up to which the surface may reach (m)."""
        return float(self._value if self._is_observed else self._value + self._extension)

    def displacement(self, along: Array, cut: Mask) -> float | None:
        """Return how far (m) the end is beyond where it was, for a frame as in :meth:`update`; None: not seen."""
        last = int(np.argmax(along))
        return float(along[last] - self._value) if self._is_observed and not cut[last] else None

    def update(self, along: Array, cut: Mask) -> None:
        """Points of one frame, by their coordinate in that direction (n,), and whether they end the sensor's range."""
        last, s = int(np.argmax(along)), self._settings
        furthest, is_cut = float(along[last]), bool(cut[last])
        beyond = furthest - self._value
        if beyond > s.end_jump:
            self._value, self._is_observed = furthest, not is_cut
        elif is_cut:
            if not self._is_observed:
                self._value = max(self._value, furthest)
        elif beyond > -s.end_jump:
            # Noise makes the outermost of several points a little too far out: the safe side.
            self._value += (s.end_smoothing if self._is_observed else 1.0) * beyond
            self._is_observed = True
        else:
            self._value += s.end_retreat * beyond


_STEP = 1e-4  # m, of the differences that give the surface's normals


class KnownSurface:
    """A shape that is given; only the place of its centre, the reference point, is found."""

    size_sigma = 0.0
    """Standard deviation of the size (m)."""

    def __init__(self, known: Shape, settings: SurfaceSettings) -> None:
        self.shape, self._settings = known, settings
        self.kind = known.kind
        self.offset = np.zeros(3)
        self._body = Bodies([known])

    def guess(self, scan: SurfacePoints) -> Array:
        """Return a first place for the centre: half the body behind the middle of the points (3,)."""
        middle, ray = scan.points.mean(axis=0), scan.rays.mean(axis=0)
        return np.asarray(middle + self.shape.support(ray) * ray)

    def fit(self, scan: SurfacePoints, predicted: Array, iterations: int = 3) -> Fit:
        """Return the place of the centre in this frame, expected at ``predicted`` (3,)."""
        place = predicted.copy()
        prior = np.eye(3) / self._settings.sideways_sigma**2
        variance = scan.noise**2 + scan.pose_variance + scan.scatter
        for _ in range(iterations):
            residual, normal = self._distance(scan.points - place)
            weight = 1.0 / (variance * (1.0 + residual**2 / (9.0 * variance)))
            information = (normal.T * weight) @ normal + prior
            place = place + np.linalg.solve(information, (normal.T * weight) @ residual + prior @ (predicted - place))
        residual, _ = self._distance(scan.points - place)
        spread = np.diag(np.linalg.inv(information)) + scan.common_variance
        return Fit(place, spread, score(residual, variance), unexplained(residual, variance, fitted=3))

    def _distance(self, offsets: Array) -> tuple[Array, Array]:
        """Distance of points (n, 3) about the centre from the surface (n,), and its gradient (n, 3)."""
        steps = np.concatenate([np.zeros((1, 3)), _STEP * np.eye(3)])
        distance = self._body.from_offsets((offsets + steps[:, None]).reshape(1, -1, 3)).reshape(4, -1)
        return distance[0], (distance[1:] - distance[0]).T / _STEP
