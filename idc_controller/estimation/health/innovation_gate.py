"""Innovation test of the measurements of one moment: a gate on each, and on each channel of a rejected one."""

from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.estimation.health.chi_squared import lower_quantile
from idc_controller.estimation.kalman_filter import Innovation
from idc_controller.estimation.measurement_model import ObservationStack
from idc_controller.estimation.update_kernels import gated


class InnovationTest(NamedTuple):
    """Result for K measurements with m rows in all."""

    variance: Array
    """Measurement variance assumed now (m,)."""
    normalised: Array
    """Innovations normalised to variance 1 (m,)."""
    mean_squares: Array
    """Mean square of each measurement's normalised innovation (K,); on average 1."""
    accepted: Mask
    """Measurements that pass (K,)."""
    accepted_rows: Mask
    """Rows (m,) of accepted measurements, and of the channels that pass alone in rejected ones."""
    ratios: Array
    """Test ratios of pose and motion (K, 2): above 1 they are rejected; equal where one of them alone is tested."""


class InnovationGate:
    """Gate that a share ``probability`` of nominal measurements passes."""

    def __init__(self, probability: float) -> None:
        self._limits = lower_quantile(probability, np.arange(7))
        """Gates (normalised innovation squared) by the size of a measurement."""

    def test(self, innovation: Innovation, stack: ObservationStack, noise_scale: float) -> InnovationTest:
        """Test the measurements of one moment; ``noise_scale``: of their variances."""
        variance = stack.variance * noise_scale
        return InnovationTest(
            variance,
            *gated(innovation.residual, innovation.covariance, variance, stack.starts, stack.sizes, self._limits),
        )
