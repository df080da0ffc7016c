"""Of how much more acceleration an obstacle is capable than the motion models allow for.

Two things tell it. Innovations tell at once that it moves unlike any model, but not how much harm that does. A
prediction that has proved wrong a second later tells that; it comes late, but for an obstacle that stops and goes off
again not too late. Both count as an acceleration, with which the obstacle may leave any prediction, and both are
forgotten slowly.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AHEAD = 1.0
"""Predictions are judged after this time (s)."""
_USUAL_ERROR = 0.15  # m, of a good prediction by that time
_SETTLED = 3.0  # s in which it is found out how a new obstacle moves
_FRAME = 0.05  # s
_OFF_SHARE = 0.15  # of a new innovation in their average


@dataclass(frozen=True)
class AgilitySettings:
    """What counts as a surprise, and what follows from it."""

    unlike: tuple[float, float] = (0.9, 1.5)
    """Squared innovations over their variance, averaged over a second (0.5 is usual): from the first on the obstacle
    moves unlike any model, from the second on altogether."""
    unlike_acceleration: float = 2.0
    """Acceleration that is then taken for possible (m/s2, one standard deviation)."""
    memory: float = 8.0
    """Time constant with which either is forgotten (s)."""
    limit: float = 0.5
    """No body is taken larger by more than this (m) while predictions prove right; for what they prove wrong by,"""
    limit_share: float = 1.5
    """by this much of it more,"""
    limit_misjudged: float = 1.5
    """up to this (m): it may come faster than one can give way, and then only distance helps."""


class Agility:
    """Of one obstacle that has been seen since ``time`` (s)."""

    def __init__(self, time: float, settings: AgilitySettings) -> None:
        self._settings = settings
        self._since = self._time = time
        self._off = 0.5
        self._unlike = 0.0
        self._foreseen: deque[tuple[float, Array]] = deque()
        self._misjudged = 0.0

    @property
    def unlike(self) -> float:
        """How much the obstacle has moved unlike any model lately, 0 .. 1."""
        return self._unlike

    @property
    def misjudged(self) -> float:
        """By how much predictions by :data:`AHEAD` have been worse than usual lately (m)."""
        return self._misjudged

    def advance(self, time: float) -> None:
        """Forget until ``time`` (s)."""
        share = float(np.exp(-max(time - self._time, 0.0) / self._settings.memory))
        self._unlike *= share
        self._misjudged *= share
        self._time = max(time, self._time)

    def innovation(self, off: float) -> None:
        """The last sample was ``off`` in squares of the standard deviation expected of it, mean over the axes."""
        self._off += _OFF_SHARE * (min(off, 10.0) - self._off)
        low, high = self._settings.unlike
        self._unlike = max(self._unlike, min((self._off - low) / (high - low), 1.0))

    def judge(self, position: Array, velocity: Array) -> None:
        """Compare what was foreseen for about now with the ``position`` (3,) (m) and ``velocity`` (3,) (m/s) found."""
        while self._foreseen and self._foreseen[0][0] <= self._time + _FRAME:
            time, expected = self._foreseen.popleft()
            error = float(np.linalg.norm(position + velocity * (time - self._time) - expected))
            self._misjudged = max(self._misjudged, error - _USUAL_ERROR)

    @property
    def is_judged(self) -> bool:
        """Whether it has been seen for long enough for its predictions to be judged."""
        return self._time - self._since > _SETTLED

    def foresee(self, position: Array) -> None:
        """It is expected at ``position`` (3,) (m), :data:`AHEAD` from now."""
        self._foreseen.append((self._time + AHEAD, position))

    def variance(self, elapsed: Array) -> Array:
        """Of the place after the times ``elapsed`` (K,) (s), beside that of the motion models, on any axis (m2)."""
        unlike = 0.5 * self._unlike * self._settings.unlike_acceleration
        return (unlike**2 + (self._misjudged / AHEAD**2) ** 2) * elapsed**4

    def growth_limit(self, unsure: float) -> float:
        """How much larger (m) the body may be taken at most, if its place is ``unsure`` (m) in every frame."""
        s = self._settings
        return min(s.limit + s.limit_share * self._misjudged + unsure, s.limit_misjudged)
