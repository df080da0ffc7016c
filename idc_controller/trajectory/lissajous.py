"""The paper's figure eight (eq:Lissajous), entered from rest and left to rest along the curve itself.

The curve is a fixed function of its phase, the phase a piecewise polynomial of time, and the derivatives
follow exactly by the chain rule: the trajectory never leaves the curve.
"""

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike
from scipy.interpolate import BPoly, PPoly

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.trajectory import Times, Trajectory, finite, positive
from idc_controller.trajectory.trajectory_kernels import figure_eight, figure_eight_at


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


SHORTEST_RAMP, LONGEST_RAMP = 0.25, 60.0
"""s, between rest and the full rate."""
RAMP_LONGER = 1.08
"""Factor from one ramp tried to the next."""
_FEW = 16
"""Every so many of the times at which limits are checked, first: the others only where these keep them."""
_RAMP = np.array([70.0, -315.0, 540.0, -420.0, 126.0]) / [10.0, 9.0, 8.0, 7.0, 6.0]
"""Integral of the polynomial from 0 to 1 whose four derivatives are zero at both ends: its powers 10 to 6."""


class LissajousTrajectory(Trajectory):
    """The curve from rest at a phase, ``duration`` s at the full phase rate, then to rest.

    Args:
        curve: the curve.
        angular_frequency: full phase rate, rad/s.
        duration: s at the full rate; the ramps before and after come on top.
        limits: hold at every time; the ramps are as short as they allow.
        start: s, when the motion begins.
        phase: rad, where it begins.

    Raises:
        TrajectoryError: a value has no meaning, or the curve at the full rate exceeds the limits.
    """

    def __init__(
        self,
        curve: LissajousCurve,
        angular_frequency: float,
        duration: float,
        limits: Limits,
        start: float = 0.0,
        phase: float = 0.0,
    ) -> None:
        self.curve = curve
        self.limits = limits
        rate = positive(angular_frequency, "angular frequency")
        duration = positive(duration, "duration")
        start = finite(start, "start")
        check_full_rate(curve, rate, limits)
        # A little gentler at first, so that it can always stop while it gathers speed.
        up, reached = _shortest_ramp(curve, _gentler(curve, rate, limits), phase, 0.0, rate)
        down, _ = _shortest_ramp(curve, limits, reached + rate * duration, rate, 0.0)
        self.full_rate = (start + up, start + up + duration)
        """Times, s, between which the phase runs at the full rate."""
        knots = np.array([start, *self.full_rate, self.full_rate[1] + down])
        self._set_phase(_phase(knots, [0.0, rate, rate, 0.0], phase))

    def _set_phase(self, phase: PPoly) -> None:
        self._phase, self._rate, self._shape = (phase.c, phase.x), phase.derivative(), self.curve.as_array()
        self.start, self._end = float(phase.x[0]), float(phase.x[-1])

    def phase(self, times: ArrayLike) -> Array:
        """Phase at times (K,), s: (K,), rad."""
        return np.asarray(PPoly(*self._phase)(np.clip(times, self.start, self._end)))

    def evaluate(self, times: Times, order: int) -> Array:
        """See ``Trajectory.evaluate``; analytic, by the chain rule."""
        return figure_eight_at(self._shape, *self._phase, times.values, order)

    def stop(self, time: float) -> Trajectory:
        """See ``Trajectory.stop``; stays on the curve."""
        time = max(finite(time, "time"), self.start)
        # While it gathers speed the limits may be used up: then a little later is sooner.
        later = np.arange(time + 0.5, self.full_rate[0], 0.5)
        end, best = self._end, None
        for begin in [time, *later]:
            longest, shorter, duration = end - begin, 0.0, SHORTEST_RAMP
            while duration < longest and not self._brakes(begin, duration):
                shorter, duration = duration, duration * 1.15
            if duration >= longest:
                continue
            for _ in range(4):
                middle = 0.5 * (shorter + duration)
                shorter, duration = (shorter, middle) if self._brakes(begin, middle) else (middle, duration)
            end, best = begin + duration, (begin, duration)
        return self if best is None else _Stopped(self, self._braked(*best))

    def scaled(self, begin: float, rate: float, time: float) -> Trajectory:
        """See ``Trajectory.scaled``."""
        (c, x), (first, last) = self._phase, self.full_rate
        powers = rate ** np.arange(len(c) - 1, -1, -1)[:, None]
        result = copy(self)
        result.full_rate = time + (first - begin) / rate, time + (last - begin) / rate
        result._set_phase(PPoly(c * powers, time + (x - begin) / rate))
        return result

    def _brakes(self, time: float, duration: float) -> bool:
        phase = self._braked(time, duration)
        return _holds_limits(self.curve, self.limits, phase, np.linspace(time, phase.x[-1], 250))

    def _braked(self, time: float, duration: float) -> PPoly:
        """The phase if from ``time`` (s) its rate is multiplied by a factor that falls to 0 in ``duration``."""
        rate = self._rate
        knots = np.unique([*rate.x[rate.x < time + duration], time, time + duration])
        knots = knots[np.append(True, np.diff(knots) > 1e-9)]
        factor = PPoly.from_bernstein_basis(
            BPoly.from_derivatives([time, time + duration], [[1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0]])
        )
        coefficients = np.zeros((rate.c.shape[0] + factor.c.shape[0] - 1, len(knots) - 1))
        for i, begin in enumerate(knots[:-1]):
            segment = min(int(np.searchsorted(rate.x, begin, side="right")) - 1, rate.c.shape[1] - 1)
            product = Polynomial(rate.c[::-1, segment])(Polynomial([begin - rate.x[segment], 1.0]))
            if begin >= time - 1e-9:
                product = product * Polynomial(factor.c[::-1, 0])(Polynomial([begin - time, 1.0]))
            coefficients[-len(product.coef) :, i] = product.coef[::-1]
        return PPoly(coefficients, knots).antiderivative()


class _Stopped(LissajousTrajectory):
    """Coming to rest."""

    def __init__(self, stopped: LissajousTrajectory, phase: PPoly) -> None:
        self.curve, self.limits, self.full_rate = stopped.curve, stopped.limits, stopped.full_rate
        self._set_phase(phase)

    def stop(self, time: float) -> Trajectory:
        """Comes to rest already."""
        finite(time, "time")
        return self


def _phase(knots: Array, rates: Sequence[float], first: float) -> PPoly:
    """Phase from ``first`` on, whose rate is given at the knots (s), where its four derivatives are zero."""
    coefficients = np.zeros((11, len(rates) - 1))
    for i, duration in enumerate(np.diff(knots)):
        change = rates[i + 1] - rates[i]
        coefficients[:5, i] = change * _RAMP / duration ** np.arange(9, 4, -1)
        coefficients[-2:, i] = rates[i], first
        first += (rates[i] + 0.5 * change) * duration
    return PPoly(coefficients, knots)


def _gentler(curve: LissajousCurve, rate: float, limits: Limits) -> Limits:
    """Limits halfway between what the curve needs anyway and what is allowed, but not below 85 %."""
    allowed = limits.as_array()[:4]
    gentler = np.maximum(0.5 * (allowed + largest_derivatives(curve, rate)), 0.85 * allowed)
    return replace(limits, **dict(zip(vars(limits), gentler.tolist(), strict=False)))


def _shortest_ramp(
    curve: LissajousCurve, limits: Limits, phase: float, before: float, after: float
) -> tuple[float, float]:
    """Shortest ramp between two rates (rad/s) within limits: (duration s, phase at its end rad)."""

    def ramp(duration: float) -> PPoly:
        return _phase(np.array([0.0, duration]), (before, after), phase)

    def feasible(duration: float) -> bool:
        times = np.linspace(0.0, duration, max(400, int(duration * 100)))
        return _holds_limits(curve, limits, ramp(duration), times)

    duration = SHORTEST_RAMP
    while not feasible(duration):
        duration *= RAMP_LONGER
        if duration > LONGEST_RAMP:
            raise TrajectoryError("no ramp between rest and the full rate holds the limits")
    shorter = duration / RAMP_LONGER
    for _ in range(6):
        middle = 0.5 * (shorter + duration)
        shorter, duration = (shorter, middle) if feasible(middle) else (middle, duration)
    return duration, float(ramp(duration)(duration))


def _holds_limits(curve: LissajousCurve, limits: Limits, phase: PPoly, times: Array) -> bool:
    # Where the limits are exceeded, a few of the times mostly show it.
    return all(_holds_limits_at(curve, limits, phase, some) for some in (times[::_FEW].copy(), times))


def _holds_limits_at(curve: LissajousCurve, limits: Limits, phase: PPoly, times: Array) -> bool:
    phases = np.array([phase(times, order) for order in range(5)])
    norms = np.linalg.norm(curve.at(phases)[1:], axis=2).max(axis=1)
    # Never backwards; samples may miss a peak by a little.
    return bool(phases[1].min() >= -1e-9 and np.all(norms <= limits.as_array()[:4] * (1.0 - 1e-3)))
