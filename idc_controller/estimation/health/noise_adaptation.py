"""What innovations tell of the filter's own assumptions: how noisy the sensors are, and how restless the forces.

Innovations whitened by their covariance have variance 1, and what one of them says of the next is nothing. Where most
are larger without pointing where the ones before pointed, the sensors are noisier than assumed; where they keep
pointing the same way, forces change faster than assumed (gusts, a load that is lost).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NOISE_MAX = 400.0
"""Largest factor of the sensors' variances."""
NOISY = 2.0
"""Median over the measurements of their mean square, of a sound filter about 1, at which the factor grows."""
LEVELS = 3
"""Of restlessness."""
STEP = 5.0
"""Factor of the forces' process noise from one level to the next."""
SHARE = 0.1
"""Of one moment in the running mean of what is common to consecutive innovations."""
RISES, FALLS = 0.3, 0.1
"""That mean, of a sound filter 0 within 0.08, at which the level rises and falls."""
DWELL = 10
"""Moments between two changes of the level."""
GAP = 0.2
"""Innovations farther apart are not consecutive (s)."""
PERSISTENT = 0.5
"""Cosine between consecutive innovations above which it is no noise."""


class Adaptation:
    """Learns from the whitened innovations of one moment after the other."""

    def __init__(self) -> None:
        self.noise = 1.0
        """Factor of the sensors' variances, 1 .. :data:`NOISE_MAX`."""
        self.level = 0
        """Restlessness of the forces, 0 .. :data:`LEVELS`."""
        self._time = -np.inf
        self._keys: Sequence[object] = ()
        self._last = np.zeros(0)
        self._common = np.zeros(2)
        self._since_change = 0
        self.payload_refused = 0
        """So many times in a row the payload unit has disagreed with the prediction."""

    @property
    def restlessness(self) -> float:
        """Factor of the densities of the forces' process noise."""
        return float(STEP**self.level)

    def persists(self, time: float, keys: Sequence[object], white: Array) -> bool:
        """Whether the innovation ``white`` (m,) points where the last one pointed."""
        if not self._follows(time, keys, white):
            return False
        product = float(white @ self._last)
        return product > PERSISTENT * float(np.linalg.norm(white) * np.linalg.norm(self._last))

    def noisier(self, mean_squares: Array) -> None:
        """Most measurements, whose whitened innovations have these mean squares (K,), are larger than they should."""
        self.noise = min(self.noise * float(np.clip(np.median(mean_squares), 1.0, NOISE_MAX)), NOISE_MAX)

    def learn(
        self, time: float, keys: Sequence[object], white: Array, mean_squares: Array,
        accepted: NDArray[np.bool_], of_payload: NDArray[np.bool_],
    ) -> None:  # fmt: skip
        """From one moment: rows that were ``accepted`` (m,), and which of them are ``of_payload`` (m,)."""
        # What goes on in one direction is no noise.
        middle = float(np.median(mean_squares)) - max(float(self._common.max()), 0.0)
        if middle > NOISY and not self.persists(time, keys, white):
            self.noise = min(self.noise * 1.3, NOISE_MAX)
        elif middle < 1.0:
            self.noise = max(self.noise * 0.97, 1.0)
        if self._follows(time, keys, white):
            product = white * self._last
            self._common = self._common.copy()  # one as it was may be kept
            for k, part in enumerate((of_payload, ~of_payload)):
                rows = part & accepted
                if rows.any():
                    self._common[k] += SHARE * (float(np.clip(product[rows].mean(), -3.0, 3.0)) - self._common[k])
            self._since_change += 1
            common = float(self._common.max())
            if self._since_change > DWELL and common > RISES and self.level < LEVELS:
                self.level, self._since_change = self.level + 1, 0
            elif self._since_change > DWELL and common < FALLS and self.level:
                self.level, self._since_change = self.level - 1, 0
        self._time, self._keys, self._last = time, keys, white

    def _follows(self, time: float, keys: Sequence[object], white: Array) -> bool:
        return keys == self._keys and len(white) == len(self._last) and 0.0 < time - self._time <= GAP
