"""Association of clusters with obstacles: the nearest surface, a different one for each cluster of a vehicle."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linear_sum_assignment

from idc_controller.arrays import Array
from idc_controller.geometry.box import Wall
from idc_controller.geometry.shape import Shape
from idc_controller.perception.scan_assembly import Cluster
from idc_controller.perception.settings import AssociationSettings

_FAR = 1e3


def gating_shape(shape: Shape, wall_extension: float) -> Shape:
    """Return a tracked shape as large as it may prove to be; ``wall_extension`` (m) beyond what was detected."""
    if not isinstance(shape, Wall):
        return shape
    x, y, z = shape.size
    return Wall((x, y + wall_extension, z + wall_extension), shape.yaw)


def associate(
    clusters: Sequence[Cluster],
    distances: Array,
    gates: Array,
    remembered: Sequence[int | None],
    settings: AssociationSettings,
) -> list[int | None]:
    """Return the body of every cluster, None if it belongs to none.

    Args:
        clusters: of one frame; those of one vehicle are different bodies.
        distances: mean distances (clusters, bodies) (m).
        gates: of the bodies (bodies,) (m).
        remembered: the body of each cluster's vehicle and number at the last frame.
        settings: gates and preference of remembered bodies.
    """
    result: list[int | None] = [None] * len(clusters)
    if distances.shape[1] == 0:
        return result
    cost = np.where(distances < gates, distances, _FAR)
    rows_of_uav: dict[int, list[int]] = defaultdict(list)
    for row, cluster in enumerate(clusters):
        rows_of_uav[cluster.uav].append(row)
    pairs = [(row, body) for row, body in enumerate(remembered) if body is not None]
    if pairs:
        rows, bodies = np.array(pairs).T
        again = distances[rows, bodies]
        kept = again < np.maximum(settings.remembered_gate, gates[bodies])
        cost[rows[kept], bodies[kept]] = again[kept] - settings.remembered_gain
    near = np.flatnonzero(cost.min(axis=0) < _FAR / 2.0)
    cost = cost[:, near]
    for of_uav in rows_of_uav.values():
        own = cost[of_uav]
        assigned, columns = linear_sum_assignment(own)
        is_near = own[assigned, columns] < _FAR / 2.0
        for i, body in zip(assigned[is_near].tolist(), near[columns[is_near]].tolist(), strict=True):
            result[of_uav[i]] = body
    return result


@dataclass
class ClusterMemory:
    """Obstacle of each vehicle's cluster number, for ``duration`` (s)."""

    duration: float
    _entries: dict[tuple[int, int], tuple[str, float]] = field(default_factory=dict)

    def name(self, cluster: Cluster, time: float) -> str:
        """Return the name of the cluster's obstacle at ``time`` (s); empty if there is none."""
        name, since = self._entries.get((cluster.uav, cluster.number), ("", -np.inf))
        return name if time - since < self.duration else ""

    def set(self, cluster: Cluster, name: str, time: float) -> None:
        """Assign the cluster's number to an obstacle at ``time`` (s)."""
        self._entries[cluster.uav, cluster.number] = name, time

    def rename(self, old: str, new: str) -> None:
        """Assign all numbers of one obstacle to another."""
        for key, (name, since) in tuple(self._entries.items()):
            if name == old:
                self._entries[key] = new, since

    def forget(self, now: float) -> None:
        """Discard what is too old at ``now`` (s)."""
        for key, (_, since) in tuple(self._entries.items()):
            if now - since > self.duration:
                del self._entries[key]
