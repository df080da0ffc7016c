"""Arrival: how near the payload came to each waypoint of its mission, in order, and where it landed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gcs.mission.targets import Target, Targets
from gcs.record.run_data import RunData
from idc_controller.arrays import Array, Indices

_ROWS_SEARCHED = 1000
"""Rows that are looked at together for the next arrival."""
_MOST_CELLS = 20_000_000
"""Waypoints times rows that are compared; of longer flights fewer rows are."""


@dataclass(frozen=True)
class Miss:
    """A target that was not reached, and by how much (m)."""

    name: str
    distance: float
    reason: str = ""
    """What is in the way there."""

    def __str__(self) -> str:
        """Return it in words, as reasons of flights have it."""
        return f"{self.name} missed by {self.distance:.2f} m" + (f": {self.reason}" if self.reason else "")


@dataclass(frozen=True)
class Arrival:
    """The largest distance to any target (m), None: not known, and the targets that were not reached."""

    largest: float | None
    missed: tuple[Miss, ...] = ()

    def __str__(self) -> str:
        """Return what was missed, in words; empty: nothing."""
        if not self.missed:
            return "" if self.largest is not None else "the records do not show whether the waypoints were reached"
        more = len(self.missed) - 1
        return f"{self.missed[0]}" + (f"; {more} more missed" if more else "")


def arrival(run: RunData, targets: Targets, tolerance: float) -> Arrival:
    """Return how the payload arrived at ``targets``, by the truth or, where there is none, the estimate."""
    if len(run.time) == 0:
        return Arrival(None)
    at, distances = closest_in_order(run.payload_position, targets.waypoints, tolerance)
    missed = [
        Miss(target.name, float(distance), obstruction(run, np.asarray(target.position), int(row)))
        for target, row, distance in zip(targets.waypoints, at, distances, strict=True)
        if distance > tolerance
    ]
    end = run.payload_position[-1]
    place = run.payload_position[0, :2] if targets.landing is None else np.array(targets.landing)
    off = float(math.hypot(*(end[:2] - place)))
    if off > tolerance:
        resting = np.array([*place, end[2]])
        missed.append(Miss("the landing place", off, obstruction(run, resting, len(run.time) - 1)))
    return Arrival(max([off, *distances.tolist()]), tuple(missed))


def closest_in_order(path: Array, targets: Sequence[Target], tolerance: float) -> tuple[Indices, Array]:
    """Return the rows (n,) at which ``path`` (T, 3) is closest to each target, in their order, and how close (n,) (m).

    Distances are those to the straight lines between rows. Where all targets are passed within ``tolerance`` in their
    order, each counts between its first such passage and its last; otherwise the passages in order whose distances have
    the least sum.
    """
    if (first := _passages(path, targets, tolerance)) is not None:
        back = _passages(path[::-1], targets[::-1], tolerance)
        # Backwards, rounding can decide otherwise at the tolerance: then each counts to the end.
        last = max(len(path) - 2, 0) - (np.zeros_like(first) if back is None else back[::-1])
        rows, distances = [], []
        for target, begin, end in zip(targets, first.tolist(), last.tolist(), strict=True):
            away = _distances(path[begin : end + 2], target)
            rows.append(begin + int(np.argmin(away)))
            distances.append(float(away.min()))
        return np.array(rows, dtype=np.int64), np.array(distances)
    every = math.ceil(len(targets) * len(path) / _MOST_CELLS)
    thinned = path[::every]
    best = np.zeros(max(len(thinned) - 1, 1))
    before = np.empty((len(targets), len(best)), dtype=np.int32)
    away = np.empty((len(targets), len(best)), dtype=np.float32)
    number = np.arange(len(best))
    for k, target in enumerate(targets):
        away[k] = _distances(thinned, target)
        best = best + away[k]
        # The row of the least sum so far.
        best = np.minimum.accumulate(best)
        is_new = np.diff(best, prepend=np.inf) < 0.0
        before[k] = np.maximum.accumulate(np.where(is_new, number, 0))
    chosen = np.empty(len(targets), dtype=np.int64)
    latest = len(best) - 1
    for k in range(len(targets) - 1, -1, -1):
        latest = int(before[k, latest])
        chosen[k] = latest
    return chosen * every, away[np.arange(len(targets)), chosen].astype(float)


def _passages(path: Array, targets: Sequence[Target], tolerance: float) -> Indices | None:
    """Return the first rows (n,) in order at which each target is within ``tolerance``; None: there are none."""
    rows, row = [], 0
    for target in targets:
        while True:
            away = _distances(path[row : row + _ROWS_SEARCHED + 1], target)
            within = np.flatnonzero(away <= tolerance)
            if len(within):
                row += int(within[0])
                break
            row += len(away)
            if row >= len(path) - 1:
                return None
        rows.append(row)
    return np.array(rows, dtype=np.int64)


def _distances(path: Array, target: Target) -> Array:
    """Return the distances (T - 1,) (m) of the lines between the rows of ``path`` (T, 3) from a target."""
    axes = slice(2, 3) if target.is_climb else slice(0, 3)
    away = path[:, axes] - np.asarray(target.position)[axes]
    if target.is_landing:
        away[:, 2] = np.minimum(away[:, 2], 0.0)
    if len(away) < 2:
        return np.asarray(np.linalg.norm(away, axis=1))
    start, along = away[:-1], np.diff(away, axis=0)
    length = np.einsum("ij,ij->i", along, along)
    share = np.einsum("ij,ij->i", -start, along) / np.where(length > 0.0, length, 1.0)
    return np.asarray(np.linalg.norm(start + np.clip(share, 0.0, 1.0)[:, None] * along, axis=1))


def obstruction(run: RunData, place: Array, row: int) -> str:
    """Return what is in the way of the formation, level at ``place`` (3,) (NED, m), at the time of ``row``; or empty.

    That is the nearest obstacle, or part of the fence, nearer than twice what plans keep from it: of what the sensors
    detect, plans keep more.
    """
    if not run.number_of_uavs or not run.barriers:
        return ""
    keep = run.kept_clearance
    found = run.level_formation(place[None]).clearances(run.barriers_at(run.time[[row]]))
    clearance = np.nan_to_num(found[0], nan=np.inf)
    nearest = int(np.argmin(clearance))
    if clearance[nearest] > 2.0 * keep:
        return ""
    name = run.barriers[nearest].name
    if clearance[nearest] == 0.0:
        return f"{name} is in the way of the formation there"
    lack = keep - clearance[nearest]
    rest = f"{keep:.2f} m are kept" + (f", {lack:.2f} m are missing" if lack > 0.0 else "")
    return f"{name} is {clearance[nearest]:.2f} m from the formation there, {rest}"
