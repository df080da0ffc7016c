"""Sparse voxels: blocks of 8 x 8 x 8 in pages of 16 x 16 x 16, compiled; the arrays that the map's kernels share."""

import math
from typing import NamedTuple

from idc_controller.arrays import Array, Array1, Array2, Cells2, Indices, Indices1, Indices2, Links2
from idc_controller.compiled import inlined


class Voxels(NamedTuple):
    """What a standing map knows of space."""

    table: Indices2
    """Hash table of the pages by open addressing, key and number (2^k, 2); key -1: empty."""
    pages: Links2
    """Number of each block of a page (P, 4096), -1: none. A ray stays in few pages, which the cache holds."""
    blocks: Indices2
    """Key of a block; whether it has changed (bits :data:`SURFACE` and :data:`FREE`); its voxels that were seen free;
    its voxels with points (B, 4)."""
    cells: Cells2
    """One byte a voxel (B, 512): how many rays have passed, up to as many as make it seen free, and :data:`HELD`, if it
    holds points. Small, as every ray reads some forty of them."""
    links: Links2
    """In bits 0 to 7 how many of the 27 voxels about a voxel hold points, above that the index of its surface element
    plus one (0: it holds no point) (B, 512)."""
    elements: Array2
    """What is known of the points in a voxel (E, COLUMNS)."""
    counts: Indices1
    """Blocks, elements ever used, first spare element plus one, serial number of the last element, pages (5,)."""


class Rules(NamedTuple):
    """How a standing map takes scans: constants that follow from its settings."""

    size: float
    """Edge of a voxel (m)."""
    free_passes: int
    """Rays through a voxel from which on it was seen free."""
    sigmas_beyond: float
    """Standard deviations by which a ray must end beyond what it passes."""
    incidence: float
    """Least cosine between a ray that passes through points, and their surface's normal."""
    prior: Array1
    """Scans that hit and that pass what stands, as counted before the first one (2,)."""
    evidence: Array1
    """Nats of one scan's hit, and most of them; least of one that passes through, and along a surface (4,)."""
    memory: float
    """Scans that an element remembers."""
    settling: float
    """Time for which points in what was seen free must last to count as standing (s)."""
    tolerance: float
    """By which bounds that grow are set beyond the point (m)."""
    chi_squared: float
    """Square of the distance, in standard deviations, up to which noise explains it."""
    sight_width: int
    """Voxels along the edge of a cell in which space is seen free, a divisor of a block's."""
    sight_rays: int
    """Followed rays through a cell from which on it was seen free."""


class Rays(NamedTuple):
    """The rays of one scan. SI units, NED."""

    origin: Array1
    """Place of the sensor (3,)."""
    returns: Array2
    """Points that rays hit (n, 3)."""
    free: Array2
    """Ends of the rays that returned nothing up to there (m, 3)."""
    sigmas: Array1
    """Standard deviations of range (m), position (m) and attitude (rad)."""


EDGE = 8
"""Voxels along the edge of a block."""
CELLS = EDGE**3
PAGE_EDGE = 16
"""Blocks along the edge of a page."""
PAGE_BLOCKS = PAGE_EDGE**3
KEY, CHANGE, FREE_CELLS, HELD_CELLS = range(4)
"""Columns of ``blocks``."""
SURFACE, FREE = 1, 2
"""Bits of a block's change: points came or went; voxels came to be free."""
HELD, PASSED = 128, 127
"""Bits of a cell: it holds points; rays that have passed."""
BLOCKS, USED, SPARE, SERIAL, PAGES = range(5)
"""Indices of ``counts``."""

MEAN, SCATTER, WEIGHT, LOW, HIGH = 0, 3, 9, 10, 13
"""Columns of an element: weighted mean (3), sums of weighted squares about it xx, xy, xz, yy, yz, zz (6), sum of the
weights (1/m2), bounds of the points (3 each)."""
POINTS, HITS, PASSES, GONE, BORN, PROVEN = 16, 17, 18, 19, 20, 21
"""Columns: number of points; scans that hit it; scans that passed through it; evidence that it is gone (nats) since it
was hit last; time of the first point (s); 1 if it counts as standing."""
LAST_HIT, LAST_PASS, BLOCK, CELL, NUMBER, NEXT_SPARE = 22, 23, 24, 25, 26, 27
"""Columns: the scans in which it was hit and passed last; its block and voxel; its serial number (0: it is spare); the
spare element after it."""
WAY = 28
"""Columns: sum of the unit vectors along the rays that hit it (3)."""
COLUMNS = 31

_OFFSET = 1 << 20
_FIELD = (1 << 21) - 1


@inlined
def block_key(x: int, y: int, z: int) -> int:
    """Return the key of the block with voxel (x, y, z)."""
    return ((x >> 3) + _OFFSET) << 42 | ((y >> 3) + _OFFSET) << 21 | ((z >> 3) + _OFFSET)


@inlined
def page_key(x: int, y: int, z: int) -> int:
    """Return the key of the page with voxel (x, y, z)."""
    return ((x >> 7) + _OFFSET) << 42 | ((y >> 7) + _OFFSET) << 21 | ((z >> 7) + _OFFSET)


@inlined
def block_in_page(x: int, y: int, z: int) -> int:
    """Return the index in its page of the block with voxel (x, y, z)."""
    return (x >> 3 & 15) << 8 | (y >> 3 & 15) << 4 | (z >> 3 & 15)


@inlined
def key_corner(key: int, axis: int) -> int:
    """Return the first voxel of a block along one axis."""
    return (((key >> (42 - 21 * axis)) & _FIELD) - _OFFSET) * 8


@inlined
def cell_index(x: int, y: int, z: int) -> int:
    """Return the index in its block of voxel (x, y, z)."""
    return (x & 7) << 6 | (y & 7) << 3 | (z & 7)


@inlined
def _first_place(key: int, mask: int) -> int:
    """Return where the search for a key begins: Teschner et al., "Optimized spatial hashing", 2003."""
    x, y, z = key >> 42 & _FIELD, key >> 21 & _FIELD, key & _FIELD
    return (x * 73856093 ^ y * 19349663 ^ z * 83492791) & mask


@inlined
def find_page(table: Indices, key: int) -> int:
    """Return the number of the page with that key, -1 if there is none."""
    mask = table.shape[0] - 1
    i = _first_place(key, mask)
    while table[i, 0] != key:
        if table[i, 0] == -1:
            return -1
        i = (i + 1) & mask
    return int(table[i, 1])


@inlined
def insert_page(table: Indices, key: int, number: int) -> None:
    """Enter a page that is not in the table."""
    mask = table.shape[0] - 1
    i = _first_place(key, mask)
    while table[i, 0] != -1:
        i = (i + 1) & mask
    table[i, 0], table[i, 1] = key, number


@inlined
def find_block(voxels: Voxels, x: int, y: int, z: int) -> int:
    """Return the number of the block with voxel (x, y, z), -1 if there is none."""
    page = find_page(voxels.table, page_key(x, y, z))
    return -1 if page < 0 else int(voxels.pages[page, block_in_page(x, y, z)])


@inlined
def page_of(voxels: Voxels, x: int, y: int, z: int) -> int:
    """Return the number of the page with voxel (x, y, z), a new one if there is none yet."""
    key = page_key(x, y, z)
    page = find_page(voxels.table, key)
    if page < 0:
        page = voxels.counts[PAGES]
        voxels.counts[PAGES] += 1
        insert_page(voxels.table, key, page)
    return int(page)


@inlined
def block_of(voxels: Voxels, x: int, y: int, z: int) -> int:
    """Return the number of the block with voxel (x, y, z), a new one if there is none yet."""
    page, place, pages, counts = page_of(voxels, x, y, z), block_in_page(x, y, z), voxels.pages, voxels.counts
    if pages[page, place] < 0:
        pages[page, place] = counts[BLOCKS]
        voxels.blocks[counts[BLOCKS], KEY] = block_key(x, y, z)
        counts[BLOCKS] += 1
    return int(pages[page, place])


@inlined
def element_at(voxels: Voxels, x: int, y: int, z: int) -> int:
    """Return the index of the element of voxel (x, y, z), -1 where there is none."""
    block = find_block(voxels, x, y, z)
    return -1 if block < 0 else int(voxels.links[block, cell_index(x, y, z)] >> 8) - 1


@inlined
def element_voxel(voxels: Voxels, element: Array) -> tuple[int, int, int]:
    """Return the voxel of an element."""
    key, cell = voxels.blocks[int(element[BLOCK]), KEY], int(element[CELL])
    return key_corner(key, 0) + (cell >> 6), key_corner(key, 1) + (cell >> 3 & 7), key_corner(key, 2) + (cell & 7)


@inlined
def add_near(voxels: Voxels, element: Array, change: int) -> None:
    """Add ``change`` to the number of voxels with points about each of the 27 voxels about an ``element``."""
    x, y, z = element_voxel(voxels, element)
    for i in range(x - 1, x + 2):
        for j in range(y - 1, y + 2):
            for k in range(z - 1, z + 2):
                voxels.links[block_of(voxels, i, j, k), cell_index(i, j, k)] += change


@inlined
def voxel(coordinate: float, size: float) -> int:
    """Return the voxel along one axis."""
    return math.floor(coordinate / size)
