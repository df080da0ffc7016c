"""Whether vehicles see the standing obstacles of the map where the map has them, and by how much they do not."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.distance import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception.association import REMEMBERED_GATE
from idc_controller.perception.obstacle_filter import surface_of
from idc_controller.perception.scan_assembly import Cluster
from idc_controller.perception.surfaces.points import SurfacePoints

Array = NDArray[np.float64]

ASTRAY = 0.2  # m: so far off the map, and surely (standard deviations), what a vehicle sees of obstacles is wrong
SURELY = 6.0
PATIENCE = 0.4  # s for which it must have been: a wrong pose places points wrongly until it is found out
AGREES = 1.25  # standard deviations: the mean distance of points that lie on a surface is 0.8
AGREED = 5  # scans
_WALK = 0.05  # m/sqrt(s): as which the offset goes on
_START = 0.5  # m, standard deviation
_SMOOTHING = 0.3


@dataclass(eq=False)
class _Offset:
    """By how much a vehicle's points have been off one obstacle without a break: a Kalman filter, axis by axis."""

    time: float
    mean: Array = field(default_factory=lambda: np.zeros(3))
    variance: Array = field(default_factory=lambda: np.full(3, _START**2))
    scatter: float = 0.0
    """Variance of the points beyond what their sensor should have (m2)."""
    astray_since: float = math.inf

    @property
    def is_astray(self) -> bool:
        """For long enough."""
        return self.time - self.astray_since >= PATIENCE

    def update(self, seen: SurfacePoints, shape: Shape, centre: Array) -> None:
        """One scan of the obstacle, which the map has at ``centre`` (3,)."""
        surface = surface_of(shape.kind, shape)
        seen = replace(seen, scatter=self.scatter)
        # What jumped far would be fitted to the side of a round shape that no sensor sees.
        predicted = surface.guess(seen) if shape.round_axes else centre + self.mean
        fit = surface.fit(seen, predicted, iterations=8)
        told, noise = fit.position + surface.offset - centre, fit.variance * max(fit.score, 1.0)
        self.variance = self.variance + _WALK**2 * max(seen.time - self.time, 0.0)
        gain = self.variance / (self.variance + noise)
        self.mean = self.mean + gain * (told - self.mean)
        self.variance = (1.0 - gain) * self.variance
        self.scatter = max(self.scatter + _SMOOTHING * fit.unexplained, 0.0)
        self.time = seen.time
        deviation = math.sqrt(float(np.sum(self.mean**2 / self.variance)))
        is_off = deviation > SURELY and float(np.linalg.norm(self.mean)) > ASTRAY + math.sqrt(self.scatter)
        self.astray_since = min(self.astray_since, self.time) if is_off else math.inf


class MapCheck:
    """What is seen of an obstacle counts once it has agreed with the map: one that stands elsewhere says nothing.

    Times are the team's (s).
    """

    def __init__(self, standing: Sequence[tuple[str, Shape, Array]], reach: float) -> None:
        """``standing``: name, shape and centre (3,) of what is on the map; within ``reach`` (m) it is surely seen."""
        self._standing, self._reach = standing, reach
        self._agreements: dict[tuple[int, int], int] = {}
        self._offsets: dict[tuple[int, int], _Offset] = {}

    def compare(self, told: Sequence[Cluster], standing: Sequence[int | None], distances: Array) -> None:
        """One frame: what vehicles ``told``, and which of the ``standing`` obstacles that was taken for (None: none).

        ``distances`` (clusters, standing ones): by which that was decided. An obstacle that a vehicle must see, and
        does not see in its place, is taken to be what it sees next to that.
        """
        if not self._standing:
            return
        seen = {
            (cluster.uav, number): row
            for row, (cluster, number) in enumerate(zip(told, standing, strict=True))
            if number is not None
        }
        taken = set(seen.values())
        nearest = distances.argmin(axis=1).tolist()
        for row in np.argsort(distances.min(axis=1)).tolist():
            if row not in taken and distances[row, nearest[row]] <= REMEMBERED_GATE:
                seen.setdefault((told[row].uav, nearest[row]), row)
        for (_, number), row in seen.items():
            self._seen(told[row], number)

    def _seen(self, cluster: Cluster, number: int) -> None:
        pair, seen = (cluster.uav, number), cluster.seen
        _, shape, centre = self._standing[number]
        places = np.concatenate([seen.origins[:1], seen.points])
        from_sensor, *from_points = np.abs(Bodies([shape]).distance(places, centre[None])[0]).tolist()
        if from_sensor > self._reach:
            return
        if np.mean(from_points) < AGREES * math.sqrt(seen.noise**2 + float(seen.pose_variance.mean())):
            self._agreements[pair] = self._agreements.get(pair, 0) + 1
            self._offsets.pop(pair, None)
        elif self._agreements.get(pair, 0) >= AGREED:
            offset = self._offsets.get(pair)
            if offset is None:
                offset = self._offsets[pair] = _Offset(seen.time)
            offset.update(seen, shape, centre)

    @property
    def astray(self) -> dict[int, Array]:
        """The offset (3,) (m) of every vehicle that sees obstacles elsewhere than it did."""
        latest: dict[int, _Offset] = {}
        for (uav, _), offset in self._offsets.items():
            if offset.is_astray and (uav not in latest or offset.time > latest[uav].time):
                latest[uav] = offset
        return {uav: offset.mean for uav, offset in latest.items()}

    def is_astray(self, uavs: Collection[int]) -> bool:
        """Whether all of ``uavs`` do, and there is one."""
        return bool(uavs) and self.astray.keys() >= set(uavs)


def moved(cluster: Cluster, by: Array) -> Cluster:
    """The points of a cluster elsewhere by (3,) (m), seen from the same place."""
    return replace(cluster, seen=replace(cluster.seen, points=cluster.seen.points + by))
