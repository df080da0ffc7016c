"""Straightening: of a path in free space the waypoints of one that is short, and has few of them."""

import math

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.geometry.free_space import FreeSpace
from idc_controller.guidance.settings import DetourSettings


def free_segments_from(space: FreeSpace, place: Array, ends: Array) -> NDArray[np.bool_]:
    """Return whether the segment from ``place`` (3,) to each of ``ends`` (E, 3) is free.

    A place that is itself too near an obstacle is left on a segment that does not come nearer to any.
    """
    begins = np.broadcast_to(place, ends.shape)
    if space.is_free(place[None])[0]:
        return space.are_free_segments(begins, ends)
    free = space.is_free(ends)
    if len(space.centres):
        allowed = np.minimum(space.clearance(place[None]), space.margin) - 1e-3
        free[free] = space.keep_away(begins[free], ends[free], allowed[0])
    return free


def straightened(space: FreeSpace, path: Array, settings: DetourSettings) -> Array:
    """Return the same path with as few and as straight pieces as free space allows."""
    points = path
    for _ in range(2):
        chosen = _fewest(space, _resampled(points, settings.straightened), settings.waypoint_cost)
        points = _tightened(space, chosen)
    return points


def _tightened(space: FreeSpace, points: Array) -> Array:
    """Return the points with every corner moved towards the straight line past it, as far as free space allows."""
    points = points.copy()
    # The second point of a path out of too little clearance stays: it is where free space begins.
    first = 1 if space.is_free(points[:1])[0] else 2
    for i in [*range(first, len(points) - 1), *range(len(points) - 2, first - 1, -1)]:
        before, corner, after = points[i - 1 : i + 2]
        chord = after - before
        along = float((corner - before) @ chord) / max(float(chord @ chord), 1e-12)
        straight = before + min(max(along, 0.0), 1.0) * chord
        tries = corner + np.linspace(1.0, 0.0, 33)[:-1, None] * (straight - corner)
        free = space.are_free_segments(np.broadcast_to(before, tries.shape), tries)
        free &= space.are_free_segments(tries, np.broadcast_to(after, tries.shape))
        if free.any():
            points[i] = tries[np.argmax(free)]
    return points


def _resampled(points: Array, number: int) -> Array:
    """The corners of a path, and more points between them, ``number`` in all."""
    if len(points) >= number:
        return points
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    spacing = max(float(lengths.sum()) / (number - len(points)), 0.05)
    pieces = []
    for a, b, length in zip(points[:-1], points[1:], lengths, strict=True):
        parts = max(1, round(length / spacing))
        pieces.append(a + (b - a) * (np.arange(parts) / parts)[:, None])
    return np.vstack([*pieces, points[-1]])


def _fewest(space: FreeSpace, points: Array, waypoint_cost: float) -> Array:
    """The best chain of points (M, 3) from the first to the last, in order: short, and with few waypoints."""
    count = len(points)
    first, second = np.triu_indices(count, 1)
    visible = np.zeros((count, count), dtype=bool)
    inner = first > 0
    visible[first[inner], second[inner]] = space.are_free_segments(points[first[inner]], points[second[inner]])
    visible[0, 1:] = free_segments_from(space, points[0], points[1:])
    visible[np.arange(count - 1), np.arange(1, count)] = True  # the path as it came
    cost = np.linalg.norm(points[:, None] - points[None], axis=-1) + waypoint_cost
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
