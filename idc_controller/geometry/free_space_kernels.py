"""Free space of the formation on lattices and segments, compiled; see :mod:`idc_controller.geometry.free_space`.

A body is a row of 7 numbers, an :class:`~idc_controller.geometry.shape.UprightBounds`. The formation is a row of 6, its
upright bounds: radius, height above and depth below the payload's centre, half edges north and east of the rectangle
and how far its rounded corners reach beyond (m). SI, NED.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.compiled import inlined, kernel

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
_SEARCH_STEPS = 20  # golden section to 1e-4 of a segment


@inlined
def _joined(a: float, b: float) -> float:
    """Return the distance to the region where both gaps, at right angles, are below zero; negative inside."""
    u, v = max(a, 0.0), max(b, 0.0)
    return float(math.sqrt(u * u + v * v) + min(max(a, b), 0.0))


@inlined
def _level_gap(body: Array, formation: Array, x: float, y: float) -> float:
    """Return the horizontal gap (m) between a body and the formation (x, y) away from it, or somewhat less.

    The larger of two lower bounds, both convex: the distance to the formation's circle, and the largest distance along
    an edge of one of the rectangles (separating axes).
    """
    c, s = body[5], body[6]
    u, v = abs(c * x + s * y), abs(c * y - s * x)
    circle = _joined(u - body[0], v - body[1]) - formation[0]
    c, s, half_x, half_y = abs(c), abs(s), formation[3], formation[4]
    along = max(u - body[0] - half_x * c - half_y * s, v - body[1] - half_x * s - half_y * c)
    along = max(along, abs(x) - half_x - body[0] * c - body[1] * s, abs(y) - half_y - body[0] * s - body[1] * c)
    return float(max(circle, along - formation[5]) - body[3])


@inlined
def _height_gap(body: Array, above: float, below: float, z: float) -> float:
    """Return the vertical gap (m) between a body and the formation z away from it."""
    return float(abs(z + (below - above) / 2.0) - body[2] - (below + above) / 2.0)


@inlined
def _distance(body: Array, formation: Array, x: float, y: float, z: float) -> float:
    """Return the distance (m) between a body and the formation (x, y, z) away from it."""
    level = _level_gap(body, formation, x, y)
    return float(_joined(level, _height_gap(body, formation[1], formation[2], z)) - body[4])


@inlined
def _least_distance(body: Array, formation: Array, offset: Array, segment: Array) -> float:
    """Return the least distance (m) to a body on the ``segment`` (3,) that begins at an ``offset`` (3,) from it."""
    low, high, left, right = 0.0, 1.0, 1.0 - _GOLDEN, _GOLDEN
    at_left, at_right, new, falls = 0.0, 0.0, left, False
    for step in range(_SEARCH_STEPS + 2):
        at_new = _distance(
            body, formation, offset[0] + new * segment[0], offset[1] + new * segment[1], offset[2] + new * segment[2]
        )
        if step == 0:
            at_left, new = at_new, right
            continue
        if step == 1 or falls:
            at_right = at_new
        else:
            at_left = at_new
        if step == _SEARCH_STEPS + 1:
            break
        falls = at_left > at_right  # the least value lies to the right of `left`
        if falls:
            low, left, at_left = left, right, at_right
            new = right = low + _GOLDEN * (high - low)
        else:
            high, right, at_right = right, left, at_left
            new = left = high - _GOLDEN * (high - low)
    return float(min(at_left, at_right))


@kernel(
    "boolean[::1](float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1], float64[::1], float64[:, ::1],"
    " float64[::1])"
)
def keep_away(
    starts: Array, ends: Array, least: Array, centres: Array, growth: Array, bodies: Array, formation: Array
) -> Mask:
    """Return whether the clearance is ``least`` (M,) (m) or more on the segments ``starts`` to ``ends`` (E, 3) -> (E,).

    Args:
        starts, ends, least: see above (m).
        centres: of the bodies (M, 3) (m).
        growth: by which they are taken larger (M,) (m).
        bodies: (M, 7).
        formation: (6,).
    """
    kept = np.ones(len(starts), dtype=np.bool_)
    offset, segment = np.empty(3), np.empty(3)
    for e in range(len(starts)):
        square = 0.0
        for i in range(3):
            segment[i] = ends[e, i] - starts[e, i]
            square += segment[i] * segment[i]
        half = math.sqrt(square) / 2.0
        for m in range(len(centres)):
            for i in range(3):
                offset[i] = (starts[e, i] + ends[e, i]) / 2.0 - centres[m, i]
            middle = _distance(bodies[m], formation, offset[0], offset[1], offset[2]) - growth[m] - least[m]
            # Nowhere does the distance change faster than the place.
            if middle > 2.0 * half:
                continue
            for i in range(3):
                offset[i] = ends[e, i] - centres[m, i]
            outer = _distance(bodies[m], formation, offset[0], offset[1], offset[2])
            for i in range(3):
                offset[i] = starts[e, i] - centres[m, i]
            outer = min(outer, _distance(bodies[m], formation, offset[0], offset[1], offset[2])) - growth[m] - least[m]
            kept[e] = middle >= 0.0 and outer >= 0.0
            if kept[e] and outer + middle < half:
                kept[e] = _least_distance(bodies[m], formation, offset, segment) - growth[m] >= least[m]
            if not kept[e]:
                break
    return kept


@kernel(
    "void(boolean[:, :, ::1], float64[::1], float64[::1], float64[::1], float64[::1], float64[::1], float64[:, ::1],"
    " float64[:, ::1], float64[::1])"
)
def bar_lattice(
    free: Mask,
    north: Array,
    east: Array,
    down: Array,
    keep: Array,
    around: Array,
    centres: Array,
    bodies: Array,
    formation: Array,
) -> None:
    """Clear ``free`` (X, Y, Z) where the formation is too near a body.

    Args:
        free: to be changed.
        north, east, down: coordinates (X,), (Y,), (Z,) (m).
        keep: the least distance of each body (M,) (m).
        around: beyond this from its centre, north and east, nothing is near it (M,) (m).
        centres: of the bodies (M, 3) (m).
        bodies: (M, 7).
        formation: (6,).
    """
    over = np.empty(len(down))
    for m in range(len(centres)):
        x, y, z = centres[m, 0], centres[m, 1], centres[m, 2]
        nearest = keep[m] + bodies[m, 4]
        for k in range(len(down)):
            over[k] = max(_height_gap(bodies[m], formation[1], formation[2], down[k] - z), 0.0)
        first, last = np.searchsorted(east, y - around[m]), np.searchsorted(east, y + around[m])
        for i in range(np.searchsorted(north, x - around[m]), np.searchsorted(north, x + around[m])):
            for j in range(first, last):
                across = max(_level_gap(bodies[m], formation, north[i] - x, east[j] - y), 0.0)
                for k in range(len(down)):
                    free[i, j, k] &= across * across + over[k] * over[k] >= nearest * nearest
