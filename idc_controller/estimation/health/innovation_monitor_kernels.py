"""Compiled kernels of the innovation monitor; see :mod:`idc_controller.estimation.health.innovation_monitor`."""

import numpy as np

from idc_controller.arrays import Array1, Array2, Indices1, Mask1
from idc_controller.compiled import kernel


@kernel
def running_means(
    time: float, which: Indices1, sizes: Indices1, innovations: Array1, gates: Array1, share: float,
    mean: Array2, square: Array2, last: Array1,
) -> Mask1:  # fmt: skip
    """Update the running means of S sensors in place; return which of K measurements are new (K,).

    Args:
        time: of the measurements (s).
        which: sensor of each measurement (K,).
        sizes: rows of each (K,).
        innovations: normalised, one measurement after the other (m,); nan counts as 0.
        gates: largest squares that count, by the number of rows (7,).
        share: of one sample in the running means.
        mean: running means of the innovations, each channel in a half (S, 6).
        square: running means of the mean squares of all rows and of each channel (S, 3).
        last: time of the last measurement of each sensor (S,) (s).
    """
    new = np.empty(len(which), np.bool_)
    first = 0
    for j in range(len(which)):
        at, size = which[j], sizes[j]
        bound = np.sqrt(gates[size])
        new[j] = time > last[at]
        if new[j]:
            last[at] = time
            rows = size // 2 if size > 3 else size
            squares = np.zeros(3)
            for c in range(size):
                value = min(max(innovations[first + c], -bound), bound)
                if value != value:
                    value = 0.0
                part = c // rows
                mean[at, 3 * part + c % rows] += share * (value - mean[at, 3 * part + c % rows])
                squares[0] += value * value
                squares[1 + part] += value * value
            square[at, 0] += share * (min(squares[0], gates[size]) / size - square[at, 0])
            for part in range(1, 3):
                square[at, part] += share * (min(squares[part], gates[rows]) / rows - square[at, part])
        first += size
    return new
