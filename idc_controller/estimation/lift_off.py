"""Lift-off of a payload of unknown mass: recognised by vertical motion, the mass from thrust and momentum.

While the ground carries the rest of the weight W of the team, nothing rises. From lift-off on, with all links taut, the
team has the momentum

    W / g v = integral of (T - W) over the time since T > W,

where T is the total upward thrust: the set-points after the motors' lag. Its solution W needs no time of lift-off,
and no wait until the motion is large. Vertical wind counts as weight.
"""

from itertools import accumulate

import numpy as np
from scipy.optimize import brentq
from scipy.stats import median_abs_deviation

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Measurement, Position
from idc_controller.estimation.settings import LiftOffSettings
from idc_controller.parameters import SystemParameters

_GRID = 0.005
"""Spacing of the times at which the thrust is computed (s): a tenth of the motors' lag."""


class LiftOffDetector:
    """Lift-off of one payload. Times in s; call :meth:`command` and :meth:`mass` once a control step."""

    def __init__(self, parameters: SystemParameters, settings: LiftOffSettings = LiftOffSettings()) -> None:
        self._parameters, self._settings = parameters, settings
        self._effective: list[float] = []
        self._thrusts: list[float] = []
        self._velocities: dict[int, tuple[float, float]] = {}
        """Time (s) and upward speed (m/s) of the newest velocity of each source."""
        self._medians: list[float] = []
        """Of their speeds, in every control step (m/s)."""

    def command(self, effective: float, thrust: float) -> None:
        """Take the total upward ``thrust`` (N) of the set-points that act from ``effective`` (s) on."""
        self._effective.append(effective)
        self._thrusts.append(thrust)

    def add(self, measurement: Measurement) -> None:
        """Take a measurement as it was sent; only velocities are used."""
        if isinstance(measurement, Position) and measurement.has_motion:
            before = self._velocities.get(measurement.source)
            if before is None or measurement.time > before[0]:
                self._velocities[measurement.source] = measurement.time, -float(measurement.motion[2])

    def mass(self, time: float) -> float | None:
        """Return the payload's mass (kg) if it has lifted off by ``time`` (s), else None.

        It has if payload and vehicles rise, in the median, in some control steps in a row, faster than nearly all noise
        on the ground. Every source gives a mass; the median is not that of a source that is wrong.
        """
        s, p = self._settings, self._parameters
        fresh = [velocity for velocity in self._velocities.values() if time - velocity[0] < s.age_max]
        if 2 * len(fresh) <= p.number_of_uavs + 1 or not self._effective:
            return None
        self._medians.append(float(np.median([speed for _, speed in fresh])))
        # The spread of what stands; that the last ones rise changes it little.
        spread = float(median_abs_deviation(self._medians, scale="normal"))
        if min(self._medians[-s.steps :]) <= max(s.speed, s.sigmas * spread):
            return None
        mass = float(np.median([self._weight(*velocity) for velocity in fresh])) / p.g - float(p.m.sum())
        return mass if mass > 0.0 else None  # the vehicles alone are heavier than their thrust

    def motion(self, time: float, mass: float) -> tuple[float, float]:
        """Return total thrust (N) and upward speed (m/s) at ``time`` (s), of a payload of ``mass`` (kg) in the air."""
        thrust, weight = self._thrust_until(time), (mass + float(self._parameters.m.sum())) * self._parameters.g
        return float(thrust[-1]), _impulse(thrust, weight) * self._parameters.g / weight

    def _weight(self, time: float, speed: float) -> float:
        """Return the weight (N) of the team that rises with ``speed`` (m/s) at ``time`` (s)."""
        thrust, g = self._thrust_until(time), self._parameters.g
        highest = float(thrust.max())
        if speed <= 0.0 or highest <= 0.0:
            return highest
        return float(brentq(lambda weight: _impulse(thrust, weight) - weight / g * speed, 0.0, highest))

    def _thrust_until(self, time: float) -> Array:
        """Return the total thrust (K,) (N) from the first set-points to ``time`` (s)."""
        times = np.arange(self._effective[0], max(time, self._effective[0]) + _GRID, _GRID)
        commanded = np.array(self._thrusts)[np.searchsorted(self._effective, times, side="right") - 1]
        keep = float(np.exp(-_GRID / self._parameters.motor_time_constant))
        lagged = accumulate(commanded.tolist(), lambda thrust, u: u + keep * (thrust - u), initial=0.0)
        return np.array([*lagged][: len(times)])


def _impulse(thrust: Array, weight: float) -> float:
    """Return the integral of ``thrust`` (K,) (N) above ``weight`` (N) (N s)."""
    return _GRID * float(np.maximum(thrust - weight, 0.0).sum())
