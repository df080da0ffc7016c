"""Detours: a polyline on which the whole formation keeps its distance from obstacles, or why there is none.

A shortest path on a grid chooses the side (over, left, right, between), from all there are; visibility then
straightens it to few waypoints. The grid's edges are proven, not sampled: the distance to a convex body is convex
along an edge, so ends that keep r = sqrt(margin^2 + (edge/2)^2) keep the margin in between. A fence's edges are such
bodies, so between ends in its area the area is not left.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import label
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from idc_controller.arrays import Array
from idc_controller.geometry.free_space import FreeSpace
from idc_controller.geometry.free_space_kernels import lattice_graph
from idc_controller.guidance.settings import DetourSettings
from idc_controller.guidance.straightening import free_segments_from, straightened
from idc_controller.trajectory.trajectory import point

Box = tuple[Array, Array]
"""Two opposite corners, NED (m)."""

_LONGER = (2.0, 6.0, math.inf)  # m than the straight line: limit of a path's length in three searches

_HALF = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if (i, j, k) > (0, 0, 0)]
_DIRECTIONS = np.array([*_HALF, *[(-i, -j, -k) for i, j, k in _HALF]])


@dataclass(frozen=True, eq=False)
class Detour:
    """A path from start to goal, or the reason why there is none."""

    waypoints: Array | None
    """(M, 3) NED (m), start and goal included."""
    reason: str = ""

    @property
    def length(self) -> float:
        """Length of the path (m); inf where there is none."""
        if self.waypoints is None:
            return math.inf
        return float(np.linalg.norm(np.diff(self.waypoints, axis=0), axis=1).sum())


def find_detour(
    space: FreeSpace,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    names: Sequence[str] | None = None,
    settings: DetourSettings = DetourSettings(),
) -> Detour:
    """Return the shortest path for the formation in free ``space`` from ``start`` to ``goal`` (3,), NED (m).

    The straight line if it is free; otherwise over, under, left or right of the obstacles on it. Straight lines
    between the waypoints keep the margin; whoever flies round their corners adds what is cut off there. A
    start nearer to an obstacle than that is left on a path that does not come nearer. Deterministic.

    ``names``: the obstacles', for the reason; None: by their kinds.

    Raises:
        TrajectoryError: what is given has no meaning.
    """
    begin, end = point(start, "start"), point(goal, "goal")
    called = names_of(space, names)
    if (reason := _refused(space, end, "goal", called)) is not None:
        return Detour(None, reason)
    if free_segments_from(space, begin, end[None])[0]:
        return Detour(np.array([begin, end]))
    boxes = [search_region(space, begin, end, settings)]
    if space.area is not None:
        whole = whole_region(space, begin, end, settings)
        boxes += [whole] if not np.array_equal(whole, boxes[0]) else []
    spacing, fine = settings.spacing, settings.fine_spacing
    reason = ""
    for box in boxes:
        coarser = max(1.0, (float(np.prod((box[1] - box[0]) / spacing + 1.0)) / settings.nodes_max) ** (1.0 / 3.0))
        for horizontal in (spacing, fine):
            grid = _Grid(space, box, coarser * np.array([horizontal, horizontal, spacing]), begin, end)
            nodes, reason = grid.path(settings.leave_within)
            if nodes is not None:
                return Detour(straightened(space, nodes, settings))
    if not space.is_free(begin[None])[0]:
        reason = (_refused(space, begin, "start", called) or reason) + ", and no path leads out of there"
    return Detour(None, reason)


def names_of(space: FreeSpace, names: Sequence[str] | None) -> list[str]:
    """Return the ``names`` of the obstacles, if there are none by their kinds."""
    return list(names) if names is not None else [f"{shape.kind} {i}" for i, shape in enumerate(space.shapes, start=1)]


def _refused(space: FreeSpace, place: Array, what: str, names: Sequence[str]) -> str | None:
    """Return why the formation cannot be at ``place``; None: it can."""
    altitude = -place[2]
    if not space.lowest - 1e-6 <= altitude <= space.highest + 1e-6:
        return f"the {what}, {altitude:.2f} m high, is not within {space.lowest:g} to {space.highest:g} m"
    if space.area is not None and not space.area.contains(place[None])[0]:
        return f"the formation at the {what} would be outside the fence"
    if len(space.centres):
        clearance = space.clearance(place[None])[0]
        nearest = int(np.argmin(clearance))
        if clearance[nearest] <= 0.0:
            lacking = f"{space.margin - clearance[nearest]:.2f} m are missing for the margin"
            return f"the formation at the {what} would meet {names[nearest]}: {lacking}"
        if clearance[nearest] < space.margin - 1e-6:
            return (
                f"the formation at the {what} would be {clearance[nearest]:.2f} m from {names[nearest]}, "
                f"less than the margin of {space.margin:g} m"
            )
    return None


def search_region(space: FreeSpace, start: Array, goal: Array, settings: DetourSettings) -> Box:
    """Return a box about start and goal that holds the obstacles in between, and a path round them.

    It is ``region_max`` wide at most: a path that leads farther round is none.
    """
    keep = space.formation.radius + space.margin + settings.around
    low, high = np.minimum(start, goal)[:2] - keep, np.maximum(start, goal)[:2] + keep
    lows = space.centres[:, :2] - (space.lateral_reach + keep)[:, None]
    highs = space.centres[:, :2] + (space.lateral_reach + keep)[:, None]
    inside = np.zeros(len(lows), dtype=bool)
    while True:  # obstacles that reach into the region widen it, and so may bring in others
        reach_in = np.all((highs - settings.around > low) & (lows + settings.around < high), axis=1)
        if not (reach_in & ~inside).any():
            break
        inside |= reach_in
        low, high = np.minimum(low, lows[inside].min(axis=0)), np.maximum(high, highs[inside].max(axis=0))
    middle = (start + goal)[:2] / 2.0
    most = np.maximum(settings.region_max / 2.0, np.abs(goal - start)[:2] / 2.0 + keep)
    low, high = np.maximum(low, middle - most), np.minimum(high, middle + most)
    top = max(-start[2], -goal[2]) + 1.0
    if len(space.centres):  # nothing is gained higher than above all obstacles
        tops = space.vertical_reach - space.centres[:, 2]
        top = max(top, float(tops.max()) + space.margin + space.formation.below + 1.0)
    return np.array([*low, -min(top, space.highest)]), np.array([*high, -space.lowest])


def whole_region(space: FreeSpace, start: Array, goal: Array, settings: DetourSettings) -> Box:
    """Return :func:`search_region`, but in a fence as wide as that: the way within it may lead farther round."""
    if space.area is not None:
        settings = replace(settings, region_max=math.inf)
    return search_region(space, start, goal, settings)


class _Grid:
    """A lattice over a box, with the first node of every axis placed such that the start is a node."""

    def __init__(self, space: FreeSpace, box: Box, spacing: Array, start: Array, goal: Array) -> None:
        self._space, self._spacing = space, spacing
        self._start, self._goal = start, goal
        # Nodes and the middles between them, numbered together: nodes have even numbers.
        low = np.floor((box[0] - start) / spacing + 1e-9)
        high = np.ceil((box[1] - start) / spacing - 1e-9)
        low[2], high[2] = np.ceil((box[0] - start) / spacing - 1e-9)[2], np.floor((box[1] - start) / spacing + 1e-9)[2]
        axes = [s + h * np.arange(2 * a, 2 * b + 1) / 2.0 for s, h, a, b in zip(start, spacing, low, high, strict=True)]
        edge = float(np.linalg.norm(spacing)) / 2.0
        needed = math.hypot(space.margin, edge / 2.0) - space.margin
        # A frame of nodes that are not free: no neighbour is ever outside.
        self._free = np.pad(space.free_lattice(axes[0], axes[1], axes[2], needed), 2)
        self._strides = np.array([self._free.shape[1] * self._free.shape[2], self._free.shape[2], 1])
        self._axes = axes

    def path(self, leave_within: float) -> tuple[Array | None, str]:
        """Points (M, 3) of the shortest path from start to goal, or None and why."""
        nodes = np.argwhere(self._free[2:-2:2, 2:-2:2, 2:-2:2])
        places = np.column_stack([axis[2 * index] for axis, index in zip(self._axes, nodes.T, strict=True)])
        starts, goals = (self._entries(places, end, leave_within) for end in (self._start, self._goal))
        if len(starts) == 0:
            return None, "there is no free space about the start"
        if len(goals) == 0:
            return None, "there is no free space about the goal"
        parts, _ = label(self._free[2:-2:2, 2:-2:2, 2:-2:2], np.ones((3, 3, 3)))
        part = parts[tuple(nodes.T)]
        reachable = np.isin(part, part[starts])
        if not reachable[goals].any():
            return None, "every path from start to goal is closed or too narrow for the formation"
        to_goal = np.linalg.norm(places - self._goal, axis=1)
        from_start = np.linalg.norm(places - self._start, axis=1)
        straight = float(np.linalg.norm(self._goal - self._start))
        for longer in _LONGER:
            # No path that is at most so much longer leaves this ellipsoid.
            chosen = np.flatnonzero(reachable & (to_goal + from_start <= straight + longer))
            found = self._search(nodes, places, chosen, starts, goals, longer)
            if found is not None:
                return np.vstack([self._start, places[found], self._goal]), ""
        return None, "every path from start to goal is closed or too narrow for the formation"

    def _entries(self, places: Array, place: Array, leave_within: float) -> NDArray[np.intp]:
        """Indices of the nodes next to ``place`` to which, or from which, there is a path."""
        distance = np.linalg.norm(places - place, axis=1)
        for within in (1.8 * float(self._spacing.max()), leave_within):
            near = np.flatnonzero(distance <= within)
            if len(near) > 400:
                near = near[np.argsort(distance[near], kind="stable")[:400]]
            near = near[free_segments_from(self._space, place, places[near])]
            if len(near):
                break
        return near

    def _search(
        self,
        nodes: NDArray[np.intp],
        places: Array,
        chosen: NDArray[np.intp],
        starts: NDArray[np.intp],
        goals: NDArray[np.intp],
        longer: float,
    ) -> NDArray[np.intp] | None:
        """Indices of the nodes on the shortest path among the ``chosen`` ones; None: there is none."""
        count = len(chosen)
        flat = (2 * nodes[chosen] + 2) @ self._strides
        number = np.full(self._free.size, -1, dtype=np.int32)
        number[flat] = np.arange(count)
        # Each edge costs its length less what it gains on the goal: Dijkstra then searches as A* does, and what
        # it counts is how much longer than straight the path is.
        to_goal = np.linalg.norm(places[chosen] - self._goal, axis=1)
        straight = float(np.linalg.norm(self._goal - self._start))
        lengths = np.linalg.norm(_DIRECTIONS * self._spacing, axis=1)
        back = np.full(len(places), -1)
        back[chosen] = np.arange(count)
        first, last = (back[ends][back[ends] >= 0] for ends in (starts, goals))
        out = np.linalg.norm(places[chosen[first]] - self._start, axis=1) + to_goal[first] - straight
        is_last = np.zeros(count, dtype=bool)
        is_last[last] = True
        graph = csr_array(
            lattice_graph(
                flat, number, self._free.ravel(), _DIRECTIONS @ self._strides, lengths, to_goal, first, out, is_last
            ),
            shape=(count + 2, count + 2),
        )
        limit = longer + 1e-3
        distance, before = dijkstra(graph, indices=count, return_predecessors=True, limit=limit)
        if not np.isfinite(distance[count + 1]):
            return None
        path = [int(before[count + 1])]
        while path[-1] != count:
            path.append(int(before[path[-1]]))
        return chosen[np.array(path[-2::-1], dtype=np.intp)]
