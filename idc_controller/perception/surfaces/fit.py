"""What all fits of a shape to surface points have in common."""

from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.perception.settings import SurfaceSettings

_SCORE_CAP = 16.0
_MEDIAN_OF_SQUARE = 0.455  # of a normal variable of variance 1


@dataclass(frozen=True, eq=False)
class Fit:
    """Where an obstacle's reference point is in one frame."""

    position: Array
    """(3,) (m)"""
    variance: Array
    """(3,) (m2)"""
    score: float
    """Mean squared distance of the points to the surface over its variance: about 1 for the right shape."""
    unexplained: float
    """How much larger their squared distances are than their variance (m2), by the median: about 0."""


def score(residual: Array, variance: Array) -> float:
    """See :class:`Fit`; single points that do not belong count for little."""
    return float(np.mean(np.minimum(residual**2 / variance, _SCORE_CAP)))


def unexplained(residual: Array, variance: Array, fitted: int) -> float:
    """See :class:`Fit`, where ``fitted`` quantities were found from the same points; points far off do not count."""
    n = len(residual)
    return float(np.median(residual**2) / _MEDIAN_OF_SQUARE * n / max(n - fitted, 1) - np.median(variance))


class EndOfSurface:
    """How far a surface reaches in one direction, from its detected points frame by frame."""

    def __init__(self, extension: float, settings: SurfaceSettings) -> None:
        """``extension`` (m) is added while the end itself was not in the sensors' range."""
        self._extension, self._settings = extension, settings
        self._value = -np.inf
        self._is_observed = False

    @property
    def outermost(self) -> float:
        """As far as the surface may be taken to reach (m)."""
        return float(self._value if self._is_observed else self._value + self._extension)

    def update(self, along: Array, cut: Mask) -> None:
        """Points of one frame, by their coordinate in that direction (n,), and whether they end the sensor's range."""
        last, s = int(np.argmax(along)), self._settings
        furthest, is_cut = float(along[last]), bool(cut[last])
        beyond = furthest - self._value
        if beyond > s.end_jump:
            self._value, self._is_observed = furthest, not is_cut
        elif is_cut:
            if not self._is_observed:
                self._value = max(self._value, furthest)
        elif beyond > -s.end_jump:
            # Noise makes the outermost of several points a little too far out: the safe side.
            self._value += (s.end_smoothing if self._is_observed else 1.0) * beyond
            self._is_observed = True
        else:
            self._value += s.end_retreat * beyond
