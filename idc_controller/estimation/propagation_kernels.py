"""Compiled kernels of the filter's propagation."""

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Const1, Const2, Const3, ConstIndices2, Indices, Indices1
from idc_controller.compiled import inlined, kernel


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
    upper = np.dot(first, x)
    for r in range(d):
        result[r] += upper[r]
    for r in range(len(columns)):
        for a in range(columns.shape[1]):
            if coefficients[r, a] != 0.0:
                result[d + r] += coefficients[r, a] * x[columns[r, a]]
    return result


@kernel
def propagated_state(
    x: Const1, dense: Const2, push: Const2, direction: Const1, columns: ConstIndices2, coefficients: Const2, B: Const2,
    u: Const1,
) -> Array1:  # fmt: skip
    """Return the state of :func:`propagated` alone (n,)."""
    return _state(x, _dense_rows(dense, push, direction), columns, coefficients, B, u)


@kernel
def propagated(
    x: Const1, P: Const2, dense: Const2, push: Const2, direction: Const1, columns: ConstIndices2, coefficients: Const2,
    B: Const2, u: Const1, Q: Const2, change: Const1, probability: Const1,
) -> tuple[Array1, Array2]:  # fmt: skip
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
    upper = np.dot(top, first.T)
    for r in range(d):
        for c in range(d):
            covariance[r, c] = upper[r, c]
    # The last columns of F P as rows: the last rows of F combine whole ones of these.
    rest, row = np.empty((n - d, n)), np.empty(n - d)
    for o in range(d):
        for c in range(n - d):
            rest[c, o] = top[o, d + c]
    for r in range(n - d):
        row[:] = 0.0
        for a in range(W):
            weight, column = coefficients[r, a], columns[r, a]
            if weight != 0.0:
                for c in range(n - d):
                    row[c] += weight * P[column, d + c]
        for c in range(n - d):
            rest[c, d + r] = row[c]
    covariance[d:] = 0.0
    for r in range(n - d):
        for a in range(W):
            weight, column = coefficients[r, a], columns[r, a] - d
            if weight != 0.0:
                for c in range(n):
                    covariance[d + r, c] += weight * rest[column, c]
    if len(change):
        N = len(probability)
        share = np.sqrt(probability)
        lost = np.empty((2 * N, n))
        for r in range(n):
            for i in range(N):
                lost[i, r] = share[i] * (B[r, 2 * i] * change[2 * i] + B[r, 2 * i + 1] * change[2 * i + 1])
                lost[N + i, r] = share[i] * B[r, 2 * N + i] * change[2 * N + i]
        for r in range(n):
            for i in range(N):
                tilt, thrust = lost[i, r], lost[N + i, r]
                for o in range(r + 1):
                    covariance[r, o] += tilt * lost[i, o] + thrust * lost[N + i, o]
    for r in range(n):
        for o in range(r + 1):
            covariance[r, o] += Q[r, o]
            covariance[o, r] = covariance[r, o]
    return result, covariance


@kernel
def propagated_variances(
    P: Const2, dense: Const2, push: Const2, direction: Const1, B: Const2, Q: Const2, change: Const1, probability: Const1
) -> Array1:
    """Return the first elements of the diagonal of the covariance of :func:`propagated` (r,).

    Args:
        P: covariance before, symmetric (n, n).
        dense: first rows of F (r, n), but for the last column.
        push, direction, B, Q, change, probability: see :func:`propagated`.
    """
    first = _dense_rows(dense, push, direction)
    top, N = np.dot(first, P), len(probability)
    variances = np.empty(len(dense))
    for r in range(len(dense)):
        total = Q[r, r]
        for c in range(len(P)):
            total += top[r, c] * first[r, c]
        if len(change):
            for i in range(N):
                tilt = B[r, 2 * i] * change[2 * i] + B[r, 2 * i + 1] * change[2 * i + 1]
                thrust = B[r, 2 * N + i] * change[2 * N + i]
                total += probability[i] * (tilt * tilt + thrust * thrust)
        variances[r] = total
    return variances


@kernel
def add_variances(P: Array2, first: int, uavs: Indices1, variance: float) -> None:
    """Add a ``variance`` to those of two states of each of ``uavs`` (K,) in the covariance ``P`` (n, n).

    ``first``: index of the first UAV's two states; those of the others follow.
    """
    for i in range(len(uavs)):
        for state in range(first + 2 * uavs[i], first + 2 * uavs[i] + 2):
            P[state, state] += variance


@kernel
def defect(
    before: Const1, after: Const1, u: Const1, columns: ConstIndices2, coefficients: Const2, B: Const2,
    first: int, end: int,
) -> Array1:  # fmt: skip
    """Return by how much the states ``first`` to ``end`` of a reference miss the model's after an interval (n,).

    That is F x_k + B u_k - x_k+1 in these states, which only depend on each other and on the input; 0 in all others.

    Args:
        before, after: reference at the interval's ends (n,).
        u: its set-points (3 N,).
        columns, coefficients, B: see :func:`propagated`.
        first, end: range of the states.
    """
    d = len(before) - len(columns)
    result = np.zeros(len(before))
    for state in range(first, end):
        total = -after[state]
        for a in range(columns.shape[1]):
            total += coefficients[state - d, a] * before[columns[state - d, a]]
        for c in range(len(u)):
            total += B[state, c] * u[c]
        result[state] = total
    return result


@kernel
def are_finite(x: Const1, P: Const2) -> bool:
    """Return whether state (n,) and covariance (n, n) are numbers."""
    total = 0.0 * x  # zero times inf or nan is nan
    for row in range(len(P)):
        for c in range(len(x)):
            total[c] += 0.0 * P[row, c]
    return not np.isnan(total).any()


@kernel
def about_reference(
    x: Const2, u: Const2, payload: Const3, on_payload: Const2, on_uavs: Const3, g: float, mass_excess: float
) -> tuple[Array2, Array2, Array2]:
    """Return what the error state is about: set-points, direction of the force of mass, and state of the reference.

    The drag that is predicted changes with the velocity, so what is estimated of it is the rest.

    Args:
        x: states of the reference in the linear model's coordinates (K, 12 + 11 N).
        u: its set-points (K, 3 N).
        payload: derivatives of the payload's position (5, K, 3).
        on_payload, on_uavs: forces of its load on the payload (K, 3) and on the UAVs (K, N, 3) (N).
        g: m/s2.
        mass_excess: of its load (kg).

    Returns:
        Set-points (K - 1, 3 N) and force of one kilogram of excess of mass g e3 - a (K - 1, 3) (N/kg), both in the mean
        from each time to the next, and states with the forces and the mass excess (K, 12 + 11 N + 3 + 2 N + 1).
    """
    K, n = x.shape
    N = on_uavs.shape[1]
    mean, direction = np.empty((K - 1, 3 * N)), np.empty((K - 1, 3))
    nominal = np.empty((K, n + 4 + 2 * N))
    for k in range(K - 1):
        for c in range(3 * N):
            mean[k, c] = (u[k, c] + u[k + 1, c]) / 2
        for c in range(3):
            direction[k, c] = (g if c == 2 else 0.0) - (payload[2, k, c] + payload[2, k + 1, c]) / 2
    for k in range(K):
        for c in range(n):
            nominal[k, c] = x[k, c]
        for c in range(3):
            nominal[k, n + c] = on_payload[k, c]
        nominal[k, -1] = mass_excess
        for i in range(N):
            nominal[k, n + 3 + 2 * i], nominal[k, n + 4 + 2 * i] = on_uavs[k, i, 0], on_uavs[k, i, 1]
    return mean, direction, nominal
