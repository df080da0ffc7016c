"""All obstacles as the ground knows them: on the map, or followed by what the vehicles' range sensors tell."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence, Set
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.measurements import Measurement
from idc_controller.geometry.distance import Bodies
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shape import Shape
from idc_controller.perception.association import assigned, for_gating, mean_distances
from idc_controller.perception.map_check import MapCheck, moved
from idc_controller.perception.motion_imm import BankSettings, MotionModels
from idc_controller.perception.retention import Unseen
from idc_controller.perception.scan_assembly import BLIND_AFTER, Cluster, Detection, ScanInbox, SensorModel
from idc_controller.perception.track import Track

Array = NDArray[np.float64]

KNOWN_GATE = 0.25  # m, mean distance of a cluster from a surface that is on the map
TRACK_GATE = 0.4  # m, and what the track itself is not sure of
UNSEEN_GATE = 3.0  # m, from a known obstacle that moves and was not seen yet
SAME_GATE = 0.5  # m, between clusters of several vehicles that begin a track together
MERGE_GATE, MERGE_FRAMES = 0.25, 3
SURELY_IN_RANGE = 0.8  # of the sensors' range
_MEMORY = 3.0  # s for which a vehicle's number stands for an obstacle
_LINK_ALIVE = 0.3  # s


class Belief(NamedTuple):
    """One followed obstacle at one time, for the records. SI units, NED."""

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
    """In the world (3,) (NED, m); of a moving obstacle, where its motion has its mean."""
    moves: bool = False


class ObstacleMap:
    """An :class:`~idc_controller.geometry.obstacles.ObstacleSource`. Times are the team's (s).

    Hand over telemetry with :meth:`measured` and :meth:`detected`, call :meth:`update` once a control step, then
    :meth:`predict`.
    """

    def __init__(self, known: Sequence[MapObstacle], sensors: SensorModel, reach: float) -> None:
        """``known``: obstacles known before the flight; ``reach`` (m) of the range sensors."""
        standing = [obstacle for obstacle in known if not obstacle.moves]
        self.models = MotionModels(BankSettings())
        self.tracks: list[Track] = [
            Track(obstacle.name, self.models, known=obstacle.shape, place=obstacle.centre)
            for obstacle in known
            if obstacle.moves
        ]
        self._standing = [(obstacle.name, obstacle.shape, obstacle.centre) for obstacle in standing]
        self._reach = reach
        self._inbox = ScanInbox(sensors)
        self._check = MapCheck(self._standing, SURELY_IN_RANGE * reach)
        self._memory: dict[tuple[int, int], tuple[str, float]] = {}
        self._names = {obstacle.name for obstacle in known}
        self._unseen = Unseen()
        self._next_number = 1
        self._scatter = 0.0
        self._time = -math.inf
        self.vanished: list[str] = []
        """Followed obstacles that are no longer seen where a vehicle could not miss them; for the caller to clear."""

    # From telemetry

    def measured(self, sample: Measurement) -> None:
        """A vehicle's position or attitude."""
        self._inbox.measured(sample)

    def estimated(self, sample: Measurement) -> None:
        """What the ground thinks of a vehicle's position or attitude: for one that does not know them itself."""
        self._inbox.estimated(sample)

    def detected(self, detection: Detection, uav: int, time: float) -> None:
        """Add a detection of UAV ``uav`` (0 .. N-1), made at ``time``; impossible ones are counted and ignored."""
        self._inbox.detected(detection, uav, time)

    def broken(self, uavs: Set[int], time: float) -> None:
        """Vehicles (0 .. N-1) whose range sensors do not work, as they say."""
        self._inbox.broken(uavs, time)

    @property
    def refused(self) -> int:
        """Detections that could not be used."""
        return self._inbox.refused

    def update(
        self,
        now: float,
        pose_noise: float = 1.0,
        misplaced: frozenset[int] = frozenset(),
        misaligned: frozenset[int] = frozenset(),
    ) -> None:
        """Learn from all that came since the last time.

        ``pose_noise``: factor of the noise of the vehicles' poses over that of the system file. ``misplaced``: vehicles
        (0 .. N-1) whose positions are wrong; ``misaligned``: whose attitudes are. Both are placed by what is estimated.
        """
        self._time = now
        for clusters in self._inbox.frames(now, pose_noise, misplaced, misaligned):
            self._learn(clusters)
        self._drop_unseen(now)

    @property
    def is_blind(self) -> bool:
        """Whether no vehicle sees anything, or tells what can not be, for a moment."""
        return self._inbox.has_vehicles and not self._inbox.seeing(self._time, BLIND_AFTER)

    @property
    def astray(self) -> dict[int, Array]:
        """Vehicles (0 .. N-1) that see the obstacles of the map elsewhere than they did, and by how much (3,) (m)."""
        return self._check.astray

    @property
    def is_astray(self) -> bool:
        """Whether all that see anything do so elsewhere."""
        return self._check.is_astray(self._inbox.seeing(self._time))

    # For the controller and the records

    def predict(self, times: Array) -> list[PredictedObstacle]:
        """All obstacles at ``times`` (K,)."""
        times = np.asarray(times, dtype=float)
        none = np.zeros(len(times))
        found = [
            PredictedObstacle(name, shape, np.broadcast_to(centre, (len(times), 3)), none)
            for name, shape, centre in self._standing
        ]
        return found + [track.predict(times, self._time) for track in self.tracks if track.is_believed]

    def beliefs(self, time: float) -> list[Belief]:
        """The followed obstacles at ``time``."""
        return [
            Belief(time, track.name, track.shape, *_split(track, time))
            for track in self.tracks
            if track.is_believed and track.filter is not None
        ]

    # Inside

    def _learn(self, told: list[Cluster]) -> None:
        """One frame: clusters of all vehicles at one time."""
        time = max(cluster.seen.time for cluster in told)
        astray = self._check.astray
        clusters = [moved(c, -astray[c.uav]) if c.uav in astray else c for c in told]
        # Corrected, they are believed only if there are no others.
        left_out = frozenset() if self.is_astray else frozenset(astray)
        tracks = self.tracks
        centres, gates = [], []
        for track in tracks:
            centre, sigma = track.expected(time)
            centres.append(centre)
            gates.append(UNSEEN_GATE if track.filter is None or track.is_gone else TRACK_GATE + sigma)
        names = [track.name for track in tracks] + [name for name, _, _ in self._standing]
        shapes = [track.shape if track.known else for_gating(track.shape) for track in tracks]
        shapes += [shape for _, shape, _ in self._standing]
        centres += [centre for _, _, centre in self._standing]
        gates += [KNOWN_GATE] * len(self._standing)
        distances = mean_distances(clusters, shapes, np.array(centres).reshape(-1, 3))
        index = {name: i for i, name in enumerate(names)}
        remembered = [index.get(self._recall(cluster, time)) for cluster in clusters]
        bodies = assigned(clusters, distances, np.array(gates), remembered)
        standing = [None if body is None or body < len(tracks) else body - len(tracks) for body in bodies]
        self._check.compare(told, standing, distances[:, len(tracks) :])

        bodies = [None if c.uav in left_out else body for c, body in zip(clusters, bodies, strict=True)]
        parts: dict[int, list[Cluster]] = defaultdict(list)
        fresh: list[Cluster] = []
        for cluster, body in zip(clusters, bodies, strict=True):
            if body is not None:
                parts[body].append(cluster)
                self._memory[cluster.uav, cluster.number] = names[body], time
            elif cluster.uav not in left_out:
                fresh.append(cluster)
        for body, members in parts.items():
            if body < len(tracks):
                tracks[body].update([cluster.seen for cluster in members])
        # It is of the sensors: what they see next will scatter as well.
        learnt = [track.filter.scatter for track in tracks if track.known is None and track.filter is not None]
        self._scatter = max(learnt, default=self._scatter)
        self._merge(clusters, bodies, distances, tracks[:])
        for group in self._grouped(fresh):
            self._begin(group, time)

    def _recall(self, cluster: Cluster, time: float) -> str:
        name, when = self._memory.get((cluster.uav, cluster.number), ("", -math.inf))
        return name if time - when < _MEMORY else ""

    def _grouped(self, clusters: list[Cluster]) -> list[list[Cluster]]:
        """Clusters of several vehicles that lie on one surface."""
        groups: list[tuple[list[Cluster], Track]] = []
        for cluster in clusters:
            for members, trial in groups:
                if any(member.uav == cluster.uav for member in members):
                    continue
                centre, _ = trial.centre(cluster.seen.time)
                if mean_distances([cluster], [for_gating(trial.shape)], centre[None])[0, 0] < SAME_GATE:
                    members.append(cluster)
                    trial.filter = None
                    trial.update([member.seen for member in members])
                    break
            else:
                trial = Track("", self.models, scatter=self._scatter)
                trial.update([cluster.seen])
                groups.append(([cluster], trial))
        return [members for members, _ in groups]

    def _begin(self, members: list[Cluster], time: float) -> None:
        while f"track {self._next_number}" in self._names:
            self._next_number += 1
        track = Track(f"track {self._next_number}", self.models, scatter=self._scatter)
        self._next_number += 1
        track.update([member.seen for member in members])
        self.tracks.append(track)
        for member in members:
            self._memory[member.uav, member.number] = track.name, time

    def _merge(self, clusters: list[Cluster], bodies: list[int | None], distances: Array, tracks: list[Track]) -> None:
        """Two tracks of one obstacle become one: the younger one's points have lain on the older for some frames."""
        of_track: dict[int, list[int]] = defaultdict(list)
        for row, body in enumerate(bodies):
            if body is not None and body < len(tracks):
                of_track[body].append(row)
        for younger, rows in of_track.items():
            track = tracks[younger]
            if track.known is not None:
                continue
            sees_younger = {clusters[row].uav for row in rows}
            for older in range(distances.shape[1]):
                is_standing = older >= len(tracks)
                name = self._standing[older - len(tracks)][0] if is_standing else tracks[older].name
                if not is_standing and (older >= younger or tracks[older].filter is None):
                    continue
                apart = any(bodies[i] == older and clusters[i].uav in sees_younger for i in range(len(clusters)))
                if apart or distances[rows, older].max() > MERGE_GATE:
                    track.overlaps.pop(name, None)
                    continue
                track.overlaps[name] = track.overlaps.get(name, 0) + 1
                if track.overlaps[name] >= MERGE_FRAMES:
                    self._remove(track)
                    for key, (remembered, when) in tuple(self._memory.items()):
                        if remembered == track.name:
                            self._memory[key] = name, when
                    break

    def _drop_unseen(self, now: float) -> None:
        could_see = partial(self._would_be_seen, now=now)
        self.tracks, vanished = self._unseen.left(self.tracks, now, self.is_blind, could_see)
        self.vanished += vanished
        for key, (_, when) in tuple(self._memory.items()):
            if now - when > _MEMORY:
                del self._memory[key]

    def _would_be_seen(self, track: Track, now: float) -> bool:
        """Whether a vehicle whose telemetry comes in is so near that its sensor could not miss the obstacle."""
        places = [self._inbox.position(uav, now, _LINK_ALIVE) for uav in self._inbox.seeing(now)]
        near = np.array([place for place in places if place is not None])
        if not len(near):
            return False
        centre, _ = track.centre(now)
        distance = Bodies([track.shape]).distance(near, centre[None])
        return bool(distance.min() < SURELY_IN_RANGE * self._reach)

    def _remove(self, track: Track) -> None:
        if track in self.tracks:
            self.tracks.remove(track)


def _split(track: Track, time: float) -> tuple[Array, Array, float]:
    position, growth = track.centre(time)
    return position, track.velocity, growth
