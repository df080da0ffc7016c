"""The way of the filter from its last update to the moment asked for: edges, the exact reference, the set-points."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.setpoint_history import SetpointHistory
from idc_controller.trajectory.reference import Reference

Array = NDArray[np.float64]


class Way:
    """The times between the last update and the moment asked for, with the exact reference at all of them."""

    def __init__(
        self,
        start: float,
        moments: list[float],
        end: float,
        setpoints: SetpointHistory,
        reference: Reference,
    ) -> None:
        times = sorted([start, *moments, end])
        switches = setpoints.switches(start + 1e-6, end - 1e-6)
        times += [t for t in switches if min(abs(t - other) for other in times) > 1e-6]
        self.edges = sorted(set(times))
        self.flat = reference.at(np.array(self.edges))
        self.setpoints = [setpoints.in_force(a, b) for a, b in pairwise(self.edges)]
        """From each edge to the next."""

    def u(self, k: int) -> Array:
        """The reference's set-points between edge ``k`` and the next (3 N,)."""
        return (self.flat.u[k] + self.flat.u[k + 1]) / 2

    def acceleration(self, k: int) -> Array:
        """The reference's acceleration between edge ``k`` and the next (3,) (m/s2)."""
        return (self.flat.payload[2, k] + self.flat.payload[2, k + 1]) / 2

    def interval_us(self, k: int) -> int:
        """Time from edge ``k`` to the next (us)."""
        return max(round((self.edges[k + 1] - self.edges[k]) * 1e6), 1)
