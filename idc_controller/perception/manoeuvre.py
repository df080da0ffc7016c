"""Manoeuvre detection: by how much more an obstacle accelerates than the motion models allow for.

Innovations show at once that the models mismatch, but not how large the error of predictions will be. A prediction that
proves wrong later shows that; it comes late, but for an obstacle that stops and starts again not too late. Both count
as an acceleration by which the obstacle may leave any prediction, and both decay slowly.
"""

import math
from collections import deque

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Wall
from idc_controller.perception.settings import ManoeuvreSettings

_USUAL = 0.5
"""Mean squared innovation of models that fit: their mixture's variance is larger than theirs."""


class ManoeuvreDetector:
    """Model mismatch and prediction error of one obstacle that was first detected at ``time`` (s)."""

    def __init__(self, time: float, settings: ManoeuvreSettings = ManoeuvreSettings()) -> None:
        self._settings = settings
        self._since = self._time = time
        self._mean_square = _USUAL
        self.model_mismatch = 0.0
        """Recent mismatch of the motion models, 0 to 1."""
        self._predictions: deque[tuple[float, Array, float]] = deque()
        self.prediction_error = 0.0
        """Recent excess of the error of predictions over ``horizon``, of those that did not expect it (m)."""

    @property
    def is_settled(self) -> bool:
        """Return whether it was detected for long enough for its predictions to be compared."""
        return self._time - self._since > self._settings.settling

    @property
    def is_unpredictable(self) -> bool:
        """Return whether predictions have erred of late by more than the growth of the body holds otherwise."""
        return self.prediction_error > self._settings.growth_max

    @property
    def is_predictable(self) -> bool:
        """Return whether predictions have been compared, and proved right of late."""
        compared = self._time - self._since > self._settings.settling + self._settings.horizon
        return compared and not self.is_unpredictable

    def advance(self, time: float) -> None:
        """Decay until ``time`` (s)."""
        was_settled = self.is_settled
        share = float(np.exp(-max(time - self._time, 0.0) / self._settings.memory))
        self.model_mismatch *= share
        self.prediction_error *= share
        self._time = max(time, self._time)
        if self.is_settled and not was_settled:
            # Until then the shape was learnt, whose changes are no motion.
            self._mean_square, self.model_mismatch = _USUAL, 0.0

    def add_innovation(self, mean_square: float) -> None:
        """Take the last innovation: its ``mean_square`` over the axes, normalised by its variance."""
        s = self._settings
        self._mean_square += s.innovation_share * (min(mean_square, s.innovation_max) - self._mean_square)
        mismatch = (self._mean_square - s.mismatch_begin) / (s.mismatch_full - s.mismatch_begin)
        self.model_mismatch = max(self.model_mismatch, min(mismatch, 1.0))

    def add_prediction(self, position: Array, error: float) -> None:
        """Take the prediction that it is at ``position`` (3,) (NED, m) after ``horizon``, and its expected error (m).

        What a prediction says of its own error is no manoeuvre: at first, most of all, velocities are hardly known.
        """
        self._predictions.append((self._time + self._settings.horizon, position, error))

    def compare(self, position: Array, velocity: Array) -> None:
        """Compare the predictions for about now with ``position`` (3,) (NED, m) and ``velocity`` (3,) (m/s)."""
        s = self._settings
        while self._predictions and self._predictions[0][0] <= self._time + s.frame:
            time, predicted, expected = self._predictions.popleft()
            error = float(np.linalg.norm(position + velocity * (time - self._time) - predicted))
            if error > expected:
                self.prediction_error = max(self.prediction_error, error - s.usual_error)

    def variance(self, elapsed: Array) -> Array:
        """Return the variance (m2) on any axis after the times ``elapsed`` (K,) (s), beside the motion models'."""
        s = self._settings
        mismatch = 0.5 * self.model_mismatch * s.mismatch_acceleration
        return np.asarray((mismatch**2 + (self.prediction_error / s.horizon**2) ** 2) * elapsed**4)

    def growth_limit(self, scatter: float) -> float:
        """Return the largest growth of the body (m) if its points ``scatter`` (m) in every frame."""
        s = self._settings
        return min(s.growth_max + s.growth_per_error * self.prediction_error + scatter, s.growth_limit)


_ABOUT = 0.1
"""Distance outside of the region up to which a place still counts as visited: errors of the centre (m)."""


class VisitedRegion:
    """Places of a body's centre (NED, m) of late: where it may be again if its motion cannot be predicted. Times in s.

    A body that stops and goes shows no motion model when it will start, nor how far it will go, but it stays about the
    places where it has been. Where predictions prove wrong, these stand for the prediction.
    """

    def __init__(self) -> None:
        self._places: deque[tuple[float, Array]] = deque()
        self._region: tuple[Array, Array, float] | None = None

    def add(self, time: float, place: Array) -> None:
        """Add the ``place`` (3,) of the centre at ``time`` (s)."""
        self._places.append((time, place))
        self._region = None

    def box(self, shape: Shape, since: float) -> tuple[Wall, Array]:
        """Return an upright box, and its centre (3,), that holds a body of this ``shape`` where it was from ``since``.

        Earlier places are forgotten, but the last one.
        """
        while len(self._places) > 1 and self._places[0][0] < since:
            self._places.popleft()
            self._region = None
        if self._region is None:
            self._region = _upright_box(np.array([place for _, place in self._places]))
        centre, edges, yaw = self._region
        along, across, height = edges + 2.0 * np.array([shape.horizontal_reach] * 2 + [shape.half_height])
        return Wall((float(along), float(across), float(height)), yaw), centre

    def holds(self, place: Array, before: float) -> bool:
        """Return whether the centre was about a ``place`` (3,) already before the time ``before`` (s)."""
        earlier = [at for time, at in self._places if time < before]
        if not earlier:
            return False
        centre, edges, yaw = _upright_box(np.array(earlier))
        return bool((np.abs(_turned(place - centre, yaw)) <= 0.5 * edges + _ABOUT).all())


def _turned(offsets: Array, yaw: float) -> Array:
    """Return offsets (..., 3) in axes turned by ``yaw`` (rad) about the vertical."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    x, y, z = np.moveaxis(offsets, -1, 0)
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=-1)


def _upright_box(places: Array) -> tuple[Array, Array, float]:
    """Return centre (3,), edges (3,) (m) and yaw (rad) of an upright box about ``places`` (n, 3), along them."""
    mean = places.mean(axis=0)
    x, y, _ = (places - mean).T
    yaw = 0.5 * math.atan2(2.0 * float(x @ y), float(x @ x - y @ y))
    turned = _turned(places - mean, yaw)
    low, high = turned.min(axis=0), turned.max(axis=0)
    return mean + _turned(0.5 * (low + high), -yaw), high - low, yaw
