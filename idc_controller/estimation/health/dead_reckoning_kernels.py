"""Compiled kernels of dead reckoning; see :mod:`idc_controller.estimation.health.dead_reckoning`."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel

_MEDIAN_EFFICIENCY = 1.2533  # standard deviation of a median of n, times sqrt(n), over that of one sample
_FROM_STEPS = 1.4826 / 2.0**0.5  # standard deviation of a sample over the median step from one to the next


@inlined
def _median(values: Array) -> float:
    """Return the median of finite ``values`` (K,)."""
    ordered, half = np.sort(values), len(values) // 2
    return float(ordered[half] if len(values) % 2 else (ordered[half - 1] + ordered[half]) / 2.0)


@inlined
def _turn(attitude: Array, duration: float, rates: Array) -> None:
    """Turn ``attitude`` (4,), w first, in place by body ``rates`` (3,) (rad/s) for a short ``duration`` (s)."""
    w, x, y, z = attitude
    p, q, r = 0.5 * duration * rates[0], 0.5 * duration * rates[1], 0.5 * duration * rates[2]
    attitude[0] = w - x * p - y * q - z * r
    attitude[1] = x + w * p + y * r - z * q
    attitude[2] = y + w * q + z * p - x * r
    attitude[3] = z + w * r + x * q - y * p
    attitude /= np.sqrt((attitude * attitude).sum())


@kernel(
    "void(float64[:, ::1], float64[::1], float64[::1], float64, Array(float64, 1, 'C', readonly=True), float64[::1])"
)
def integrate(motions: Array, motion: Array, integral: Array, duration: float, pose: Array, difference: Array) -> None:
    """Integrate the median motion, and take the difference of a pose and the integral.

    Args:
        motions: of the last samples (S, 3), velocities (m/s, world) or body rates (rad/s).
        motion: median motion until now (3,); replaced by the new one.
        integral: path (3,) (m) or attitude (4,), w first, body to world; continued over the duration.
        duration: since the last one (s); 0 at the first.
        pose: measured position (3,) or attitude (4,).
        difference: of pose and integral (3,): a path (m) or a rotation vector in the world, as long as it is small
            (rad). Filled.
    """
    mean = np.empty(3)
    for c in range(3):
        median = _median(motions[:, c].copy())
        mean[c] = 0.5 * (motion[c] + median)
        motion[c] = median
    if len(integral) == 3:
        for c in range(3):
            integral[c] += duration * mean[c]
            difference[c] = pose[c] - integral[c]
        return
    if duration > 0.0:
        _turn(integral, duration, mean)
    w, x, y, z = integral
    a, b, c, d = pose
    twice = 2.0 if a * w + b * x + c * y + d * z >= 0.0 else -2.0
    difference[0] = twice * (b * w - a * x - c * z + d * y)
    difference[1] = twice * (c * w - a * y - d * x + b * z)
    difference[2] = twice * (d * w - a * z - b * y + c * x)


@kernel("float64(float64[:, ::1], int64, float64, float64)")
def drift_ratio(window: Array, n: int, error: float, sigmas: float) -> float:
    """Return how far differences have moved over the window, over what is allowed; the largest of the axes.

    One that is not a number is inf: no evidence of consistency.

    Args:
        window: differences of poses and integrated motions, in order of time, each after its time (K, 4) (m or rad).
        n: samples at either end whose medians are compared.
        error: allowed of the integrated motion (m or rad).
        sigmas: standard deviations of the medians' difference allowed beside it; the noise follows from the steps
            between consecutive differences.
    """
    of_medians = _MEDIAN_EFFICIENCY / n**0.5 * 2.0**0.5
    worst = 0.0
    for c in range(1, window.shape[1]):
        values = window[:, c].copy()
        moved = abs(_median(values[-n:]) - _median(values[:n]))
        sigma = _FROM_STEPS * _median(np.abs(values[1:] - values[:-1]))
        ratio = moved / (error + sigmas * of_medians * sigma)
        if ratio != ratio:
            return np.inf
        worst = max(worst, ratio)
    return worst
