"""List of tracks: initiation from unassigned clusters, merging, and retention."""

import math
from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.geometry.obstacles import Bodies, PointGroups
from idc_controller.perception.clusters import Cluster, gating_shape
from idc_controller.perception.motion_evidence import Frame, MotionEvidence, Normals, PartOfScan, unknown_normals
from idc_controller.perception.motion_imm import MotionModels
from idc_controller.perception.obstacle_filter import ObstacleFilter
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.surfaces.points import SurfacePoints, joined
from idc_controller.perception.track import Detections, Track


class TrackList:
    """Tracks, the oldest first. Times are the team's (s)."""

    def __init__(
        self,
        known: Sequence[Track],
        names: Sequence[str],
        models: MotionModels,
        settings: PerceptionSettings,
        normals: Normals = unknown_normals,
    ) -> None:
        """``known``: tracks of the map's moving obstacles; ``names``: of all its obstacles; ``normals`` of surfaces."""
        self._settings = settings
        self.tracks = list(known)
        self._models, self._normals = models, normals
        self._names = set(names)
        self._deleted: list[tuple[float, Track]] = []
        self._next_number = 1
        self._scatter = 0.0

    def update(self, assigned: dict[int, list[Cluster]], frame: Frame) -> None:
        """Update tracks by the clusters of one frame, by index of the track, and by all its scans."""
        for index, members in assigned.items():
            self.tracks[index].update([member.surface_points for member in members], _explained(members), frame)
        # Scatter is of the sensors: new tracks begin with it.
        scatter = [t.filter.scatter for t in self.tracks if t.map_shape is None and t.filter is not None]
        self._scatter = max(scatter, default=self._scatter)

    def begin(self, clusters: list[Cluster], frame: Frame) -> None:
        """Begin tracks from clusters of one frame that belong to no obstacle."""
        for members, points, found in self._grouped(clusters):
            while f"track {self._next_number}" in self._names:
                self._next_number += 1
            detections = Detections(evidence=MotionEvidence(self._normals))
            name = f"track {self._next_number}"
            track = Track(name, self._models, self._settings, filter=found, detections=detections)
            self._next_number += 1
            track.add(points, len(members), _explained(members), frame)
            self.tracks.append(track)

    def merge(self, clusters: list[Cluster], bodies: list[int | None], distances: Array, standing: list[str]) -> None:
        """Remove the younger of two tracks of one obstacle, whose points belong to the older one for some frames.

        Args:
            clusters: of one frame.
            bodies: index of the track or standing obstacle of each (None: none).
            distances: mean distances (clusters, tracks and standing obstacles) (m).
            standing: names of the standing obstacles of the map, which come after the tracks.
        """
        s, tracks = self._settings.association, self.tracks[:]
        names = [track.name for track in tracks] + standing
        by_track: dict[int, list[int]] = defaultdict(list)
        for row, body in enumerate(bodies):
            if body is not None and body < len(tracks):
                by_track[body].append(row)
        for younger, rows in by_track.items():
            track = tracks[younger]
            if track.map_shape is not None:
                continue
            near = np.flatnonzero(distances[rows].max(axis=0) <= s.merge_gate).tolist()
            near = [body for body in near if body < younger or body >= len(tracks)]
            if not near and not track.overlaps:
                continue
            uavs = {clusters[row].uav for row in rows}
            apart = {body for body, cluster in zip(bodies, clusters, strict=True) if cluster.uav in uavs}
            # Of a track that is not compared now, the count stays.
            omitted = (
                {t.name for i, t in enumerate(tracks) if i >= younger or t.filter is None} if track.overlaps else ()
            )
            overlaps = {name: count for name, count in track.overlaps.items() if name in omitted}
            for older in near:
                if older in apart or (older < len(tracks) and tracks[older].filter is None):
                    continue
                name = names[older]
                overlaps[name] = track.overlaps.get(name, 0) + 1
                if overlaps[name] >= s.merge_frames:
                    if track in self.tracks:
                        self.tracks.remove(track)
                    break
            track.overlaps = overlaps

    def absorb(self, stands: Callable[[Array, float], Mask], observed: float) -> None:
        """Remove tracks of what stands, once the standing map holds the points that were seen of them last.

        They have come to rest, or have never moved, nothing says that they do, and what the map holds there was first
        hit before ``observed`` (s).

        Args:
            stands: returns whether the map holds what stands at points (n, 3) (n,), first hit before a time (s).
            observed: time before which what moves would have been elsewhere (s).
        """

        tracks = [track for track in self.tracks if track.map_shape is None]
        if not tracks:
            return
        points = [track.detections.points for track in tracks]
        sizes = np.array([len(of_track) for of_track in points])
        starts, everywhere = np.cumsum(sizes) - sizes, np.concatenate(points)
        held, held_for_long = (
            (2 * np.add.reduceat(stands(everywhere, since), starts, dtype=int) > sizes).tolist()
            for since in (math.inf, observed)
        )

        def is_absorbed(track: Track, is_held: bool, is_held_for_long: bool) -> bool:
            # What stops and goes may have come to rest for a moment only.
            rests = track.is_static and not track.is_bound_to_region
            return (rests and is_held) or (is_held_for_long and (track.seems_to_stand or track.is_static))

        kept = {
            id(track)
            for track, *of_track in zip(tracks, held, held_for_long, strict=True)
            if not is_absorbed(track, *of_track)
        }
        self.tracks = [track for track in self.tracks if track.map_shape is not None or id(track) in kept]

    def retain(self, now: float, sensing_lost: bool, in_field_of_view: Callable[[Track], bool]) -> list[str]:
        """Delete tracks that are not detected; return the names of those that counted as obstacles.

        Args:
            now: s.
            sensing_lost: whether no vehicle can detect obstacles; then nothing is deleted, and what was is restored.
            in_field_of_view: whether a vehicle would certainly detect a track.
        """
        s = self._settings.retention
        self._deleted = [(since, track) for since, track in self._deleted if now - since <= s.restorable]
        if sensing_lost:
            self._restore()
            return []
        kept, deleted = [], []
        for track in self.tracks:
            undetected = now - track.detections.last
            on_map = track.map_shape is not None
            if undetected <= s.tentative_time or track.is_retained or (on_map and track.is_deleted):
                kept.append(track)
            elif not track.is_confirmed:
                pass
            elif track.detections.missed(now, in_field_of_view(track)) > s.delete_after:
                if track.is_obstacle:
                    deleted.append(track.name)
                    self._deleted.append((now, track))
                if on_map:
                    track.is_deleted = True
                    kept.append(track)
            elif (
                on_map
                or (track.has_moved and track.is_static)
                or undetected <= (s.visited_memory if track.is_bound_to_region else s.forget_after)
            ):
                kept.append(track)
        self.tracks = kept
        return deleted

    def _restore(self) -> None:
        """Retain the tracks confirmed before obstacle sensing was lost, and restore those deleted meanwhile."""
        for _, track in self._deleted:
            track.is_deleted = False
            if track not in self.tracks:
                self.tracks.append(track)
        self._deleted.clear()
        for track in self.tracks:
            track.is_retained = track.is_retained or track.is_confirmed

    def _grouped(self, clusters: list[Cluster]) -> list[tuple[list[Cluster], SurfacePoints, ObstacleFilter]]:
        """Return clusters of several vehicles that lie on one surface, together, with their points and a filter."""
        s = self._settings.association
        groups: list[tuple[list[Cluster], SurfacePoints, ObstacleFilter]] = []
        for cluster in clusters:
            for i, (members, _, found) in enumerate(groups):
                if any(member.uav == cluster.uav for member in members):
                    continue
                shape = gating_shape(found.shape, s.wall_extension)
                points, centres = PointGroups.of([cluster.points]), found.centres(np.array([cluster.scan.time]))
                if Bodies([shape]).mean_distances(points, centres)[0, 0] < s.group_gate:
                    groups[i] = self._group([*members, cluster])
                    break
            else:
                groups.append(self._group([cluster]))
        return groups

    def _group(self, members: list[Cluster]) -> tuple[list[Cluster], SurfacePoints, ObstacleFilter]:
        points = joined([member.surface_points for member in members])
        return (
            members,
            points,
            ObstacleFilter(self._models, points, settings=self._settings.tracking, scatter=self._scatter),
        )


def _explained(members: list[Cluster]) -> list[PartOfScan]:
    """Return what the map says of clusters."""
    return [PartOfScan(member.uav, member.unexplained, member.explained) for member in members]
