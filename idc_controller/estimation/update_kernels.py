"""Compiled kernels of the measurement update: innovations, their covariance, and their test.

Rows that observe the error state have few elements: each is given by ``columns`` and ``coefficients`` (m, W).
"""

import math

import numpy as np

from idc_controller.arrays import (
    Array,
    Array1,
    Array2,
    Const1,
    Const2,
    Const3,
    Indices,
    Indices1,
    Indices2,
    Mask,
    Mask1,
)
from idc_controller.compiled import inlined, kernel


@inlined
def _measured_less_reference(
    values: Array, sources: Indices, is_position: Mask, m: int, reference: Array, payload: Array,
    q: Array, q_dot: Array, k: int, p: Array, l: Array,
) -> Array:  # fmt: skip
    """Return measured less reference (m,) of K measurements of one moment; nan where nothing was measured.

    A position has 6 rows, an attitude of the payload 6 (Euler angles and body rates), one of a UAV 4: of that only the
    direction of the thrust moves anything, n = -R e3, n' = -R (omega x e3).
    """
    N = len(l)
    result = np.empty(m)
    at, row = 0, 0
    for j in range(len(sources)):
        i = sources[j]
        if is_position[j]:
            for c in range(3):
                position, velocity = payload[0, k, c], payload[1, k, c]
                if i >= 0:
                    position, velocity = position + p[i, c] - l[i] * q[c], velocity - l[i] * q_dot[c]
                result[row + c], result[row + 3 + c] = values[at + c] - position, values[at + 3 + c] - velocity
            at, row = at + 6, row + 6
            continue
        w, a, b, c = values[at], values[at + 1], values[at + 2], values[at + 3]
        omega_x, omega_y, omega_z = values[at + 4], values[at + 5], values[at + 6]
        at += 7
        if i < 0:
            result[row] = math.atan2(2 * (w * a + b * c), 1 - 2 * (a * a + b * b))
            sine = 2 * (w * b - c * a)
            result[row + 1] = math.asin(min(max(sine, -1.0), 1.0)) if sine == sine else sine
            result[row + 2] = math.atan2(2 * (w * c + a * b), 1 - 2 * (b * b + c * c))
            result[row + 3], result[row + 4], result[row + 5] = omega_x, omega_y, omega_z
            row += 6
        else:
            n, n_dot = 12 + 4 * N + 2 * i, 12 + 6 * N + 2 * i
            result[row] = -2.0 * (a * c + w * b) - reference[k, n]
            result[row + 1] = -2.0 * (b * c - w * a) - reference[k, n + 1]
            turn, cross = 2.0 * (a * b - w * c), 2.0 * (a * b + w * c)
            result[row + 2] = turn * omega_x - (1.0 - 2.0 * (b * b + c * c)) * omega_y - reference[k, n_dot]
            result[row + 3] = (1.0 - 2.0 * (a * a + c * c)) * omega_x - cross * omega_y - reference[k, n_dot + 1]
            row += 4
    return result


@inlined
def predicted(
    x: Array, P: Array, y: Array, columns: Indices, coefficients: Array, starts: Indices, sizes: Indices
) -> tuple[Array, Array]:
    """Return the residual y - H x (m,) of the sparse rows H, and H P H' (m, m) of each measurement by itself.

    Args:
        x: predicted error state (n,).
        P: its covariance (n, n).
        y: measured less reference (m,).
        columns, coefficients: elements of the rows that are not zero (m, W).
        starts, sizes: first row and number of rows of each measurement (K,); between two of them, zeros are returned.
    """
    m, W = columns.shape
    residual, covariance = y.copy(), np.zeros((m, m))
    for j in range(len(starts)):
        for r in range(starts[j], starts[j] + sizes[j]):
            for a in range(W):
                weight, column = coefficients[r, a], columns[r, a]
                if weight == 0.0:
                    continue
                residual[r] -= weight * x[column]
                for o in range(starts[j], r + 1):
                    for b in range(W):
                        if coefficients[o, b] != 0.0:
                            covariance[r, o] += weight * coefficients[o, b] * P[column, columns[o, b]]
            for o in range(starts[j], r):
                covariance[o, r] = covariance[r, o]
    return residual, covariance


@kernel
def innovations(
    values: Const1, sources: Indices1, is_position: Mask1, reference: Const2, payload: Const3, q: Const2, q_dot: Const2,
    k: int, p: Const2, l: Const1, columns: Indices2, coefficients: Const2, uavs: Indices1, heights: Indices1,
    starts: Indices1, sizes: Indices1, x: Const1, P: Const2,
) -> tuple[Array2, Array1, Array2]:  # fmt: skip
    """Return the innovations of K measurements, and the coefficients of the rows that observe the error there.

    A change of the lateral part of a tilted link changes its height too.

    Args:
        values: poses (quaternion or position) and motions, one measurement after the other, NED, SI.
        sources: UAV (K,), or negative for the payload.
        is_position: whether each is a position; else it is an attitude (K,).
        reference: states of the reference in the linear model's coordinates (T, 12 + 11 N).
        payload: derivatives of the payload's position (5, T, 3).
        q, q_dot: direction of the links and its derivative (T, 3).
        k: index of the time in the reference.
        p, l: attachment points (N, 3) and lengths (N,) of the links (m).
        columns, coefficients: with links upright (m, W); the last two of the heights' rows are those of the link.
        uavs: UAVs whose position is observed (P,).
        heights: rows of their heights (P,); those of the vertical velocities are three below.
        starts, sizes, x, P: see :func:`predicted`.

    Returns:
        Coefficients (m, W), residual (m,), nan where nothing was measured, and H P H' (m, m), see :func:`predicted`.
    """
    tilted = coefficients.copy()
    for j in range(len(uavs)):
        for axis in range(2):
            slope = l[uavs[j]] * (q[k, axis] / q[k, 2])
            at = coefficients.shape[1] - 2 + axis
            tilted[heights[j], at] = tilted[heights[j] + 3, at] = slope
    y = _measured_less_reference(
        values, sources, is_position, len(coefficients), reference, payload, q[k], q_dot[k], k, p, l
    )
    residual, covariance = predicted(x, P, y, columns, tilted, starts, sizes)
    return tilted, residual, covariance


@kernel
def corrected(
    P: Const2, residual: Array1, columns: Indices2, coefficients: Array2, variance: Array1, cancelled: float
) -> tuple[Array1, Array2, float]:
    """Correct by the rows of independent noise one after the other, which equals the correction by all at once.

    Each takes p p' / s from the covariance, with p = P h and s = h' P h + its variance: the squares of the diagonal of
    the Cholesky factor of the innovation covariance are these s.

    Args:
        P: covariance before, symmetric (n, n).
        residual: innovations (m,).
        columns, coefficients: elements of the rows that are not zero (m, W).
        variance: of the measurements (m,).
        cancelled: share of a variance below which what is left of it is rounding.

    Returns:
        Correction of the state (n,), covariance after (n, n), symmetric to the digit, and the normalised innovation
        squared: nan where a variance is cancelled or their covariance is not positive definite.
    """
    n, (m, W) = len(P), columns.shape
    x, after, p = np.zeros(n), P.copy(), np.empty(n)
    squared = 0.0
    for r in range(m):
        left = residual[r]
        p[:] = 0.0
        for a in range(W):
            weight, column = coefficients[r, a], columns[r, a]
            if weight != 0.0:
                left -= weight * x[column]
                for c in range(n):
                    p[c] += weight * after[column, c]
        s = variance[r]
        for a in range(W):
            s += coefficients[r, a] * p[columns[r, a]]
        if not s > 0.0:
            return x, after, np.nan
        normalised, scale = left / np.sqrt(s), 1.0 / np.sqrt(s)
        squared += normalised * normalised
        for c in range(n):
            p[c] *= scale
            x[c] += p[c] * normalised
        for row in range(n):
            share = p[row]
            for c in range(n):
                after[row, c] -= share * p[c]
    for c in range(n):
        if not after[c, c] >= cancelled * P[c, c]:
            return x, after, np.nan
    return x, after, squared


@inlined
def _normalise(residual: Array, covariance: Array, variance: Array, first: int, size: int, into: Array) -> float:
    """Fill ``into`` (size,) with the rows from ``first`` on normalised to variance 1; return the sum of their squares.

    Both are inf where the covariance of these rows is not positive definite: of a filter that has diverged already.
    """
    L = np.empty((size, size))
    total = 0.0
    for r in range(size):
        for c in range(r + 1):
            value = covariance[first + r, first + c]
            if r == c:
                value += variance[first + r]
            for k in range(c):
                value -= L[r, k] * L[c, k]
            if r != c:
                L[r, c] = value / L[c, c]
            elif value > 0.0:
                L[r, r] = np.sqrt(value)
            else:
                into[:size] = np.inf
                return np.inf
        value = residual[first + r]
        for k in range(r):
            value -= L[r, k] * into[k]
        into[r] = value / L[r, r]
        total += into[r] ** 2
    return total


@kernel
def gated(
    residual: Array1, covariance: Array2, variance: Array1, starts: Indices1, sizes: Indices1, limits: Array1
) -> tuple[Array1, Array1, Mask1, Mask1, Array2]:
    """Test the innovations of K measurements, each by its own block of the covariance.

    Args:
        residual: innovations (m,).
        covariance: of the predicted measurements (m, m).
        variance: of the measurements (m,).
        starts, sizes: first row and number of rows of each measurement (K,).
        limits: gates (normalised innovation squared) by the number of rows.

    Returns:
        Normalised innovations (m,), their mean square by measurement (K,), the measurements that pass (K,), the rows
        that pass (m,): of a rejected measurement with pose and motion, the one that passes alone. A drifting position,
        say, comes with a true velocity. And the test ratios (K, 2) of pose and motion, normalised innovation squared
        over its gate: the smaller of the measurement's and its own, so that above 1 it is rejected; in measurements of
        3 rows or fewer both are the measurement's.
    """
    normalised, mean_squares, ratios = np.empty(len(residual)), np.empty(len(starts)), np.empty((len(starts), 2))
    accepted, rows, half = np.empty(len(starts), np.bool_), np.zeros(len(residual), np.bool_), np.empty(3)
    for j in range(len(starts)):
        first, size = starts[j], sizes[j]
        square = _normalise(residual, covariance, variance, first, size, normalised[first : first + size])
        mean_squares[j] = square / size if square == square else np.inf
        accepted[j] = square <= limits[size]
        rows[first : first + size] = accepted[j]
        ratios[j] = square / limits[size] if square == square else np.inf
        if size > 3:
            part = size // 2
            for c in range(2):
                begin = first + c * part
                square = _normalise(residual, covariance, variance, begin, part, half)
                if not accepted[j]:
                    rows[begin : begin + part] = square <= limits[part]
                ratios[j, c] = min(ratios[j, c], square / limits[part] if square == square else np.inf)
    return normalised, mean_squares, accepted, rows, ratios


@kernel
def mean_products(normalised: Array1, last: Array1, accepted: Mask1, of_payload: Mask1) -> tuple[float, float]:
    """Return the mean product of two normalised innovations (m,), over the payload's rows and over the UAVs'.

    Args:
        normalised, last: innovations of two consecutive moments (m,).
        accepted: rows that count (m,); nan where there are none.
        of_payload: rows of the payload unit (m,).
    """
    total, count = np.zeros(2), np.zeros(2)
    for r in range(len(normalised)):
        if accepted[r]:
            part = 0 if of_payload[r] else 1
            total[part] += normalised[r] * last[r]
            count[part] += 1.0
    return total[0] / count[0], total[1] / count[1]
