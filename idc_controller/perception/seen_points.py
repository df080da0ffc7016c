"""Points of a body that were seen in the last frames, in a frame of reference that moves with it."""

import math
from collections import deque

import numpy as np

from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shape import Shape


class SeenPoints:
    """Points of one body, relative to its reference point. Times in s, m."""

    def __init__(self, memory: float) -> None:
        """``memory``: time for which points are remembered (s)."""
        self._memory = memory
        self._frames: deque[tuple[float, Array, Array]] = deque()

    def add(self, time: float, points: Array, noise: Array) -> None:
        """Add the ``points`` (n, 3) of one frame; ``noise`` (n,) alone puts each by so much outside."""
        self._frames.append((time, points, noise))
        while self._frames[0][0] < time - self._memory:
            self._frames.popleft()

    def shift(self, by: Array) -> None:
        """Shift all points ``by`` (3,), as the reference point is another."""
        self._frames = deque((time, points + by, noise) for time, points, noise in self._frames)

    def outermost(self, shape: Shape, centre: Array, false_share: float) -> float:
        """Return how far the outermost point lies outside of a ``shape`` at ``centre`` (3,), 0 if none does.

        As many as there are false ones among them are left out: a share ``false_share``, rounded up.
        """
        points = np.concatenate([points for _, points, _ in self._frames])
        noise = np.concatenate([noise for _, _, noise in self._frames])
        distance = Bodies([shape]).distance(points, np.asarray(centre)[None])[0]
        outside, false = distance - noise, math.ceil(false_share * len(points))
        if len(points) <= false:
            return 0.0
        return max(float(np.partition(outside, -1 - false)[-1 - false]), 0.0)
