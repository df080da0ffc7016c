"""Which measurements of one moment the prediction excludes: a gate on each, and on each half of what it refuses."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from idc_controller.estimation.measurement_model import Stack

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Judgement:
    """Of K measurements with m rows in all."""

    variance: Array
    """Of their noise, as it is assumed now (m,)."""
    white: Array
    """Innovations with variance 1 (m,)."""
    mean_squares: Array
    """Of these, a measurement (K,); on average 1."""
    accepted: NDArray[np.bool_]
    """(K,)"""
    covariance: Array
    """Of the innovations (m, m)."""


class OutlierGate:
    """The gate that lets a share ``probability`` of sound measurements through."""

    def __init__(self, probability: float) -> None:
        self._limits = chi2.ppf(probability, np.arange(7))
        """By the size of a measurement."""

    def judge(self, residual: Array, predicted: Array, stack: Stack, noise: float) -> Judgement:
        """The innovations ``residual`` (m,), of which the prediction has the covariance ``predicted`` (m, m).

        ``noise``: factor of the sensors' variances.
        """
        variance = stack.variance * noise
        covariance = predicted.copy()
        covariance.flat[:: len(variance) + 1] += variance
        white = _whitened(residual, covariance, stack)
        squares = np.add.reduceat(white**2, stack.starts) / stack.sizes
        mean_squares = np.nan_to_num(squares, nan=np.inf)
        return Judgement(
            variance, white, mean_squares, mean_squares * stack.sizes <= self._limits[stack.sizes], covariance
        )

    def sound_rows(self, residual: Array, judgement: Judgement, stack: Stack) -> NDArray[np.bool_]:
        """Rows (m,) that are accepted, or are the half of a refused measurement that is.

        The pose or the motion may be right: a drifting position, say, comes with a true velocity.
        """
        rows = np.repeat(judgement.accepted, stack.sizes)
        for c in np.flatnonzero(~judgement.accepted & (stack.sizes > 3)):
            half = int(stack.sizes[c]) // 2
            for first in (stack.starts[c], stack.starts[c] + half):
                part = slice(first, first + half)
                with contextlib.suppress(np.linalg.LinAlgError):
                    inverse = np.linalg.solve(judgement.covariance[part, part], residual[part])
                    rows[part] = float(residual[part] @ inverse) <= self._limits[half]
        return rows


def _whitened(residual: Array, covariance: Array, stack: Stack) -> Array:
    """Each measurement's innovation with variance 1 (m,), by its own block of the covariance."""
    white = np.full(len(residual), np.inf)
    for rows in stack.rows_by_size:
        with contextlib.suppress(np.linalg.LinAlgError):  # of a filter that is lost already
            factor = np.linalg.cholesky(covariance[rows[:, :, None], rows[:, None, :]])
            white[rows] = np.linalg.solve(factor, residual[rows][..., None])[..., 0]
    return white
