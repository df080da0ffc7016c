"""Points of the formation's hull, compiled."""

import numpy as np

from idc_controller.arrays import Array1, Array2, Array3
from idc_controller.compiled import kernel


@kernel
def hull_points(
    corners: Array2, rims: Array3, hover_offsets: Array2, lengths: Array1, g: float, acceleration: Array2
) -> Array3:
    """Return the points about the payload's centre whose hull is the formation (K, C + N R, 3) (m).

    Args:
        corners: of the payload about its centre (C, 3) (m).
        rims: points on the rims of the discs about their centres (N, R, 3) (m).
        hover_offsets: UAVs from the payload's centre in hover (N, 3) (m).
        lengths: of the links (N,) (m).
        g: gravity (m/s2).
        acceleration: of the payload (K, 3).
    """
    number, rim = rims.shape[0], rims.shape[1]
    points = np.empty((len(acceleration), len(corners) + number * rim, 3))
    for k in range(len(acceleration)):
        for c in range(len(corners)):
            for axis in range(3):
                points[k, c, axis] = corners[c, axis]
        for i in range(number):
            lever = lengths[i] / max(g - acceleration[k, 2], 0.2 * g)
            for axis in range(3):
                offset = hover_offsets[i, axis]
                if axis < 2:
                    offset += lever * acceleration[k, axis]
                for r in range(rim):
                    points[k, len(corners) + i * rim + r, axis] = offset + rims[i, r, axis]
    return points
