"""Innovation test of the measurements of one moment: a gate on each, and on each channel of a rejected one."""

import contextlib
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from idc_controller.arrays import Array, Mask
from idc_controller.estimation.measurement_model import ObservationStack


@dataclass(frozen=True, eq=False)
class InnovationTest:
    """Result for K measurements with m rows in all."""

    variance: Array
    """Measurement variance assumed now (m,)."""
    normalised: Array
    """Innovations normalised to variance 1 (m,)."""
    mean_squares: Array
    """Mean square of each measurement's normalised innovation (K,); on average 1."""
    accepted: Mask
    """Measurements that pass (K,)."""
    covariance: Array
    """Innovation covariance (m, m)."""


class InnovationGate:
    """Gate that a share ``probability`` of nominal measurements passes."""

    def __init__(self, probability: float) -> None:
        self._limits = chi2.ppf(probability, np.arange(7))
        """Gates (normalised innovation squared) by the size of a measurement."""

    def test(self, residual: Array, predicted: Array, stack: ObservationStack, noise_scale: float) -> InnovationTest:
        """Test the measurements of one moment.

        Args:
            residual: innovations (m,).
            predicted: covariance of the predicted measurements (m, m).
            stack: the measurements.
            noise_scale: scale of the measurement variances.
        """
        variance = stack.variance * noise_scale
        covariance = predicted.copy()
        covariance.flat[:: len(variance) + 1] += variance
        normalised = _normalised(residual, covariance, stack)
        squares = np.add.reduceat(normalised**2, stack.starts) / stack.sizes
        mean_squares = np.nan_to_num(squares, nan=np.inf)
        accepted = mean_squares * stack.sizes <= self._limits[stack.sizes]
        return InnovationTest(variance, normalised, mean_squares, accepted, covariance)

    def accepted_rows(self, residual: Array, test: InnovationTest, stack: ObservationStack) -> Mask:
        """Return the rows (m,) of accepted measurements, and of the channels that pass alone in rejected ones.

        Pose or motion may be right by itself: a drifting position, say, comes with a true velocity.
        """
        rows = np.repeat(test.accepted, stack.sizes)
        for c in np.flatnonzero(~test.accepted & (stack.sizes > 3)):
            half = int(stack.sizes[c]) // 2
            for first in (stack.starts[c], stack.starts[c] + half):
                part = slice(first, first + half)
                with contextlib.suppress(np.linalg.LinAlgError):
                    inverse = np.linalg.solve(test.covariance[part, part], residual[part])
                    rows[part] = float(residual[part] @ inverse) <= self._limits[half]
        return rows


def _normalised(residual: Array, covariance: Array, stack: ObservationStack) -> Array:
    """Return each measurement's innovation with variance 1 (m,), by its own block of the covariance."""
    normalised = np.full(len(residual), np.inf)
    for rows in stack.rows_by_size:
        with contextlib.suppress(np.linalg.LinAlgError):  # of a filter that has diverged already
            factor = np.linalg.cholesky(covariance[rows[:, :, None], rows[:, None, :]])
            normalised[rows] = np.linalg.solve(factor, residual[rows][..., None])[..., 0]
    return normalised
