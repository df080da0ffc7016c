"""Settings of trajectories: limits of the motion, clearance to keep, how a team without set-points brakes."""

import math
from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array
from idc_controller.errors import TrajectoryError
from idc_controller.settings import SettingsTable, derived, setting

CORNER = 0.2
"""Distance (m) within which the default system passes a waypoint without hold: ``motion.corner``."""


@dataclass(frozen=True, eq=False, repr=False)
class Limits(SettingsTable):
    """Largest Euclidean norms that a trajectory's derivatives may reach; the defaults are those between waypoints.

    Raises:
        TrajectoryError: a limit is not positive or not finite.
    """

    speed: float = 1.5
    """m/s"""
    acceleration: float = 1.5
    """m/s2"""
    jerk: float = 2.0
    """m/s3"""
    snap: float = 6.0
    """m/s4"""
    crackle: float = 12.0
    """m/s5, of splines: the UAVs' tilt set-points jump where it does"""

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0.0):
                raise TrajectoryError(f"limit {name} must be a positive number, not {value}")

    def as_array(self) -> Array:
        """Return the limits by order of derivative (5,)."""
        return np.array([self.speed, self.acceleration, self.jerk, self.snap, self.crackle])

    def stopping_time(self, speed: float) -> float:
        """Return the time of a stop along a line from ``speed`` (m/s) (s); half of it at that speed is its way."""
        a, j, s, c = self.acceleration, self.jerk, self.snap, self.crackle
        return speed / a + a / j + j / s + s / c


@dataclass(frozen=True, eq=False, repr=False)
class AvoidanceSettings(SettingsTable):
    """Clearance from obstacles, and how fast they are approached: table ``avoidance``."""

    margin: float = setting(0.5, "m", "clearance to keep between hull and obstacles", gt=0.0)
    barrier_rates: tuple[float, ...] = setting(
        (5.0,), "1/s", "rates of the exponential barrier, one for each degree", gt=0.0
    )


@dataclass(frozen=True, eq=False, repr=False)
class BrakingSettings(SettingsTable):
    """Duration of a stop: the least, or as long as the deceleration demands."""

    time: float = 4.0  # s; least time in which a team without set-points comes to rest
    deceleration: float = derived(2.0)
    """Largest deceleration of that stop (m/s2); a faster team takes longer."""

    def usual_duration(self, velocity: Array) -> float:
        """Return the time from a ``velocity`` (3,) (m/s) to rest (s)."""
        return max(self.time, 1.5 * math.sqrt(velocity @ velocity) / self.deceleration)
