"""The graph of a lattice in which detours are searched, compiled."""

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.compiled import kernel

_TIE = 1e-9  # m, so that no edge is without cost


@kernel("boolean[::1](int64[::1], int32[::1], int64[::1], int64[::1])")
def connected(flat: Indices, number: NDArray[np.int32], steps: Indices, starts: Indices) -> Mask:
    """Return which nodes some of ``starts`` lead to by way of neighbours, whether or not there are edges (n,).

    ``flat``, ``number``, ``steps``: as of :func:`lattice_graph`.
    """
    found = np.zeros(len(flat), dtype=np.bool_)
    waiting = np.empty(len(flat), dtype=np.int64)
    count = 0
    for start in starts:
        if not found[start]:
            found[start], waiting[count] = True, start
            count += 1
    while count:
        count -= 1
        place = flat[waiting[count]]
        for step in steps:
            node = number[place + 2 * step]
            if node >= 0 and not found[node]:
                found[node], waiting[count] = True, node
                count += 1
    return found


@kernel(
    "Tuple((float64[::1], int32[::1], int32[::1]))(int64[::1], int32[::1], boolean[::1], int64[::1], float64[::1],"
    " float64[::1], int64[::1], float64[::1], boolean[::1])"
)
def lattice_graph(
    flat: Indices,
    number: NDArray[np.int32],
    free: Mask,
    steps: Indices,
    lengths: Array,
    to_goal: Array,
    first: Indices,
    out: Array,
    is_last: Mask,
) -> tuple[Array, NDArray[np.int32], NDArray[np.int32]]:
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
    count = len(flat)
    begins = np.empty(count + 3, dtype=np.int32)
    edges = 0
    for node in range(count):
        edges += is_last[node]
        for step in steps:
            edges += number[flat[node] + 2 * step] >= 0 and free[flat[node] + step]
    costs, heads = np.empty(edges + len(first)), np.empty(edges + len(first), dtype=np.int32)
    at = 0
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
