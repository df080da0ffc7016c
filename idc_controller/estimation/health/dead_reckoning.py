"""Consistency of poses with their own motion: positions with velocities, attitudes with body rates.

The innovation test goes by what most sources measure. Positions that are wrong for one common reason (a base station
that drifts, say) agree with each other and would bias the estimate. So would the payload's only unit, which is right
when it persists after a blow. Yet each of them contradicts its own motion, whatever the others measure.
"""

import numpy as np

from idc_controller.estimation.health.dead_reckoning_kernels import reckon
from idc_controller.estimation.measurements import Attitude, Position, SampleStack, SensorGroup
from idc_controller.estimation.settings import DeadReckoningSettings


class DeadReckoning:
    """Compares poses and motions of N UAVs and of the payload unit.

    Arrays are those of :func:`~idc_controller.estimation.health.dead_reckoning_kernels.reckon`.
    """

    def __init__(self, number_of_uavs: int, settings: DeadReckoningSettings = DeadReckoningSettings()) -> None:
        self._number_of_uavs, self._settings = number_of_uavs, settings
        sources = number_of_uavs + 2
        self._recent = np.zeros((sources, settings.smoothed, 8))
        self._motion, self._integral = np.zeros((sources, 3)), np.zeros((sources, 4))
        self._differences = np.zeros((sources, 256, 4))
        self._counts = np.zeros((sources, 5), dtype=int)
        self._ratio = np.full(sources, np.nan)
        self._groups: tuple[SensorGroup, ...] = ()

    @property
    def inconsistent_groups(self) -> tuple[SensorGroup, ...]:
        """Groups whose poses contradict their motions.

        Most vehicles' positions, while the payload unit's are consistent; or the other way round; or the payload
        unit's attitude.
        """
        return self._groups

    def add(self, samples: SampleStack) -> None:
        """Take the poses of one moment with their motions."""
        s = self._settings
        longest, tests = reckon(
            *samples, self._number_of_uavs, s.window, s.gap, s.samples, s.position_error, s.attitude_error, s.sigmas,
            self._recent, self._motion, self._integral, self._differences, self._counts, self._ratio,
        )  # fmt: skip
        if 2 * longest >= self._differences.shape[1]:
            self._differences = np.concatenate([self._differences, np.zeros_like(self._differences)], axis=1)
        if tests:
            self._groups = self._inconsistent()

    def is_inconsistent(self, uav: int) -> bool:
        """Return whether the position of a UAV contradicts its velocity."""
        return bool(self._ratio[uav] > 1.0)

    def _inconsistent(self) -> tuple[SensorGroup, ...]:
        *ratios, position, _ = self._ratio.tolist()  # nan where nothing was measured
        position_failed, attitude_failed = (self._counts[-2:, 4] >= self._settings.consecutive).tolist()
        consistent, most = self._settings.consistent_ratio, self._number_of_uavs
        found = []
        if position <= consistent and 2 * sum(r > 1.0 for r in ratios) > most:
            found.append(SensorGroup(False, Position))
        if position_failed and 2 * sum(r <= consistent for r in ratios) > most:
            found.append(SensorGroup(True, Position))
        if attitude_failed:
            found.append(SensorGroup(True, Attitude))
        return tuple(found)
