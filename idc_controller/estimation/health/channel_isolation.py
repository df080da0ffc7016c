"""Which sensors of the vehicles have been refused for so long that nothing they say counts.

A single refusal may be the filter's error. But while it doubts its own prediction (a gust, a load that changes) its
gate is wide, and a sensor that has been wrong all along would come through it, and be believed against all others.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from idc_controller.estimation.measurement_model import Stack
from idc_controller.estimation.measurements import PAYLOAD, Position

Array = NDArray[np.float64]

REFUSED_FOR = 12
"""Refusals, less what was accepted in between, after which a sensor is distrusted."""
AGREES_FOR = 25
"""Times in a row that it must agree with the prediction to be trusted again."""
AGREES = float(chi2.ppf(0.999, 3))
"""Square of an innovation, by its covariance, that agrees."""


class Half(NamedTuple):
    """Pose (0) or motion (1) of one kind of measurement of one UAV."""

    source: int
    kind: type
    which: int

    @property
    def channel(self) -> str:
        """position, velocity, attitude or rates."""
        return (("position", "velocity") if self.kind is Position else ("attitude", "rates"))[self.which]


class Distrust:
    """Of N vehicles' sensors; never of more than half of the vehicles, which are not wrong together."""

    def __init__(self, number_of_uavs: int) -> None:
        self._number_of_uavs = number_of_uavs
        self._refused: dict[Half, int] = {}
        self._agreed: dict[Half, int] = {}

    def __copy__(self) -> Distrust:
        other = Distrust(self._number_of_uavs)
        other._refused, other._agreed = self._refused.copy(), self._agreed.copy()
        return other

    @property
    def halves(self) -> tuple[Half, ...]:
        """What is distrusted."""
        return tuple(self._agreed)

    @property
    def lost(self) -> tuple[int, ...]:
        """UAVs of which neither position nor velocity is believed."""
        return tuple(sorted(h.source for h in self._agreed if h.kind is Position and not h.which
                            and h._replace(which=1) in self._agreed))  # fmt: skip

    def rows(self, stack: Stack) -> NDArray[np.bool_]:
        """Rows (m,) of a whole ``stack`` that are distrusted."""
        rows = np.zeros(len(stack.variance), dtype=bool)
        for half, part in _halves(stack):
            rows[part] = half in self._agreed
        return rows

    def learn(
        self, stack: Stack, judged: NDArray[np.bool_], kept: NDArray[np.bool_], contradicts: Callable[[int], bool]
    ) -> None:
        """From one moment: which rows (m,) were ``judged``, and ``kept``.

        ``contradicts``: whether position and velocity of a UAV are against each other. Where they agree, and yet are
        refused, it is the vehicle that does not fly as it should: it may believe in a wrong attitude.
        """
        if not self._refused and bool(kept[judged].all()):
            return
        for half, part in _halves(stack):
            if not judged[part].all():
                continue
            count = self._refused.pop(half, 0) + (-1 if kept[part].all() else 1)
            is_wrong = half.kind is not Position or contradicts(half.source)
            if count >= REFUSED_FOR and is_wrong and self._is_no_majority_with(half.source):
                self._agreed[half] = 0
            elif count > 0:
                self._refused[half] = min(count, REFUSED_FOR)

    def reconsider(self, stack: Stack, residual: Array, H: Array, P: Array, noise: float) -> None:
        """Trust again what agrees with the prediction of covariance ``P``: innovations (m,) and their rows ``H``."""
        for half, part in _halves(stack):
            if half not in self._agreed or not np.isfinite(residual[part]).all():
                continue
            covariance = H[part] @ P @ H[part].T + noise * np.diag(stack.variance[part])
            off = float(residual[part] @ np.linalg.solve(covariance, residual[part]))
            self._agreed[half] = self._agreed[half] + 1 if off <= AGREES else 0
            if self._agreed[half] >= AGREES_FOR:
                del self._agreed[half]

    def _is_no_majority_with(self, source: int) -> bool:
        return 2 * len({half.source for half in self._agreed} | {source}) <= self._number_of_uavs


def _halves(stack: Stack) -> list[tuple[Half, slice]]:
    """Of the vehicles' measurements in a whole stack, and their rows."""
    return [
        (Half(source, kind, which), slice(start + which * size // 2, start + (which + 1) * size // 2))
        for (source, kind), start, size in zip(stack.keys, stack.starts.tolist(), stack.sizes.tolist(), strict=True)
        if source != PAYLOAD
        for which in (0, 1)
    ]
