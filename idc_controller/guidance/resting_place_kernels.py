"""Clearance of the formation on its path to rest and below it, for many ways to brake, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array1, Array2, Array3
from idc_controller.compiled import kernel
from idc_controller.geometry.distance_kernels import distance_to
from idc_controller.trajectory.stop_plan_kernels import point_on_quartic


@kernel
def least_distances(
    control: Array3,
    durations: Array1,
    elapsed: Array1,
    axis: Array1,
    step: float,
    bodies: Array2,
    reach: Array1,
    centres: Array3,
    growth: Array2,
    limit: float,
) -> Array1:
    """Return the least distance (m) of points to obstacles for each of C paths (C,), at most ``limit`` (m).

    The points are those of the formation's upright axis on its path, each at its own moment, and from the place of
    rest down to the ground at all moments. SI, NED.

    Args:
        control: control points of the paths to rest (C, 5, 3).
        durations: of the paths (C,).
        elapsed: moments since the paths began (K,).
        axis: points of the upright axis, down from the payload's centre, the highest first (A,).
        step: between points below the place of rest.
        bodies: obstacles (O, 14), see :mod:`idc_controller.geometry.distance_kernels`.
        reach: radius of the ball that holds each of them (O,).
        centres: of the obstacles at the moments (O, K, 3).
        growth: of them (O, K).
        limit: distances above it are not distinguished.
    """
    moments, count = elapsed.shape[0], bodies.shape[0]
    least = np.full(control.shape[0], limit)
    half = max(abs(axis[0]), abs(axis[-1]))
    place = np.empty((moments, 3))
    for c in range(control.shape[0]):
        for k in range(moments):
            share = min(elapsed[k] / durations[c], 1.0)
            for i in range(3):
                place[k, i] = point_on_quartic(control[c], share, i)
        north, east = place[-1, 0], place[-1, 1]
        top = min(place[-1, 2] + axis[0], 0.0)
        below = math.ceil(-top / step)
        for b in range(count):
            for k in range(moments):
                x, y, z = place[k, 0] - centres[b, k, 0], place[k, 1] - centres[b, k, 1], place[k, 2] - centres[b, k, 2]
                if math.sqrt(x * x + y * y + z * z) - half - reach[b] - growth[b, k] < least[c]:
                    for height in axis:
                        least[c] = min(least[c], distance_to(bodies, b, x, y, z + height) - growth[b, k])
                if k and growth[b, k] == growth[b, k - 1] and (centres[b, k] == centres[b, k - 1]).all():
                    continue  # where it was a moment before, it is as far from the points below
                x, y = north - centres[b, k, 0], east - centres[b, k, 1]
                if math.sqrt(x * x + y * y) - reach[b] - growth[b, k] < least[c]:
                    for i in range(below):
                        apart = distance_to(bodies, b, x, y, top + i * step - centres[b, k, 2])
                        least[c] = min(least[c], apart - growth[b, k])
    return least
