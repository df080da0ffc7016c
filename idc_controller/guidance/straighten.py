"""A way made straight: as few waypoints as room allows, and its corners drawn in."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from idc_controller.geometry.free_space import FreeSpace

Array = NDArray[np.float64]

WAYPOINT_COST = 0.15
"""m of way that one waypoint less is worth."""
STRAIGHTENED = 40
"""Points among which the straightening chooses its waypoints."""


def ways_out(room: FreeSpace, place: Array, ends: Array) -> NDArray[np.bool_]:
    """Whether the way from ``place`` (3,) to each of ``ends`` (E, 3) is free.

    A place that itself has no room is left on a way that does not come nearer to anything.
    """
    begins = np.broadcast_to(place, ends.shape)
    if room.is_free(place[None])[0]:
        return room.are_free_segments(begins, ends)
    free = room.is_free(ends)
    if len(room.centres):
        allowed = np.minimum(room.clearance(place[None]), room.margin) - 1e-3
        free[free] = room.keep_away(begins[free], ends[free], allowed[0])
    return free


def straightened(room: FreeSpace, way: Array, climb_cost: float) -> Array:
    """The same way with as few and as straight pieces as room allows."""
    scale = np.array([1.0, 1.0, climb_cost])
    points = way
    for _ in range(2):
        points = _tightened(room, _fewest(room, _resampled(points), scale))
    return points


def _tightened(room: FreeSpace, points: Array) -> Array:
    """Every corner moved towards the straight way past it, as far as room allows."""
    points = points.copy()
    # The second point of a way out of too little room stays: it is where room begins.
    first = 1 if room.is_free(points[:1])[0] else 2
    for i in [*range(first, len(points) - 1), *range(len(points) - 2, first - 1, -1)]:
        before, corner, after = points[i - 1 : i + 2]
        way = after - before
        along = float((corner - before) @ way) / max(float(way @ way), 1e-12)
        straight = before + min(max(along, 0.0), 1.0) * way
        tries = corner + np.linspace(1.0, 0.0, 33)[:-1, None] * (straight - corner)
        free = room.are_free_segments(np.broadcast_to(before, tries.shape), tries)
        free &= room.are_free_segments(tries, np.broadcast_to(after, tries.shape))
        if free.any():
            points[i] = tries[np.argmax(free)]
    return points


def _resampled(points: Array) -> Array:
    """The corners of a way, and more points between them."""
    if len(points) >= STRAIGHTENED:
        return points
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    spacing = max(float(lengths.sum()) / (STRAIGHTENED - len(points)), 0.05)
    pieces = []
    for a, b, length in zip(points[:-1], points[1:], lengths, strict=True):
        number = max(1, round(length / spacing))
        pieces.append(a + (b - a) * (np.arange(number) / number)[:, None])
    return np.vstack([*pieces, points[-1]])


def _fewest(room: FreeSpace, points: Array, scale: Array) -> Array:
    """The best chain of points (M, 3) from the first to the last, in order: short, and with few waypoints."""
    count = len(points)
    first, second = np.triu_indices(count, 1)
    visible = np.zeros((count, count), dtype=bool)
    inner = first > 0
    visible[first[inner], second[inner]] = room.are_free_segments(points[first[inner]], points[second[inner]])
    visible[0, 1:] = ways_out(room, points[0], points[1:])
    visible[np.arange(count - 1), np.arange(1, count)] = True  # the way as it came
    cost = np.linalg.norm((points[:, None] - points[None]) * scale, axis=-1) + WAYPOINT_COST
    best, before = np.full(count, math.inf), np.zeros(count, dtype=int)
    best[0] = 0.0
    for j in range(1, count):
        candidates = np.where(visible[:j, j], best[:j] + cost[:j, j], math.inf)
        before[j] = int(np.argmin(candidates))
        best[j] = candidates[before[j]]
    chain = [count - 1]
    while chain[-1]:
        chain.append(int(before[chain[-1]]))
    return np.asarray(points[chain[::-1]])
