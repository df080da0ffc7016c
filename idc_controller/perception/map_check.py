"""Map check: offsets of the detected standing obstacles from their places on the map, vehicle by vehicle."""

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import Bodies, PointGroups
from idc_controller.geometry.shape import Shape
from idc_controller.perception.clusters import Cluster
from idc_controller.perception.obstacle_filter import surface_of
from idc_controller.perception.settings import MapCheckSettings, PerceptionSettings, SurfaceSettings
from idc_controller.perception.surfaces.points import SurfacePoints


class _Offset:
    """Offset of a vehicle's points from one obstacle, without a break: a Kalman filter, axis by axis."""

    def __init__(self, time: float, settings: MapCheckSettings, surfaces: SurfaceSettings) -> None:
        self.time, self._settings, self._surfaces = time, settings, surfaces
        self.mean = np.zeros(3)
        self.agreements = 0
        """Scans in a row, up to the last one, that agree with the map."""
        self._variance = np.full(3, settings.initial_sigma**2)
        self._scatter = 0.0  # variance of the points beyond their sensor's (m2)
        self._detected_since = math.inf

    @property
    def is_detected(self) -> bool:
        """Return whether there is an offset, and has been for long enough."""
        return self.time - self._detected_since >= self._settings.duration

    def update(self, points: SurfacePoints, shape: Shape, centre: Array) -> None:
        """Take one scan of the obstacle, which the map has at ``centre`` (3,)."""
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
        deviation = math.sqrt(float(np.sum(self.mean**2 / self._variance)))
        is_off = deviation > s.sigmas and float(np.linalg.norm(self.mean)) > s.offset_min + math.sqrt(self._scatter)
        self._detected_since = min(self._detected_since, self.time) if is_off else math.inf


class MapCheck:
    """Compares the vehicles' scans with the map; an obstacle that never agreed with it is not compared.

    Times are the team's (s).
    """

    def __init__(
        self,
        standing: Sequence[tuple[str, Shape, Array]],
        view_range: float,
        settings: PerceptionSettings,
    ) -> None:
        """Start without offsets.

        Args:
            standing: name, shape and centre (3,) (NED, m) of the obstacles on the map.
            view_range: within which they are certainly detected (m).
            settings: of perception.
        """
        self._bodies = Bodies([shape for _, shape, _ in standing])
        self._centres = np.array([centre for *_, centre in standing]).reshape(-1, 3)
        self._standing, self._view_range, self._gate = standing, view_range, settings.association.remembered_gate
        self._settings, self._surfaces = settings.map_check, settings.tracking.surfaces
        self._agreements: dict[tuple[int, int], int] = {}
        self._offsets: dict[tuple[int, int], _Offset] = {}

    def compare(self, clusters: Sequence[Cluster], standing: Sequence[int | None], distances: Array) -> None:
        """Take one frame.

        An obstacle in a vehicle's field of view that is not detected in its place is taken to be what is nearest.

        Args:
            clusters: as the vehicles placed them.
            standing: the standing obstacle that each belongs to (None: none).
            distances: mean distances (clusters, standing obstacles) (m), once their vehicles' offsets are removed.
        """
        if not self._standing:
            return
        detected = {
            (cluster.uav, number): row
            for row, (cluster, number) in enumerate(zip(clusters, standing, strict=True))
            if number is not None
        }
        taken = set(detected.values())
        nearest, least = distances.argmin(axis=1).tolist(), distances.min(axis=1)
        order = np.argsort(least)
        for row in order[least[order] <= self._gate].tolist():
            if row not in taken:
                detected.setdefault((clusters[row].uav, nearest[row]), row)
        if not detected:
            return
        numbers, rows = [number for _, number in detected], list(detected.values())
        origins = np.array([clusters[row].scan.origins[clusters[row].part.start or 0] for row in rows])
        from_sensors = np.abs(self._bodies.from_own_offsets(numbers, origins - self._centres[numbers])).tolist()
        means, sigmas = distances[rows, numbers].tolist(), _sigmas([clusters[row] for row in rows])
        offset_uavs = self.offsets.keys()
        for number, row, from_sensor, mean, sigma in zip(numbers, rows, from_sensors, means, sigmas, strict=True):
            if from_sensor <= self._view_range:
                self._detected(clusters[row], number, None if clusters[row].uav in offset_uavs else mean, sigma)

    def _detected(self, cluster: Cluster, number: int, mean: float | None, sigma: float) -> None:
        """Take a cluster of an obstacle by its ``mean`` distance from that (m), None: not known yet.

        ``sigma``: standard deviation of its points (m).
        """
        pair, s = (cluster.uav, number), self._settings
        _, shape, centre = self._standing[number]
        if mean is None:
            mean = float(Bodies([shape]).mean_distances(PointGroups.of([cluster.points]), centre[None])[0, 0])
        agrees, offset = mean < s.agreement_sigmas * sigma, self._offsets.get(pair)
        points = cluster.surface_points
        if agrees:
            self._agreements[pair] = self._agreements.get(pair, 0) + 1
        elif offset is None and self._agreements.get(pair, 0) >= s.agreements:
            offset = self._offsets[pair] = _Offset(points.time, s, self._surfaces)
        if offset is not None:
            # A few points may agree by chance: they count, but do not end an offset by themselves.
            offset.agreements = offset.agreements + 1 if agrees else 0
            offset.update(points, shape, centre)
            if offset.agreements >= s.agreements:
                del self._offsets[pair]

    @property
    def offsets(self) -> dict[int, Array]:
        """Detected offset (3,) (NED, m) of what each vehicle (0 .. N-1) detects from the map."""
        latest: dict[int, _Offset] = {}
        for (uav, _), offset in self._offsets.items():
            if offset.is_detected and (uav not in latest or offset.time > latest[uav].time):
                latest[uav] = offset
        return {uav: offset.mean for uav, offset in latest.items()}

    def all_offset(self, uavs: Collection[int]) -> bool:
        """Return whether there are ``uavs``, and all of them have an offset."""
        return bool(uavs) and self.offsets.keys() >= set(uavs)


def _sigmas(clusters: Sequence[Cluster]) -> list[float]:
    """Return the standard deviation of the points of each cluster, by range noise and pose (m)."""
    variances = [cluster.pose_variance for cluster in clusters]
    sizes = np.array([len(values) for values in variances])
    of_poses = np.add.reduceat(np.concatenate(variances), np.cumsum(sizes) - sizes) / sizes
    of_ranges = np.array([cluster.scan.noise for cluster in clusters]) ** 2
    sigmas: list[float] = np.sqrt(of_ranges + of_poses).tolist()
    return sigmas
