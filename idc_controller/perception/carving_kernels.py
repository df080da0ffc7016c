"""Rays of a scan through the sparse voxels of the standing map, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array, Array2, Indices1
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.element_kernels import free_element, halve_memory
from idc_controller.perception.normal_kernels import surface_normal
from idc_controller.perception.voxel_kernels import (
    CELLS,
    CHANGE,
    FREE,
    FREE_CELLS,
    GONE,
    HELD,
    HELD_CELLS,
    HITS,
    LAST_HIT,
    LAST_PASS,
    MEAN,
    NUMBER,
    PASSES,
    POINTS,
    PROVEN,
    SCATTER,
    USED,
    WAY,
    WEIGHT,
    Rays,
    Rules,
    Voxels,
    block_in_page,
    block_of,
    cell_index,
    page_key,
    page_of,
    voxel,
)

_ALIKE = math.cos(math.radians(20.0))
"""Mean cosine between a ray and those that hit a surface from which on it is like them."""


@inlined
def _is_passed(
    voxels: Voxels, rules: Rules, element: Array, rays: Rays, way: Array, length: float, range_variance: float,
    normal: Array,
) -> int:  # fmt: skip
    """Return 1 for a ray that goes through the place of an element's points and ends beyond, else 0.

    -1: along their surface, but as the rays went that hit it. ``way`` (3,) and ``length`` of the ray; ``normal`` (3,)
    is written to.
    """
    along, square = 0.0, 0.0
    for i in range(3):
        offset = element[MEAN + i] - rays.origin[i]
        along += offset * way[i]
        square += offset * offset
    if along <= 0.0:
        return 0
    weight = element[WEIGHT]
    xx, xy, xz = element[SCATTER], element[SCATTER + 1], element[SCATTER + 2]
    yy, yz, zz = element[SCATTER + 3], element[SCATTER + 4], element[SCATTER + 5]
    depth = (
        xx * way[0] ** 2 + yy * way[1] ** 2 + zz * way[2] ** 2
        + 2.0 * (xy * way[0] * way[1] + xz * way[0] * way[2] + yz * way[1] * way[2])
    ) / weight  # fmt: skip
    beyond = length - along
    noise = range_variance + max(depth, element[POINTS] / weight)
    if beyond <= 0.0 or beyond * beyond <= rules.sigmas_beyond**2 * noise:
        return 0
    # Within the spread of the points, without what is noise of it, or within the noise of the ray.
    spread = 1.5 * (max((xx + yy + zz) / weight - depth, 0.0) / 2.0 - element[POINTS] / weight)
    across = rays.sigmas[1] ** 2 + (rays.sigmas[2] * along) ** 2
    if square - along * along > max(spread, across):
        return 0
    surface_normal(voxels, element, normal)
    dot = normal[0] * way[0] + normal[1] * way[1] + normal[2] * way[2]
    if abs(dot) >= rules.incidence or normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2 == 0.0:
        return 1
    alike = element[WAY] * way[0] + element[WAY + 1] * way[1] + element[WAY + 2] * way[2]
    return -1 if alike >= _ALIKE * element[POINTS] else 0


@inlined
def _first_side(start: float, way: float, size: float) -> tuple[int, int, float, float]:
    """Return for one axis: voxel, step, length to the voxel's side along the ray and between sides (m)."""
    first = voxel(start, size)
    if abs(way) < 1e-9:
        return first, 0, math.inf, math.inf
    if way > 0.0:
        return first, 1, ((first + 1) * size - start) / way, size / way
    return first, -1, (first * size - start) / way, -size / way


@inlined
def _sides_before(at: int, step: int) -> int:
    """Return how many sides of voxels come before the side of the block along one axis."""
    return 7 - (at & 7) if step > 0 else at & 7


@kernel
def carve(voxels: Voxels, rules: Rules, rays: Rays, scan: float) -> None:
    """Count the rays of a scan through the voxels they pass, and free elements that enough scans have passed.

    A ray that has met the voxel of an element is no evidence for free voxels beyond: it may go along its surface.
    An element is passed at most once a scan, as the error of the pose is common to its rays, and not in a scan that
    hit it. The run of scans that pass it is compared with what its own record of hits and passes predicts
    (beta-binomial).

    Args:
        voxels: of the map, of enough capacity.
        rules: of the map.
        rays: of the scan.
        scan: its number.
    """
    origin, returns, free, sigmas = rays
    size, free_passes, prior, evidence = rules.size, rules.free_passes, rules.prior, rules.evidence
    pages, blocks, cells, elements = voxels.pages, voxels.blocks, voxels.cells, voxels.elements
    way, normal = np.empty(3), np.empty(3)
    returned = returns.shape[0]
    for r in range(returned + free.shape[0]):
        length = 0.0
        for i in range(3):
            way[i] = (returns[r, i] if r < returned else free[r - returned, i]) - origin[i]
            length += way[i] * way[i]
        length = math.sqrt(length)
        if not 0.0 < length < math.inf:
            continue
        range_variance = sigmas[1] ** 2 + (sigmas[0] ** 2 if r < returned else 0.0)
        last = length - rules.sigmas_beyond * math.sqrt(range_variance) if r < returned else length
        way /= length
        # Voxels in the order in which the ray leaves them (Amanatides and Woo, 1987): place along it of the next side.
        x, x_step, x_next, x_apart = _first_side(origin[0], way[0], size)
        y, y_step, y_next, y_apart = _first_side(origin[1], way[1], size)
        z, z_step, z_next, z_apart = _first_side(origin[2], way[2], size)
        x_edge, y_edge, z_edge = 7 * (x_step > 0), 7 * (y_step > 0), 7 * (z_step > 0)
        is_other, in_page, page, block, met = True, -1, -1, -1, False
        reach = min(x_next, y_next, z_next)
        while reach <= last:
            if is_other:
                is_other = False
                if page_key(x, y, z) != in_page:
                    in_page, page = page_key(x, y, z), page_of(voxels, x, y, z)
                block = pages[page, block_in_page(x, y, z)]
                if block < 0 and not met:
                    block = block_of(voxels, x, y, z)
                if block < 0 or (blocks[block, HELD_CELLS] == 0 and (met or blocks[block, FREE_CELLS] == CELLS)):
                    # Nothing to do in the whole block.
                    out = min(
                        x_next + _sides_before(x, x_step) * x_apart if x_step else math.inf,
                        y_next + _sides_before(y, y_step) * y_apart if y_step else math.inf,
                        z_next + _sides_before(z, z_step) * z_apart if z_step else math.inf,
                    )
                    if x_next <= out:
                        sides = int((out - x_next) / x_apart) + 1
                        x, x_next = x + sides * x_step, x_next + sides * x_apart
                    if y_next <= out:
                        sides = int((out - y_next) / y_apart) + 1
                        y, y_next = y + sides * y_step, y_next + sides * y_apart
                    if z_next <= out:
                        sides = int((out - z_next) / z_apart) + 1
                        z, z_next = z + sides * z_step, z_next + sides * z_apart
                    is_other, reach = True, min(x_next, y_next, z_next)
                    continue
            cell = cell_index(x, y, z)
            value = cells[block, cell]
            if value & HELD:
                met = True
                index = (voxels.links[block, cell] >> 8) - 1
                element = elements[index]
                passed = 0
                if element[LAST_HIT] != scan and element[LAST_PASS] != scan:
                    passed = _is_passed(voxels, rules, element, rays, way, length, range_variance, normal)
                if passed:
                    element[LAST_PASS] = scan
                    # Along a surface, a ray that misses it is as likely as one that hits it elsewhere.
                    hits = element[HITS] + (prior[0] if passed > 0 else prior[1])
                    passes = element[PASSES] + (prior[1] if passed > 0 else prior[0])
                    element[GONE] += max(math.log((hits + passes) / passes), evidence[2] if passed > 0 else evidence[3])
                    element[PASSES] += 1.0
                    # What has appeared where nothing was, and has not lasted, goes as easily as one hit.
                    most = evidence[1] if element[PROVEN] == 1.0 else evidence[0]
                    if element[GONE] >= min(element[HITS] * evidence[0], most):
                        free_element(voxels, index, free_passes, free_passes)
                    else:
                        halve_memory(element, rules.memory)
            elif not met and value < free_passes:
                cells[block, cell] = value + 1
                if value + 1 == free_passes:
                    blocks[block, CHANGE] |= FREE
                    blocks[block, FREE_CELLS] += 1
            # From the last voxel of a block the ray enters another one.
            if x_next == reach:
                is_other = x & 7 == x_edge
                x += x_step
                x_next += x_apart
            elif y_next == reach:
                is_other = y & 7 == y_edge
                y += y_step
                y_next += y_apart
            else:
                is_other = z & 7 == z_edge
                z += z_step
                z_next += z_apart
            reach = min(x_next, y_next, z_next)


@kernel
def release(voxels: Voxels, indices: Indices1, free_passes: int) -> None:
    """Remove elements with ``indices`` (n,) whose points belong to what has moved; no ray has passed there yet."""
    for index in indices:
        free_element(voxels, index, free_passes, 0)


#: Cells of directions about a vehicle: of azimuth, and of the sine of elevation.
_AZIMUTHS, _ELEVATIONS = 64, 24


@inlined
def _direction_cell(x: float, y: float, z: float, length: float) -> tuple[int, int]:
    azimuth = int((math.atan2(y, x) + math.pi) / (2.0 * math.pi) * _AZIMUTHS)
    elevation = int((1.0 - z / length) / 2.0 * _ELEVATIONS)
    return min(max(azimuth, 0), _AZIMUTHS - 1), min(max(elevation, 0), _ELEVATIONS - 1)


@kernel
def followed_rays(voxels: Voxels, rays: Rays, first: int, stride: int) -> Array2:
    """Return those rays without return (k, 3) that may pass an element, and of the others every ``stride``-th.

    What stands is freed by the evidence of all rays; where nothing stands, space is seen free by few.

    Args:
        voxels: of the map.
        rays: of the scan.
        first: number of the first ray of the others.
        stride: of the others.
    """
    near, held = np.zeros((_AZIMUTHS, _ELEVATIONS), np.bool_), np.zeros((_AZIMUTHS, _ELEVATIONS), np.bool_)
    origin, free, elements, reach = rays.origin, rays.free, voxels.elements, 0.0
    for r in range(free.shape[0]):
        square = 0.0
        for i in range(3):
            square += (free[r, i] - origin[i]) ** 2
        reach = max(reach, square)
    for e in range(voxels.counts[USED]):
        if elements[e, NUMBER] == 0.0:
            continue
        x, y, z = (elements[e, MEAN] - origin[0], elements[e, MEAN + 1] - origin[1], elements[e, MEAN + 2] - origin[2])
        square = x * x + y * y + z * z
        if 0.0 < square <= reach:
            a, b = _direction_cell(x, y, z, math.sqrt(square))
            if held[a, b]:
                continue
            held[a, b] = True
            for i in range(-1, 2):
                for j in range(max(b - 1, 0), min(b + 2, _ELEVATIONS)):
                    near[(a + i) % _AZIMUTHS, j] = True
    found, n = np.empty(free.shape), 0
    for r in range(free.shape[0]):
        x, y, z = free[r, 0] - origin[0], free[r, 1] - origin[1], free[r, 2] - origin[2]
        length = math.sqrt(x * x + y * y + z * z)
        if length == 0.0:
            continue
        a, b = _direction_cell(x, y, z, length)
        if near[a, b] or r % stride == first % stride:
            for i in range(3):
                found[n, i] = free[r, i]
            n += 1
    return found[:n].copy()
