"""The filter that turns a path flown at constant speed into one within limits of acceleration up to crackle.

A path sampled at an interval is averaged by three boxes and used as control points of a spline of degree 5.
Averages stay in the convex hull, so nothing overshoots. Three boxes in the right proportion need about two
thirds of the time of the plain spline for the same snap.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from idc_controller.arrays import Array
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.spline import SUPPORT, evaluate

TURN = 2.0**0.5
"""Change of velocity, in full speeds, that holds the limits without a pause: a right angle."""
SHORTEST_INTERVAL = 0.02
"""s; looser limits than this could use are not used."""
MOST_SAMPLES = 12
"""Samples of the three boxes together: more would gain little time and cost planning time."""
SETTLED = 0.4e-3
"""m, of either the motion before or after a pause, beyond which a hold does not count."""


@dataclass(frozen=True)
class Smoothing:
    """``interval`` s between samples; ``weights`` (n,) of the averages, sum 1; ``settling`` see below."""

    interval: float
    weights: Array
    settling: float
    """s before the (delayed) end of a motion at full speed is reached to ``SETTLED``."""

    @property
    def reach(self) -> int:
        """Samples over which one sample acts on the trajectory."""
        return len(self.weights) - 1 + SUPPORT

    @property
    def delay(self) -> float:
        """Mean delay of the trajectory after the path as sampled, s, if sample 1 acts from time 0 on."""
        return self.interval * (self.reach / 2.0 - 1.0)

    def control_points(self, samples: Array) -> Array:
        """Averages (M - n + 1, 3) of samples (M, 3), each over itself and the n - 1 before it."""
        windows = np.lib.stride_tricks.sliding_window_view(samples, len(self.weights), axis=0)
        # Relative to one sample: rest stays exactly rest.
        newest = windows[..., -1:]
        return np.asarray(newest[..., 0] + (windows - newest) @ self.weights)


@lru_cache(maxsize=16)
def smoothing_for(limits: Limits) -> Smoothing:
    """The shortest filter that holds the limits for any start, stop or right angle at ``limits.speed``."""
    best: tuple[float, float, Array] | None = None
    for a in range(1, MOST_SAMPLES):
        for b in range(1, min(a, MOST_SAMPLES - a) + 1):
            for c in range(1, min(b, MOST_SAMPLES - a - b) + 1):
                weights = np.convolve(np.convolve(np.full(a, 1 / a), np.full(b, 1 / b)), np.full(c, 1 / c))
                interval = _interval(weights, limits)
                duration = interval * (len(weights) - 1 + SUPPORT)
                if best is None or duration < best[0] * (1 - 1e-9):
                    best = duration, interval, weights
    assert best is not None  # the loops run at least once
    _, interval, weights = best
    weights.setflags(write=False)
    return Smoothing(interval, weights, _settling(interval, weights, limits.speed))


def _interval(weights: Array, limits: Limits) -> float:
    """The interval at which a right angle at full speed holds acceleration, jerk, snap and crackle."""
    shortest = SHORTEST_INTERVAL
    differences = weights
    for power, limit in enumerate(limits.as_array()[1:].tolist(), start=1):
        needed = TURN * limits.speed * np.abs(differences).max() / (0.999 * limit)
        shortest = max(shortest, float(needed ** (1.0 / power)))
        differences = np.diff(np.concatenate([[0.0], differences, [0.0]]))
    return shortest


def _settling(interval: float, weights: Array, speed: float) -> float:
    reach = len(weights) - 1 + SUPPORT
    samples = np.arange(-3.0 * reach, 3.0 * reach).clip(max=0.0)[:, None] * [1.0, 0.0, 0.0]
    smooth = Smoothing(interval, weights, 0.0).control_points(samples)
    arguments = np.linspace(2 * reach, 5 * reach, 60 * reach + 1)
    distance = -evaluate(smooth, interval, arguments, 0)[0, :, 0] * speed * interval
    settled = arguments[np.flatnonzero(distance > SETTLED)[-1] + 1] if (distance > SETTLED).any() else 0.0
    # Sample 3 * reach is the first at rest; control point j needs samples j .. j + n - 1.
    stopped = 3 * reach - (len(weights) - 1) + reach / 2.0
    return max(0.0, (settled - stopped) * interval)
