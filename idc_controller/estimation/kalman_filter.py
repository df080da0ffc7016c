"""Kalman filter of the estimator: filterpy's, corrected by one row of the measurements after the other."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from filterpy.kalman import KalmanFilter

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.estimation.propagation_kernels import propagated, propagated_state
from idc_controller.estimation.update_kernels import corrected

_CANCELLED = 1e-6
"""Share of a variance that a correction may leave before its rounding needs Joseph's form."""


class SparseRows(NamedTuple):
    """Rows H (m, n) that observe the state: their few elements that are not zero, (m, W) each."""

    columns: Indices
    coefficients: Array

    @classmethod
    def of(cls, H: Array, width: int) -> SparseRows:
        """Return the rows ``H`` (m, n), of which none has more than ``width`` elements that are not zero."""
        columns, coefficients = np.zeros((len(H), width), dtype=int), np.zeros((len(H), width))
        for r, row in enumerate(H):
            filled = np.flatnonzero(row)
            columns[r, : len(filled)], coefficients[r, : len(filled)] = filled, row[filled]
        return cls(columns, coefficients)

    def dense(self, n: int) -> Array:
        """Return H (m, n)."""
        H = np.zeros((len(self.columns), n))
        np.add.at(H, (np.arange(len(H))[:, None], self.columns), self.coefficients)
        return H


class Innovation(NamedTuple):
    """Measurements less their prediction."""

    rows: SparseRows
    """H (m, n)"""
    residual: Array
    """(m,)"""
    covariance: Array
    """H P H' (m, m), of the prediction alone; zero between different measurements."""

    def subset(self, which: Mask) -> Innovation:
        """Return that of some rows (m,)."""
        columns, coefficients = self.rows
        rows = SparseRows(columns[which], coefficients[which])
        return Innovation(rows, self.residual[which], self.covariance[np.ix_(which, which)])


class Transition(NamedTuple):
    """Transition matrix F (n, n) and input matrix B (n, 3 N) over an interval."""

    dense: Array
    """First rows of F (d, n), but for the last column."""
    push: Array
    """Columns by which a force on the payload moves these rows (d, 3); the last state is such a force's size."""
    sparse: SparseRows
    """The others, whose elements are in the last n - d columns."""
    B: Array

    def state(self, x: Array, direction: Array, u: Array) -> Array:
        """Return the state (n,) after ``x`` (n,) under the input ``u`` (3 N,); ``direction``: see :meth:`F`."""
        return propagated_state(x, self.dense, self.push, direction, *self.sparse, self.B, u)

    def F(self, direction: Array) -> Array:
        """Return the transition matrix (n, n), where ``direction`` (3,) is the force for one unit of the last state."""
        dense = np.column_stack([self.dense[:, :-1], self.push @ direction])
        return np.vstack([dense, self.sparse.dense(self.dense.shape[1])])


class StructuredKalmanFilter(KalmanFilter):  # type: ignore[misc]  # filterpy has no types
    """filterpy's filter for sparse models: prediction by blocks, correction without inverse and dense rows."""

    x: Array
    P: Array

    def propagate(
        self, transition: Transition, direction: Array, u: Array, Q: Array, change: Array, probability: Array
    ) -> None:
        """Predict over an interval; filterpy's ``predict`` with these matrices gives the same.

        Args:
            transition: over the interval.
            direction: force for one unit of the last state (3,).
            u: input (3 N,).
            Q: covariance of the process noise (n, n).
            change: of the input (3 N,), which may not act yet, or never; empty: there is none.
            probability: with which each vehicle still flies the input before (N,).
        """
        dense, push, (columns, coefficients), B = transition
        self.x, self.P = propagated(
            self.x, self.P, dense, push, direction, columns, coefficients, B, u, Q, change, probability
        )

    def correct(self, innovation: Innovation, variance: Array) -> float:
        """Correct by measurements with ``variance`` (m,) and return their normalised innovation squared.

        Where that leaves next to nothing of a variance, or their covariance is not positive definite, filterpy's own
        update in Joseph's form takes its place.
        """
        x, P, squared = corrected(self.P, innovation.residual, *innovation.rows, variance, _CANCELLED)
        if not math.isnan(squared):
            self.x, self.P = self.x + x, P
            return squared
        H = innovation.rows.dense(self.dim_x)
        self.update(innovation.residual + H @ self.x, R=np.diag(variance), H=H)
        self.P = (self.P + self.P.T) / 2
        return float(self.y @ self.SI @ self.y)
