"""Surface elements of the standing map's voxels: created, freed and faded, compiled."""

from idc_controller.arrays import Array
from idc_controller.compiled import inlined
from idc_controller.perception.voxel_kernels import (
    BLOCK,
    CELL,
    CHANGE,
    FREE,
    FREE_CELLS,
    HELD,
    HELD_CELLS,
    HITS,
    NEXT_SPARE,
    NUMBER,
    PASSED,
    PASSES,
    POINTS,
    SCATTER,
    SERIAL,
    SPARE,
    SURFACE,
    USED,
    WAY,
    WEIGHT,
    Voxels,
    add_near,
)


@inlined
def new_element(voxels: Voxels, block: int, cell: int) -> int:
    """Return the index of a new element of a voxel that has none."""
    elements, counts = voxels.elements, voxels.counts
    index = counts[SPARE] - 1
    if index < 0:
        index = counts[USED]
        counts[USED] += 1
    else:
        counts[SPARE] = int(elements[index, NEXT_SPARE])
    counts[SERIAL] += 1
    elements[index] = 0.0
    elements[index, BLOCK], elements[index, CELL], elements[index, NUMBER] = block, cell, counts[SERIAL]
    voxels.cells[block, cell] |= HELD
    voxels.links[block, cell] += (index + 1) << 8
    voxels.blocks[block, CHANGE] |= SURFACE
    voxels.blocks[block, HELD_CELLS] += 1
    add_near(voxels, elements[index], 1)
    return int(index)


@inlined
def free_element(voxels: Voxels, index: int, free_passes: int, least_passes: int) -> None:
    """Remove an element; its voxel counts as passed by ``least_passes`` rays, if there were not more."""
    element, blocks, cells, counts = voxels.elements[index], voxels.blocks, voxels.cells, voxels.counts
    block, cell = int(element[BLOCK]), int(element[CELL])
    add_near(voxels, element, -1)
    passed = cells[block, cell] & PASSED
    if passed < least_passes:
        blocks[block, FREE_CELLS] += least_passes == free_passes
        passed = least_passes
    cells[block, cell] = passed
    voxels.links[block, cell] &= 255
    blocks[block, CHANGE] |= SURFACE | FREE
    blocks[block, HELD_CELLS] -= 1
    element[NUMBER], element[NEXT_SPARE] = 0.0, counts[SPARE]
    counts[SPARE] = index + 1


@inlined
def halve_memory(element: Array, most: float) -> None:
    """Halve the weight of past scans when they are more than ``most``."""
    if element[HITS] + element[PASSES] > most:
        element[HITS] /= 2.0
        element[PASSES] /= 2.0
        for i in range(SCATTER, WEIGHT + 1):
            element[i] /= 2.0
        element[POINTS] /= 2.0
        for i in range(WAY, WAY + 3):
            element[i] /= 2.0
