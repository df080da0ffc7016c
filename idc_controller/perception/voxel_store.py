"""The standing map's voxels: none, and as many as the next scan may need."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from idc_controller.perception.return_kernels import capacity_for, enter_pages
from idc_controller.perception.voxel_kernels import BLOCKS, CELLS, COLUMNS, EDGE, PAGE_BLOCKS, PAGES, USED, Rays, Voxels

_FIRST_PAGES, _FIRST_BLOCKS, _FIRST_ELEMENTS = 16, 4096, 4096


def no_voxels() -> Voxels:
    """Return the voxels of a map without scans."""
    return Voxels(
        table=np.full((4 * _FIRST_PAGES, 2), -1),
        pages=np.full((_FIRST_PAGES, PAGE_BLOCKS), -1, dtype=np.int32),
        blocks=np.zeros((_FIRST_BLOCKS, 4), dtype=np.int64),
        cells=np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.uint8),
        links=np.zeros((_FIRST_BLOCKS, CELLS), dtype=np.int32),
        elements=np.zeros((_FIRST_ELEMENTS, COLUMNS)),
        counts=np.zeros(5, dtype=np.int64),
    )


def reserved(voxels: Voxels, size: float, rays: Rays) -> Voxels:
    """Return ``voxels`` of that ``size`` (m) with capacity for all that a scan can add."""
    blocks, pages = capacity_for(rays, EDGE * size)
    number = voxels.counts.tolist()
    if number[PAGES] + pages > len(voxels.pages):
        grown = _grown(voxels.pages, number[PAGES] + pages, -1)
        voxels = voxels._replace(pages=grown, table=np.full((4 << (len(grown) - 1).bit_length(), 2), -1))
        enter_pages(voxels.table, voxels.pages, voxels.blocks, number[PAGES])
    if (rows := number[BLOCKS] + blocks) > len(voxels.blocks):
        grown_of = {name: _grown(getattr(voxels, name), rows) for name in ("blocks", "cells", "links")}
        voxels = voxels._replace(**grown_of)
    if (rows := number[USED] + len(rays.returns)) > len(voxels.elements):
        voxels = voxels._replace(elements=_grown(voxels.elements, rows))
    return voxels


def _grown(rows: NDArray[Any], count: int, value: int = 0) -> NDArray[Any]:
    """Return ``rows`` with ``count`` of them or more, at least twice as many as before."""
    shape = max(count, 2 * len(rows)), *rows.shape[1:]
    # Zeros take no memory until they are written to.
    grown = np.full(shape, value, dtype=rows.dtype) if value else np.zeros(shape, dtype=rows.dtype)
    grown[: len(rows)] = rows
    return grown
