"""Upright boxes that cover points of the standing map, cut until none of them holds a gap that was seen free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.perception.standing_map import StandingMap
from idc_controller.perception.upright_box_kernels import fitted_box

_MOST_GAPS = 256
"""Gaps of a body that are looked at to cut it."""


class Body(NamedTuple):
    """A body that covers some of the points."""

    members: Indices
    """Elements whose points it covers (n,)."""
    box: Array
    """See :mod:`idc_controller.perception.upright_box_kernels` (8,)."""


def cut(standing: StandingMap, bounds: Array, members: Indices) -> list[Body]:
    """Return bodies without gaps, of which each of the ``members`` (n,) belongs to one; the largest first.

    ``bounds`` (E, 6): of the points of all elements (m).
    """
    found: list[Body] = []
    waiting = [members]
    while waiting:
        part = waiting.pop()
        box = fitted_box(bounds, part)
        gaps = standing.gaps(box, _MOST_GAPS)
        parts = _split(bounds[part], box, gaps, standing.settings.voxel) if len(gaps) else ()
        if parts:
            waiting += [part[half] for half in parts]
        else:
            found.append(Body(part, box))
    return sorted(found, key=lambda body: len(body.members), reverse=True)


def _split(bounds: Array, box: Array, gaps: Array, voxel: float) -> tuple[Indices, ...]:
    """Return two parts of points with ``bounds`` (n, 6), on the two sides of a plane beside or amid ``gaps`` (m, 3).

    Of the planes across the box's axes, it is the one that leaves the smallest boxes; none if all points are in one
    place.
    """
    axes = np.array([(box[6], box[7], 0.0), (-box[7], box[6], 0.0), (0.0, 0.0, 1.0)])
    places = ((bounds[:, :3] + bounds[:, 3:]) / 2.0 - box[:3]) @ axes.T
    empty = (gaps - box[:3]) @ axes.T
    best = np.inf
    parts: tuple[Indices, ...] = ()
    for axis in range(3):
        own, gap = places[:, axis], empty[:, axis]
        for level in (gap.min() - voxel / 2.0, np.median(gap), gap.max() + voxel / 2.0, own.mean()):
            below = own < level
            if below.all() or not below.any():
                continue
            volume = sum(float(np.prod(np.ptp(places[side], axis=0) + voxel)) for side in (below, ~below))
            if volume < best:
                best, parts = volume, (np.flatnonzero(below), np.flatnonzero(~below))
    return parts
