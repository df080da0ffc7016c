"""Section IV of the paper: the system, the figure eight as printed and with a beginning, and the two spheres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gcs.config import SystemConfig
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.sphere import Sphere as SphereShape
from idc_controller.trajectory.lissajous import LissajousCurve, LissajousTrajectory
from idc_controller.trajectory.paths import Leg
from idc_controller.trajectory.trajectory import Limits, Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

Array = NDArray[np.float64]

ALTITUDE, RATE = 5.0, 0.5
"""m and rad/s, eq:Lissajous."""
AMPLITUDE = (6.0, 3.0)
RADIUS, MARGIN = 0.5, 0.5
"""m, of the spheres and around them: R_o = 1 m."""
SWING, SWING_RATE = 1.5, 1.0
"""m and rad/s of the moving sphere: not stated by the paper."""


@cache
def configuration() -> SystemConfig:
    """Return the default system: Table I."""
    return SystemConfig()


def printed_reference(times: Array) -> Array:
    """eq:Lissajous (K, 3): a step to the altitude, and full speed from the first moment on."""
    phase = RATE * np.asarray(times, dtype=float)
    return np.column_stack(
        [
            AMPLITUDE[0] * np.sin(phase),
            -2.0 * AMPLITUDE[1] * np.sin(phase) * np.cos(phase),
            np.full(len(phase), -ALTITUDE),
        ]
    )


@dataclass(frozen=True, eq=False)
class ShapedFigure:
    """The same curve, entered from rest after a climb."""

    trajectory: Trajectory
    full_rate: float
    """Time from which on the phase runs at its full rate (s)."""
    meets: float
    """When the payload first comes to (6, 0, -5) (s)."""


@cache
def shaped_figure(duration: float) -> ShapedFigure:
    """Climb, then ``duration`` (s) at full rate, within the limits of the system file."""
    motion = configuration().motion
    climb = Limits(motion.climb_speed, motion.acceleration, motion.jerk, motion.snap)
    curve = Limits(motion.curve_speed, motion.curve_acceleration, motion.curve_jerk, motion.curve_snap)
    up = WaypointTrajectory([0.0, 0.0, 0.0], [Leg(np.array([0.0, 0.0, -ALTITUDE]), motion.climb_speed)], climb)
    up.position(ALTITUDE / motion.climb_speed + 20.0)  # it learns of its end by looking ahead
    figure = LissajousTrajectory(LissajousCurve(AMPLITUDE, -ALTITUDE), RATE, duration, curve, start=up.end)
    begin, phase = figure.full_rate[0], figure.phase([figure.full_rate[0]])[0, 0]
    # The phase is monotonic: the time of a quarter turn is before or after the full rate begins.
    times = np.linspace(up.end, begin, 2000)
    turn = np.pi / 2.0
    meets = float(np.interp(turn, figure.phase(times)[0], times)) if phase > turn else begin + (turn - phase) / RATE
    return ShapedFigure(up.then(lambda _end, _position: figure), begin, meets)


@dataclass(frozen=True)
class Sphere:
    """Radius 0.5 m; swings along x about its mean position when it has an amplitude."""

    name: str
    mean: tuple[float, float, float]
    amplitude: float = 0.0
    phase: float = 0.0

    def motion(self, times: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (K, 3)."""
        angle = SWING_RATE * np.asarray(times, dtype=float) + self.phase
        along = self.amplitude * np.array([1.0, 0.0, 0.0])
        return (
            np.array(self.mean) + np.outer(np.sin(angle), along),
            SWING_RATE * np.outer(np.cos(angle), along),
            -(SWING_RATE**2) * np.outer(np.sin(angle), along),
        )


def two_spheres(meets: float) -> tuple[Sphere, ...]:
    """One rests at (-6, 0, -5); one oscillates about (6, 0, -5) and is there, moving inwards, at ``meets`` (s)."""
    phase = (np.pi - SWING_RATE * meets) % (2.0 * np.pi)
    return (Sphere("static", (-6.0, 0.0, -ALTITUDE)), Sphere("moving", (6.0, 0.0, -ALTITUDE), SWING, phase))


class KnownSpheres:
    """The spheres as the safety filter sees them: positions and motions known, as the paper assumes."""

    def __init__(self, spheres: Sequence[Sphere]) -> None:
        self.spheres = tuple(spheres)

    def predict(self, times: Array) -> list[PredictedObstacle]:
        """All of them at ``times`` (K,)."""
        none = np.zeros(len(times))
        return [PredictedObstacle(s.name, SphereShape(RADIUS), s.motion(times)[0], none) for s in self.spheres]
