"""Region that a body has visited of late: where it may be again if its motion cannot be predicted.

A body that stops and goes shows no motion model when it will start, nor how far it will go. What it did is known: it
stays about the places where it has been. Where predictions prove wrong, these places stand for the prediction.
"""

import math
from collections import deque

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.shape import Shape
from idc_controller.geometry.shapes import Wall

_ABOUT = 0.1
"""Distance outside of the region up to which a place still counts as visited: errors of the centre (m)."""


class VisitedRegion:
    """Places of a body's centre (NED, m) of late. Times in s."""

    def __init__(self) -> None:
        self._places: deque[tuple[float, Array]] = deque()
        self._region: tuple[Array, Array, float] | None = None

    def add(self, time: float, place: Array) -> None:
        """Add the ``place`` (3,) of the centre at ``time`` (s)."""
        self._places.append((time, place))
        self._region = None

    def box(self, shape: Shape, since: float) -> tuple[Wall, Array]:
        """Return an upright box, and its centre (3,), that holds a body of this ``shape`` where it was from ``since``.

        Earlier places are forgotten, but the last one.
        """
        while len(self._places) > 1 and self._places[0][0] < since:
            self._places.popleft()
            self._region = None
        if self._region is None:
            self._region = _upright_box(np.array([place for _, place in self._places]))
        centre, edges, yaw = self._region
        along, across, height = edges + 2.0 * np.array([shape.horizontal_reach] * 2 + [shape.half_height])
        return Wall((float(along), float(across), float(height)), yaw), centre

    def holds(self, place: Array, before: float) -> bool:
        """Return whether the centre was about a ``place`` (3,) already before the time ``before`` (s)."""
        earlier = [at for time, at in self._places if time < before]
        if not earlier:
            return False
        centre, edges, yaw = _upright_box(np.array(earlier))
        return bool((np.abs(_turned(place - centre, yaw)) <= 0.5 * edges + _ABOUT).all())


def _turned(offsets: Array, yaw: float) -> Array:
    """Return offsets (..., 3) in axes turned by ``yaw`` (rad) about the vertical."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    x, y, z = np.moveaxis(offsets, -1, 0)
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=-1)


def _upright_box(places: Array) -> tuple[Array, Array, float]:
    """Return centre (3,), edges (3,) (m) and yaw (rad) of an upright box about ``places`` (n, 3), along them."""
    mean = places.mean(axis=0)
    x, y, _ = (places - mean).T
    yaw = 0.5 * math.atan2(2.0 * float(x @ y), float(x @ x - y @ y))
    turned = _turned(places - mean, yaw)
    low, high = turned.min(axis=0), turned.max(axis=0)
    return mean + _turned(0.5 * (low + high), -yaw), high - low, yaw
