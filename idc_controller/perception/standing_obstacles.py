"""Standing obstacles: those of the map, and the convex pieces that cover what range sensors have hit."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.geometry.obstacles import Bodies, PredictedObstacle, Region
from idc_controller.geometry.shape import Shape
from idc_controller.perception.convex_pieces import ConvexPieces
from idc_controller.perception.settings import StandingMapSettings
from idc_controller.perception.standing_map import StandingMap

_FAR = 2.0  # m; farther obstacles of the map are not distinguished

NamedBody = tuple[str, Shape, Array]
"""Name, shape, and centre (3,) (NED, m)."""
Estimate = Callable[[], tuple[Shape, Array]]


class MapObstacle(NamedTuple):
    """An obstacle that is known before the flight."""

    name: str
    shape: Shape
    centre: Array
    """Centre in the world (3,) (NED, m); of a moving obstacle, the mean of its motion."""
    moves: bool = False
    is_body: bool = True
    """Whether there is a body that range sensors can detect: the limit of an area is none."""


class NextObstacles(NamedTuple):
    """Standing obstacles of the map about n points. Distances from surfaces, m."""

    distance: Array
    """From the next one (n,)."""
    body: Indices
    """Number of the next one that can be detected (n,)."""
    body_distance: Array
    """From that (n,)."""
    others: Array
    """From the next of all others that can be detected (n,)."""


class _AtRest:
    """Obstacles that stand, gathered."""

    def __init__(self, obstacles: Sequence[NamedBody], estimates: Sequence[Estimate | None]) -> None:
        self._obstacles, self._estimates = obstacles, estimates
        self.centres = np.array([centre for *_, centre in obstacles]).reshape(-1, 3)
        self._reach = np.array([shape.horizontal_reach for _, shape, _ in obstacles])
        self._predicted: dict[int, list[PredictedObstacle]] = {}

    def near(self, place: Array, radius: float) -> Indices:
        """Return the indices of those within ``radius`` (m) of the vertical line through ``place`` (3,)."""
        apart = self.centres[:, :2] - place[:2]
        return np.flatnonzero(np.hypot(apart[:, 0], apart[:, 1]) <= radius + self._reach)

    def predict(self, count: int, region: Region | None) -> list[PredictedObstacle]:
        """Return them at ``count`` moments, all or those that reach into a ``region``."""
        if not self._obstacles:
            return []
        if count not in self._predicted:
            places, growth = np.repeat(self.centres[:, None], count, axis=1), np.zeros(count)
            self._predicted[count] = [
                PredictedObstacle(name, shape, place, growth, estimate=estimate)
                for (name, shape, _), estimate, place in zip(self._obstacles, self._estimates, places, strict=True)
            ]
        predicted = self._predicted[count]
        return predicted[:] if region is None else [predicted[i] for i in self.near(*region).tolist()]


class StandingObstacles:
    """The standing obstacles of the map, gathered."""

    def __init__(self, known: Sequence[MapObstacle]) -> None:
        self.obstacles = [(o.name, o.shape, o.centre) for o in known]
        self.names = [o.name for o in known]
        self.bodies = Bodies([o.shape for o in known])
        self._at_rest = _AtRest(self.obstacles, [None] * len(known))
        self.centres = self._at_rest.centres
        self.predict = self._at_rest.predict
        self._is_body = np.array([o.is_body for o in known], dtype=bool)

    def next_to(self, points: Array, origin: Array) -> NextObstacles:
        """Return those next to points (n, 3), seen from ``origin`` (3,); those beyond :data:`_FAR` may be left out."""
        far = np.full(len(points), math.inf)
        none = NextObstacles(far, np.full(len(points), -1), far, far)
        if not len(points) or not self.names:
            return none
        farthest = float(np.hypot(*(points[:, :2] - origin[:2]).T).max())
        near = self._at_rest.near(origin, farthest + _FAR)
        if not len(near):
            return none
        distance = self.bodies.distance_among(near, points, self.centres, _FAR)
        np.abs(distance, out=distance)
        next_of_all, bodies = distance.min(axis=0), near[self._is_body[near]]
        if not len(bodies):
            return none._replace(distance=next_of_all)
        if len(bodies) < len(near):
            distance = distance[self._is_body[near]]
        next_body, each = distance.argmin(axis=0), np.arange(len(points))
        body_distance = distance[next_body, each]
        distance[next_body, each] = math.inf
        return NextObstacles(next_of_all, bodies[next_body], body_distance, distance.min(axis=0))


class SeenObstacles:
    """The standing map, and the pieces that cover it as obstacles, kept while they do not change."""

    def __init__(self, settings: StandingMapSettings) -> None:
        self.map = StandingMap(settings)
        self._cover = ConvexPieces()
        self._known: dict[int, tuple[Array, Shape]] = {}
        self.pieces: list[NamedBody] = []
        self._at_rest = _AtRest([], [])

    def update(self) -> None:
        """Cover what has changed in the map."""
        known: dict[int, tuple[Array, Shape]] = {}
        pieces = self._cover.update(self.map)
        for piece in pieces:
            box, shape = self._known.get(piece.number, (None, None))
            if shape is None or box is not piece.box:
                shape = piece.shape
            known[piece.number] = piece.box, shape
        self._known = known
        self.pieces = [(f"piece {number}", shape, box[:3]) for number, (box, shape) in known.items()]
        self._at_rest = _AtRest(self.pieces, [partial(piece.estimate, self.map) for piece in pieces])

    def predict(self, count: int, region: Region | None) -> list[PredictedObstacle]:
        """Return them at ``count`` moments, all or those that reach into a ``region``."""
        return self._at_rest.predict(count, region)
