"""Fit of spheres and poles to surface points, compiled: Gauss-Newton on distance to the surface, centre and radius.

``theta`` is the centre on 3 axes (sphere) or 2 (pole), then the radius (m). World frame, SI.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.surfaces.points import MEDIAN_OF_SQUARE, SCORE_CAP

_FARTHEST = 0.0025  # m2: from three times its root on, residuals count for less and less


@inlined
def _solved(A: Array, b: Array) -> Array:
    """Return the solution of A x = b for a symmetric positive definite A (n, n), b (n,), by its Cholesky factor."""
    n = b.shape[0]
    L, x = np.zeros((n, n)), b.copy()
    for i in range(n):
        for j in range(i + 1):
            total = A[i, j]
            for k in range(j):
                total -= L[i, k] * L[j, k]
            L[i, j] = math.sqrt(total) if i == j else total / L[j, j]
    for i in range(n):
        for k in range(i):
            x[i] -= L[i, k] * x[k]
        x[i] /= L[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= L[k, i] * x[k]
        x[i] /= L[i, i]
    return x


@inlined
def _median(values: Array) -> float:
    """Return the median of ``values`` (n,), as ``np.median``, which takes seconds to compile."""
    ordered, half, low, high = values.copy(), len(values) // 2, 0, len(values) - 1
    while low < high:  # quickselect
        pivot, i, j = ordered[(low + high) // 2], low, high
        while i <= j:
            while ordered[i] < pivot:
                i += 1
            while pivot < ordered[j]:
                j -= 1
            if i <= j:
                ordered[i], ordered[j] = ordered[j], ordered[i]
                i, j = i + 1, j - 1
        if half <= j:
            high = j
        elif half >= i:
            low = i
        else:
            break
    middle = ordered[half]
    if len(values) % 2 == 0:
        below = ordered[0]
        for i in range(1, half):
            below = max(below, ordered[i])
        middle = (below + middle) / 2.0
    return float(middle)


@inlined
def _residuals(
    points: Array, origins: Array, theta: Array, noise: float, own_variance: Array, scatter: float, H: Array
) -> tuple[Array, Array]:
    """Return the distances of points (n, 3) to the surface (n,), and their variance (n,).

    ``H`` (n, axes + 1) is filled with the derivatives of the distances by ``theta``.
    """
    n, axes = points.shape[0], theta.shape[0] - 1
    radius = theta[axes]
    residual, variance = np.empty(n), np.empty(n)
    d, ray = np.empty(axes), np.empty(axes)
    # Scatter across the surface puts points outside of it on average, the more so the smaller it is.
    outside = 0.5 * (axes - 1) * scatter / radius
    for p in range(n):
        length, apart = 0.0, 0.0
        for i in range(3):
            length += (points[p, i] - origins[p, i]) ** 2
        length = max(math.sqrt(length), 1e-6)
        for i in range(axes):
            d[i], ray[i] = points[p, i] - theta[i], (points[p, i] - origins[p, i]) / length
            apart += d[i] ** 2
        distance = max(math.sqrt(apart), 1e-3)
        incidence = 0.0
        for i in range(axes):
            H[p, i] = -d[i] / distance
            incidence -= H[p, i] * ray[i]
        H[p, axes] = -1.0
        variance[p] = (noise * incidence) ** 2 + own_variance[p]
        residual[p] = distance - radius - outside
        if scatter > 0.0:
            # Points that seem to be on the side hidden from all sensors are as far off as from the rim of the visible
            # one. Otherwise they would fit a body as well that is nearer by its width.
            flat, along, across = 0.0, 0.0, 0.0
            for i in range(axes):
                flat += ray[i] ** 2
            flat = max(math.sqrt(flat), 1e-6)
            for i in range(axes):
                along += d[i] * ray[i] / flat
            if along > 0.0:
                for i in range(axes):
                    across += (d[i] - along * ray[i] / flat) ** 2
                width = max(math.sqrt(across), 1e-3)
                out = width - radius
                distance = max(math.hypot(along, out), 1e-3)
                residual[p] = distance
                for i in range(axes):
                    sideways = d[i] - along * ray[i] / flat
                    H[p, i] = -(along * ray[i] / flat + out / width * sideways) / distance
                H[p, axes] = -out / distance
    return residual, variance


@kernel
def fitted_round(
    points: Array2,
    origins: Array2,
    pose_variance: Array1,
    expected: Array1,
    axes: int,
    radius: float,
    prior_variance: float,
    radius_variance: float,
    noise: float,
    scatter: float,
    model_variance: float,
    radius_min: float,
    radius_max: float,
    end_depth: float,
    end_share: float,
    iterations: int,
    free: int,
    close_enough: float,
) -> tuple[Array1, Array1, float, float, float, float]:
    """Fit a sphere or a pole to n points.

    Args:
        points: on the surface (n, 3).
        origins: of the sensors that detected them (n, 3).
        pose_variance: of each point on every axis (n,), by the pose of its sensor (m2).
        expected: place of the centre (3,).
        axes: 3 for a sphere, 2 for a pole.
        radius: expected (m).
        prior_variance: of the place on every axis (m2).
        radius_variance: of the radius (m2).
        noise: standard deviation along the line of sight (m).
        scatter: variance of the points beyond that of their sensors (m2).
        model_variance: of the surface about the shape (m2).
        radius_min, radius_max: bounds of the radius (m).
        end_depth, end_share: depth in a pole's side (m), and share of the radius beside it, from which on a point
            lies on its end.
        iterations: largest number of steps.
        free: number of quantities that the points determine.
        close_enough: size of a last step (m).

    Returns:
        Place of the centre (3,), its variances (3,), radius, its variance, and score and unexplained variance as in
        :class:`~idc_controller.perception.surfaces.points.Fit`. A pole's place is on the ground, of variance 0.
    """
    n, size, is_pole = points.shape[0], axes + 1, axes == 2
    own_variance = pose_variance + scatter + model_variance
    mean, prior = np.empty(size), np.full(size, 1.0 / prior_variance)
    for i in range(axes):
        mean[i] = expected[i]
    mean[axes], prior[axes] = radius, 1.0 / radius_variance
    theta, information, H = mean.copy(), np.empty((size, size)), np.empty((n, size))
    for _ in range(iterations):
        residual, variance = _residuals(points, origins, theta, noise, own_variance, scatter, H)
        information[:] = 0.0
        gradient = prior * (mean - theta)
        for p in range(n):
            weight = 1.0 / (variance[p] * (1.0 + residual[p] ** 2 / (9.0 * max(variance[p], _FARTHEST))))
            if is_pole and residual[p] < -end_depth - end_share * theta[axes]:
                weight = 0.0
            for i in range(size):
                gradient[i] -= weight * H[p, i] * residual[p]
                for j in range(size):
                    information[i, j] += weight * H[p, i] * H[p, j]
        for i in range(size):
            information[i, i] += prior[i]
        step = _solved(information, gradient)
        theta += step
        theta[axes] = min(max(theta[axes], radius_min), radius_max)
        if np.abs(step).max() < close_enough:
            break
    variances, unit = np.empty(size), np.zeros(size)
    for i in range(size):
        unit[:] = 0.0
        unit[i] = 1.0
        variances[i] = _solved(information, unit)[i]
    residual, variance = _residuals(points, origins, theta, noise, own_variance, scatter, H)
    if is_pole:
        # What lies inside the side must be the top: the highest points.
        highest = points[:, 2].min()
        for p in range(n):
            if residual[p] <= -end_depth - end_share * theta[axes]:
                residual[p] = min(-residual[p], points[p, 2] - highest)
    squared = residual**2
    score = np.minimum(squared / variance, SCORE_CAP).mean()
    excess = _median(squared) / MEDIAN_OF_SQUARE * n / max(n - free, 1) - _median(variance)
    place, spread = np.zeros(3), np.zeros(3)
    for i in range(axes):
        place[i], spread[i] = theta[i], variances[i]
    return place, spread, theta[axes], variances[axes], score, excess
