"""Section IV of the paper: the system, the figure eight as printed and entered from rest, and the two spheres."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from gcs.config import SystemConfig
from idc_controller.arrays import Array
from idc_controller.geometry.obstacles import PredictedObstacle, Region
from idc_controller.geometry.shapes import Sphere as SphereShape
from idc_controller.trajectory.lissajous import LissajousCurve, LissajousTrajectory
from idc_controller.trajectory.paths import Leg
from idc_controller.trajectory.trajectory import Trajectory
from idc_controller.trajectory.waypoints import WaypointTrajectory

ALTITUDE, RATE = 5.0, 0.5
"""Altitude (m) and angular rate (rad/s) of eq:Lissajous."""
AMPLITUDE = (6.0, 3.0)
RADIUS, MARGIN = 0.5, 0.5
"""Radius of the spheres and safety margin (m): R_o = 1 m."""
OSCILLATION, OSCILLATION_RATE = 1.5, 1.0
"""Amplitude (m) and angular rate (rad/s) of the moving sphere: not stated by the paper."""


@cache
def configuration() -> SystemConfig:
    """Return the default system: Table I."""
    return SystemConfig()


def printed_reference(times: Array, region: Region | None = None) -> Array:
    """Return eq:Lissajous (K, 3) at ``times`` (K,): a step to the altitude, and full speed from the start."""
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
    """Time at which the payload first reaches (6, 0, -5) (s)."""


@cache
def shaped_figure(duration: float) -> ShapedFigure:
    """Return a climb, then ``duration`` (s) at full rate, within the limits of the system file."""
    motion = configuration().motion
    up = WaypointTrajectory(
        [0.0, 0.0, 0.0], [Leg(np.array([0.0, 0.0, -ALTITUDE]), motion.climb_speed)], motion.climb_limits
    )
    up.position(ALTITUDE / motion.climb_speed + 20.0)  # its end is known only after a sample beyond it
    figure = LissajousTrajectory(
        LissajousCurve(AMPLITUDE, -ALTITUDE), RATE, duration, motion.curve_limits, start=up.end
    )
    begin, phase = figure.full_rate[0], float(figure.phase(figure.full_rate[0]))
    # The phase is monotonic: the time of a quarter turn is before or after the full rate begins.
    times = np.linspace(up.end, begin, 2000)
    turn = np.pi / 2.0
    meets = float(np.interp(turn, figure.phase(times), times)) if phase > turn else begin + (turn - phase) / RATE
    return ShapedFigure(up.then(lambda _end, _position: figure), begin, meets)


@dataclass(frozen=True)
class Sphere:
    """A sphere of :data:`RADIUS` that oscillates along x about its mean position with ``amplitude`` (m)."""

    name: str
    mean: tuple[float, float, float]
    amplitude: float = 0.0
    phase: float = 0.0

    def motion(self, times: Array, region: Region | None = None) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration (K, 3) at ``times`` (K,)."""
        angle = OSCILLATION_RATE * np.asarray(times, dtype=float) + self.phase
        along = self.amplitude * np.array([1.0, 0.0, 0.0])
        return (
            np.array(self.mean) + np.outer(np.sin(angle), along),
            OSCILLATION_RATE * np.outer(np.cos(angle), along),
            -(OSCILLATION_RATE**2) * np.outer(np.sin(angle), along),
        )


def two_spheres(meets: float) -> tuple[Sphere, ...]:
    """Return one at rest at (-6, 0, -5), and one about (6, 0, -5) that is there, moving inwards, at ``meets`` (s)."""
    phase = (np.pi - OSCILLATION_RATE * meets) % (2.0 * np.pi)
    return (Sphere("static", (-6.0, 0.0, -ALTITUDE)), Sphere("moving", (6.0, 0.0, -ALTITUDE), OSCILLATION, phase))


class KnownSpheres:
    """The spheres for the safety filter: where they will be is known."""

    def __init__(self, spheres: Sequence[Sphere]) -> None:
        self.spheres = tuple(spheres)

    def predict(self, times: Array, region: Region | None = None) -> list[PredictedObstacle]:
        """Return all of them at ``times`` (K,)."""
        none = np.zeros(len(times))
        return [PredictedObstacle(s.name, SphereShape(RADIUS), s.motion(times)[0], none) for s in self.spheres]


class ExtrapolatedSpheres(KnownSpheres):
    """The spheres for the safety filter: position, velocity and acceleration now are known, as the paper assumes."""

    def predict(self, times: Array, region: Region | None = None) -> list[PredictedObstacle]:
        """Return all of them at ``times`` (K,), with the acceleration that they have at the first of these."""
        elapsed = (np.asarray(times, dtype=float) - times[0])[:, None]
        none, found = np.zeros(len(times)), []
        for s in self.spheres:
            position, velocity, acceleration = s.motion(times[:1])
            places = position + elapsed * velocity + 0.5 * elapsed**2 * acceleration
            found.append(PredictedObstacle(s.name, SphereShape(RADIUS), places, none))
        return found
