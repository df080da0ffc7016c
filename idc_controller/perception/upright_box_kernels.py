"""Upright boxes that hold points of the standing map, compiled: bounds of the points, boxes, and gaps in them.

A box is a row of 8 numbers: centre (3,), half edges along its heading, across it and vertically (m), cosine and sine of
the heading. Bounds are rows of 6: lower (3,) and upper (3,) (m).
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Indices, Indices1, Mask1
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.voxel_kernels import (
    EDGE,
    FREE_CELLS,
    HIGH,
    HITS,
    KEY,
    LOW,
    MEAN,
    POINTS,
    WEIGHT,
    Rules,
    Voxels,
    cell_index,
    element_at,
    element_voxel,
    find_block,
    key_corner,
    voxel,
)

_COARSE, _FINE = 18, 5
"""Headings tried of a quarter turn, and on each side of the best of them."""
_STEP = math.pi / 2.0 / _COARSE


@inlined
def _take(bounds: Array, rows: Indices, cosine: float, sine: float, ranges: Array) -> None:
    """Extend ``ranges`` (3, 2) along a heading, across it and vertically (m) to hold ``bounds`` at some ``rows``."""
    a, b = abs(cosine), abs(sine)
    for row in rows:
        x, y = (bounds[row, 0] + bounds[row, 3]) / 2.0, (bounds[row, 1] + bounds[row, 4]) / 2.0
        p, q = (bounds[row, 3] - bounds[row, 0]) / 2.0, (bounds[row, 4] - bounds[row, 1]) / 2.0
        u, v, du, dv = cosine * x + sine * y, cosine * y - sine * x, a * p + b * q, a * q + b * p
        ranges[0, 0], ranges[0, 1] = min(u - du, ranges[0, 0]), max(u + du, ranges[0, 1])
        ranges[1, 0], ranges[1, 1] = min(v - dv, ranges[1, 0]), max(v + dv, ranges[1, 1])
        ranges[2, 0], ranges[2, 1] = min(bounds[row, 2], ranges[2, 0]), max(bounds[row, 5], ranges[2, 1])


@inlined
def _ranges(box: Array) -> Array:
    """Return the ranges of a box along its heading, across it and vertically (3, 2) (m)."""
    u, v = box[6] * box[0] + box[7] * box[1], box[6] * box[1] - box[7] * box[0]
    ranges = np.empty((3, 2))
    ranges[0, 0], ranges[0, 1] = u - box[3], u + box[3]
    ranges[1, 0], ranges[1, 1] = v - box[4], v + box[4]
    ranges[2, 0], ranges[2, 1] = box[2] - box[5], box[2] + box[5]
    return ranges


@inlined
def _box(ranges: Array, cosine: float, sine: float) -> Array:
    """Return the box (8,) with these ranges (3, 2)."""
    box, u, v = np.empty(8), (ranges[0, 1] + ranges[0, 0]) / 2.0, (ranges[1, 1] + ranges[1, 0]) / 2.0
    box[0], box[1], box[2] = cosine * u - sine * v, sine * u + cosine * v, (ranges[2, 1] + ranges[2, 0]) / 2.0
    for axis in range(3):
        box[3 + axis] = (ranges[axis, 1] - ranges[axis, 0]) / 2.0
    box[6], box[7] = cosine, sine
    return box


@inlined
def _nothing() -> Array:
    """Return the ranges (3, 2) that hold nothing."""
    ranges = np.empty((3, 2))
    ranges[:, 0], ranges[:, 1] = math.inf, -math.inf
    return ranges


@kernel
def fitted_box(bounds: Array2, rows: Indices1) -> Array1:
    """Return the upright box (8,) with about the least plan view that holds ``bounds`` (E, 6) of some ``rows`` (n,).

    The heading is the best of some, found to half a degree.
    """
    heading, least = 0.0, math.inf
    for attempt in range(2):
        middle = heading
        for i in range(_COARSE if attempt == 0 else 2 * _FINE + 1):
            tried = i * _STEP if attempt == 0 else middle + (i - _FINE) * _STEP / (2.0 * _FINE)
            if attempt == 1 and i == _FINE:
                continue
            ranges = _nothing()
            _take(bounds, rows, math.cos(tried), math.sin(tried), ranges)
            area = (ranges[0, 1] - ranges[0, 0]) * (ranges[1, 1] - ranges[1, 0])
            if area < least * (1.0 - 1e-9):
                heading, least = tried, area
    ranges = _nothing()
    _take(bounds, rows, math.cos(heading), math.sin(heading), ranges)
    return _box(ranges, math.cos(heading), math.sin(heading))


@kernel
def extended_box(box: Array1, bounds: Array2, rows: Indices1) -> Array1:
    """Return a ``box`` (8,) extended, at its heading, to hold the ``bounds`` (E, 6) of some ``rows`` (n,)."""
    ranges = _ranges(box)
    _take(bounds, rows, box[6], box[7], ranges)
    return _box(ranges, box[6], box[7])


@kernel
def reaches_out(box: Array1, bounds: Array2, rows: Indices1, tolerance: float) -> Mask1:
    """Return which of ``bounds`` (E, 6), at ``rows`` (n,), reach beyond a ``box`` (8,) by over ``tolerance`` (m)."""
    held, out = _ranges(box), np.zeros(rows.shape[0], np.bool_)
    for i in range(rows.shape[0]):
        ranges = _nothing()
        _take(bounds, rows[i : i + 1], box[6], box[7], ranges)
        for axis in range(3):
            beyond = max(held[axis, 0] - ranges[axis, 0], ranges[axis, 1] - held[axis, 1])
            out[i] = out[i] or beyond > tolerance
    return out


@kernel
def cover_points(voxels: Voxels, indices: Indices1, sigmas: Array1, tolerance: float, bounds: Array2) -> None:
    """Write the bounds within which the true surface in the voxels of some elements lies into ``bounds`` (E, 6).

    Bounds of the measured points, moved outwards by as many standard deviations as the number of scans that hit the
    surface there requires: inwards, towards the mean, where many scans make it certain that noise has spread them.

    Args:
        voxels: of the map.
        indices: of the elements (n,).
        sigmas: standard deviations for 1, 2, ... scans (s,).
        tolerance: added on all sides (m).
        bounds: to be written to.
    """
    elements, mean = voxels.elements, np.empty(3)
    for e in indices:
        x, y, z = element_voxel(voxels, elements[e])
        hits = 0.0
        mean[:] = 0.0
        for i in range(x - 1, x + 2):
            for j in range(y - 1, y + 2):
                for k in range(z - 1, z + 2):
                    other = element_at(voxels, i, j, k)
                    if other >= 0:
                        hits += elements[other, HITS]
                        for axis in range(3):
                            mean[axis] += elements[other, HITS] * elements[other, MEAN + axis]
        count = min(max(int(hits), 1), sigmas.shape[0])
        out = sigmas[count - 1] * math.sqrt(elements[e, POINTS] / elements[e, WEIGHT])
        for axis in range(3):
            low, high, middle = elements[e, LOW + axis], elements[e, HIGH + axis], mean[axis] / max(hits, 1e-9)
            if out >= 0.0:
                low, high = low - out, high + out
            else:
                high = max(high + out, middle) if high > middle else high
                low = min(low - out, middle) if low < middle else low
                if low > high:
                    low = high = high if high > middle else low
            bounds[e, axis], bounds[e, 3 + axis] = low - tolerance, high + tolerance


@inlined
def _gaps_of_block(voxels: Voxels, rules: Rules, block: int, box: Array, reach: Array, found: Array, count: int) -> int:
    """Write the gaps of one block into ``found`` from row ``count`` on; return how many there are then."""
    if voxels.blocks[block, FREE_CELLS] == 0:
        return count
    key, size = voxels.blocks[block, KEY], rules.size
    x0, y0, z0 = key_corner(key, 0), key_corner(key, 1), key_corner(key, 2)
    for x in range(max(x0, voxel(box[0] - reach[0], size)), min(x0 + EDGE, voxel(box[0] + reach[0], size) + 1)):
        for y in range(max(y0, voxel(box[1] - reach[1], size)), min(y0 + EDGE, voxel(box[1] + reach[1], size) + 1)):
            p, q = (x + 0.5) * size - box[0], (y + 0.5) * size - box[1]
            if abs(box[6] * p + box[7] * q) > box[3] or abs(box[6] * q - box[7] * p) > box[4]:
                continue
            for z in range(max(z0, voxel(box[2] - reach[2], size)), min(z0 + EDGE, voxel(box[2] + reach[2], size) + 1)):
                cell = cell_index(x, y, z)
                if voxels.cells[block, cell] != rules.free_passes or voxels.links[block, cell] & 255:
                    continue
                if abs((z + 0.5) * size - box[2]) > box[5]:
                    continue
                found[count, 0], found[count, 1], found[count, 2] = (x + 0.5) * size, (y + 0.5) * size, (z + 0.5) * size
                count += 1
                if count == found.shape[0]:
                    return count
    return count


@kernel
def gaps_within(voxels: Voxels, rules: Rules, among: Indices1, box: Array1, most: int) -> Array2:
    """Return the middles (n, 3) of the gaps in a box: voxels seen free, with no point in the 27 voxels about them.

    Args:
        voxels: of the map.
        rules: of the map.
        among: blocks that are searched; none: all that the box reaches into.
        box: (8,).
        most: gaps that are returned.
    """
    size, found, count, reach = rules.size, np.empty((most, 3)), 0, np.empty(3)
    reach[0] = box[3] * abs(box[6]) + box[4] * abs(box[7])
    reach[1] = box[3] * abs(box[7]) + box[4] * abs(box[6])
    reach[2] = box[5]
    if among.shape[0]:
        for block in among:
            if count < most:
                count = _gaps_of_block(voxels, rules, block, box, reach, found, count)
        return found[:count].copy()
    for x in range(voxel(box[0] - reach[0], size) >> 3, (voxel(box[0] + reach[0], size) >> 3) + 1):
        for y in range(voxel(box[1] - reach[1], size) >> 3, (voxel(box[1] + reach[1], size) >> 3) + 1):
            for z in range(voxel(box[2] - reach[2], size) >> 3, (voxel(box[2] + reach[2], size) >> 3) + 1):
                block = find_block(voxels, x << 3, y << 3, z << 3)
                if block >= 0 and count < most:
                    count = _gaps_of_block(voxels, rules, block, box, reach, found, count)
    return found[:count].copy()
