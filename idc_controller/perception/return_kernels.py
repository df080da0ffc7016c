"""Returns of a scan in the sparse voxels of the standing map, compiled."""

import math

from idc_controller.arrays import Array, Indices2, Links2, Mask1
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.element_kernels import free_element, halve_memory, new_element
from idc_controller.perception.voxel_kernels import (
    BORN,
    CHANGE,
    GONE,
    HIGH,
    HITS,
    KEY,
    LAST_HIT,
    LOW,
    MEAN,
    PAGE_EDGE,
    PASSED,
    POINTS,
    PROVEN,
    SCATTER,
    SURFACE,
    WAY,
    WEIGHT,
    Rays,
    Rules,
    Voxels,
    block_of,
    cell_index,
    element_at,
    element_voxel,
    insert_page,
    key_corner,
    page_key,
    voxel,
)

_NEAR = 2.0
"""Standard deviations of a return within which it may be one of the points beside its voxel."""
_RARER, _NOISIER = 8.0, 1.3
"""Points may be noise of others that were hit by so many times as many scans, at so much smaller variance."""


@kernel
def capacity_for(rays: Rays, size: float) -> tuple[int, int]:
    """Return upper bounds of the blocks and pages that a scan can add, of blocks with edge ``size`` (m)."""
    origin, returns, free, _ = rays
    by_rays, by_box, by_pages = 0.0, 1.0, 1.0
    for axis in range(3):
        reach = 0.0
        for ends in (returns, free):
            for r in range(ends.shape[0]):
                if abs(ends[r, axis] - origin[axis]) < math.inf:
                    reach = max(reach, abs(ends[r, axis] - origin[axis]) / size)
        by_rays += reach * (returns.shape[0] + free.shape[0])
        by_box *= 2.0 * reach + 4.0
        by_pages *= 2.0 * reach / PAGE_EDGE + 3.0
    # Rays enter a block by one of its sides; an element has voxels about it in up to eight blocks.
    by_rays += 4.0 * free.shape[0] + 12.0 * returns.shape[0]
    return math.ceil(min(by_rays, by_box)), math.ceil(min(by_rays, by_pages))


@kernel
def enter_pages(table: Indices2, pages: Links2, blocks: Indices2, count: int) -> None:
    """Enter the first ``count`` pages into an empty ``table``."""
    for page in range(count):
        for block in pages[page]:
            if block >= 0:
                key = blocks[block, KEY]
                x, y, z = key_corner(key, 0), key_corner(key, 1), key_corner(key, 2)
                insert_page(table, page_key(x, y, z), page)
                break


@inlined
def _explaining_element(voxels: Voxels, x: int, y: int, z: int, point: Array, variance: float) -> int:
    """Return the index of an often-hit element about voxel (x, y, z) whose bounds are near a point, -1 if none is."""
    elements, nearest, found = voxels.elements, _NEAR * _NEAR * variance, -1
    for i in range(x - 1, x + 2):
        for j in range(y - 1, y + 2):
            for k in range(z - 1, z + 2):
                index = element_at(voxels, i, j, k)
                if index < 0 or elements[index, HITS] < _RARER or elements[index, PROVEN] == 0.0:
                    continue
                square = 0.0
                for axis in range(3):
                    low, high = elements[index, LOW + axis], elements[index, HIGH + axis]
                    square += max(low - point[axis], point[axis] - high, 0.0) ** 2
                if square <= nearest:
                    nearest, found = square, index
    return found


@inlined
def _absorb_noise(voxels: Voxels, rules: Rules, element: Array) -> None:
    """Remove elements in the voxels about an element that its surface explains, with the noise of their points.

    Such are less accurate and were hit by much fewer scans: what is there, better scans would have hit as often.
    """
    x, y, z = element_voxel(voxels, element)
    elements = voxels.elements
    variance = element[POINTS] / element[WEIGHT]
    for i in range(x - 1, x + 2):
        for j in range(y - 1, y + 2):
            for k in range(z - 1, z + 2):
                index = element_at(voxels, i, j, k)
                if index < 0 or elements[index, HITS] * _RARER > element[HITS]:
                    continue
                other = elements[index, POINTS] / elements[index, WEIGHT]
                if other < _NOISIER * variance:
                    continue
                square = 0.0
                for axis in range(3):
                    square += (elements[index, MEAN + axis] - element[MEAN + axis]) ** 2
                if square <= rules.chi_squared * other:
                    free_element(voxels, index, rules.free_passes, 0)


@kernel
def add_returns(voxels: Voxels, rules: Rules, rays: Rays, taken: Mask1, time: float, scan: float) -> None:
    """Add the returns of a scan to the elements of their voxels.

    Args:
        voxels: of the map, of enough capacity.
        rules: of the map.
        rays: of the scan.
        taken: which of its returns are added (n,).
        time, scan: time (s) and number of the scan.
    """
    (origin, returns, _, sigmas), size, tolerance = rays, rules.size, rules.tolerance
    blocks, links, elements = voxels.blocks, voxels.links, voxels.elements
    for p in range(returns.shape[0]):
        square = 0.0
        for i in range(3):
            square += (returns[p, i] - origin[i]) ** 2
        if not (taken[p] and square < math.inf):
            continue
        x, y, z = voxel(returns[p, 0], size), voxel(returns[p, 1], size), voxel(returns[p, 2], size)
        block, cell = block_of(voxels, x, y, z), cell_index(x, y, z)
        variance = sigmas[1] ** 2 + (sigmas[0] ** 2 + 2.0 * sigmas[2] ** 2 * square) / 3.0
        index = (links[block, cell] >> 8) - 1
        if index < 0:
            if links[block, cell] & 255:
                index = _explaining_element(voxels, x, y, z, returns[p], variance)
            if index >= 0:
                # It shows that those are still there, but not where.
                elements[index, LAST_HIT], elements[index, GONE] = scan, 0.0
                continue
            was_free = voxels.cells[block, cell] & PASSED >= rules.free_passes
            index = new_element(voxels, block, cell)
            elements[index, BORN], elements[index, PROVEN] = time, 0.0 if was_free else 1.0
            for i in range(3):
                elements[index, MEAN + i] = elements[index, LOW + i] = elements[index, HIGH + i] = returns[p, i]
        element = elements[index]
        if element[LAST_HIT] != scan:
            element[LAST_HIT] = scan
            element[HITS] += 1.0
            element[GONE] = 0.0
            halve_memory(element, rules.memory)
            if time - element[BORN] >= rules.settling:
                element[PROVEN] = 1.0
            if element[HITS] >= _RARER and int(element[HITS]) % 8 == 0:
                _absorb_noise(voxels, rules, element)
        weight = 1.0 / max(variance, 1e-6)
        element[WEIGHT] += weight
        element[POINTS] += 1.0
        share = weight / element[WEIGHT]
        column = SCATTER
        for i in range(3):
            offset = returns[p, i] - element[MEAN + i]
            for j in range(i, 3):
                element[column] += weight * (1.0 - share) * offset * (returns[p, j] - element[MEAN + j])
                column += 1
        for i in range(3):
            element[MEAN + i] += share * (returns[p, i] - element[MEAN + i])
            element[WAY + i] += (returns[p, i] - origin[i]) / math.sqrt(max(square, 1e-12))
            if returns[p, i] < element[LOW + i]:
                element[LOW + i] = returns[p, i] - tolerance
                blocks[block, CHANGE] |= SURFACE
            if returns[p, i] > element[HIGH + i]:
                element[HIGH + i] = returns[p, i] + tolerance
                blocks[block, CHANGE] |= SURFACE
