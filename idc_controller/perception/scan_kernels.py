"""Which returns are possible, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.compiled import kernel


@kernel("int64[::1](float64[:, ::1], float64[::1], float64)")
def possible_points(body: Array, max_range: Array, factor: float) -> Indices:
    """Return which of the points in the body frame (n, 3) a sensor of ``max_range`` (n,) can have detected.

    Those that are finite, not at its own place, and nearer than ``factor`` times its range (m).
    """
    n = body.shape[0]
    found, count = np.empty(n, np.int64), 0
    for p in range(n):
        distance = math.sqrt(body[p, 0] ** 2 + body[p, 1] ** 2 + body[p, 2] ** 2)
        if math.isfinite(max_range[p]) and 0.0 < distance < factor * max_range[p]:
            found[count] = p
            count += 1
    return found[:count].copy()
