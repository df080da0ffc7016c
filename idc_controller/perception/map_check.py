"""Map check: offsets of the detected standing obstacles from their places on the map, vehicle by vehicle."""

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shape import Shape
from idc_controller.perception.obstacle_filter import surface_of
from idc_controller.perception.scan_assembly import Cluster
from idc_controller.perception.settings import MapCheckSettings, PerceptionSettings, SurfaceSettings
from idc_controller.perception.surfaces.points import SurfacePoints


class _Offset:
    """Offset of a vehicle's points from one obstacle, without a break: a Kalman filter, axis by axis."""

    def __init__(self, time: float, settings: MapCheckSettings, surfaces: SurfaceSettings) -> None:
        self.time, self._settings, self._surfaces = time, settings, surfaces
        self.mean = np.zeros(3)
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
        nearest = distances.argmin(axis=1).tolist()
        for row in np.argsort(distances.min(axis=1)).tolist():
            if row not in taken and distances[row, nearest[row]] <= self._gate:
                detected.setdefault((clusters[row].uav, nearest[row]), row)
        if not detected:
            return
        numbers, rows = [number for _, number in detected], list(detected.values())
        origins = np.array([clusters[row].surface_points.origins[0] for row in rows])
        bodies = Bodies([self._standing[number][1] for number in numbers])
        centres = np.array([self._standing[number][2] for number in numbers])
        from_sensors = np.abs(bodies.from_offsets((origins - centres)[:, None])[:, 0]).tolist()
        offset_uavs = self.offsets.keys()
        for number, row, from_sensor in zip(numbers, rows, from_sensors, strict=True):
            cluster = clusters[row]
            if from_sensor <= self._view_range:
                mean = None if cluster.uav in offset_uavs else float(distances[row, number])
                self._detected(cluster, number, mean)

    def _detected(self, cluster: Cluster, number: int, mean: float | None) -> None:
        """Take a cluster of an obstacle by its ``mean`` distance from that (m), None: not known yet."""
        pair, detected, s = (cluster.uav, number), cluster.surface_points, self._settings
        _, shape, centre = self._standing[number]
        if mean is None:
            mean = float(Bodies([shape]).mean_distances([detected.points], centre[None])[0, 0])
        if mean < s.agreement_sigmas * math.sqrt(detected.noise**2 + float(detected.pose_variance.mean())):
            self._agreements[pair] = self._agreements.get(pair, 0) + 1
            self._offsets.pop(pair, None)
        elif self._agreements.get(pair, 0) >= s.agreements:
            offset = self._offsets.get(pair)
            if offset is None:
                offset = self._offsets[pair] = _Offset(detected.time, s, self._surfaces)
            offset.update(detected, shape, centre)

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


def shifted(cluster: Cluster, by: Array) -> Cluster:
    """Return a cluster with its points shifted ``by`` (3,) (NED, m), detected from the same place."""
    points = cluster.surface_points
    return replace(cluster, surface_points=replace(points, points=points.points + by))
