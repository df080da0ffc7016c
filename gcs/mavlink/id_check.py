"""Whose data a vehicle tells: two may be mixed up, by their ids, their cables or a router between.

What a mixed-up vehicle tells is plausible in itself, and a loop that is closed over it pushes both vehicles the wrong
way. Its positions give it away: they are another's, and that one's are its own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.measurements import PAYLOAD, Measurement, Position

NEARER = 2.0
"""So many times nearer to another's place than to its own are positions that are another's."""
STEPS = 3
"""Control steps for which it must be so."""


class Identities:
    """Of N vehicles' telemetry. Vehicles are 0 .. N-1."""

    def __init__(self, number_of_uavs: int) -> None:
        self._whose = list(range(number_of_uavs))
        self._positions: dict[int, NDArray[np.float64]] = {}
        self._suspected: dict[int, int] = {}
        self._steps = 0

    def whose(self, teller: int) -> int:
        """The vehicle whose data ``teller`` tells."""
        return self._whose[teller]

    @property
    def mixed_up(self) -> dict[int, int]:
        """Those who tell another's data, and whose."""
        return {teller: whose for teller, whose in enumerate(self._whose) if whose != teller}

    def told(self, sample: Measurement) -> None:
        """What has come in as of the vehicle that is its source."""
        if isinstance(sample, Position) and sample.source != PAYLOAD and sample.has_pose:
            self._positions[sample.source] = sample.position

    def compare(self, estimated: Sequence[Measurement]) -> None:
        """What was told since the last time with where the vehicles are estimated to be; once a control step."""
        places = np.array([sample.position for sample in estimated if isinstance(sample, Position)])
        found = _mixed_up(self._positions, places)
        self._positions = {}
        self._steps = self._steps + 1 if found and found == self._suspected else int(bool(found))
        self._suspected = found
        if self._steps >= STEPS:
            self._whose = [found.get(whose, whose) for whose in self._whose]
            self._suspected, self._steps = {}, 0


def _mixed_up(positions: dict[int, NDArray[np.float64]], places: NDArray[np.float64]) -> dict[int, int]:
    """Vehicles whose ``positions`` are at each other's ``places`` (N, 3), and at whose; otherwise none."""
    at = {}
    for vehicle, position in positions.items():
        away = np.linalg.norm(places - position, axis=1)
        nearest = int(away.argmin())
        if away[nearest] * NEARER < away[vehicle]:
            at[vehicle] = nearest
    return at if set(at) == set(at.values()) else {}
