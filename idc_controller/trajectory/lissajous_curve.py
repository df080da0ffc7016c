"""The paper's figure eight (eq:Lissajous) as a function of its phase, and whether it can be flown at a rate."""

import math
from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.settings import Limits


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

    def by_phase(self, phase: Array, order: int) -> list[Array]:
        """The curve and its derivatives by phase (rad) up to ``order``, each (K, 3), m / rad^d."""
        result = []
        for d in range(order + 1):
            x = self.amplitude[0] * np.sin(phase + d * np.pi / 2.0)
            y = -self.amplitude[1] * 2.0**d * np.sin(2.0 * phase + d * np.pi / 2.0)
            result.append(np.column_stack([x, y, np.zeros_like(x)]))
        result[0] += [*self.centre, self.down]
        return result

    def by_time(self, phases: Array) -> Array:
        """Return velocity to snap (4, K, 3) by the chain rule; ``phases``: phase and derivatives by time (5, K)."""
        _, r_1, r_2, r_3, r_4 = self.by_phase(phases[0], 4)
        s_1, s_2, s_3, s_4 = phases[1:, :, None]
        curved = r_2 * (3.0 * s_2**2 + 4.0 * s_1 * s_3)
        return np.array([
            r_1 * s_1,
            r_2 * s_1**2 + r_1 * s_2,
            r_3 * s_1**3 + 3.0 * r_2 * s_1 * s_2 + r_1 * s_3,
            r_4 * s_1**4 + 6.0 * r_3 * s_1**2 * s_2 + curved + r_1 * s_4,
        ])  # fmt: skip


def largest_derivatives(curve: LissajousCurve, rate: float) -> Array:
    """Largest norms (4,) of speed to snap at the full rate."""
    r = np.array(curve.by_phase(np.linspace(0.0, 2.0 * np.pi, 721), 4)[1:])
    return np.asarray(np.linalg.norm(r, axis=2).max(axis=1) * rate ** np.arange(1, 5))


def check_full_rate(curve: LissajousCurve, rate: float, limits: Limits) -> None:
    """Raise :class:`TrajectoryError` for a curve whose derivatives at ``rate`` (rad/s) exceed limits."""
    for (name, limit), largest in zip(vars(limits).items(), largest_derivatives(curve, rate), strict=False):
        if largest > limit * (1.0 - 1e-3):
            raise TrajectoryError(f"the curve at {rate:g} rad/s needs {name} {largest:.3g}, the limit is {limit:g}")
