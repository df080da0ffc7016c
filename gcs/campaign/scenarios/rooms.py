"""Rooms without a roof: walls with doors, dead ends and corridors; the mission leads from one room into another."""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from gcs.campaign.scenarios.layout import Layout, Random
from gcs.campaign.scenarios.passage import Passages
from idc_controller.arrays import Array

HEIGHT = 18.0
"""m: the walls cannot be flown over."""
ROOM, CORRIDOR = (9.6, 13.0), (5.0, 6.2)
"""Width (m) of rooms and of corridors, between the middles of their walls."""
DOOR, NARROW = (4.8, 6.5), (0.9, 2.3)
"""Width (m) of doors that can be passed, and of those that cannot."""
LINTEL, LOW = (5.3, 7.0), (2.4, 3.8)
"""Height (m) of the lintels of some doors: of those that can be passed, and of those that cannot."""
LINTELS = 0.2
"""Share of the doors with a lintel."""
CLOSED = 0.25
"""Share of the layouts with no way."""
MORE_DOORS = 0.15
"""Share of the walls with a door beside those that every room needs."""
JAMB = 0.2
"""m of wall beside a door, at least."""

Cell = tuple[int, int]
Door = frozenset[Cell]
"""The two cells that a door joins."""


def rooms(random: Random, passages: Passages) -> Layout:
    """Return a grid of rooms, each of which a door leads into; some are as narrow as corridors, others dead ends."""
    sizes = [_sizes(random, int(random.integers(2, 4))), _sizes(random, int(random.integers(1, 4)))]
    edges = [np.concatenate([[0.0], np.cumsum(each)]) for each in sizes]
    cells = [(i, j) for i in range(len(sizes[0])) for j in range(len(sizes[1]))]
    large = [cell for cell in cells if all(sizes[axis][cell[axis]] >= ROOM[0] for axis in (0, 1))]
    start = large[random.integers(len(large))]
    doors = _tree(random, cells)
    goal = max((cell for cell in large if cell != start), key=lambda cell: len(_way(doors, start, cell)), default=None)
    heading = random.uniform(-math.pi, math.pi)
    altitude, speed = round(random.uniform(4.0, 6.0), 3), round(random.uniform(1.0, 2.0), 3)
    if goal is None:  # one room: the layout is refused
        return Layout([(1.0, 0.0, -altitude)], speed)
    middles = [[(low + high) / 2.0 for low, high in pairwise(each)] for each in edges]
    origin = np.array([middles[0][start[0]], middles[1][start[1]]])
    turn = np.array([[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]])

    def placed(x: float, y: float) -> tuple[float, float]:
        north, east = turn @ (np.array([x, y]) - origin)
        return float(north), float(east)

    closed = random.random() < CLOSED
    north, east = placed(middles[0][goal[0]], middles[1][goal[1]])
    layout = Layout([(round(north, 3), round(east, 3), -altitude)], speed, not closed)
    way = _way(doors, start, goal)
    narrow = way[random.integers(len(way))] if closed else None
    thickness = random.uniform(0.15, 0.4)
    for (i, j, axis), length in _walls(edges):
        neighbours = frozenset({(i, j), (i - 1, j) if axis == 0 else (i, j - 1)})
        more = not closed and neighbours <= set(cells) and random.random() < MORE_DOORS
        has_door = more or neighbours in doors
        for low, high, bottom in _pieces(random, length, has_door, neighbours == narrow):
            x = edges[0][i] + (0.0 if axis == 0 else (low + high) / 2.0)
            y = edges[1][j] + ((low + high) / 2.0 if axis == 0 else 0.0)
            # Walls meet at the corners.
            along = high - low + (thickness if bottom == 0.0 and (low == 0.0 or high == length) else 0.0)
            size = (thickness, along) if axis == 0 else (along, thickness)
            layout.add_wall("lintel" if bottom else "wall", placed(x, y), (*size, HEIGHT - bottom), heading, bottom)
    return layout


def _pieces(random: Random, length: float, has_door: bool, is_closed: bool) -> list[tuple[float, float, float]]:
    """Return the pieces of a wall of ``length`` (m): begin, end, and height of the underside (m)."""
    if not has_door:
        return [(0.0, length, 0.0)]
    is_low = random.random() < LINTELS
    width = min(random.uniform(*(NARROW if is_closed and not is_low else DOOR)), length - 2.0 * JAMB)
    begin = random.uniform(JAMB, length - width - JAMB)
    pieces = [(0.0, begin, 0.0), (begin + width, length, 0.0)]
    return [*pieces, (begin, begin + width, random.uniform(*(LOW if is_closed else LINTEL)))] if is_low else pieces


def _sizes(random: Random, count: int) -> Array:
    """Return the widths of rooms side by side, one of which may be a corridor."""
    sizes = random.uniform(*ROOM, count)
    if count > 1 and random.random() < 0.5:
        sizes[random.integers(count)] = random.uniform(*CORRIDOR)
    return sizes


def _tree(random: Random, cells: list[Cell]) -> set[Door]:
    """Return doors that join all cells without a loop."""
    joined, doors = {cells[random.integers(len(cells))]}, set[Door]()
    while len(joined) < len(cells):
        choices = [Door((a, b)) for a in sorted(joined) for b in cells if b not in joined and math.dist(a, b) == 1.0]
        door = choices[random.integers(len(choices))]
        doors.add(door)
        joined |= door
    return doors


def _way(doors: set[Door], start: Cell, goal: Cell) -> list[Door]:
    """Return the doors on the way from ``start`` to ``goal``."""
    ways: dict[Cell, list[Door]] = {start: []}
    cells = [start]
    for cell in cells:
        for door in sorted(doors, key=sorted):
            if cell in door:
                (other,) = door - {cell}
                if other not in ways:
                    ways[other] = [*ways[cell], door]
                    cells.append(other)
    return ways[goal]


def _walls(edges: list[Array]) -> Iterator[tuple[tuple[int, int, int], float]]:
    """Yield walls: of the cell (i, j) the one before it on an axis, and its length (m)."""
    nx, ny = len(edges[0]) - 1, len(edges[1]) - 1
    for i in range(nx + 1):
        for j in range(ny):
            yield (i, j, 0), float(edges[1][j + 1] - edges[1][j])
    for i in range(nx):
        for j in range(ny + 1):
            yield (i, j, 1), float(edges[0][i + 1] - edges[0][i])
