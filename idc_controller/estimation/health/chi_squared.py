"""Quantiles of the chi-squared distribution: the limits of innovation tests."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtri, gammaincinv

from idc_controller.arrays import Array


def lower_quantile(probability: float, freedom: ArrayLike) -> Array:
    """Return what a share ``probability`` of samples with ``freedom`` degrees of freedom does not exceed."""
    return np.asarray(2.0 * gammaincinv(np.asarray(freedom) / 2.0, probability))


def upper_quantile(probability: float, freedom: ArrayLike) -> Array:
    """Return what a share ``probability`` of samples with ``freedom`` degrees of freedom exceeds."""
    return np.asarray(chdtri(freedom, probability))
