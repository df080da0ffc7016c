"""Kernel of the load adaptation; see :mod:`idc_controller.control.load_adaptation`. N UAVs, NED, SI."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import inlined, kernel


@inlined
def _limiting(vector: Array, limit: float) -> float:
    """Return the factor that shortens ``vector`` (3,) to ``limit`` if it is longer."""
    norm = math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
    return limit / norm if norm > limit else 1.0


@kernel(
    "Tuple((float64[::1], float64[:, ::1]))"
    "(float64[::1], float64[:, ::1], float64[::1], float64[:, ::1], float64[::1], float64[::1], float64[::1], "
    "float64[::1], float64, float64, float64)"
)
def followed_forces(
    force: Array,
    uav_force: Array,
    estimated: Array,
    uav_estimated: Array,
    drag_before: Array,
    uav_drag_before: Array,
    drag: Array,
    uav_drag: Array,
    share: float,
    limit: float,
    uav_limit: float,
) -> tuple[Array, Array]:
    """Return the constant forces on the payload (3,) and on the UAVs (N, 3) (N) that follow the estimated ones.

    Args:
        force, uav_force: constant forces so far (3,), (N, 3) (N).
        estimated, uav_estimated: estimated forces (3,), (N, 3) (N), drag and all.
        drag_before, uav_drag_before: drag that came on top so far, on the payload and on each UAV (3,) (N).
        drag, uav_drag: drag that comes on top from now on (3,) (N): it changes what is left over, not the whole.
        share: of the difference that is followed.
        limit, uav_limit: of the estimated forces (N).
    """
    followed, uav_followed = np.empty(3), np.empty_like(uav_force)
    factor = _limiting(estimated, limit)
    for c in range(3):
        rest = (force[c] + drag_before[c]) - drag[c]
        followed[c] = rest + share * (estimated[c] * factor - drag[c] - rest)
    for i in range(len(uav_force)):
        factor = _limiting(uav_estimated[i], uav_limit)
        for c in range(3):
            rest = (uav_force[i, c] + uav_drag_before[c]) - uav_drag[c]
            uav_followed[i, c] = rest + share * (uav_estimated[i, c] * factor - uav_drag[c] - rest)
    return followed, uav_followed
