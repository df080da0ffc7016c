"""Map check: offsets of the detected standing obstacles from their places on the map, vehicle by vehicle.

An obstacle is compared by returns that nothing else can have produced: with an offset of any size that is looked for,
they are of no other obstacle of the map and of no track. An offset is a vehicle's, not an obstacle's: it displaces all
that the vehicle detects. So the one that fits an obstacle counts only if of those that the vehicle detects together
more are likelier with it than are in their places. What has stood near them before is no evidence.
"""

import math
from collections import defaultdict, deque
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.estimation.health.chi_squared import upper_quantile
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception.clusters import Cluster
from idc_controller.perception.obstacle_filter import surface_of
from idc_controller.perception.settings import MapCheckSettings, PerceptionSettings, SurfaceSettings
from idc_controller.perception.standing_obstacles import NextObstacles
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


class _Offset:
    """Offset of a vehicle's points from one obstacle, without a break: a Kalman filter, axis by axis."""

    def __init__(self, time: float, agreed: float, settings: MapCheckSettings, surfaces: SurfaceSettings) -> None:
        self.time, self.agreed = time, agreed
        """Times of the last scan, and of the last before the offset that agreed with the map."""
        self._settings, self._surfaces = settings, surfaces
        self.mean = np.zeros(3)
        self.agreements = 0
        """Scans in a row, up to the last one, that agree with the map."""
        self.since = math.inf
        """Time from which on it has been one."""
        self._variance = np.full(3, settings.initial_sigma**2)
        self._scatter = 0.0  # variance of the points beyond their sensor's (m2)

    @property
    def is_detected(self) -> bool:
        """Return whether there is an offset, and has been for long enough."""
        return self.time - self.since >= self._settings.duration

    def update(self, points: SurfacePoints, shape: Shape, centre: Array, limit: float) -> None:
        """Take one scan of the obstacle, which the map has at ``centre`` (3,).

        ``limit``: square sum of the normalised offset that noise alone does not exceed.
        """
        s = self._settings
        surface = surface_of(shape.kind, shape, self._surfaces)
        points = replace(points, scatter=self._scatter)
        # After a large jump the fit would end on the side of a round shape that faces away from the sensor.
        predicted = surface.guess(points) if shape.round_axes else centre + self.mean
        fit = surface.fit(points, predicted, iterations=8)
        measured, noise = fit.position + surface.offset - centre, fit.variance * max(fit.score, 1.0)
        self._variance = self._variance + s.walk**2 * max(points.time - self.time, 0.0)
        gain = self._variance / (self._variance + noise)
        self.mean = self.mean + gain * (measured - self.mean)
        self._variance = (1.0 - gain) * self._variance
        self._scatter = max(self._scatter + s.smoothing * fit.unexplained, 0.0)
        self.time = points.time
        square = float(np.sum(self.mean**2 / self._variance))
        is_off = square > limit and float(np.linalg.norm(self.mean)) > s.offset_min + math.sqrt(self._scatter)
        self.since = min(self.since, self.time) if is_off else math.inf


class _Found(NamedTuple):
    """What a vehicle detected of an obstacle in one scan."""

    points: SurfacePoints
    mean: float
    """Mean distance of the points from the obstacle's surface (m)."""
    sigma: float
    """Standard deviation of a point (m)."""


class MapCheck:
    """Compares the vehicles' scans with the map; an obstacle that never agreed with it is not compared.

    Times are the team's (s).
    """

    def __init__(
        self,
        standing: Sequence[tuple[str, Shape, Array]],
        view_range: float,
        is_standing: Callable[[Array, float], Mask],
        settings: PerceptionSettings,
    ) -> None:
        """Start without offsets.

        Args:
            standing: name, shape and centre (3,) (NED, m) of the obstacles on the map.
            view_range: within which they are certainly detected (m).
            is_standing: says of points (n, 3) whether something unknown has stood there since a time (s).
            settings: of perception.
        """
        self._bodies = Bodies([shape for _, shape, _ in standing])
        self._centres = np.array([centre for *_, centre in standing]).reshape(-1, 3)
        self._standing, self._view_range, self._gate = standing, view_range, settings.association.remembered_gate
        self._evidence = MapEvidence(standing, is_standing, settings)
        self._settings, self._surfaces = settings.map_check, settings.tracking.surfaces
        self._agreements: dict[Pair, int] = {}
        self._agreed: dict[Pair, float] = {}
        """Time of the last agreement."""
        self._offsets: dict[Pair, _Offset] = {}
        self.offsets: dict[int, Array] = {}
        """Detected offset (3,) (NED, m) of what each vehicle (0 .. N-1) detects from the map."""

    def told_apart(self, next_to: NextObstacles) -> Mask:
        """Return which returns (n,) are of one obstacle of the map only, whatever offset they have."""
        return (next_to.body_distance <= self._gate) & (next_to.others > self._gate)

    def compare(self, detected: Sequence[tuple[Cluster, int]]) -> None:
        """Take one frame: clusters as the vehicles placed them, each with the number of the obstacle that it is of.

        Of several clusters of one obstacle, the one nearest to its place is taken.
        """
        found = self._found(detected)
        if not found:
            return
        for pair, of_pair in found.items():
            self._take(pair, of_pair)
        uavs = dict.fromkeys(uav for (uav, _), offset in self._offsets.items() if offset.is_detected)
        self.offsets = {uav: offset for uav in uavs if (offset := self._likeliest(uav)) is not None}

    def all_offset(self, uavs: Collection[int]) -> bool:
        """Return whether there are ``uavs``, and all of them have an offset."""
        return bool(uavs) and self.offsets.keys() >= set(uavs)

    def _found(self, detected: Sequence[tuple[Cluster, int]]) -> dict[Pair, _Found]:
        """Return what was found of each obstacle in a vehicle's field of view."""
        if not detected:
            return {}
        clusters, numbers = [cluster for cluster, _ in detected], [number for _, number in detected]
        parts = [cluster.surface_points for cluster in clusters]
        sizes = np.array([len(part.points) for part in parts])
        starts, of_points = np.cumsum(sizes) - sizes, np.repeat(numbers, sizes)
        points, origins = np.concatenate([part.points for part in parts]), np.array([part.origins[0] for part in parts])
        distances = np.abs(self._bodies.from_own_offsets(of_points.tolist(), points - self._centres[of_points]))
        means = (np.add.reduceat(distances, starts) / sizes).tolist()
        from_sensors = np.abs(self._bodies.from_own_offsets(numbers, origins - self._centres[numbers])).tolist()
        found: dict[Pair, _Found] = {}
        for cluster, number, part, mean, from_sensor in zip(clusters, numbers, parts, means, from_sensors, strict=True):
            pair = cluster.uav, number
            if from_sensor <= self._view_range and (pair not in found or mean < found[pair].mean):
                sigma = math.sqrt(part.noise**2 + float(np.mean(part.pose_variance)))
                found[pair] = _Found(part, mean, sigma)
        return found

    def _take(self, pair: Pair, found: _Found) -> None:
        """Take what a vehicle ``found`` of an obstacle."""
        s, (_, shape, centre) = self._settings, self._standing[pair[1]]
        agrees, offset = found.mean < s.agreement_sigmas * found.sigma, self._offsets.get(pair)
        if agrees:
            self._agreements[pair] = self._agreements.get(pair, 0) + 1
            self._agreed[pair] = found.points.time
        if self._agreements.get(pair, 0) < s.agreements:
            return
        self._evidence.add(pair, found.points)
        if offset is None and not agrees:
            offset = self._offsets[pair] = _Offset(found.points.time, self._agreed[pair], s, self._surfaces)
        if offset is not None:
            # A few points may agree by chance: they count, but do not end an offset by themselves.
            offset.agreements = offset.agreements + 1 if agrees else 0
            # Bonferroni: one of as many comparisons exceeds its limit by noise with the probability of all of them.
            limit = float(upper_quantile(s.false_alarm / len(self._agreements), 3))
            offset.update(found.points, shape, centre, limit)
            if offset.agreements >= s.agreements:
                del self._offsets[pair]

    def _likeliest(self, uav: int) -> Array | None:
        """Return the detected offset (3,) (m) that explains best what a vehicle detects; None: it has none."""
        # What an offset of any vehicle has put there is no body that has stood there.
        agreed: dict[int, float] = {}
        for (_, number), offset in self._offsets.items():
            agreed[number] = min(agreed.get(number, math.inf), offset.agreed)
        best, most = None, 0.0
        for (of, _), offset in self._offsets.items():
            if of == uav and offset.is_detected:
                votes = self._evidence.votes(uav, offset.mean, offset.since, agreed)
                if votes > most:
                    best, most = offset.mean, votes
        return best
