"""Compiled kernels of the filter's propagation."""

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.compiled import inlined, kernel

_VECTOR, _MATRIX, _COLUMNS = (
    f"Array({of}, {axes}, 'C', readonly=True)" for of, axes in (("float64", 1), ("float64", 2), ("int64", 2))
)
"""Types of arrays that are only read."""


@inlined
def _dense_rows(dense: Array, push: Array, direction: Array) -> Array:
    """Return the first rows of F (d, n), see :func:`propagated`."""
    first = dense.copy()
    for r in range(len(dense)):
        first[r, -1] = push[r, 0] * direction[0] + push[r, 1] * direction[1] + push[r, 2] * direction[2]
    return first


@inlined
def _state(x: Array, first: Array, columns: Indices, coefficients: Array, B: Array, u: Array) -> Array:
    """Return F x + B u (n,), see :func:`propagated`; ``first``: rows of F (d, n)."""
    d = len(first)
    result: Array = np.dot(B, u)
    result[:d] += np.dot(first, x)
    for r in range(len(columns)):
        for a in range(columns.shape[1]):
            if coefficients[r, a] != 0.0:
                result[d + r] += coefficients[r, a] * x[columns[r, a]]
    return result


@kernel(f"float64[::1]({_VECTOR}, {_MATRIX}, {_MATRIX}, {_VECTOR}, {_COLUMNS}, {_MATRIX}, {_MATRIX}, {_VECTOR})")
def propagated_state(
    x: Array, dense: Array, push: Array, direction: Array, columns: Indices, coefficients: Array, B: Array, u: Array
) -> Array:
    """Return the state of :func:`propagated` alone (n,)."""
    return _state(x, _dense_rows(dense, push, direction), columns, coefficients, B, u)


@kernel(
    f"Tuple((float64[::1], float64[:, ::1]))({_VECTOR}, {_MATRIX}, {_MATRIX}, {_MATRIX}, {_VECTOR}, {_COLUMNS}, "
    f"{_MATRIX}, {_MATRIX}, {_VECTOR}, {_MATRIX}, {_VECTOR}, {_VECTOR})"
)
def propagated(
    x: Array, P: Array, dense: Array, push: Array, direction: Array, columns: Indices, coefficients: Array, B: Array,
    u: Array, Q: Array, change: Array, probability: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """Return the state F x + B u (n,) and its covariance F P F' + Q (n, n) after an interval.

    The first rows of F are dense: payload and links move by all states. The others have few elements, none of them in
    the columns of the first states: each thrust and each disturbance goes by itself.

    Args:
        x: state (n,).
        P: its covariance, symmetric (n, n).
        dense: first rows of F (d, n), but for the last column.
        push, direction: factors of that, (d, 3) and (3,).
        columns, coefficients: elements of the other rows of F that are not zero (n - d, W).
        B: input matrix (n, 3 N).
        u: input (3 N,).
        Q: covariance of the process noise (n, n).
        change: of the set-points (3 N,): some vehicles may still fly those before; empty: none.
        probability: with which each vehicle does (N,).
    """
    n, d, W = len(x), len(dense), columns.shape[1]
    first = _dense_rows(dense, push, direction)
    result = _state(x, first, columns, coefficients, B, u)
    covariance = np.empty((n, n))
    top = np.dot(first, P)
    covariance[:d, :d] = np.dot(top, first.T)
    row = np.empty(n)
    for r in range(n - d):
        row[:] = 0.0
        for a in range(W):
            weight, column = coefficients[r, a], columns[r, a]
            if weight != 0.0:
                for c in range(d, n):
                    row[c] += weight * P[column, c]
        for o in range(d):
            total = 0.0
            for a in range(W):
                total += coefficients[r, a] * top[o, columns[r, a]]
            covariance[d + r, o] = total
        for o in range(r + 1):
            total = 0.0
            for a in range(W):
                total += coefficients[o, a] * row[columns[o, a]]
            covariance[d + r, d + o] = total
    if len(change):
        N = len(probability)
        share = np.sqrt(probability)
        lost = np.empty((2 * N, n))
        for r in range(n):
            for i in range(N):
                lost[i, r] = share[i] * (B[r, 2 * i] * change[2 * i] + B[r, 2 * i + 1] * change[2 * i + 1])
                lost[N + i, r] = share[i] * B[r, 2 * N + i] * change[2 * N + i]
        for r in range(n):
            for c in range(2 * N):
                weight = lost[c, r]
                if weight != 0.0:  # a set-point moves payload, links and its own vehicle
                    for o in range(r + 1):
                        covariance[r, o] += weight * lost[c, o]
    for r in range(n):
        for o in range(r + 1):
            covariance[r, o] += Q[r, o]
            covariance[o, r] = covariance[r, o]
    return result, covariance
