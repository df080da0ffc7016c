"""White noise integrated over an interval of a linear model, as a power series of the interval."""

from collections.abc import Sequence

import numpy as np

from idc_controller.arrays import Array

_TERMS = 24
"""Of the series; within :attr:`IntegratedNoise.duration_max` the next one is 2^24 / 25! of the first, 1e-18."""


class IntegratedNoise:
    """Integral of exp(A s) C exp(A' s) over s from 0 to t, where C is a weighted sum of power spectral densities.

    It is the sum of t^k / k! M_k with M_1 = C and M_(k+1) = A M_k + M_k A'.
    """

    def __init__(self, A: Array, densities: Sequence[Array]) -> None:
        """Take the matrix ``A`` (n, n) of the model and the ``densities`` (P), (n, n) each."""
        self.duration_max = 1.0 / float(np.abs(np.linalg.eigvals(A)).max())
        """Up to which the series is exact to the digit (s)."""
        terms = [np.stack(densities)]
        for k in range(2, _TERMS + 1):
            product = A @ terms[-1]
            terms.append((product + product.transpose(0, 2, 1)) / k)
        self._terms = np.stack(terms)  # (K, P, n, n)

    def covariance(self, duration: float, weights: Sequence[float]) -> Array:
        """Return the integral (n, n) over a ``duration`` (s), with ``weights`` (P) of the densities."""
        factors = np.outer(duration ** np.arange(1, _TERMS + 1), weights)
        return np.tensordot(factors, self._terms, axes=2)
