"""Time scaling: a trajectory that is followed from some progress on, faster or slower than its own time."""

from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array
from idc_controller.trajectory.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class ScaledReference:
    """``trajectory`` with its time replaced by the progress s(t) = progress + rate (t - start)."""

    trajectory: Trajectory
    start: float = 0.0
    """Time (s) of ``progress``."""
    progress: float = 0.0
    """Path parameter (s): the trajectory's own time."""
    rate: float = 1.0
    """Rate of the progress: 1 is the trajectory's own speed, 0 rest."""

    def progress_at(self, time: float) -> float:
        """Return the progress (s) at ``time`` (s)."""
        return self.progress + self.rate * (time - self.start)

    def after(self, elapsed: Array, order: int = 4) -> Array:
        """Return position and derivatives (order + 1, K, 3), NED, SI, at ``elapsed`` (K,) (s) since the start."""
        derivatives = self.trajectory.derivatives(self.progress + self.rate * elapsed, order)
        if self.rate == 1.0:
            return derivatives
        return derivatives * (self.rate ** np.arange(order + 1))[:, None, None]

    def derivatives(self, times: Array, order: int = 4) -> Array:
        """Return position and derivatives (order + 1, K, 3), NED, SI, at ``times`` (K,) (s)."""
        return self.after(np.asarray(times, dtype=float) - self.start, order)
