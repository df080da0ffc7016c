"""The paper's figure eight (eq:Lissajous) as a function of its phase, and whether it can be flown at a rate."""

import math
from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.trajectory_kernels import figure_eight


@dataclass(frozen=True)
class LissajousCurve:
    """x = a_x sin(phase), y = -a_y sin(2 phase), z = down; with a_y = a_x / 2 the paper's figure eight.

    ``amplitude`` (2,) m; ``down`` m (NED, so minus the altitude); ``centre`` (2,) m, north and east.

    Raises:
        TrajectoryError: not finite, or an amplitude is negative, or both are zero.
    """

    amplitude: tuple[float, float]
    down: float
    centre: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if len(self.amplitude) != 2 or not np.isfinite(self.amplitude).all() or min(self.amplitude) < 0.0:
            raise TrajectoryError(f"amplitude must be two numbers, none negative, not {self.amplitude}")
        if max(self.amplitude) == 0.0:
            raise TrajectoryError("one amplitude at least must be positive")
        if not math.isfinite(self.down):
            raise TrajectoryError(f"down must be a finite number, not {self.down}")
        if len(self.centre) != 2 or not np.isfinite(self.centre).all():
            raise TrajectoryError(f"centre must be two finite numbers, not {self.centre}")

    def as_array(self) -> Array:
        """Return the amplitudes, the centre and down (5,) (m)."""
        return np.array([*self.amplitude, *self.centre, self.down])

    def at(self, phases: Array) -> Array:
        """Return position to the derivative of ``order`` by time (order + 1, K, 3), NED, SI.

        ``phases``: the phase and its derivatives by time (order + 1, K) (rad / s^d), order 4 at most.
        """
        return figure_eight(self.as_array(), phases)


def largest_derivatives(curve: LissajousCurve, rate: float) -> Array:
    """Largest norms (4,) of speed to snap at the full rate."""
    phases = np.zeros((5, 721))
    phases[0], phases[1] = np.linspace(0.0, 2.0 * np.pi, 721), rate
    return np.asarray(np.linalg.norm(curve.at(phases)[1:], axis=2).max(axis=1))


def check_full_rate(curve: LissajousCurve, rate: float, limits: Limits) -> None:
    """Raise :class:`TrajectoryError` for a curve whose derivatives at ``rate`` (rad/s) exceed limits."""
    for (name, limit), largest in zip(vars(limits).items(), largest_derivatives(curve, rate), strict=False):
        if largest > limit * (1.0 - 1e-3):
            raise TrajectoryError(f"the curve at {rate:g} rad/s needs {name} {largest:.3g}, the limit is {limit:g}")
