"""Arrays of the standing map's voxels, which grow with the space that was seen."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array, Cells, Indices, Links
from idc_controller.perception.return_kernels import capacity_for, enter_pages
from idc_controller.perception.voxel_kernels import BLOCKS, CELLS, COLUMNS, EDGE, PAGE_BLOCKS, PAGES, USED

_FIRST_PAGES, _FIRST_BLOCKS, _FIRST_ELEMENTS = 16, 4096, 4096


class VoxelStore:
    """The arrays that :mod:`idc_controller.perception.voxel_kernels` describes."""

    def __init__(self, voxel: float) -> None:
        """``voxel``: edge of a voxel (m)."""
        self._block = EDGE * voxel
        self.table: Indices = np.full((4 * _FIRST_PAGES, 2), -1)
        self.pages: Links = np.full((_FIRST_PAGES, PAGE_BLOCKS), -1, dtype=np.int32)
        self.blocks: Indices = np.zeros((_FIRST_BLOCKS, 4), dtype=np.int64)
        self.cells: Cells = np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.uint8)
        self.links: Links = np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.int32)
        self.elements: Array = np.zeros((_FIRST_ELEMENTS, COLUMNS))
        self.counts: Indices = np.zeros(5, dtype=np.int64)

    def reserve(self, origin: Array, returns: Array, free: Array) -> None:
        """Reserve capacity for all that a scan from ``origin`` (3,) can add.

        ``returns`` (n, 3) and ends of ``free`` rays (m, 3), NED (m).
        """
        blocks, pages = capacity_for(origin, returns, free, self._block)
        count = int(self.counts[PAGES])
        if count + pages > len(self.pages):
            self.pages = _grown(self.pages, count + pages, -1)
            self.table = np.full((4 << (len(self.pages) - 1).bit_length(), 2), -1)
            enter_pages(self.table, self.pages, self.blocks, count)
        if self.counts[BLOCKS] + blocks > len(self.blocks):
            rows = int(self.counts[BLOCKS]) + blocks
            self.blocks, self.cells = _grown(self.blocks, rows), _grown(self.cells, rows)
            self.links = _grown(self.links, rows)
        if self.counts[USED] + len(returns) > len(self.elements):
            self.elements = _grown(self.elements, int(self.counts[USED]) + len(returns))


def _grown(rows: NDArray[Any], count: int, value: int = 0) -> NDArray[Any]:
    """Return ``rows`` with ``count`` of them or more, at least twice as many as before."""
    shape = max(count, 2 * len(rows)), *rows.shape[1:]
    # Zeros take no memory until they are written to.
    grown = np.full(shape, value, dtype=rows.dtype) if value else np.zeros(shape, dtype=rows.dtype)
    grown[: len(rows)] = rows
    return grown
