"""Results of the estimator: the state at one moment, and the innovations of the measurements applied for it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from idc_controller.arrays import Array, Indices
from idc_controller.estimation.measurements import SensorKey


@dataclass(frozen=True, eq=False)
class InnovationRecord:
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


@dataclass(frozen=True, eq=False)
class Estimate:
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

    @cached_property
    def covariance(self) -> Array:
        """Covariance of x, forces (3 + 2 N) and mass excess (12 + 13 N + 4,) squared; predicted only if asked for."""
        return self.predict_covariance()
