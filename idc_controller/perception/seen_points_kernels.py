"""Points of a body that were seen in the last frames, in a frame of reference that moves with it, compiled.

A row is the time (s), the place (3,) relative to the body's reference point, and the distance by which noise alone puts
the point outside (m).
"""

import math

import numpy as np

from idc_controller.arrays import Array1, Array2
from idc_controller.compiled import kernel
from idc_controller.geometry.distance_kernels import distance_to


@kernel
def remembered(
    seen: Array2,
    since: float,
    time: float,
    points: Array2,
    reference: Array1,
    pose_variance: Array1,
    variance: float,
    scatter: float,
    deviations: float,
) -> Array2:
    """Return the rows ``seen`` (m, 5) that are not before ``since`` (s), and those of a frame at ``time`` (s).

    Args:
        seen: rows of frames before.
        since: s.
        time: s.
        points: of the frame (n, 3), world (m).
        reference: reference point of the body (3,).
        pose_variance, variance, scatter: variances (m2) of the points on any axis, of each (n,) and of all.
        deviations: standard deviations that are noise.
    """
    first = 0
    while first < seen.shape[0] and seen[first, 0] < since:
        first += 1
    kept = seen.shape[0] - first
    rows = np.empty((kept + points.shape[0], 5))
    for i in range(kept):
        for k in range(5):
            rows[i, k] = seen[first + i, k]
    for i in range(points.shape[0]):
        rows[kept + i, 0] = time
        for k in range(3):
            rows[kept + i, 1 + k] = points[i, k] - reference[k]
        rows[kept + i, 4] = deviations * math.sqrt(variance + pose_variance[i] + scatter)
    return rows


@kernel
def distances_outside(seen: Array2, body: Array2, centre: Array1) -> Array1:
    """Return how far each of the points ``seen`` (n, 5) lies outside of a body, beyond its noise (n,) (m).

    Args:
        seen: rows.
        body: see :mod:`idc_controller.geometry.distance_kernels` (1, 14).
        centre: of the body, relative to its reference point (3,).
    """
    outside = np.empty(seen.shape[0])
    for i in range(seen.shape[0]):
        x, y, z = seen[i, 1] - centre[0], seen[i, 2] - centre[1], seen[i, 3] - centre[2]
        outside[i] = distance_to(body, 0, x, y, z) - seen[i, 4]
    return outside
