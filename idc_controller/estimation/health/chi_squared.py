"""Quantiles of the chi-squared distribution: the limits of innovation tests."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import chdtri, gammaincinv

from idc_controller.arrays import Array


def lower_quantile(probability: float, freedom: ArrayLike) -> Array:
    """Return what a share ``probability`` of samples with ``freedom`` degrees of freedom does not exceed."""
    return np.asarray(2.0 * gammaincinv(np.asarray(freedom) / 2.0, probability))


def length_quantile(probability: float, covariance: Array) -> Array:
    """Return the length (K,) that normal errors with ``covariance`` (K, n, n) exceed with that probability, about.

    By a chi-squared distribution with the mean and variance of the squared length (Satterthwaite 1946): exact for one
    axis and for equal ones.
    """
    mean = np.trace(covariance, axis1=-2, axis2=-1)
    squares = np.sum(covariance**2, axis=(-2, -1))
    scale = squares / np.maximum(mean, 1e-300)
    return np.asarray(np.sqrt(scale * upper_quantile(probability, np.maximum(mean / np.maximum(scale, 1e-300), 1.0))))


def upper_quantile(probability: float, freedom: ArrayLike) -> Array:
    """Return what a share ``probability`` of samples with ``freedom`` degrees of freedom exceeds."""
    return np.asarray(chdtri(freedom, probability))
