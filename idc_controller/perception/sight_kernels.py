"""What of a body's way was not seen free, and what of it is hidden, compiled."""

import math

from idc_controller.arrays import Array, Array1, Array2
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.voxel_kernels import HELD, PASSED, Rules, Voxels, cell_index, find_block, voxel


@inlined
def _is_seen(voxels: Voxels, x: int, y: int, z: int, width: int, rays: int) -> bool:
    """Return whether ``rays`` have passed a cube of voxels from (x, y, z) on, or there are points at it.

    A ray passes ``3 width - 2`` voxels of the cube at most; those through one voxel are as many rays.
    """
    block = find_block(voxels, x, y, z)
    if block < 0:
        return False
    passes = 0
    for i in range(x, x + width):
        for j in range(y, y + width):
            for k in range(z, z + width):
                cell = cell_index(i, j, k)
                value = voxels.cells[block, cell]
                if value & HELD or voxels.links[block, cell] & 255 or value & PASSED >= rays:
                    return True
                passes += value & PASSED
    return passes > (rays - 1) * (3 * width - 2)


@kernel
def unseen_cells(voxels: Voxels, rules: Rules, path: Array2, body: Array1, found: Array2) -> int:
    """Return how many cells of a body's way from the first place of its path on were not seen free.

    Cells are cubes of voxels, on the way if their middle is; those that the body holds at the first place are not. None
    of which a voxel holds points, or is next to one that does, is among them.

    Args:
        voxels: of the map.
        rules: of the map.
        path: places of the body (P, 3), NED (m).
        body: upright cylinder: radius, extent up and down from its place, height above the ground below which nothing
            is seen (4,) (m).
        found: to be written to, at most so many (M, 4): last place before, by its index, and middle of the cell.
    """
    width = rules.sight_width
    edge = width * rules.size
    radius, up, down, height = body[0], body[1], body[2], body[3]
    square = radius * radius
    before, count = 0, 0
    for p in range(1, path.shape[0]):
        x, y, z = path[p, 0], path[p, 1], path[p, 2]
        u, v, w = x - path[before, 0], y - path[before, 1], z - path[before, 2]
        if u * u + v * v + w * w < 0.25 * edge * edge:
            continue
        top, bottom = z - up, min(z + down, -height)
        top_before, bottom_before = path[before, 2] - up, path[before, 2] + down
        first_top, first_bottom = path[0, 2] - up, path[0, 2] + down
        for i in range(math.floor((x - radius) / edge), math.floor((x + radius) / edge) + 1):
            north = (i + 0.5) * edge
            for j in range(math.floor((y - radius) / edge), math.floor((y + radius) / edge) + 1):
                east = (j + 0.5) * edge
                if (north - x) ** 2 + (east - y) ** 2 > square:
                    continue
                was = (north - path[before, 0]) ** 2 + (east - path[before, 1]) ** 2 <= square
                was_first = (north - path[0, 0]) ** 2 + (east - path[0, 1]) ** 2 <= square
                for k in range(math.ceil(top / edge - 0.5), math.floor(bottom / edge - 0.5) + 1):
                    place = (k + 0.5) * edge
                    if was and top_before <= place <= bottom_before:
                        continue
                    if was_first and first_top <= place <= first_bottom:
                        continue
                    if not _is_seen(voxels, i * width, j * width, k * width, width, rules.sight_rays):
                        if count == found.shape[0]:
                            return count
                        found[count, 0], found[count, 1], found[count, 2], found[count, 3] = before, north, east, place
                        count += 1
        before = p
    return count


@inlined
def _is_clear(voxels: Voxels, start: Array, north: float, east: float, down: float, size: float) -> bool:
    """Return whether no voxel with points is met from ``start`` (3,) on, at steps of half a voxel, short of the end."""
    u, v, w = north - start[0], east - start[1], down - start[2]
    steps = math.ceil(2.0 * math.sqrt(u * u + v * v + w * w) / size)
    for s in range(1, steps - 1):
        share = s / steps
        x, y, z = (
            voxel(start[0] + share * u, size),
            voxel(start[1] + share * v, size),
            voxel(start[2] + share * w, size),
        )
        block = find_block(voxels, x, y, z)
        if block >= 0 and voxels.cells[block, cell_index(x, y, z)] & HELD:
            return False
    return True


@kernel
def first_hidden(voxels: Voxels, path: Array2, sensors: Array2, heights: Array1, size: float) -> int:
    """Return the index of the first place of a ``path`` (P, 3) that what was hit hides from all ``sensors`` (N, 3).

    A place is hidden if all of its points at ``heights`` (H,) (m) above it are; P: none is. NED (m).
    ``size``: edge of a voxel (m).
    """
    for p in range(path.shape[0]):
        is_hidden = True
        for h in range(heights.shape[0]):
            for s in range(sensors.shape[0]):
                if is_hidden and _is_clear(voxels, sensors[s], path[p, 0], path[p, 1], path[p, 2] - heights[h], size):
                    is_hidden = False
        if is_hidden:
            return p
    return len(path)
