"""Evidence for an offset of a vehicle in all that it detects of the map's obstacles together."""

import math
from collections import defaultdict, deque
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.surfaces.points import SurfacePoints

_OUTLIER = 9.0
"""Normalised square of a distance from which on a point is no more evidence: it is of something else."""

Pair = tuple[int, int]
"""A vehicle (0 .. N-1), and the number of an obstacle."""


class MapEvidence:
    """The last scans of each obstacle, by vehicle: each obstacle is for an offset or against it. Times in s, m."""

    def __init__(
        self,
        standing: Sequence[tuple[str, Shape, Array]],
        is_standing: Callable[[Array, float], Mask],
        settings: PerceptionSettings,
    ) -> None:
        """See :class:`~idc_controller.perception.map_check.MapCheck`."""
        self._standing, self._is_standing = standing, is_standing
        self._duration, self._settling = settings.map_check.duration, settings.standing_map.settling_time
        self._latest: dict[int, dict[int, deque[SurfacePoints]]] = defaultdict(lambda: defaultdict(deque))
        """Of each vehicle and obstacle, not older than an offset must last."""
        voxel, reach = settings.standing_map.voxel, settings.association.remembered_gate
        steps = voxel * np.arange(-(reach // voxel), reach // voxel + 1.0)
        grid = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
        self._about = grid[np.linalg.norm(grid, axis=1) <= reach]
        """Places (G, 3) about a point from which an offset may have moved it."""

    def add(self, pair: Pair, points: SurfacePoints) -> None:
        """Take what a vehicle detected of an obstacle in one scan."""
        latest = self._latest[pair[0]][pair[1]]
        latest.append(points)
        while latest[0].time < points.time - self._duration:
            latest.popleft()

    def votes(self, uav: int, offset: Array, since: float, agreed: Mapping[int, float]) -> float:
        """Return how many more obstacles are likelier with an ``offset`` (3,) of a vehicle than in their places.

        Args:
            uav: the vehicle.
            offset: NED.
            since: time since which there has been that offset.
            agreed: of obstacles that disagree with the map, when they agreed last.
        """
        of_uav = self._latest[uav]
        since = max(since, max(scans[-1].time for scans in of_uav.values()) - self._duration)
        first, votes = min(agreed.values(), default=math.inf), 0.0
        for number, scans in of_uav.items():
            begin = agreed.get(number, first) - self._settling
            votes += float(
                np.sign(sum(self._gain(number, points, offset, begin) for points in scans if points.time >= since))
            )
        return votes

    def _gain(self, number: int, points: SurfacePoints, offset: Array, begin: float) -> float:
        """Return by how much points of an obstacle are likelier with an ``offset`` (3,) than in its place (nats).

        Those near what had stood there at the time ``begin`` may be of that.
        """
        _, shape, centre = self._standing[number]
        away = points.points - centre
        distances = Bodies([shape]).from_offsets(np.stack([away, away - offset]).reshape(1, -1, 3))
        squares = distances.reshape(2, -1) ** 2 / (points.noise**2 + points.pose_variance)
        in_place, moved = np.minimum(squares, _OUTLIER)
        # What is out of place is so with any offset; what is in its place contradicts one that moves it away.
        gains = 0.5 * (in_place - np.where(in_place < _OUTLIER, moved, 0.0))
        of_others = self._is_standing((points.points[:, None] + self._about).reshape(-1, 3), begin)
        return float(gains[~of_others.reshape(len(gains), -1).any(axis=1)].sum())
