"""Arrays of the standing map's voxels, which grow with the space that was seen."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.perception.return_kernels import capacity_for, enter_pages
from idc_controller.perception.voxel_kernels import BLOCKS, CELLS, COLUMNS, EDGE, PAGE_BLOCKS, PAGES, USED, Voxels

_FIRST_PAGES, _FIRST_BLOCKS, _FIRST_ELEMENTS = 16, 4096, 4096


class VoxelStore:
    """The :class:`~idc_controller.perception.voxel_kernels.Voxels` of a map."""

    def __init__(self, voxel: float) -> None:
        """``voxel``: edge of a voxel (m)."""
        self._block = EDGE * voxel
        self.arrays = Voxels(
            table=np.full((4 * _FIRST_PAGES, 2), -1),
            pages=np.full((_FIRST_PAGES, PAGE_BLOCKS), -1, dtype=np.int32),
            blocks=np.zeros((_FIRST_BLOCKS, 4), dtype=np.int64),
            cells=np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.uint8),
            links=np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.int32),
            elements=np.zeros((_FIRST_ELEMENTS, COLUMNS)),
            counts=np.zeros(5, dtype=np.int64),
        )

    def reserve(self, origin: Array, returns: Array, free: Array) -> None:
        """Reserve capacity for all that a scan from ``origin`` (3,) can add.

        ``returns`` (n, 3) and ends of ``free`` rays (m, 3), NED (m).
        """
        blocks, pages = capacity_for(origin, returns, free, self._block)
        v, number = self.arrays, self.arrays.counts.tolist()
        if number[PAGES] + pages > len(v.pages):
            grown = _grown(v.pages, number[PAGES] + pages, -1)
            v = v._replace(pages=grown, table=np.full((4 << (len(grown) - 1).bit_length(), 2), -1))
            enter_pages(v.table, v.pages, v.blocks, number[PAGES])
        if (rows := number[BLOCKS] + blocks) > len(v.blocks):
            v = v._replace(blocks=_grown(v.blocks, rows), cells=_grown(v.cells, rows), links=_grown(v.links, rows))
        if (rows := number[USED] + len(returns)) > len(v.elements):
            v = v._replace(elements=_grown(v.elements, rows))
        self.arrays = v


def _grown(rows: NDArray[Any], count: int, value: int = 0) -> NDArray[Any]:
    """Return ``rows`` with ``count`` of them or more, at least twice as many as before."""
    shape = max(count, 2 * len(rows)), *rows.shape[1:]
    # Zeros take no memory until they are written to.
    grown = np.full(shape, value, dtype=rows.dtype) if value else np.zeros(shape, dtype=rows.dtype)
    grown[: len(rows)] = rows
    return grown
