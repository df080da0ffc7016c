"""Manoeuvre detection: by how much more an obstacle accelerates than the motion models allow for.

Innovations show at once that the models mismatch, but not how large the error of predictions will be. A prediction that
proves wrong later shows that; it comes late, but for an obstacle that stops and starts again not too late. Both count
as an acceleration by which the obstacle may leave any prediction, and both decay slowly.
"""

from collections import deque

import numpy as np

from idc_controller.arrays import Array
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
