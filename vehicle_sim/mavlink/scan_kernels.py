"""Nearest returns of a scan by sectors about the vehicle, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array2, Indices1
from idc_controller.compiled import kernel


@kernel
def nearest_by_sector(points: Array2, sectors: int, none: int) -> Indices1:
    """Return the distance (sectors,) (cm, rounded down) of the nearest return in each sector, ``none`` without.

    Args:
        points: returns in the body frame, forward-right-down (n, 3) (m); those that are not finite are passed over.
        sectors: their number, of equal width, clockwise, the middle of the first ahead.
        none: larger than any distance.
    """
    nearest = np.full(sectors, none)
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        distance = math.sqrt(x * x + y * y + z * z)
        if not distance < math.inf:
            continue
        sector = round(math.atan2(y, x) / (2.0 * math.pi) * sectors) % sectors
        nearest[sector] = min(nearest[sector], int(min(100.0 * distance, none - 1.0)))
    return nearest
