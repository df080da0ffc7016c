"""Upright boxes that hold points of the standing map.

A box is a row of 8 numbers: centre (3,), half edges along its heading, across it and vertically (m), cosine and sine of
the heading. Bounds are rows of 6: lower (3,) and upper (3,) (m).
"""

import math

import numpy as np

from idc_controller.arrays import Array, Indices, Mask

_COARSE, _FINE = 18, 5
"""Headings tried of a quarter turn, and on each side of the best of them."""
_STEP = math.pi / 2.0 / _COARSE


def fitted_box(bounds: Array, rows: Indices) -> Array:
    """Return the upright box (8,) with about the least plan view that holds ``bounds`` (E, 6) of some ``rows`` (n,).

    The heading is the best of some, found to half a degree.
    """
    held = bounds[rows]
    best, least = _best_heading(held, [i * _STEP for i in range(_COARSE)], 0.0, math.inf)
    fine = [best + j * _STEP / (2.0 * _FINE) for j in range(-_FINE, _FINE + 1) if j]
    heading, _ = _best_heading(held, fine, best, least)
    cosine, sine = math.cos(heading), math.sin(heading)
    along, across = _spans(held, cosine, sine)
    return _box(_range(along), _range(across), (held[:, 2].min(), held[:, 5].max()), cosine, sine)


def extended_box(box: Array, bounds: Array, rows: Indices) -> Array:
    """Return a ``box`` (8,) extended, at its heading, to hold the ``bounds`` (E, 6) of some ``rows`` (n,)."""
    held, (along, across, vertical) = bounds[rows], _ranges(box)
    both = _spans(held, box[6], box[7])
    heights = min(held[:, 2].min(), vertical[0]), max(held[:, 5].max(), vertical[1])
    return _box(_range(both[0], along), _range(both[1], across), heights, box[6], box[7])


def reaches_out(box: Array, bounds: Array, rows: Indices, tolerance: float) -> Mask:
    """Return which of ``bounds`` (E, 6), at ``rows`` (n,), reach beyond a ``box`` (8,) by over ``tolerance`` (m)."""
    held = bounds[rows]
    beyond = np.full(len(rows), -math.inf)
    for (low, high), (least, most) in zip(
        (*_spans(held, box[6], box[7]), (held[:, 2], held[:, 5])), _ranges(box), strict=True
    ):
        beyond = np.maximum(beyond, np.maximum(least - low, high - most))
    return np.asarray(beyond > tolerance)


def _best_heading(held: Array, headings: list[float], best: float, least: float) -> tuple[float, float]:
    """Return which of the ``headings`` has a plan view clearly smaller than ``least`` (m2), and how large that is."""
    cosines, sines = (np.array([[of(heading)] for heading in headings]) for of in (math.cos, math.sin))
    (low_u, high_u), (low_v, high_v) = _spans(held, cosines, sines)
    areas = (high_u.max(axis=1) - low_u.min(axis=1)) * (high_v.max(axis=1) - low_v.min(axis=1))
    for heading, area in zip(headings, areas.tolist(), strict=True):
        if area < least * (1.0 - 1e-9):
            best, least = heading, area
    return best, least


Span = tuple[Array, Array]
Range = tuple[float, float]


def _spans(held: Array, cosine: Array | float, sine: Array | float) -> tuple[Span, Span]:
    """Return least and largest coordinate of bounds (n, 6) along headings (H, 1), and across them (H, n) (m)."""
    x, y = (held[:, 0] + held[:, 3]) / 2.0, (held[:, 1] + held[:, 4]) / 2.0
    p, q = (held[:, 3] - held[:, 0]) / 2.0, (held[:, 4] - held[:, 1]) / 2.0
    a, b = np.abs(cosine), np.abs(sine)
    u, v, du, dv = cosine * x + sine * y, cosine * y - sine * x, a * p + b * q, a * q + b * p
    return (u - du, u + du), (v - dv, v + dv)


def _range(span: Span, other: Range = (math.inf, -math.inf)) -> Range:
    """Return the range that holds a span, and another range."""
    return min(float(span[0].min()), other[0]), max(float(span[1].max()), other[1])


def _ranges(box: Array) -> list[Range]:
    """Return the ranges of a box along its heading, across it and vertically (m)."""
    x, y, z, h, w, d, cosine, sine = box.tolist()
    u, v = cosine * x + sine * y, cosine * y - sine * x
    return [(u - h, u + h), (v - w, v + w), (z - d, z + d)]


def _box(along: Range, across: Range, vertical: Range, cosine: float, sine: float) -> Array:
    """Return the box (8,) with these ranges."""
    (u, v, z), (h, w, d) = (
        [(high + sign * low) / 2.0 for low, high in (along, across, vertical)] for sign in (1.0, -1.0)
    )
    return np.array([cosine * u - sine * v, sine * u + cosine * v, z, h, w, d, cosine, sine])
