"""Which cluster belongs to which obstacle: nearest surface, one obstacle of a kind for each cluster of a vehicle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from idc_controller.geometry.box import Wall
from idc_controller.geometry.distance import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception.scan_assembly import Cluster

Array = NDArray[np.float64]

REMEMBERED_GATE = 1.2  # m: as far may a cluster be from the obstacle to which it belonged before
_REMEMBERED = 0.5  # m: what it is worth that it did
_WALL_BEYOND = 4.0  # m: how much longer and higher than what is seen of it a wall may prove to be
_FAR = 1e3


def mean_distances(clusters: Sequence[Cluster], shapes: Sequence[Shape], centres: Array) -> Array:
    """Mean distance of every cluster's points from every surface (clusters, bodies) (m).

    ``shapes`` at ``centres`` (bodies, 3).
    """
    if not shapes:
        return np.zeros((len(clusters), 0))
    points = np.concatenate([cluster.seen.points for cluster in clusters])
    counts = np.array([len(cluster.seen.points) for cluster in clusters])
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    distance = np.abs(Bodies(shapes).distance(points, centres))
    return (np.add.reduceat(distance, starts, axis=1) / counts).T


def for_gating(shape: Shape) -> Shape:
    """Return a shape under observation as large as it may prove to be."""
    if not isinstance(shape, Wall):
        return shape
    x, y, z = shape.size
    return Wall((x, y + _WALL_BEYOND, z + _WALL_BEYOND), shape.yaw)


def assigned(
    clusters: Sequence[Cluster], distances: Array, gates: Array, remembered: Sequence[int | None]
) -> list[int | None]:
    """For every cluster the body it belongs to, None if to none.

    ``distances`` (clusters, bodies); ``gates`` (bodies,) (m); ``remembered``: the body of each cluster's vehicle and
    number at the last frame. A vehicle has told its clusters apart: they are different bodies.
    """
    result: list[int | None] = [None] * len(clusters)
    if distances.shape[1] == 0:
        return result
    cost = np.where(distances < gates, distances, _FAR)
    for row, body in enumerate(remembered):
        if body is not None and distances[row, body] < max(REMEMBERED_GATE, gates[body]):
            cost[row, body] = distances[row, body] - _REMEMBERED
    uavs = np.array([cluster.uav for cluster in clusters])
    for uav in np.unique(uavs):
        rows = np.flatnonzero(uavs == uav)
        for i, body in zip(*linear_sum_assignment(cost[rows]), strict=True):
            if cost[rows[i], body] < _FAR / 2.0:
                result[rows[i]] = int(body)
    return result
