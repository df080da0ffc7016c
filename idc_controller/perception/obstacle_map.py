"""Obstacle map: the obstacles known before the flight, and tracks of those the vehicles' range sensors detect."""

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.estimation.health.chi_squared import upper_quantile
from idc_controller.geometry.obstacles import Bodies, PointGroups, PredictedObstacle, Region
from idc_controller.geometry.shape import Shape
from idc_controller.perception.clusters import Cluster, Segmentation, associate, frames, gating_shape, shifted
from idc_controller.perception.map_check import MapCheck
from idc_controller.perception.motion_evidence import Frame
from idc_controller.perception.motion_imm import MotionModels
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.range_sensors import SensorModel
from idc_controller.perception.scan_placement import ScanPlacement, SensorRays
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.standing_obstacles import MapObstacle, SeenObstacles, StandingObstacles
from idc_controller.perception.track import Track
from idc_controller.perception.track_list import TrackList

_UNSEEN = 256
"""Unseen cells on the way of the formation that are looked at: the next ones."""


class TrackEstimate(NamedTuple):
    """One confirmed track at one time. SI units, NED."""

    time: float
    name: str
    shape: Shape
    position: Array
    velocity: Array
    growth: float


class ObstacleMap:
    """An :class:`~idc_controller.geometry.obstacles.ObstacleSource`. Times are the team's (s).

    Add telemetry to :attr:`placement`, call :meth:`update` once a control step, then :meth:`predict`.
    """

    def __init__(
        self,
        known: Sequence[MapObstacle],
        sensors: SensorModel,
        sensor_range: float,
        rays: SensorRays,
        settings: PerceptionSettings = PerceptionSettings(),
    ) -> None:
        """``known``: obstacles known before the flight; ``sensor_range`` of the range sensors (m), and their rays."""
        self._settings = s = settings
        models = MotionModels(s.tracking.motion)
        moving = [Track(o.name, models, s, o.shape, o.centre) for o in known if o.moves]
        self._standing = StandingObstacles([o for o in known if not o.moves])
        self.seen = SeenObstacles(s.standing_map)
        """What the range sensors have seen to stand."""
        names = [obstacle.name for obstacle in known]
        self._tracks = TrackList(moving, names, models, s, self.seen.map.normals)
        self._view_range = s.retention.in_view_share * sensor_range
        self.placement = ScanPlacement(sensors, rays, s.scans)
        """Takes scans, poses and failures of the range sensors from telemetry."""
        self._segmentation = Segmentation(
            rays.pattern,
            sensor_range - s.scans.cut_sigmas * sensors.range_noise,
            2.0 * s.tracking.surfaces.radius_max,
        )
        self._rays = rays
        self._check = MapCheck(self._standing.obstacles, self._view_range, self.seen.map.is_standing, s)
        self._sigmas = math.sqrt(float(upper_quantile(s.standing_map.false_alarm, 3)))
        self._time = -math.inf
        self._viewing: list[tuple[Array, Array]] = []
        """Poses of the vehicles with valid range sensors whose telemetry comes in."""
        self._deleted: list[str] = []

    def update(
        self,
        now: float,
        pose_noise_scale: float = 1.0,
        unusable_positions: frozenset[int] = frozenset(),
        unusable_attitudes: frozenset[int] = frozenset(),
    ) -> None:
        """Update map and tracks by all scans since the last call, see :meth:`ScanPlacement.scans`."""
        self._time = now
        scans = self.placement.scans(now, pose_noise_scale, unusable_positions, unusable_attitudes)
        for frame in frames(scans, self._settings.scans.simultaneous):
            self._update(frame)
        if scans:
            moved = [body for track in self.tracks for body in track.take_places()]
            self.seen.map.release(moved, self._settings.association.map_gate)
            self.seen.update()
            self._tracks.absorb(self.seen.map.is_standing, now - self._settings.standing_map.settling_time)
        timeout, poses = self._settings.retention.link_timeout, self.placement.poses
        last = (poses.last_pose(uav, now, timeout) for uav in self._valid_uavs()) if self.tracks else ()
        self._viewing = [pose for pose in last if pose is not None]
        self._deleted += self._tracks.retain(now, self.sensing_lost, self._in_field_of_view)

    @property
    def sensing_lost(self) -> bool:
        """Return whether no vehicle has had a valid range sensor for some time, one that is not silent or displaced."""
        return self.placement.range_sensors.lost(self.placement.poses.uavs, self._time)

    @property
    def map_offsets(self) -> dict[int, Array]:
        """Offset (3,) (NED, m) of what each vehicle (0 .. N-1) detects from the map, where there is one."""
        return self._check.offsets

    @property
    def map_offset_detected(self) -> bool:
        """Return whether all vehicles with valid range sensors detect the obstacles of the map with an offset."""
        return bool(self.map_offsets) and self._check.all_offset(self._valid_uavs())

    def take_deleted_tracks(self) -> list[str]:
        """Return the names of tracks of obstacles deleted in the field of view since the last call."""
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
        found = self._standing.predict(len(times), region) + self.seen.predict(len(times), region)
        for track in self.tracks:
            if track.is_obstacle:
                found += track.obstacles(times, self._time)
        return found

    def unseen(self, time: float, path: Array, body: Array) -> tuple[Indices, Array]:
        """See :class:`idc_controller.guidance.sight.Sight`."""
        indices, middles = self.seen.map.unseen(path, body, _UNSEEN)
        if not len(indices):
            return indices, middles
        # What an obstacle covers, and what its surface keeps rays from, is for the safety filter.
        region = Region(path[0], float(np.hypot(*(middles - path[0])[:, :2].T).max()) + self.seen.map.cell)
        near = self.predict(np.array([time]), region)
        if not near:
            return indices, middles
        distance = Bodies([o.shape for o in near]).distance(middles, np.array([o.positions[0] for o in near]))
        beyond = self._settings.standing_map.sigmas_beyond * self.placement.sigma_along
        reach = 0.5 * math.sqrt(3.0) * self.seen.map.cell + beyond
        is_open = (distance - np.array([o.growth[0] for o in near])[:, None] > reach).all(axis=0)
        return indices[is_open], middles[is_open]

    def first_hidden(self, path: Array, sensors: Array, heights: Array) -> int:
        """See :class:`idc_controller.guidance.sight.Sight`."""
        return self.seen.map.first_hidden(path, sensors, heights)

    @property
    def has_sight(self) -> bool:
        """See :class:`idc_controller.guidance.sight.Sight`."""
        return not self.seen.map.is_empty

    @property
    def lowest_seen(self) -> float:
        """See :class:`idc_controller.guidance.sight.Sight`."""
        sensor_range = self._view_range / self._settings.retention.in_view_share
        return self.placement.free_height(sensor_range) + self._settings.standing_map.voxel

    def confirmed_tracks(self, time: float) -> list[TrackEstimate]:
        """Return the confirmed tracks that were detected, at ``time`` (s)."""
        found = []
        for track in self.tracks:
            if track.is_obstacle and track.filter is not None:
                now = track.predict(np.array([time]), time)
                position, growth = now.positions[0], float(now.growth[0])
                found.append(TrackEstimate(time, track.name, now.shape, position, track.velocity, growth))
        return found

    # Inside

    def _update(self, frame: list[PlacedScan]) -> None:
        """Take one frame: scans of all vehicles at one time."""
        offsets = self._check.offsets
        # With their offset removed, they are used only if there are no others.
        excluded = frozenset() if self.map_offset_detected else frozenset(offsets)
        placed: list[Cluster] = []
        on_map: list[tuple[Cluster, int]] = []
        candidates: set[int] = set()
        usable: list[PlacedScan] = []
        for scan in frame:
            corrected = shifted(scan, -offsets[scan.uav]) if scan.uav in offsets else scan
            next_to = self._standing.next_to(corrected.returns, corrected.origin)
            known, (of_tracks, near_tracks), unexplained, is_new = self._classified(corrected, next_to.distance)
            before = frame[0].time - self._settings.scans.simultaneous
            explained = self.seen.map.is_standing(corrected.returns, before)
            rows = of_tracks | unexplained | is_new
            clusters, seen = self._segmentation.candidates(scan, rows, unexplained, explained)
            candidates |= seen
            # Whole, also where only a part of what is offset lies within the gate.
            placed += [*clusters, *self._segmentation.clusters(scan, known[1] & ~of_tracks)]
            told_apart = self._check.told_apart(next_to) & ~near_tracks
            on_map += self._segmentation.of_bodies(scan, told_apart, next_to.body)
            if scan.uav not in excluded:
                self.seen.map.add(corrected, known[0] | of_tracks)
                usable.append(corrected)
        if placed:
            self._associate(placed, offsets, usable, candidates)
        self._check.compare(on_map)

    def _classified(self, scan: PlacedScan, distance: Array) -> tuple[tuple[Mask, Mask], tuple[Mask, Mask], Mask, Mask]:
        """Return which returns of a scan (n,), at a ``distance`` (n,) (m) from the map, belong to what.

        Those on standing obstacles of the map, and those near them; those on tracks that move, and those that an offset
        may have moved away from any track; those that nothing standing explains; those of what has not been seen to
        stand for long.
        """
        s, sigma = self._settings.association, self._sigmas * scan.sigma
        known = distance <= np.maximum(s.map_gate, sigma)
        of_tracks = near_tracks = np.zeros(len(known), dtype=bool)
        tracks = [track for track in self.tracks if track.is_obstacle]
        if tracks and len(known):
            centres = np.array([track.expected(scan.time)[0] for track in tracks])
            to_tracks = Bodies([track.shape for track in tracks]).distance(scan.returns, centres)
            moves = np.array([not track.is_static for track in tracks])
            of_tracks = (to_tracks[moves] <= np.maximum(s.track_gate, sigma)).any(axis=0) & ~known
            reach = np.array([s.undetected_gate if track.filter is None else s.remembered_gate for track in tracks])
            near_tracks = np.asarray((to_tracks <= reach[:, None]).any(axis=0))
        unexplained = self.seen.map.unexplained(scan) & ~known
        observed = scan.time - self._settings.standing_map.settling_time
        is_new = ~known & ~self.seen.map.is_standing(scan.returns, observed)
        return (known, distance <= s.remembered_gate), (of_tracks, near_tracks), unexplained, is_new

    def _associate(
        self, placed: list[Cluster], offsets: dict[int, Array], usable: list[PlacedScan], candidates: set[int]
    ) -> None:
        """Update tracks by the clusters of a frame, ``placed`` by the vehicles' poses, and its ``usable`` scans."""
        uavs = {scan.uav for scan in usable}
        time = max(cluster.scan.time for cluster in placed)
        clusters = [c.shifted(-offsets[c.uav]) if c.uav in offsets else c for c in placed]
        standing = self._standing.names
        distances, gates = self._distances(clusters, time)
        bodies = associate(clusters, distances, gates)
        n = len(self.tracks)
        bodies = [body if c.uav in uavs else None for c, body in zip(clusters, bodies, strict=True)]
        assigned: dict[int, list[Cluster]] = defaultdict(list)
        unassigned: list[Cluster] = []
        for cluster, body in zip(clusters, bodies, strict=True):
            if body is None:
                if cluster.uav in uavs and cluster.number in candidates:
                    unassigned.append(cluster)
            elif body < n:
                assigned[body].append(cluster)
        frame = Frame.of(usable)
        self._tracks.update(assigned, frame)
        self._tracks.merge(clusters, bodies, distances, standing)
        self._tracks.begin(unassigned, frame)

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
        return self.placement.range_sensors.valid(self.placement.poses.uavs, self._time)

    def _in_field_of_view(self, track: Track) -> bool:
        """Return whether the range sensor of a vehicle whose telemetry comes in would certainly detect a track now.

        It is near, its middle within the elevations of the rays, and nothing that stands hides it.
        """
        centre = track.centre(self._time)
        near = [place for place, attitude in self._viewing if self._rays.are_towards(centre, place, attitude)]
        if not near:
            return False
        sensors = np.array(near)
        distance = Bodies([track.shape]).distance(sensors, centre[None])[0]
        sensors = sensors[distance < self._view_range]
        return bool(len(sensors)) and self.seen.map.first_hidden(centre[None], sensors, np.zeros(1)) > 0
