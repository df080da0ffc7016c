"""Neighbours among the points of the standing map, compiled."""

import numpy as np

from idc_controller.arrays import Array, Indices, Links
from idc_controller.compiled import kernel
from idc_controller.perception.voxel_kernels import (
    NUMBER,
    element_at,
    element_voxel,
)


@kernel(
    "int64[::1](int64[:, ::1], int32[:, ::1], int64[:, ::1], int32[:, ::1], float64[:, ::1], int64[::1], int64[:, ::1],"
    " int64)"
)
def nearest_owners(
    table: Indices,
    pages: Links,
    blocks: Indices,
    links: Links,
    elements: Array,
    indices: Indices,
    owners: Indices,
    reach: int,
) -> Indices:
    """Return for elements ``indices`` (n,) the owner of the nearest that has one within ``reach`` voxels, or -1.

    Args:
        table, pages, blocks, links, elements: see ``voxel_kernels``.
        owners: owner and serial number of each element (E, 2); of another serial number: none.
    """
    found = np.full(indices.shape[0], -1, np.int64)
    for n in range(indices.shape[0]):
        x, y, z = element_voxel(blocks, elements[indices[n]])
        nearest = reach * reach + 1
        for i in range(-reach, reach + 1):
            for j in range(-reach, reach + 1):
                for k in range(-reach, reach + 1):
                    square = i * i + j * j + k * k
                    if square >= nearest:
                        continue
                    index = element_at(table, pages, links, x + i, y + j, z + k)
                    if index < 0 or index >= owners.shape[0] or owners[index, 0] < 0:
                        continue
                    if owners[index, 1] == int(elements[index, NUMBER]):
                        nearest, found[n] = square, owners[index, 0]
    return found
