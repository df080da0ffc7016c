"""Association of clusters with obstacles: the nearest surface, a different one for each cluster of a vehicle."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Wall
from idc_controller.perception.clusters import Cluster

_FAR = 1e3


def gating_shape(shape: Shape, wall_extension: float) -> Shape:
    """Return a tracked shape as large as it may prove to be; ``wall_extension`` (m) beyond what was detected."""
    if not isinstance(shape, Wall):
        return shape
    x, y, z = shape.size
    return Wall((x, y + wall_extension, z + wall_extension), shape.yaw)


def associate(clusters: Sequence[Cluster], distances: Array, gates: Array) -> list[int | None]:
    """Return the body of every cluster, None if it belongs to none.

    Args:
        clusters: of one frame; those of one vehicle are different bodies.
        distances: mean distances (clusters, bodies) (m).
        gates: of the bodies (bodies,) (m).
    """
    result: list[int | None] = [None] * len(clusters)
    if distances.shape[1] == 0:
        return result
    cost = np.where(distances < gates, distances, _FAR)
    rows_of_uav: dict[int, list[int]] = defaultdict(list)
    for row, cluster in enumerate(clusters):
        rows_of_uav[cluster.uav].append(row)
    near = np.flatnonzero(cost.min(axis=0) < _FAR / 2.0)
    cost = cost[:, near]
    for of_uav in rows_of_uav.values():
        own = cost[of_uav]
        assigned, columns = linear_sum_assignment(own)
        is_near = own[assigned, columns] < _FAR / 2.0
        for i, body in zip(assigned[is_near].tolist(), near[columns[is_near]].tolist(), strict=True):
            result[of_uav[i]] = body
    return result
