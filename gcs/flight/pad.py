"""Where payload and vehicles stand before take-off: the mean of what they tell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.measurements import PAYLOAD, Measurement, Position

Array = NDArray[np.float64]

SAMPLES = 100  # of each source, the newest


class Pad:
    """Gathers positions on the ground. Frames NED, m."""

    def __init__(self, number_of_uavs: int) -> None:
        self._positions: dict[int, list[Array]] = {source: [] for source in (PAYLOAD, *range(number_of_uavs))}

    def measured(self, measurement: Measurement) -> None:
        """Telemetry of a vehicle or of the payload."""
        if isinstance(measurement, Position) and measurement.has_pose:
            samples = self._positions[measurement.source]
            samples.append(measurement.position)
            del samples[:-SAMPLES]

    @property
    def is_known(self) -> bool:
        """Whether all have told where they are."""
        return all(self._positions.values())

    @property
    def payload(self) -> Array:
        """Position of the payload (3,)."""
        return np.mean(self._positions[PAYLOAD], axis=0)

    @property
    def vehicles(self) -> Array:
        """Positions of the vehicles (N, 3)."""
        return np.array([np.mean(samples, axis=0) for source, samples in self._positions.items() if source != PAYLOAD])
