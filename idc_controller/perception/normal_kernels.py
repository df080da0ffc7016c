"""Normal of the surface about a voxel, from the means of the points in the 27 voxels about it, compiled."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.compiled import inlined
from idc_controller.perception.voxel_kernels import HITS, MEAN, Voxels, element_at, element_voxel

_FEWEST = 3
"""Voxels with points about a voxel, itself included, from which on they have a normal."""


@inlined
def least_direction(a: Array, normal: Array) -> None:
    """Write the unit eigenvector of the least eigenvalue of a symmetric matrix ``a`` (3, 3) into ``normal`` (3,).

    Zero where it is not determined. Closed form: Smith, "Eigenvalues of a symmetric 3 x 3 matrix", 1961.
    """
    q = (a[0, 0] + a[1, 1] + a[2, 2]) / 3.0
    off = a[0, 1] ** 2 + a[0, 2] ** 2 + a[1, 2] ** 2
    p = math.sqrt(((a[0, 0] - q) ** 2 + (a[1, 1] - q) ** 2 + (a[2, 2] - q) ** 2 + 2.0 * off) / 6.0)
    normal[:] = 0.0
    if p <= 1e-12:
        return
    x, y, z = (a[0, 0] - q) / p, (a[1, 1] - q) / p, (a[2, 2] - q) / p
    u, v, w = a[0, 1] / p, a[0, 2] / p, a[1, 2] / p
    r = (x * (y * z - w * w) - u * (u * z - w * v) + v * (u * w - y * v)) / 2.0
    least = q + 2.0 * p * math.cos(math.acos(min(max(r, -1.0), 1.0)) / 3.0 + 2.0 * math.pi / 3.0)
    x, y, z = a[0, 0] - least, a[1, 1] - least, a[2, 2] - least
    u, v, w = a[0, 1], a[0, 2], a[1, 2]
    # Of the products of two rows of a - least, the longest.
    best = 0.0
    for pair in range(3):
        if pair == 0:
            i, j, k = u * w - v * y, v * u - x * w, x * y - u * u
        elif pair == 1:
            i, j, k = u * z - v * w, v * v - x * z, x * w - u * v
        else:
            i, j, k = y * z - w * w, w * v - u * z, u * w - y * v
        square = i * i + j * j + k * k
        if square > best:
            best = square
            length = math.sqrt(square)
            normal[0], normal[1], normal[2] = i / length, j / length, k / length


@inlined
def surface_normal(voxels: Voxels, element: Array, normal: Array) -> None:
    """Write the normal of the surface about an ``element`` into ``normal`` (3,); zero where there is none."""
    x, y, z = element_voxel(voxels, element)
    elements = voxels.elements
    mean, square, weight, count = np.zeros(3), np.zeros((3, 3)), 0.0, 0
    for i in range(x - 1, x + 2):
        for j in range(y - 1, y + 2):
            for k in range(z - 1, z + 2):
                index = element_at(voxels, i, j, k)
                if index < 0:
                    continue
                hits = elements[index, HITS]
                count += 1
                weight += hits
                for r in range(3):
                    offset = elements[index, MEAN + r] - element[MEAN + r]
                    mean[r] += hits * offset
                    for s in range(r + 1):
                        square[r, s] += hits * offset * (elements[index, MEAN + s] - element[MEAN + s])
    normal[:] = 0.0
    if count < _FEWEST:
        return
    for r in range(3):
        for s in range(r + 1):
            square[r, s] = square[r, s] / weight - mean[r] * mean[s] / (weight * weight)
            square[s, r] = square[r, s]
    least_direction(square, normal)
