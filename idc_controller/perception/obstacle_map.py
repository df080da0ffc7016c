"""Obstacle map: the obstacles known before the flight, and tracks of those the vehicles' range sensors detect."""

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import Bodies, PointGroups, PredictedObstacle, Region
from idc_controller.geometry.shape import Shape
from idc_controller.perception.association import associate, gating_shape
from idc_controller.perception.map_check import MapCheck
from idc_controller.perception.motion_imm import MotionModels
from idc_controller.perception.scan_assembly import Cluster, ScanAssembly, SensorModel
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.track import Track
from idc_controller.perception.track_list import TrackList


class TrackEstimate(NamedTuple):
    """One confirmed track at one time. SI units, NED."""

    time: float
    name: str
    shape: Shape
    position: Array
    velocity: Array
    growth: float


class MapObstacle(NamedTuple):
    """An obstacle that is known before the flight."""

    name: str
    shape: Shape
    centre: Array
    """Centre in the world (3,) (NED, m); of a moving obstacle, the mean of its motion."""
    moves: bool = False


class ObstacleMap:
    """An :class:`~idc_controller.geometry.obstacles.ObstacleSource`. Times are the team's (s).

    Add telemetry to :attr:`scans`, call :meth:`update` once a control step, then :meth:`predict`.
    """

    def __init__(
        self,
        known: Sequence[MapObstacle],
        sensors: SensorModel,
        sensor_range: float,
        settings: PerceptionSettings = PerceptionSettings(),
    ) -> None:
        """``known``: obstacles known before the flight; ``sensor_range`` of the range sensors (m)."""
        self._settings = s = settings
        models = MotionModels(s.tracking.motion)
        moving = [Track(o.name, models, s, o.shape, o.centre) for o in known if o.moves]
        self._standing = _Standing([o for o in known if not o.moves])
        self._tracks = TrackList(moving, [obstacle.name for obstacle in known], models, s)
        self._view_range = s.retention.in_view_share * sensor_range
        self.scans = ScanAssembly(sensors, s.scans)
        """Takes poses, detections and failures of the range sensors from telemetry."""
        self._check = MapCheck(self._standing.obstacles, self._view_range, s)
        self._time = -math.inf
        self._deleted: list[str] = []

    def update(
        self,
        now: float,
        pose_noise_scale: float = 1.0,
        unusable_positions: frozenset[int] = frozenset(),
        unusable_attitudes: frozenset[int] = frozenset(),
    ) -> None:
        """Update the tracks by all detections since the last call, see :meth:`ScanAssembly.frames`."""
        self._time = now
        for clusters in self.scans.frames(now, pose_noise_scale, unusable_positions, unusable_attitudes):
            self._update(clusters)
        self._deleted += self._tracks.retain(now, self.sensing_lost, self._in_field_of_view)

    @property
    def sensing_lost(self) -> bool:
        """Return whether no vehicle has had a valid range sensor for some time."""
        return self.scans.range_sensors.lost(self.scans.poses.uavs, self._time)

    @property
    def map_offsets(self) -> dict[int, Array]:
        """Offset (3,) (NED, m) of what each vehicle (0 .. N-1) detects from the map, where there is one."""
        return self._check.offsets

    @property
    def map_offset_detected(self) -> bool:
        """Return whether all vehicles with valid range sensors detect the obstacles of the map with an offset."""
        return bool(self.map_offsets) and self._check.all_offset(self._valid_uavs())

    def take_deleted_tracks(self) -> list[str]:
        """Return the names of confirmed tracks deleted in the field of view since the last call."""
        deleted, self._deleted = self._deleted, []
        return deleted

    # For the controller and the records

    @property
    def tracks(self) -> list[Track]:
        """All tracks, the oldest first."""
        return self._tracks.tracks

    def predict(self, times: Array, region: Region | None = None) -> list[PredictedObstacle]:
        """Return all obstacles at ``times`` (K,) (s); standing ones that are out of ``region`` are left out."""
        times = np.asarray(times, dtype=float)
        found = self._standing.predict(len(times), region)
        return found + [track.predict(times, self._time) for track in self.tracks if track.is_confirmed]

    def confirmed_tracks(self, time: float) -> list[TrackEstimate]:
        """Return the confirmed tracks that were detected, at ``time`` (s)."""
        found = []
        for track in self.tracks:
            if track.is_confirmed and track.filter is not None:
                position, growth = track.centre(time)
                found.append(TrackEstimate(time, track.name, track.shape, position, track.velocity, growth))
        return found

    # Inside

    def _update(self, placed: list[Cluster]) -> None:
        """Take one frame: clusters of all vehicles at one time."""
        time = max(cluster.scan.time for cluster in placed)
        offsets = self._check.offsets
        clusters = [c.shifted(-offsets[c.uav]) if c.uav in offsets else c for c in placed]
        # With their offset removed, they are used only if there are no others.
        excluded = frozenset() if self.map_offset_detected else frozenset(offsets)
        memory, standing = self._tracks.memory, self._standing.names
        names = [track.name for track in self.tracks] + standing
        distances, gates = self._distances(clusters, time)
        index = {name: i for i, name in enumerate(names)}
        remembered = [index.get(memory.name(cluster, time)) for cluster in clusters]
        bodies = associate(clusters, distances, gates, remembered, self._settings.association)
        n = len(self.tracks)
        on_map = [None if body is None or body < n else body - n for body in bodies]
        self._check.compare(placed, on_map, distances[:, n:])

        bodies = [None if c.uav in excluded else body for c, body in zip(clusters, bodies, strict=True)]
        assigned: dict[int, list[Cluster]] = defaultdict(list)
        unassigned: list[Cluster] = []
        for cluster, body in zip(clusters, bodies, strict=True):
            if body is not None:
                memory.set(cluster, names[body], time)
                if body < n:
                    assigned[body].append(cluster)
            elif cluster.uav not in excluded:
                unassigned.append(cluster)
        self._tracks.update(assigned)
        self._tracks.merge(clusters, bodies, distances, standing)
        self._tracks.begin(unassigned, time)

    def _distances(self, clusters: list[Cluster], time: float) -> tuple[Array, Array]:
        """Return mean distances of the clusters from tracks and standing obstacles (m), and the gates of those (m)."""
        s = self._settings.association
        shapes, centres, gates = [], [], []
        for track in self.tracks:
            centre, sigma = track.expected(time)
            centres.append(centre)
            gates.append(s.undetected_gate if track.filter is None or track.is_deleted else s.track_gate + sigma)
            shapes.append(gating_shape(track.shape, s.wall_extension) if track.map_shape is None else track.shape)
        points = PointGroups.of([cluster.points for cluster in clusters])
        of_tracks = Bodies(shapes).mean_distances(points, np.array(centres).reshape(-1, 3))
        # Beyond the gates it does not matter how far they are.
        far = max(s.map_gate, s.remembered_gate, s.merge_gate)
        of_standing = self._standing.bodies.mean_distances(points, self._standing.centres, far)
        gates += [s.map_gate] * len(self._standing.names)
        return np.hstack([of_tracks, of_standing]), np.array(gates)

    def _valid_uavs(self) -> tuple[int, ...]:
        return self.scans.range_sensors.valid(self.scans.poses.uavs, self._time)

    def _in_field_of_view(self, track: Track) -> bool:
        """Return whether the range sensor of a vehicle whose telemetry comes in would certainly detect a track now."""
        timeout = self._settings.retention.link_timeout
        places = [self.scans.poses.position(uav, self._time, timeout) for uav in self._valid_uavs()]
        near = np.array([place for place in places if place is not None])
        if not len(near):
            return False
        centre, _ = track.centre(self._time)
        distance = Bodies([track.shape]).distance(near, centre[None])
        return bool(distance.min() < self._view_range)


class _Standing:
    """The standing obstacles of the map, gathered."""

    def __init__(self, known: Sequence[MapObstacle]) -> None:
        self.obstacles = [(o.name, o.shape, o.centre) for o in known]
        self.names = [o.name for o in known]
        self.bodies = Bodies([o.shape for o in known])
        self.centres = np.array([o.centre for o in known]).reshape(-1, 3)
        self._reach = np.array([o.shape.horizontal_reach for o in known])
        self._predicted: dict[int, list[PredictedObstacle]] = {}

    def predict(self, count: int, region: Region | None) -> list[PredictedObstacle]:
        """Return them at ``count`` moments, all or those that reach into a ``region``."""
        if not self.obstacles:
            return []
        if count not in self._predicted:
            none = np.zeros(count)
            self._predicted[count] = [
                PredictedObstacle(name, shape, np.tile(centre, (count, 1)), none)
                for name, shape, centre in self.obstacles
            ]
        predicted = self._predicted[count]
        if region is None:
            return predicted[:]
        apart = self.centres[:, :2] - region.place[:2]
        near = np.hypot(apart[:, 0], apart[:, 1]) <= region.radius + self._reach
        return [predicted[i] for i in np.flatnonzero(near).tolist()]
