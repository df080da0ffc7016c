"""Track of one obstacle."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shape import Shape
from idc_controller.perception.manoeuvre import VisitedRegion
from idc_controller.perception.motion_evidence import NO_SCANS, Frame, MotionEvidence, PartOfScan
from idc_controller.perception.motion_imm import MotionModels
from idc_controller.perception.obstacle_filter import ObstacleFilter
from idc_controller.perception.settings import PerceptionSettings
from idc_controller.perception.surfaces.points import SurfacePoints, joined


@dataclass(eq=False)
class Detections:
    """When and where a track was detected. Times in s, NED, m."""

    last: float = -math.inf
    out_of_view: float = -math.inf
    """When it was out of view last, of the times at which it was not detected."""
    clusters: int = 0
    points: Array = field(default_factory=lambda: np.empty((0, 3)))
    """Points of the last frame (n, 3)."""
    first: float = math.inf
    """When it was detected first."""
    places: list[Array] = field(default_factory=list)
    """Its centres (3,), until they are taken."""
    evidence: MotionEvidence = field(default_factory=MotionEvidence)
    visited: VisitedRegion = field(default_factory=VisitedRegion)

    def add(self, points: SurfacePoints, clusters: int, centre: Array, time: float) -> None:
        """Add one frame; ``time`` (s) of the ``centre`` (3,)."""
        self.last, self.points = max(self.last, points.time), points.points
        self.clusters += clusters
        self.first = min(self.first, points.time)
        self.places.append(centre)
        self.visited.add(time, centre)

    def missed(self, time: float, in_view: bool) -> float:
        """Return for how long (s) it has been in view undetected; ``in_view``: whether it is at ``time`` (s)."""
        if not in_view:
            self.out_of_view = time
        return time - max(self.last, self.out_of_view)

    def take_places(self) -> list[Array]:
        """Return the centres since the last call."""
        places, self.places = self.places, []
        return places


@dataclass(eq=False)
class Track:
    """An obstacle with its filter; a moving obstacle of the map has none until it is detected. Times in s."""

    name: str
    models: MotionModels
    settings: PerceptionSettings
    map_shape: Shape | None = None
    """Shape of an obstacle of the map."""
    map_centre: Array = field(default_factory=lambda: np.zeros(3))
    """Its place on the map (3,) (NED, m), until it is detected."""
    filter: ObstacleFilter | None = None
    detections: Detections = field(default_factory=lambda: Detections())
    has_moved: bool = False
    """It has been seen to move; at rest, the standing map holds it."""
    is_deleted: bool = False
    """Not detected in the field of view; a track of the map is kept for another detection."""
    is_retained: bool = False
    """Confirmed when all obstacle sensing proved to be lost: never deleted from then on."""
    overlaps: dict[str, int] = field(default_factory=dict)
    """Frames in a row in which its points belonged to another track as well."""

    def update(self, parts: list[SurfacePoints], explained: Sequence[PartOfScan] = (), frame: Frame = NO_SCANS) -> None:
        """Take the points of one frame, by all vehicles that detect it.

        Args:
            parts: its points by vehicle.
            explained: what the map says of them, by vehicle.
            frame: all scans of it.
        """
        points = joined(parts)
        if self.filter is None:
            self.filter = ObstacleFilter(self.models, points, self.map_shape, self.settings.tracking)
        else:
            self.filter.update(points)
        self.add(points, len(parts), explained, frame)

    def add(self, points: SurfacePoints, clusters: int, explained: Sequence[PartOfScan], frame: Frame) -> None:
        """Take for detected what the filter has taken: ``points`` of as many ``clusters``, as in :meth:`update`."""
        assert self.filter is not None
        self.detections.add(points, clusters, self.filter.state[0], self.filter.time)
        s, evidence = self.settings.standing_map, self.detections.evidence
        if not self.filter.may_move:
            # Not one body: clusters of several that stand were joined. It takes new evidence to be one.
            self.has_moved = False
            evidence.reset()
        elif not self.has_moved:
            evidence.add(points, explained, frame, s)
            self.has_moved = evidence.nats > -math.log(s.false_alarm) and self.filter.is_moving(s.false_alarm)
        self.is_deleted = False

    @property
    def is_confirmed(self) -> bool:
        """Return whether it counts as an obstacle."""
        confirmed = self.map_shape is not None or self.detections.clusters >= self.settings.retention.confirmations
        return not self.is_deleted and confirmed

    def take_places(self) -> list[tuple[Shape, Array, float]]:
        """Return its body at all places where it was seen since the last call, and since when it has been seen (s).

        None before it is known to move.
        """
        if not (self.has_moved and not self.is_static and self.is_confirmed):
            return []
        return [(self.shape, place, self.detections.first) for place in self.detections.take_places()]

    @property
    def is_obstacle(self) -> bool:
        """Return whether it counts as an obstacle beside those that stand."""
        return self.is_confirmed and (self.map_shape is not None or self.has_moved)

    @property
    def is_static(self) -> bool:
        """Return whether it is static."""
        return self.filter is not None and self.filter.is_static

    @property
    def seems_to_stand(self) -> bool:
        """Return whether it has never moved, and there is no evidence now that it does."""
        return not self.has_moved and self.detections.evidence.nats == 0.0

    @property
    def shape(self) -> Shape:
        """Shape on the map or as estimated."""
        if self.map_shape is not None:
            return self.map_shape
        assert self.filter is not None
        return self.filter.shape

    @property
    def velocity(self) -> Array:
        """Velocity (3,) (NED, m/s)."""
        return np.zeros(3) if self.filter is None else self.filter.state[1]

    @property
    def is_bound_to_region(self) -> bool:
        """Return whether it moves, and its predictions have not proved right: it may be where it has been."""
        if self.filter is None or self.map_shape is not None or not self.has_moved:
            return False
        return not self.filter.manoeuvre.is_predictable

    def obstacles(self, times: Array, now: float) -> list[PredictedObstacle]:
        """Return what holds it at ``times`` (K,) as estimated at ``now`` (s).

        Until its predictions have proved right, that is the region that it visited of late, and its prediction; if they
        have proved wrong, the latter only while it is where it has not been before.
        """
        if not self.is_bound_to_region:
            return [self.predict(times, now)]
        assert self.filter is not None
        visited, retention = self.detections.visited, self.settings.retention
        shape, centre = visited.box(self.shape, now - retention.visited_memory)
        count = len(times)
        region = PredictedObstacle(f"{self.name} region", shape, np.tile(centre, (count, 1)), np.zeros(count), True)
        place = self.centre(now)
        if self.filter.manoeuvre.is_unpredictable and visited.holds(place, now - retention.visited_before):
            return [region]
        return [region, replace(self.predict(times, now), may_leave=True)]

    def predict(self, times: Array, now: float) -> PredictedObstacle:
        """Return the obstacle at ``times`` (K,) as estimated at ``now`` (s); a static one that coasts stays at rest."""
        if self.filter is None:
            positions = np.tile(self.map_centre, (len(times), 1))
            growth = np.full(len(times), self.settings.retention.undetected_growth)
            return PredictedObstacle(self.name, self.shape, positions, growth)
        return PredictedObstacle(self.name, self.shape, *self.filter.predict(self._coasted(times, now)))

    def centre(self, time: float) -> Array:
        """Return the centre (3,) (NED, m) at ``time`` (s), as estimated then."""
        if self.filter is None:
            return self.map_centre
        return np.asarray(self.filter.centres(self._coasted(np.array([time]), time))[0])

    def expected(self, time: float) -> tuple[Array, float]:
        """Return the expected centre (3,) (NED, m) at the time of a new frame, and its standard deviation (m).

        The filter is predicted to that time.
        """
        largest = self.settings.retention.undetected_growth
        if self.filter is None:
            return self.map_centre, largest
        if not self._coasts_at_rest(time):
            self.filter.advance(time)
        return self.filter.state[0], min(self.filter.position_sigma, largest)

    def _coasted(self, times: Array, now: float) -> Array:
        """Return the times (K,) (s) for which the filter is asked: one that coasts at rest stays as it was."""
        return times - (now - self.detections.last) if self._coasts_at_rest(now) else times

    def _coasts_at_rest(self, now: float) -> bool:
        return now - self.detections.last > self.settings.retention.coasting_after and self.is_static
