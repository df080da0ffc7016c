"""Arrays of the standing map's voxels, which grow with the space that was seen."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array, Cells, Indices, Links
from idc_controller.perception.standing_map_kernels import enter_pages
from idc_controller.perception.voxel_kernels import BLOCKS, CELLS, COLUMNS, EDGE, PAGE_BLOCKS, PAGE_EDGE, PAGES, USED

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

    def reserve(self, origin: Array, ends: Array, returns: int) -> None:
        """Make room for all that a scan can add, whose rays lead from ``origin`` (3,) to ``ends`` (n, 3) (m)."""
        if not len(ends):
            return
        extent = (np.abs(ends - origin).max(axis=0) / self._block).tolist()
        # Rays enter a block by one of its sides; an element has voxels about it in up to eight blocks.
        by_rays = len(ends) * (sum(extent) + 4.0) + 8.0 * returns
        blocks = math.ceil(min(by_rays, math.prod(2.0 * x + 4.0 for x in extent)))
        pages = math.ceil(min(by_rays, math.prod(2.0 * x / PAGE_EDGE + 3.0 for x in extent)))
        count = int(self.counts[PAGES])
        if count + pages > len(self.pages):
            self.pages = _grown(self.pages, count + pages, -1)
            self.table = np.full((4 << (len(self.pages) - 1).bit_length(), 2), -1)
            enter_pages(self.table, self.pages, self.blocks, count)
        if self.counts[BLOCKS] + blocks > len(self.blocks):
            rows = int(self.counts[BLOCKS]) + blocks
            self.blocks, self.cells = _grown(self.blocks, rows), _grown(self.cells, rows)
            self.links = _grown(self.links, rows)
        if self.counts[USED] + returns > len(self.elements):
            self.elements = _grown(self.elements, int(self.counts[USED]) + returns)


def _grown(rows: NDArray[Any], count: int, value: int = 0) -> NDArray[Any]:
    """Return ``rows`` with ``count`` of them or more, at least twice as many as before."""
    shape = max(count, 2 * len(rows)), *rows.shape[1:]
    # Zeros take no memory until they are written to.
    grown = np.full(shape, value, dtype=rows.dtype) if value else np.zeros(shape, dtype=rows.dtype)
    grown[: len(rows)] = rows
    return grown
