"""Results of the estimator: the state at one moment, and the innovations of the measurements applied for it."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.estimation.measurements import SensorKey


class InnovationRecord(NamedTuple):
    """Innovation test of the measurements of one moment."""

    time: float
    """s"""
    normalised_squared: float
    """y' S^-1 y of the accepted rows; on average ``degrees_of_freedom``."""
    degrees_of_freedom: int
    rejected: tuple[SensorKey, ...]
    """Sources and kinds that failed the test."""
    covariance_reset: bool
    """Most sources disagreed with the prediction, or it was no number: its covariance was reset."""
    keys: tuple[SensorKey, ...]
    """Sources and kinds of all measurements (K,)."""
    sizes: Indices
    """Rows of each (K,); they add up to m."""
    normalised: Array
    """Innovations, one measurement after the other, normalised to variance 1 (m,)."""
    test_ratios: Array
    """Normalised innovations squared of pose and motion over their gates (K, 2); above 1: rejected, nan: not tested."""


class Estimate(NamedTuple):
    """State at one moment. ``x`` (12 + 11 N,) in the linear model's coordinates, absolute."""

    time: float
    """s"""
    x: Array
    force: Array
    """Disturbance force on the payload (3,) (N, NED)."""
    uav_force: Array
    """Level disturbance force on each UAV (N, 3) (N, NED)."""
    mass_excess: float
    """Payload mass less nominal (kg)."""
    force_covariance: Array
    """Of the force on the payload (3, 3) (N2)."""
    predict_covariance: Callable[[], Array]
    """Predicts :attr:`covariance`."""
    innovations: tuple[InnovationRecord, ...] = ()
    """Innovations applied since the last estimate, in order of time; those replayed come again."""
    predict_payload_variances: Callable[[], Array] = lambda: np.full(12, np.nan)
    """Predicts the variances of the payload's position, velocity, attitude (Euler angles) and rates (12,) squared."""

    @property
    def covariance(self) -> Array:
        """Covariance of x, forces (3 + 2 N) and mass excess (12 + 13 N + 4,) squared; predicted at each access."""
        return self.predict_covariance()
