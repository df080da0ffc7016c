"""A cached trajectory that computes no time twice: overlapping horizons need the same times step after step."""

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.trajectory.trajectory import Trajectory, checked_times

TICKS = 1e8  # per second: times closer than one are the same
CAPACITY = 4000  # times; the oldest half goes when there are more


class CachedTrajectory(Trajectory):
    """Another trajectory, which must not change at times that were evaluated."""

    def __init__(self, trajectory: Trajectory) -> None:
        self.start, self._trajectory = trajectory.start, trajectory
        self._cache: dict[int, Array] = {}

    @property
    def end(self) -> float:
        """See ``Trajectory.end``."""
        return self._trajectory.end

    def derivatives(self, times: ArrayLike, order: int = 4) -> Array:
        """See ``Trajectory.derivatives``."""
        times = checked_times(times, order)
        if len(times) == 0:
            return np.zeros((order + 1, 0, 3))
        cache = self._cache
        ticks = np.rint(times * TICKS).astype(np.int64).tolist()
        new = [i for i, tick in enumerate(ticks) if tick not in cache]
        if new:
            if len(cache) > CAPACITY:
                for tick in list(cache)[: CAPACITY // 2]:
                    del cache[tick]
                new = [i for i, tick in enumerate(ticks) if tick not in cache]
            fresh = self._trajectory.derivatives(times[new], 4).transpose(1, 0, 2)
            cache.update((ticks[i], row) for i, row in zip(new, fresh, strict=True))
        return np.array([cache[tick] for tick in ticks])[:, : order + 1].transpose(1, 0, 2)

    def waypoints(self, begin: float, end: float) -> Array:
        """See ``Trajectory.waypoints``."""
        return self._trajectory.waypoints(begin, end)

    def stop(self, time: float) -> Trajectory:
        """See ``Trajectory.stop``."""
        return self._trajectory.stop(time)
