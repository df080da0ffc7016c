"""Questions to the standing map, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array, Array2, Indices1, Indices2, Mask1
from idc_controller.compiled import inlined, kernel
from idc_controller.perception.normal_kernels import surface_normal
from idc_controller.perception.voxel_kernels import (
    BORN,
    HELD,
    MEAN,
    NUMBER,
    PASSED,
    PROVEN,
    SCATTER,
    WEIGHT,
    Rays,
    Rules,
    Voxels,
    cell_index,
    element_at,
    element_voxel,
    find_block,
    voxel,
)


@kernel
def stands_at(voxels: Voxels, points: Array2, size: float, since: float) -> Mask1:
    """Return whether the voxels with ``points`` (n, 3) hold standing points, and have ``since`` that time (s) (n,)."""
    elements, found = voxels.elements, np.zeros(points.shape[0], np.bool_)
    for p in range(points.shape[0]):
        x, y, z = voxel(points[p, 0], size), voxel(points[p, 1], size), voxel(points[p, 2], size)
        index = element_at(voxels, x, y, z)
        found[p] = index >= 0 and elements[index, PROVEN] == 1.0 and elements[index, BORN] <= since
    return found


@kernel
def normals_at(voxels: Voxels, points: Array2, size: float) -> Array2:
    """Return the unit normals of what stands at ``points`` (n, 3) -> (n, 3); zero where nothing does."""
    elements, found = voxels.elements, np.zeros((points.shape[0], 3))
    for p in range(points.shape[0]):
        x, y, z = voxel(points[p, 0], size), voxel(points[p, 1], size), voxel(points[p, 2], size)
        index = element_at(voxels, x, y, z)
        if index >= 0 and elements[index, PROVEN] == 1.0:
            surface_normal(voxels, elements[index], found[p])
    return found


@inlined
def _square_distance(c: Array, d: Array) -> float:
    """Return d' inv(c) d of a symmetric positive definite matrix (3, 3) and a vector (3,)."""
    l00 = math.sqrt(c[0, 0])
    l10, l20 = c[1, 0] / l00, c[2, 0] / l00
    l11 = math.sqrt(c[1, 1] - l10 * l10)
    l21 = (c[2, 1] - l20 * l10) / l11
    l22 = math.sqrt(c[2, 2] - l20 * l20 - l21 * l21)
    a = d[0] / l00
    b = (d[1] - l10 * a) / l11
    e = (d[2] - l20 * a - l21 * b) / l22
    return float(a * a + b * b + e * e)


@inlined
def _is_free_about(voxels: Voxels, rules: Rules, point: Array, radius: float) -> bool:
    """Return whether all voxels that a ball reaches into were seen free and hold no standing points."""
    x, y, z, cells, size = point[0], point[1], point[2], voxels.cells, rules.size
    for i in range(voxel(x - radius, size), voxel(x + radius, size) + 1):
        u = max(i * size - x, x - (i + 1) * size, 0.0)
        for j in range(voxel(y - radius, size), voxel(y + radius, size) + 1):
            v = max(j * size - y, y - (j + 1) * size, 0.0)
            for k in range(voxel(z - radius, size), voxel(z + radius, size) + 1):
                w = max(k * size - z, z - (k + 1) * size, 0.0)
                if u * u + v * v + w * w > radius * radius:
                    continue
                block, cell = find_block(voxels, i, j, k), cell_index(i, j, k)
                if block < 0 or cells[block, cell] & PASSED < rules.free_passes:
                    return False
                element = (voxels.links[block, cell] >> 8) - 1
                if cells[block, cell] & HELD and voxels.elements[element, PROVEN] == 1.0:
                    return False
    return True


@kernel
def unexplained_returns(voxels: Voxels, rules: Rules, rays: Rays) -> Mask1:
    """Return which returns (n,) lie in what was seen free and farther from standing points than noise explains."""
    (origin, returns, _, sigmas), size, chi_squared = rays, rules.size, rules.chi_squared
    elements, found = voxels.elements, np.zeros(returns.shape[0], np.bool_)
    way, offset, covariance, own = np.empty(3), np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    for p in range(returns.shape[0]):
        square = 0.0
        for i in range(3):
            way[i] = returns[p, i] - origin[i]
            square += way[i] * way[i]
        if not 0.0 < square < math.inf:
            continue
        across = sigmas[1] ** 2 + sigmas[2] ** 2 * square
        along = sigmas[1] ** 2 + sigmas[0] ** 2
        radius = math.sqrt(chi_squared * max(across, along))
        if not _is_free_about(voxels, rules, returns[p], radius):
            continue
        for i in range(3):
            for j in range(3):
                own[i, j] = (along - across) * way[i] * way[j] / square + (across if i == j else 0.0)
        # Of points that fill a voxel.
        reach = math.sqrt(chi_squared * (max(across, along) + size * size / 12.0 + along))
        explained = False
        for x in range(voxel(returns[p, 0] - reach, size), voxel(returns[p, 0] + reach, size) + 1):
            for y in range(voxel(returns[p, 1] - reach, size), voxel(returns[p, 1] + reach, size) + 1):
                for z in range(voxel(returns[p, 2] - reach, size), voxel(returns[p, 2] + reach, size) + 1):
                    index = element_at(voxels, x, y, z)
                    if explained or index < 0 or elements[index, PROVEN] == 0.0:
                        continue
                    element = elements[index]
                    column = SCATTER
                    for i in range(3):
                        offset[i] = returns[p, i] - element[MEAN + i]
                        for j in range(i, 3):
                            covariance[i, j] = own[i, j] + element[column] / element[WEIGHT]
                            covariance[j, i] = covariance[i, j]
                            column += 1
                    explained = _square_distance(covariance, offset) <= chi_squared
        found[p] = not explained
    return found


@kernel
def nearest_owners(voxels: Voxels, indices: Indices1, owners: Indices2, reach: int) -> Indices1:
    """Return for elements ``indices`` (n,) the owner of the nearest that has one within ``reach`` voxels, or -1.

    ``owners``: owner and serial number of each element (E, 2); of another serial number: none.
    """
    elements, found = voxels.elements, np.full(indices.shape[0], -1, np.int64)
    for n in range(indices.shape[0]):
        x, y, z = element_voxel(voxels, elements[indices[n]])
        nearest = reach * reach + 1
        for i in range(-reach, reach + 1):
            for j in range(-reach, reach + 1):
                for k in range(-reach, reach + 1):
                    square = i * i + j * j + k * k
                    if square >= nearest:
                        continue
                    index = element_at(voxels, x + i, y + j, z + k)
                    if index < 0 or index >= owners.shape[0] or owners[index, 0] < 0:
                        continue
                    if owners[index, 1] == int(elements[index, NUMBER]):
                        nearest, found[n] = square, owners[index, 0]
    return found
