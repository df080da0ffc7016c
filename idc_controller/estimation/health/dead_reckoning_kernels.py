"""Compiled kernel of dead reckoning; see :mod:`idc_controller.estimation.health.dead_reckoning`."""

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


@kernel("float64(float64[:, ::1], int64, float64, float64)")
def drift_ratio(differences: Array, n: int, error: float, sigmas: float) -> float:
    """Return how far differences have moved over the window, over what is allowed; the largest of the axes.

    Args:
        differences: of poses and integrated motions, in order of time (K, 3) (m or rad).
        n: samples at either end whose medians are compared.
        error: allowed of the integrated motion (m or rad).
        sigmas: standard deviations of the medians' difference allowed beside it; the noise follows from the steps
            between consecutive differences.
    """
    of_medians = _MEDIAN_EFFICIENCY / n**0.5 * 2.0**0.5
    worst = 0.0
    for c in range(differences.shape[1]):
        values = differences[:, c].copy()
        moved = abs(_median(values[-n:]) - _median(values[:n]))
        sigma = _FROM_STEPS * _median(np.abs(values[1:] - values[:-1]))
        worst = max(worst, moved / (error + sigmas * of_medians * sigma))
    return worst
