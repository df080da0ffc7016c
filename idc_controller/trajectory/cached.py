"""A trajectory that computes no time twice: horizons that overlap ask for the same times step after step."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.trajectory.trajectory import Array, Trajectory, checked_times

TICKS = 1e8  # per second: times closer than one are the same
CAPACITY = 4000  # times; the oldest half goes when there are more


class RememberedTrajectory(Trajectory):
    """Another trajectory, which must not change its mind about what it has told once."""

    def __init__(self, trajectory: Trajectory) -> None:
        self._trajectory = trajectory
        self._told: dict[int, Array] = {}

    @property
    def start(self) -> float:
        """See ``Trajectory.start``."""
        return self._trajectory.start

    @property
    def end(self) -> float:
        """See ``Trajectory.end``."""
        return self._trajectory.end

    def derivatives(self, times: ArrayLike, order: int = 4) -> Array:
        """See ``Trajectory.derivatives``."""
        times = checked_times(times, order)
        if len(times) == 0:
            return np.zeros((order + 1, 0, 3))
        told = self._told
        ticks = np.rint(times * TICKS).astype(np.int64).tolist()
        new = [i for i, tick in enumerate(ticks) if tick not in told]
        if new:
            if len(told) > CAPACITY:
                for tick in list(told)[: CAPACITY // 2]:
                    del told[tick]
                new = [i for i, tick in enumerate(ticks) if tick not in told]
            fresh = self._trajectory.derivatives(times[new], 4).transpose(1, 0, 2)
            told.update((ticks[i], row) for i, row in zip(new, fresh, strict=True))
        return np.array([told[tick] for tick in ticks])[:, : order + 1].transpose(1, 0, 2)

    def waypoints(self, begin: float, end: float) -> Array:
        """See ``Trajectory.waypoints``."""
        return self._trajectory.waypoints(begin, end)

    def stop(self, time: float) -> Trajectory:
        """See ``Trajectory.stop``."""
        return self._trajectory.stop(time)
