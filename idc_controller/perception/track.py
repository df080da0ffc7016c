"""One obstacle that is followed by the vehicles' sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shape import Shape
from idc_controller.perception.motion_imm import MotionModels
from idc_controller.perception.obstacle_filter import ObstacleFilter
from idc_controller.perception.surfaces.points import SurfacePoints, joined

Array = NDArray[np.float64]

OUT_OF_SIGHT = 0.3  # s
CONFIRMED = 2  # clusters after which a track is believed
GROWTH_UNSEEN = 0.5  # m, of a known obstacle whose place has not been seen yet


@dataclass(eq=False)
class Track:
    """An obstacle with a filter; a known one that moves has none before it is seen. Times are the team's (s)."""

    name: str
    models: MotionModels
    filter: ObstacleFilter | None = None
    known: Shape | None = None
    scatter: float = 0.0
    """Of its points (m2), before it is seen."""
    place: Array = field(default_factory=lambda: np.zeros(3))
    """Of a known one, before it is seen: its place on the map (3,)."""
    last_seen: float = -math.inf
    clusters: int = 0
    is_gone: bool = False
    """It was not where it was expected, although the vehicles could have seen it there."""
    is_kept: bool = False
    """It was believed when all sensors proved to be blind, and is from then on, whatever they do not see."""
    overlaps: dict[str, int] = field(default_factory=dict)
    """How many frames in a row it covered what belongs to another track."""

    def update(self, parts: list[SurfacePoints]) -> None:
        """Points of one frame, by all vehicles that see it."""
        seen = joined(parts)
        if self.filter is None:
            self.filter = ObstacleFilter(self.models, seen, self.known, scatter=self.scatter)
        else:
            self.filter.update(seen)
        self.last_seen = max(self.last_seen, seen.time)
        self.clusters += len(parts)
        self.is_gone = False

    @property
    def is_believed(self) -> bool:
        """Whether it counts as an obstacle."""
        return not self.is_gone and (self.known is not None or self.clusters >= CONFIRMED)

    @property
    def is_static(self) -> bool:
        """Whether it surely stands."""
        return self.filter is not None and self.filter.is_static

    @property
    def shape(self) -> Shape:
        """As it is known or believed to be."""
        if self.known is not None:
            return self.known
        assert self.filter is not None
        return self.filter.shape

    def predict(self, times: Array, now: float) -> PredictedObstacle:
        """At ``times`` (K,), as believed at ``now``. One that stood when it was last seen is taken to stand still."""
        if self.filter is None:
            positions = np.tile(self.place, (len(times), 1))
            return PredictedObstacle(self.name, self.shape, positions, np.full(len(times), GROWTH_UNSEEN))
        if self._rests(now):
            times = times - (now - self.last_seen)
        return PredictedObstacle(self.name, self.shape, *self.filter.predict(times))

    def centre(self, time: float) -> tuple[Array, float]:
        """Centre (3,) and growth at one time, as believed then."""
        predicted = self.predict(np.array([time]), time)
        return predicted.positions[0], float(predicted.growth[0])

    def expected(self, time: float) -> tuple[Array, float]:
        """Where it is expected at the time of a new frame, and its standard deviation; carries the filter there."""
        if self.filter is None:
            return self.place, GROWTH_UNSEEN
        if not self._rests(time):
            self.filter.advance(time)
        return self.filter.state[0], min(self.filter.position_sigma, GROWTH_UNSEEN)

    def _rests(self, now: float) -> bool:
        """Whether nothing is to be expected of it although it is not seen."""
        return self.is_static and now - self.last_seen > OUT_OF_SIGHT

    @property
    def velocity(self) -> Array:
        """(3,) (m/s)"""
        return np.zeros(3) if self.filter is None else self.filter.state[1]
