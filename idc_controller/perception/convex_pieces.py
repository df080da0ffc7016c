"""Convex pieces that cover the points of the standing map, and close no gap that was seen free."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from idc_controller.arrays import Array, Indices
from idc_controller.geometry.box import Wall
from idc_controller.perception.piece_cutting import Body, cut
from idc_controller.perception.standing_map import StandingMap, SurfaceElements
from idc_controller.perception.upright_box_kernels import extended_box, fitted_box, reaches_out
from idc_controller.perception.voxel_kernels import EDGE

_TRIES = 20
"""Pairs of pieces that one update tries to merge."""
_LARGER = 1.5
"""Growth of a pair's number of voxels after which its merging is tried again."""
_NOWHERE = np.empty(0, dtype=np.int64)


@dataclass(eq=False)
class Piece:
    """An upright box that covers the points in some voxels of the standing map."""

    number: int
    members: Indices
    """Indices of the voxels' elements in the map (n,)."""
    numbers: Indices
    """Their serial numbers (n,)."""
    box: Array
    """See :mod:`idc_controller.perception.upright_box_kernels` (8,)."""
    hits: float
    """Scans that had hit them when the box was computed from all of them."""
    tried: dict[int, int] = field(default_factory=dict)
    """Voxels of both when it could not be merged with another piece."""

    @property
    def name(self) -> str:
        """The same for as long as most of the piece exists."""
        return f"piece {self.number}"

    @property
    def centre(self) -> Array:
        """(3,), NED (m)."""
        return self.box[:3]

    @property
    def shape(self) -> Wall:
        """The body about its centre."""
        x, y, z = (2.0 * self.box[3:6]).tolist()
        return Wall((x, y, z), math.atan2(self.box[7], self.box[6]))

    @property
    def bounds(self) -> Array:
        """Lower and upper bounds (2, 3) (m)."""
        x, y, z, c, s = self.box[3:].tolist()
        reach = np.array([x * abs(c) + y * abs(s), x * abs(s) + y * abs(c), z])
        return np.array([self.box[:3] - reach, self.box[:3] + reach])


class ConvexPieces:
    """The pieces, kept up to date with what changes in the map."""

    def __init__(self) -> None:
        self._pieces: dict[int, Piece] = {}
        self._owners = np.full((0, 2), -1)
        self._bounds = np.empty((0, 6))
        self._waiting: deque[int] = deque()
        self._next = 1

    def update(self, standing: StandingMap) -> list[Piece]:
        """Return the pieces after all that has changed in the map since the last call."""
        blocks, first, surface = standing.take_changed_blocks()
        if len(blocks):
            more = 2 * standing.element_count - len(self._owners)
            if standing.element_count > len(self._owners):
                self._owners = np.vstack([self._owners, np.full((more, 2), -1)])
                self._bounds = np.vstack([self._bounds, np.zeros((more, 6))])
            elements = standing.elements_of(blocks[surface])
            standing.cover(elements.indices, self._bounds)
            self._recompute(standing, blocks, first)
            if len(elements.indices):
                self._cover(standing, elements)
        self._merge(standing)
        return list(self._pieces.values())

    def _recompute(self, standing: StandingMap, blocks: Indices, first: Indices) -> None:
        """Compute anew the pieces in changed ``blocks`` of whose points some are freed, or that hold a gap now.

        One of those that were hit twice as often as when they were computed is, too: its points are surer.
        """
        if not self._pieces:
            return
        ripe, voxel = None, standing.settings.voxel
        pieces = list(self._pieces.values())
        bounds = np.array([piece.bounds for piece in pieces])
        within = (first * voxel <= bounds[:, None, 1]) & ((first + EDGE) * voxel >= bounds[:, None, 0])
        touched = np.asarray(within.all(axis=2))
        for i in np.flatnonzero(touched.any(axis=1)).tolist():
            piece = pieces[i]
            current = standing.are_current(piece.members, piece.numbers)
            if not current.all():
                self._rebuild(standing, piece, piece.members[current])
            elif len(standing.gaps(piece.box, 1, blocks[touched[i]])):
                self._rebuild(standing, piece, piece.members)
            elif ripe is None and standing.hits(piece.members) >= 2.0 * piece.hits:
                ripe = piece
        if ripe is not None:
            self._rebuild(standing, ripe, ripe.members)

    def _cover(self, standing: StandingMap, elements: SurfaceElements) -> None:
        """Extend pieces to the points that reach out of them or belong to none, or begin new ones."""
        indices, numbers, tolerance = elements.indices, elements.numbers, standing.settings.tolerance
        known = self._owners[indices]
        owners = np.where(known[:, 1] == numbers, known[:, 0], -1)
        left = []
        for owner, rows in _groups(owners):
            if owner < 0:
                continue
            piece = self._pieces[owner]
            beyond = rows[reaches_out(piece.box, self._bounds, indices[rows], tolerance)]
            if len(beyond) and not self._extend(standing, piece, indices[beyond], _NOWHERE):
                keep = ~np.isin(piece.members, indices[beyond])
                piece.members, piece.numbers = piece.members[keep], piece.numbers[keep]
                self._owners[indices[beyond]] = -1
                if not len(piece.members):
                    del self._pieces[owner]
                left.append(beyond)
        new = np.flatnonzero(owners < 0)
        nearest = standing.nearest_owners(indices[new], self._owners)
        for owner, places in _groups(nearest):
            rows = new[places]
            if owner < 0 or not self._extend(standing, self._pieces[owner], indices[rows], numbers[rows]):
                left.append(rows)
        if left:
            rows = np.concatenate(left)
            means = elements.means[rows]
            for group in _connected(means, standing.settings.bridged_gap):
                for body in cut(standing, self._bounds, indices[rows[group]]):
                    self._begin(standing, body)

    def _extend(self, standing: StandingMap, piece: Piece, members: Indices, numbers: Indices) -> bool:
        """Extend a piece to the points of elements; return whether that closes no gap, else leave it.

        ``numbers``: serial numbers of new ``members`` (n,); none, where they are members already.
        """
        box = extended_box(piece.box, self._bounds, members)
        if len(standing.gaps(box, 1)):
            box = fitted_box(self._bounds, np.concatenate([piece.members, members]))
            if len(standing.gaps(box, 1)):
                return False
        piece.box = box
        if len(numbers):
            self._own(piece, members, numbers)
        self._changed(piece)
        return True

    def _rebuild(self, standing: StandingMap, piece: Piece, members: Indices) -> None:
        """Compute a piece anew from its ``members``, in several pieces where need be: most of it keeps its name."""
        if not len(members):
            del self._pieces[piece.number]
            return
        standing.cover(members, self._bounds)
        first, *others = cut(standing, self._bounds, members)
        piece.members, piece.numbers = _NOWHERE, _NOWHERE
        piece.box, piece.hits = first.box, standing.hits(first.members)
        self._own(piece, first.members, standing.numbers(first.members))
        self._changed(piece)
        for body in others:
            self._begin(standing, body)

    def _begin(self, standing: StandingMap, body: Body) -> None:
        piece = Piece(self._next, _NOWHERE, _NOWHERE, body.box, standing.hits(body.members))
        self._next += 1
        self._pieces[piece.number] = piece
        self._own(piece, body.members, standing.numbers(body.members))
        self._changed(piece)

    def _own(self, piece: Piece, members: Indices, numbers: Indices) -> None:
        piece.members = np.concatenate([piece.members, members])
        piece.numbers = np.concatenate([piece.numbers, numbers])
        self._owners[members, 0], self._owners[members, 1] = piece.number, numbers

    def _changed(self, piece: Piece) -> None:
        if piece.number not in self._waiting:
            self._waiting.append(piece.number)

    def _merge(self, standing: StandingMap) -> None:
        """Merge pieces where that closes no gap, a bounded number of tries."""
        tries = 0
        while self._waiting and tries < _TRIES:
            piece = self._pieces.get(self._waiting.popleft())
            if piece is None:
                continue
            for other in self._near(piece, standing.settings.bridged_gap):
                voxels = len(piece.members) + len(other.members)
                if voxels < _LARGER * piece.tried.get(other.number, 0):
                    continue
                tries += 1
                if self._merged(standing, *sorted((piece, other), key=lambda p: p.number)):
                    break
                piece.tried[other.number] = other.tried[piece.number] = voxels

    def _near(self, piece: Piece, gap: float) -> Sequence[Piece]:
        """Return the pieces within ``gap`` (m) of one, those first with which it makes the smallest box."""
        others = [other for other in self._pieces.values() if other is not piece]
        if not others:
            return []
        low, high = piece.bounds
        bounds = np.array([other.bounds for other in others])
        near = np.flatnonzero(((bounds[:, 0] <= high + gap) & (bounds[:, 1] >= low - gap)).all(axis=1))
        size = np.maximum(bounds[near, 1], high) - np.minimum(bounds[near, 0], low)
        return [others[i] for i in near[np.argsort(size.prod(axis=1))].tolist()]

    def _merged(self, standing: StandingMap, older: Piece, younger: Piece) -> bool:
        """Merge two pieces into the older one; return False, with both as they are, where that closes a gap."""
        box = fitted_box(self._bounds, np.concatenate([older.members, younger.members]))
        if len(standing.gaps(box, 1)):
            return False
        del self._pieces[younger.number]
        self._own(older, younger.members, younger.numbers)
        older.box, older.hits = box, older.hits + younger.hits
        older.tried.clear()
        self._changed(older)
        return True


def _groups(values: Indices) -> Iterable[tuple[int, Indices]]:
    """Return each of the ``values`` (n,) with its rows."""
    order = np.argsort(values, kind="stable")
    found, begins = np.unique(values[order], return_index=True)
    return zip(found.tolist(), np.split(order, begins[1:]), strict=False)


def _connected(points: Array, gap: float) -> list[Indices]:
    """Return the rows of ``points`` (n, 3) that are connected by steps up to ``gap`` (m), group by group."""
    pairs = cKDTree(points).query_pairs(gap, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    return [rows for _, rows in _groups(connected_components(graph, directed=False)[1].astype(np.int64))]
