"""Steps of the interacting multiple model filter of one obstacle, compiled.

M models, on each of three axes a state (position, velocity, acceleration); SI, NED. See
:mod:`idc_controller.perception.motion_imm`.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Array3, Array4
from idc_controller.compiled import inlined, kernel

_LOG_2PI = math.log(2.0 * math.pi)


@inlined
def _mixed(weight: Array, x: Array, P: Array, change: float) -> tuple[Array, Array, Array]:
    """Mix states (M, axis, 3) and covariances (M, axis, 3, 3) of models, of whose weight a share ``change`` moves."""
    m = weight.shape[0]
    shares, total = np.empty((m, m)), np.zeros(m)
    for i in range(m):
        for j in range(m):
            shares[i, j] = weight[i] * (change / (m - 1) + (1.0 - change - change / (m - 1) if i == j else 0.0))
            total[j] += shares[i, j]
    # Second moments about a common point, so that little is lost in the difference of large numbers.
    common = np.zeros((3, 3))
    for i in range(m):
        common += weight[i] * x[i]
    new_x, new_P = np.zeros_like(x), np.zeros_like(P)
    for j in range(m):
        for i in range(m):
            share = shares[i, j] / total[j]
            for axis in range(3):
                for a in range(3):
                    apart = x[i, axis, a] - common[axis, a]
                    new_x[j, axis, a] += share * apart
                    for b in range(3):
                        new_P[j, axis, a, b] += share * (P[i, axis, a, b] + apart * (x[i, axis, b] - common[axis, b]))
        for axis in range(3):
            for a in range(3):
                for b in range(3):
                    new_P[j, axis, a, b] -= new_x[j, axis, a] * new_x[j, axis, b]
        for axis in range(3):
            for a in range(3):
                new_x[j, axis, a] += common[axis, a]
    return total, new_x, new_P


@kernel
def advanced(
    weight: Array1, x: Array3, P: Array4, F: Array3, Q: Array3, change: float
) -> tuple[Array1, Array3, Array4]:
    """Mix and predict all models over one step.

    Args:
        weight: of the models (M,).
        x: their states (M, axis, 3).
        P: covariances of these (M, axis, 3, 3).
        F: transition over the step (M, 3, 3).
        Q: process noise (M, 3, 3).
        change: share of a model's weight that moves to the others.

    Returns:
        Weight, states and covariances after the step.
    """
    weight, x, P = _mixed(weight, x, P, change)
    FP = np.empty((3, 3))
    for m in range(weight.shape[0]):
        for axis in range(3):
            old, covariance = x[m, axis].copy(), P[m, axis]
            for a in range(3):
                x[m, axis, a] = F[m, a, 0] * old[0] + F[m, a, 1] * old[1] + F[m, a, 2] * old[2]
                for b in range(3):
                    FP[a, b] = (
                        F[m, a, 0] * covariance[0, b] + F[m, a, 1] * covariance[1, b] + F[m, a, 2] * covariance[2, b]
                    )
            for a in range(3):
                for b in range(3):
                    P[m, axis, a, b] = (
                        FP[a, 0] * F[m, b, 0] + FP[a, 1] * F[m, b, 1] + FP[a, 2] * F[m, b, 2] + Q[m, a, b]
                    )
    return weight, x, P


@kernel
def updated(
    weight: Array1, x: Array3, P: Array4, position: Array1, variance: Array1
) -> tuple[Array1, Array3, Array4, float]:
    """Correct all models by a ``position`` (3,) (m; nan: not measured) of that ``variance`` (3,) (m2).

    ``weight`` (M,), states ``x`` (M, axis, 3) and covariances ``P`` (M, axis, 3, 3).

    Returns:
        Weight, states and covariances after it, and the mixture's squared innovation over its variance, mean over
        the measured axes.
    """
    m = weight.shape[0]
    weight, x, P = weight.copy(), x.copy(), P.copy()
    likelihood = np.zeros(m)
    squared, measured = 0.0, 0
    for axis in range(3):
        if not math.isfinite(position[axis]):
            continue
        measured += 1
        expected, spread = 0.0, 0.0
        for i in range(m):
            expected += weight[i] * x[i, axis, 0]
        for i in range(m):
            spread += weight[i] * (P[i, axis, 0, 0] + (x[i, axis, 0] - expected) ** 2)
        squared += (position[axis] - expected) ** 2 / (spread + variance[axis])
        for i in range(m):
            S, y = P[i, axis, 0, 0] + variance[axis], position[axis] - x[i, axis, 0]
            likelihood[i] -= 0.5 * (y**2 / S + math.log(S) + _LOG_2PI)
            row = P[i, axis, 0].copy()
            for a in range(3):
                gain = P[i, axis, a, 0] / S
                x[i, axis, a] += gain * y
                for b in range(3):
                    P[i, axis, a, b] -= gain * row[b]
    best, total = likelihood.max(), 0.0
    for i in range(m):
        weight[i] *= math.exp(max(likelihood[i] - best, -50.0))
        total += weight[i]
    weight = np.maximum(weight, 1e-6 * total)
    return weight / weight.sum(), x, P, squared / max(measured, 1)


@kernel
def predicted(weight: Array1, x: Array3, P: Array4, F: Array4, Q: Array4) -> tuple[Array2, Array3]:
    """Return mean (K, 3) (m) and covariance (K, 3, 3) (m2) of the mixture's position at K moments.

    ``weight`` (M,), states ``x`` (M, axis, 3) and covariances ``P`` (M, axis, 3, 3) now; transitions ``F`` and noise
    ``Q`` (M, K, 3, 3) until the moments.
    """
    m, count = weight.shape[0], F.shape[1]
    mean, covariance = np.zeros((count, 3)), np.zeros((count, 3, 3))
    means, apart = np.empty((m, 3)), np.empty(3)
    for k in range(count):
        for i in range(m):
            f0, f1, f2 = F[i, k, 0, 0], F[i, k, 0, 1], F[i, k, 0, 2]
            for axis in range(3):
                means[i, axis] = f0 * x[i, axis, 0] + f1 * x[i, axis, 1] + f2 * x[i, axis, 2]
                mean[k, axis] += weight[i] * means[i, axis]
                p = P[i, axis]
                variance = Q[i, k, 0, 0] + (
                    f0 * (f0 * p[0, 0] + f1 * p[0, 1] + f2 * p[0, 2])
                    + f1 * (f0 * p[1, 0] + f1 * p[1, 1] + f2 * p[1, 2])
                    + f2 * (f0 * p[2, 0] + f1 * p[2, 1] + f2 * p[2, 2])
                )
                covariance[k, axis, axis] += weight[i] * variance
        for i in range(m):
            for axis in range(3):
                apart[axis] = means[i, axis] - mean[k, axis]
            for a in range(3):
                for b in range(3):
                    covariance[k, a, b] += weight[i] * apart[a] * apart[b]
    return mean, covariance
