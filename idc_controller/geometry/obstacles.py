"""Obstacles as the safety filter takes them: convex shapes, their predicted places, and the distances to them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple, Protocol

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.geometry.distance_kernels import (
    distances_of_offsets,
    distances_of_points,
    mean_distances_of_groups,
)
from idc_controller.geometry.shape import ROW, Shape


@dataclass(frozen=True, eq=False)
class PredictedObstacle:
    """One obstacle at K moments."""

    name: str
    """The same from step to step."""
    shape: Shape
    positions: Array
    """Centres in the world (K, 3) (m)."""
    growth: Array
    """Growth of the body at each moment, for what is not known (K,) (m)."""
    may_leave: bool = False
    """It moves, or has moved of late: where it is, it need not stay."""
    estimate: Callable[[], tuple[Shape, Array]] | None = None
    """Returns the most probable body and its centre (3,), where ``shape`` covers what is uncertain as well."""

    @property
    def stands(self) -> bool:
        """Return whether it stays where it is."""
        return not self.may_leave and bool((self.positions[0] == self.positions[-1]).all())


class Region(NamedTuple):
    """All within ``radius`` (m) of the vertical line through ``place`` (3,), NED (m)."""

    place: Array
    radius: float


class ObstacleSource(Protocol):
    """A source of predicted obstacles: a map, a tracker of detections, or both."""

    def predict(self, times: Array, region: Region | None = None) -> Sequence[PredictedObstacle]:
        """Return all obstacles at ``times`` (K,) (s); those that stay out of ``region`` may be missing."""
        ...


class PointGroups(NamedTuple):
    """Groups of points, one behind the other."""

    points: Array
    """(n, 3), world (m)."""
    starts: Indices
    """Index of the first point of each group, then n (G + 1,)."""

    @classmethod
    def of(cls, groups: Sequence[Array]) -> PointGroups:
        """Return groups of points (n, 3) each, none of them or empty ones included."""
        return cls(np.concatenate([np.empty((0, 3)), *groups]), np.array([0, *accumulate(map(len, groups))]))


class Bodies:
    """Shapes gathered for distances from points to all of them together."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self.shapes = shapes
        self.rows = np.array([shape.row for shape in shapes]).reshape(len(shapes), ROW)
        """Rounded boxes as :mod:`idc_controller.geometry.distance_kernels` takes them (B, 14)."""
        self.others = [(i, shape) for i, shape in enumerate(shapes) if shape.rounded_box is None]
        """Bodies that are no rounded boxes, with their index."""

    @cached_property
    def reach(self) -> Array:
        """Radius of the ball about its centre that holds each body (B,) (m)."""
        return np.array([shape.reach for shape in self.shapes])

    @cached_property
    def _horizontal_reach(self) -> Array:
        return np.array([shape.horizontal_reach for shape in self.shapes])

    def distance(self, points: Array, centres: Array) -> Array:
        """Signed distance (m) from ``points`` (n, 3) to the surfaces of bodies at ``centres`` (B, 3): (B, n)."""
        return self.distance_among(np.arange(len(self.shapes)), points, centres)

    def distance_among(self, indices: Indices, points: Array, centres: Array, far: float = math.inf) -> Array:
        """Return the same for the bodies of different ``indices`` (b,) only: (b, n).

        Distances that are surely above ``far`` (m) may be inf.
        """
        reach = self._horizontal_reach[indices] if far < math.inf else np.zeros(len(indices))
        distance = distances_of_points(self.rows[indices], reach, centres[indices], np.ascontiguousarray(points), far)
        for i, shape in self.others:
            for k in np.flatnonzero(indices == i):
                distance[k] = shape.distance((points - centres[i]) @ shape.rotation)
        return distance

    def from_offsets(self, offsets: Array) -> Array:
        """Return the same for points relative to each body's centre (B, n, 3)."""
        distance = distances_of_offsets(self.rows, np.ascontiguousarray(offsets))
        for i, shape in self.others:
            distance[i] = shape.distance(offsets[i] @ shape.rotation)
        return distance

    def from_own_offsets(self, indices: Sequence[int], offsets: Array) -> Array:
        """Return the signed distance (K,) (m) of one point relative to each centre (K, 3) from the body of each index.

        An index may come more than once.
        """
        distance = distances_of_offsets(self.rows[indices], np.ascontiguousarray(offsets[:, None]))[:, 0]
        for i, shape in self.others:
            own = [k for k, index in enumerate(indices) if index == i]
            if own:
                distance[own] = shape.distance(offsets[own] @ shape.rotation)
        return distance

    def mean_distances(self, groups: PointGroups, centres: Array, far: float = math.inf) -> Array:
        """Return the mean distance (m) of every group of points from every surface (groups, B), inf without points.

        Distances that are surely above ``far`` (m) may be inf.
        """
        points, starts = groups
        reach = self._horizontal_reach if far < math.inf else np.zeros(len(self.shapes))
        mean = mean_distances_of_groups(self.rows, reach, np.ascontiguousarray(centres), points, starts, far)
        for i, shape in self.others:
            distance = np.abs(shape.distance((points - centres[i]) @ shape.rotation))
            spans = zip(starts.tolist(), starts[1:].tolist(), strict=False)
            mean[:, i] = [distance[begin:end].mean() if begin < end else math.inf for begin, end in spans]
        return mean
