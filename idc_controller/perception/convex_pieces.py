"""Convex pieces that cover the points of the standing map, and close no gap that was seen free."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.geometry.shapes import Wall
from idc_controller.perception.piece_cutting import Body, cut
from idc_controller.perception.standing_map import StandingMap, SurfaceElements
from idc_controller.perception.upright_box_kernels import extended_box, fitted_box, reaches_out
from idc_controller.perception.voxel_kernels import EDGE

_TRIES = 20
"""Pairs of pieces that one update tries to merge."""
_LARGER = 1.3
"""Growth of a pair's number of voxels after which its merging is tried again."""
_NOWHERE = np.empty(0, dtype=np.int64)
_LEAST_MEMBERS, _OUTLIERS = 8, 0.02
"""Voxels from which on a body is estimated by them; share of them on each side that are noise."""


@dataclass(eq=False)
class Piece:
    """An upright box that covers the points in some voxels of the standing map."""

    number: int
    """The same for as long as most of the piece exists."""
    row: int
    """Its row in the table of bounds."""
    members: Indices
    """Indices of the voxels' elements in the map (n,)."""
    numbers: Indices
    """Their serial numbers (n,)."""
    box: Array
    """See :mod:`idc_controller.perception.upright_box_kernels` (8,)."""
    hits: float
    """Scans that had hit them when the box was computed from all of them."""
    voxels_tried: int = 0
    """Voxels when merging was tried last."""
    tried: dict[int, int] = field(default_factory=dict)
    """Voxels of both when it could not be merged with another piece."""

    @property
    def centre(self) -> Array:
        """(3,), NED (m)."""
        return self.box[:3]

    def estimate(self, standing: StandingMap) -> tuple[Wall, Array]:
        """Return the most probable body and its centre (3,): the box about the means of its points, not their noise.

        As of the ``standing`` map now; the cover, where too little is left there.
        """
        members = self.members[standing.are_current(self.members, self.numbers)]
        if len(members) < _LEAST_MEMBERS:
            return self.shape, self.centre
        cosine, sine = self.box[6:]
        axes = np.array([(cosine, sine, 0.0), (-sine, cosine, 0.0), (0.0, 0.0, 1.0)])
        places = (standing.elements(members).means - self.centre) @ axes.T
        low, high = np.quantile(places, (_OUTLIERS, 1.0 - _OUTLIERS), axis=0)
        # Its top may be out of the field of view: it is as high as the cover says.
        low[2] = -self.box[5]
        x, y, z = np.maximum(high - low, standing.settings.tolerance).tolist()
        return Wall((x, y, z), self.shape.yaw), self.centre + 0.5 * (low + high) @ axes

    @property
    def shape(self) -> Wall:
        """The body about its centre."""
        x, y, z = (2.0 * self.box[3:6]).tolist()
        return Wall((x, y, z), math.atan2(self.box[7], self.box[6]))


class _Pieces:
    """The pieces by number, and a table of their bounds."""

    def __init__(self) -> None:
        self._by_row: list[Piece | None] = []
        self._table = np.empty((0, 2, 3))
        self._by_number: dict[int, Piece] = {}
        self._last = 0

    def __iter__(self) -> Iterator[Piece]:
        return iter(self._by_number.values())

    def __getitem__(self, number: int) -> Piece:
        return self._by_number[number]

    def get(self, number: int) -> Piece | None:
        """Return the piece of that number, if it still exists."""
        return self._by_number.get(number)

    def begin(self, box: Array, hits: float) -> Piece:
        """Return a new piece without members."""
        row = self._by_row.index(None) if None in self._by_row else len(self._by_row)
        if row == len(self._by_row):
            self._by_row.append(None)
        if row >= len(self._table):
            self._table = np.concatenate([self._table, np.full((len(self._table) + 64, 2, 3), np.nan)])
        self._last += 1
        piece = Piece(self._last, row, _NOWHERE, _NOWHERE, box, hits)
        self._by_row[row] = self._by_number[piece.number] = piece
        self.place(piece, box)
        return piece

    def place(self, piece: Piece, box: Array) -> None:
        """Set the box of a piece."""
        piece.box = box
        x, y, z, h, w, d, c, s = box.tolist()
        u, v = h * abs(c) + w * abs(s), h * abs(s) + w * abs(c)
        self._table[piece.row] = (x - u, y - v, z - d), (x + u, y + v, z + d)

    def remove(self, piece: Piece) -> None:
        """Remove a piece."""
        del self._by_number[piece.number]
        self._by_row[piece.row] = None
        self._table[piece.row] = np.nan

    def near(self, piece: Piece, gap: float) -> list[Piece]:
        """Return the others within ``gap`` (m) of one, those first with which it makes the smallest box."""
        low, high = self._table[piece.row]
        rows = np.flatnonzero(((self._table[:, 0] <= high + gap) & (self._table[:, 1] >= low - gap)).all(axis=1))
        size = np.maximum(self._table[rows, 1], high) - np.minimum(self._table[rows, 0], low)
        found = [self._by_row[row] for row in rows[np.argsort(size.prod(axis=1))].tolist()]
        return [other for other in found if other is not None and other is not piece]

    def touching(self, low: Array, high: Array) -> list[tuple[Piece, Mask]]:
        """Return the pieces that reach into boxes with bounds ``low`` and ``high`` (n, 3), and which of them (n,)."""
        within = np.ones((len(self._table), len(low)), dtype=bool)
        for axis in range(3):
            within &= low[:, axis] <= self._table[:, 1, axis, None]
            within &= high[:, axis] >= self._table[:, 0, axis, None]
        pieces = [(self._by_row[row], within[row]) for row in np.flatnonzero(within.any(axis=1)).tolist()]
        return [(piece, boxes) for piece, boxes in pieces if piece is not None]


class ConvexPieces:
    """The pieces, kept up to date with what changes in the map."""

    def __init__(self) -> None:
        self._pieces = _Pieces()
        self._owners = np.full((0, 2), -1)
        self._bounds = np.empty((0, 6))
        self._waiting: deque[int] = deque()

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
        return list(self._pieces)

    def _recompute(self, standing: StandingMap, blocks: Indices, first: Indices) -> None:
        """Compute anew the pieces in changed ``blocks`` of whose points some are freed, or that hold a gap now.

        One of those that were hit twice as often as when they were computed is, too: its points are surer.
        """
        ripe, voxel = None, standing.settings.voxel
        corners = first.astype(float) * voxel
        for piece, touched in self._pieces.touching(corners, corners + EDGE * voxel):
            current = standing.are_current(piece.members, piece.numbers)
            if not current.all():
                self._rebuild(standing, piece, piece.members[current])
            elif len(standing.gaps(piece.box, 1, blocks[touched])):
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
                    self._pieces.remove(piece)
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
        self._pieces.place(piece, box)
        if len(numbers):
            self._own(piece, members, numbers)
        self._changed(piece)
        return True

    def _rebuild(self, standing: StandingMap, piece: Piece, members: Indices) -> None:
        """Compute a piece anew from its ``members``, in several pieces where need be: most of it keeps its name."""
        if not len(members):
            self._pieces.remove(piece)
            return
        standing.cover(members, self._bounds)
        first, *others = cut(standing, self._bounds, members)
        piece.members, piece.numbers = _NOWHERE, _NOWHERE
        self._pieces.place(piece, first.box)
        piece.hits, piece.voxels_tried = standing.hits(first.members), 0
        self._own(piece, first.members, standing.numbers(first.members))
        self._changed(piece)
        for body in others:
            self._begin(standing, body)

    def _begin(self, standing: StandingMap, body: Body) -> None:
        piece = self._pieces.begin(body.box, standing.hits(body.members))
        self._own(piece, body.members, standing.numbers(body.members))
        self._changed(piece)

    def _own(self, piece: Piece, members: Indices, numbers: Indices) -> None:
        piece.members = np.concatenate([piece.members, members])
        piece.numbers = np.concatenate([piece.numbers, numbers])
        self._owners[members, 0], self._owners[members, 1] = piece.number, numbers

    def _changed(self, piece: Piece) -> None:
        """Try to merge a piece if it has grown enough since that was tried last."""
        if len(piece.members) >= _LARGER * piece.voxels_tried and piece.number not in self._waiting:
            self._waiting.append(piece.number)

    def _merge(self, standing: StandingMap) -> None:
        """Merge pieces where that closes no gap, a bounded number of tries."""
        tries = 0
        while self._waiting and tries < _TRIES:
            piece = self._pieces.get(self._waiting.popleft())
            if piece is None:
                continue
            piece.voxels_tried = len(piece.members)
            for other in self._pieces.near(piece, standing.settings.bridged_gap):
                voxels = len(piece.members) + len(other.members)
                if voxels < _LARGER * piece.tried.get(other.number, 0):
                    continue
                tries += 1
                if self._merged(standing, *sorted((piece, other), key=lambda p: p.number)):
                    break
                piece.tried[other.number] = other.tried[piece.number] = voxels

    def _merged(self, standing: StandingMap, older: Piece, younger: Piece) -> bool:
        """Merge two pieces into the older one; return False, with both as they are, where that closes a gap."""
        box = fitted_box(self._bounds, np.concatenate([older.members, younger.members]))
        if len(standing.gaps(box, 1)):
            return False
        self._pieces.remove(younger)
        self._own(older, younger.members, younger.numbers)
        self._pieces.place(older, box)
        older.hits += younger.hits
        older.voxels_tried = 0
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
