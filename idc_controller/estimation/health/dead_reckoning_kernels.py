"""Compiled kernels of dead reckoning; see :mod:`idc_controller.estimation.health.sensor_health`."""

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Array3, Const1, Indices1, Indices2, Mask1
from idc_controller.compiled import inlined, kernel

_MEDIAN_EFFICIENCY = 1.2533  # standard deviation of a median of n, times sqrt(n), over that of one sample
_FROM_STEPS = 1.4826 / 2.0**0.5  # standard deviation of a sample over the median step from one to the next


@inlined
def _median(values: Array) -> float:
    """Return the median of finite ``values`` (K,)."""
    ordered, half = values.copy(), len(values) // 2
    for k in range(1, len(ordered)):  # by insertion: so few are sorted sooner than by numba's quicksort
        value, at = ordered[k], k
        while at > 0 and ordered[at - 1] > value:
            ordered[at] = ordered[at - 1]
            at -= 1
        ordered[at] = value
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


@kernel
def integrate(
    motions: Array2, motion: Array1, integral: Array1, duration: float, pose: Const1, difference: Array1
) -> None:
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


@kernel
def drift_ratio(window: Array2, n: int, error: float, sigmas: float) -> float:
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


@kernel
def reckon(
    times: Const1, sources: Indices1, is_position: Mask1, values: Const1,
    vehicles: int, window: float, gap: float, n: int, position_error: float, attitude_error: float, sigmas: float,
    recent: Array3, motion: Array2, integral: Array2, differences: Array3, counts: Indices2, ratio: Array1,
) -> tuple[int, int]:  # fmt: skip
    """Take the poses and motions of one moment, and test the sources that have enough new ones.

    Late ones, repetitions, those that lack either part, and vehicles' attitudes are passed over. The rows of the S
    sources are the vehicles' positions, then position and attitude of the payload unit.

    Args:
        times: of the measurements (K,) (s).
        sources: UAV (K,), or negative for the payload.
        is_position: whether each is a position; else it is an attitude (K,).
        values: poses and motions, one measurement after the other.
        vehicles: number of vehicles N.
        window: over which poses are compared with their integrated motion (s).
        gap: without a sample after which the integration starts anew (s).
        n: samples whose median is compared.
        position_error, attitude_error: allowed of the integrated motion (m, rad).
        sigmas: see :func:`drift_ratio`.
        recent: last samples of each source (S, R, 8): time, pose, motion. This and all below are updated.
        motion: median motion (S, 3).
        integral: path (m), or attitude (S, 4).
        differences: of poses and integrated motions over the window, each after its time (S, C, 4).
        counts: of recent samples, begin and end of the window in its array, samples since the last test, failed tests
            in a row (S, 5).
        ratio: test ratios (S,); nan before the first sample.

    Returns:
        Length of the longest window, which must stay below C / 2, and the number of tests.
    """
    longest, tests, at = 0, 0, 0
    kept, capacity = recent.shape[1], differences.shape[1]
    for j in range(len(times)):
        size = 3 if is_position[j] else 4
        first, at = at, at + size + 3
        if sources[j] < 0:
            s = vehicles if is_position[j] else vehicles + 1
        elif is_position[j]:
            s = sources[j]
        else:
            continue
        if not np.isfinite(values[first:at].sum()):
            continue
        count, samples = counts[s], recent[s]
        if count[0]:
            last = samples[count[0] - 1]
            if times[j] <= last[0]:
                continue
            repeated = True
            for c in range(size + 3):
                repeated = repeated and last[1 + c] == values[first + c]
            if repeated:
                continue  # a relay of the same sample by a vehicle whose clock is off brings nothing new
            if times[j] - last[0] > gap:
                count[:3] = 0
        elif ratio[s] != ratio[s]:
            ratio[s] = 0.0
            if size == 4:
                for c in range(4):
                    integral[s, c] = values[first + c]
        if count[0] == kept:
            for k in range(kept - 1):
                for c in range(samples.shape[1]):
                    samples[k, c] = samples[k + 1, c]
        else:
            count[0] += 1
        newest = samples[count[0] - 1]
        newest[0] = times[j]
        for c in range(size + 3):
            newest[1 + c] = values[first + c]
        if count[0] == kept:
            middle = samples[kept // 2]
            duration = middle[0] - samples[kept // 2 - 1, 0] if count[2] > count[1] else 0.0
            if count[2] == capacity:
                length = count[2] - count[1]
                for k in range(length):
                    for c in range(differences.shape[2]):
                        differences[s, k, c] = differences[s, count[1] + k, c]
                count[1], count[2] = 0, length
            row = differences[s, count[2]]
            count[2] += 1
            row[0] = middle[0]
            motions = samples[:, 1 + size : 4 + size].copy()
            integrate(motions, motion[s], integral[s, :size], duration, middle[1 : 1 + size], row[1:])
        while count[1] < count[2] and differences[s, count[1], 0] < times[j] - window:
            count[1] += 1
        longest = max(longest, count[2] - count[1])
        count[3] += 1
        if count[3] >= n // 2:
            count[3] = 0
            tests += 1
            ratio[s] = 0.0
            if count[2] - count[1] > 2 * n:
                error = position_error if is_position[j] else attitude_error
                ratio[s] = drift_ratio(differences[s, count[1] : count[2]], n, error, sigmas)
            count[4] = count[4] + 1 if ratio[s] > 1.0 else 0
    return longest, tests
