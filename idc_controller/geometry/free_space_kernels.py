"""Free space of the formation on segments and lattices, compiled; see :mod:`idc_controller.geometry.free_space`.

A body is a row of 7 numbers, a shape's upright bounds. The formation is a row of 6, its upright bounds: radius, height
above and depth below the payload's centre, half edges north and east of the rectangle and how far its rounded corners
reach beyond (m). SI, NED.
"""

import math

import numpy as np

from idc_controller.arrays import Array, Array1, Array2, Indices1, Links1, Mask1
from idc_controller.compiled import inlined, kernel

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
_SEARCH_STEPS = 20
"""Of golden section: to 1e-4 of a segment."""
_TIE = 1e-9  # m, so that no edge is without cost


@inlined
def _joined(a: float, b: float) -> float:
    """Return the distance to the region where both gaps, at right angles, are below zero; negative inside."""
    u, v = max(a, 0.0), max(b, 0.0)
    return math.sqrt(u * u + v * v) + min(max(a, b), 0.0)


@inlined
def _distance(body: Array, formation: Array, x: float, y: float, z: float) -> float:
    """Return the distance (m) between a body and the formation (x, y, z) away from it, or somewhat less; < 0 inside.

    Its horizontal part is the larger of two lower bounds, both convex: the distance to the formation's circle, and the
    largest distance along an edge of one of the rectangles (separating axes).
    """
    c, s = body[5], body[6]
    u, v = abs(c * x + s * y) - body[0], abs(c * y - s * x) - body[1]
    circle = _joined(u, v) - formation[0]
    c, s, above, below, half_x, half_y = abs(c), abs(s), formation[1], formation[2], formation[3], formation[4]
    along = max(abs(x) - half_x - body[0] * c - body[1] * s, abs(y) - half_y - body[0] * s - body[1] * c)
    along = max(along, max(u - half_x * c - half_y * s, v - half_x * s - half_y * c))
    level = max(circle, along - formation[5]) - body[3]
    height = abs(z + (below - above) / 2.0) - body[2] - (below + above) / 2.0
    return float(_joined(level, height) - body[4])


@inlined
def _distance_to(body: Array, formation: Array, centre: Array, place: Array) -> float:
    """Return that between a body at ``centre`` (3,) and the formation at ``place`` (3,)."""
    return _distance(body, formation, place[0] - centre[0], place[1] - centre[1], place[2] - centre[2])


@inlined
def _least_distance(body: Array, formation: Array, centre: Array, start: Array, end: Array) -> float:
    """Return the least distance (m) to a body at ``centre`` (3,) on the segment from ``start`` to ``end`` (3,)."""
    low, high, least, place = 0.0, 1.0, math.inf, np.empty(3)
    shares, distances = np.empty(2), np.empty(2)
    for _ in range(_SEARCH_STEPS):
        shares[0], shares[1] = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        for k in range(2):
            for i in range(3):
                place[i] = start[i] + shares[k] * (end[i] - start[i])
            distances[k] = _distance_to(body, formation, centre, place)
            least = min(least, distances[k])
        if distances[0] > distances[1]:
            low = shares[0]
        else:
            high = shares[1]
    return least


@kernel
def keep_away(
    starts: Array2, ends: Array2, least: Array1, centres: Array2, growth: Array1, bodies: Array2, formation: Array1
) -> Mask1:
    """Return whether the clearance is ``least`` (M,) (m) or more on the segments ``starts`` to ``ends`` (E, 3) -> (E,).

    Args:
        starts, ends, least: see above (m).
        centres: of the bodies (M, 3) (m).
        growth: by which they are taken larger (M,) (m).
        bodies: (M, 7).
        formation: (6,).
    """
    kept, place = np.ones(len(starts), dtype=np.bool_), np.empty(3)
    for e in range(len(starts)):
        start, end, square = starts[e], ends[e], 0.0
        for i in range(3):
            place[i] = (start[i] + end[i]) / 2.0
            square += (end[i] - start[i]) * (end[i] - start[i])
        half = math.sqrt(square) / 2.0
        for m in range(len(centres)):
            body, centre = bodies[m], centres[m]
            middle = _distance_to(body, formation, centre, place) - growth[m] - least[m]
            # Nowhere does the distance change faster than the place.
            if middle > 2.0 * half:
                continue
            at_start, at_end = (
                _distance_to(body, formation, centre, start) - growth[m],
                _distance_to(body, formation, centre, end) - growth[m],
            )
            outer = min(at_start, at_end) - least[m]
            kept[e] = middle >= 0.0 and outer >= 0.0
            if kept[e] and outer + middle < half:
                kept[e] = _least_distance(body, formation, centre, start, end) - growth[m] >= least[m]
            if not kept[e]:
                break
    return kept


@kernel
def lattice_graph(
    flat: Indices1, number: Links1, free: Mask1, steps: Indices1, lengths: Array1, to_goal: Array1, first: Indices1,
    out: Array1, is_last: Mask1,
) -> tuple[Array1, Links1, Links1]:  # fmt: skip
    """Return costs, heads and where each row begins, as a sparse matrix of rows has them: nodes, start, goal.

    An edge costs its length less what it gains on the goal.

    Args:
        flat: places of the n nodes in the arrays of the lattice (n,).
        number: of the node at each place, -1 where there is none.
        free: whether the formation is free at each place.
        steps: from a node to the middle of each of its edges (D,).
        lengths: of these edges (D,) (m).
        to_goal: distance from each node to the goal (n,) (m).
        first: nodes next to the start.
        out: costs of the edges to these.
        is_last: whether a node is next to the goal (n,).
    """
    count, edges = len(flat), len(first)
    for node in range(count):
        edges += is_last[node]
        for step in steps:
            edges += number[flat[node] + 2 * step] >= 0 and free[flat[node] + step]
    begins = np.empty(count + 3, dtype=np.int32)
    costs, heads, at = np.empty(edges), np.empty(edges, dtype=np.int32), 0
    for node in range(count):
        begins[node] = at
        for d in range(len(steps)):
            head = number[flat[node] + 2 * steps[d]]
            if head >= 0 and free[flat[node] + steps[d]]:
                costs[at] = max(lengths[d] + to_goal[head] - to_goal[node], 0.0) + _TIE
                heads[at] = head
                at += 1
        if is_last[node]:
            costs[at], heads[at] = _TIE, count + 1
            at += 1
    begins[count] = at
    for i in range(len(first)):
        costs[at], heads[at] = max(out[i], 0.0) + _TIE, first[i]
        at += 1
    begins[count + 1] = begins[count + 2] = at
    return costs, heads, begins
