"""What a free vehicle flies by itself: phases, one after the other, as goals of a moving set-point."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from gcs.config.vehicle_settings import FreeFlightSettings
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.free.position_control import SpeedLimits
from vehicle_sim.autopilot.free.smooth_motion import SmoothMotion
from vehicle_sim.world.sensors import Measurement


@dataclass(frozen=True)
class Goal:
    """Fly to a place and stay there for a while, for ever with an infinite ``hold``.

    ``position`` NED (m), NaN: where the set-point is; ``yaw`` (rad), NaN: ahead to the place if it is far, else as it
    is; ``radius`` (m): horizontal distance of the vehicle within which it has arrived; ``hold`` (s).
    """

    position: Vector
    radius: float
    yaw: float = math.nan
    hold: float = 0.0
    looks_ahead: bool = True
    """Without a ``yaw``."""
    climb_speed: float = math.inf
    """m/s; upwards, if that is less than the vehicle's limit."""


@dataclass(frozen=True)
class Brake:
    """Come to rest, wherever that is."""


@dataclass(frozen=True)
class Descent:
    """Descend where it is until the ground holds the vehicle. ``ground``: NED (m)."""

    ground: float


Phase = Goal | Brake | Descent


class AutoFlight:
    """Phases flown one after the other; ``finished`` after the last."""

    def __init__(self, phases: Sequence[Phase], settings: FreeFlightSettings) -> None:
        self._phases = [*phases]
        self._settings = settings
        self.place: Vector = (math.nan, math.nan, math.nan)
        """The last goal (NED, m)."""
        self._since: float | None = None
        """When the vehicle arrived at the goal of the phase (s)."""
        self._turn_left = 0.0
        """Commanded change of the heading that is still to be made (rad)."""
        self._turn_rate = 0.0

    @property
    def finished(self) -> bool:
        """Return True if no phase is left."""
        return not self._phases

    @property
    def is_landing(self) -> bool:
        """Return True if it descends to the ground."""
        return bool(self._phases) and isinstance(self._phases[0], Descent)

    def turn(self, angle: float, rate: float) -> None:
        """Change the heading by ``angle`` (rad, clockwise) with ``rate`` (rad/s), and keep it then."""
        self._turn_left, self._turn_rate = angle, rate
        self._phases = [
            replace(phase, yaw=math.nan, looks_ahead=False) if isinstance(phase, Goal) else phase
            for phase in self._phases
        ]

    def destination(self, here: Vector) -> Vector:
        """Return where the phase ends (NED, m), as far as that is known; ``here``: position of the set-point."""
        phase = self._phases[0] if self._phases else Brake()
        if isinstance(phase, Descent):
            return here[0], here[1], phase.ground
        return filled(phase.position, here) if isinstance(phase, Goal) else here

    def advance(
        self,
        motion: SmoothMotion,
        measured: Measurement,
        limits: SpeedLimits,
        landing_speed: Callable[[float], float],
        now: float,
        step: float,
    ) -> None:
        """Move the set-point on for a ``step`` (s), and pass on to the next phase where one is at its end.

        ``landing_speed``: speed of a descent (m/s) at a height above the ground (m).
        """
        if not self._phases:
            return
        phase = self._phases[0]
        if self._turn_left:
            self._turn_left -= motion.turn_by(self._turn_left, self._turn_rate, step)
        if isinstance(phase, Descent):
            sinking = landing_speed(phase.ground - motion.position[2])
            motion.with_velocity((0.0, 0.0, sinking), step)
        elif isinstance(phase, Brake):
            motion.with_velocity((0.0, 0.0, 0.0), step)
            if math.hypot(*motion.velocity) < self._settings.rest_speed:
                self._next()
        else:
            goal = self._resolved(phase, motion)
            motion.to(goal.position, limits._replace(up=min(limits.up, goal.climb_speed)), step)
            self._turn(goal, motion, step)
            if self._since is None and self._has_arrived(goal, measured):
                self._since = now
            if self._since is not None and now - self._since >= goal.hold:
                self._next()

    def _next(self) -> None:
        del self._phases[0]
        self._since = None

    def _resolved(self, goal: Goal, motion: SmoothMotion) -> Goal:
        """Return the goal with its place in full, which then stays."""
        self.place = goal.position
        if not math.isnan(sum(goal.position)):
            return goal
        self.place = filled(goal.position, motion.position)
        resolved = replace(goal, position=self.place)
        self._phases[0] = resolved
        return resolved

    def _turn(self, goal: Goal, motion: SmoothMotion, step: float) -> None:
        if not math.isnan(goal.yaw):
            motion.turn_to(goal.yaw, step)
        elif goal.looks_ahead:
            north, east = goal.position[0] - motion.position[0], goal.position[1] - motion.position[1]
            if math.hypot(north, east) > self._settings.heading_from:
                motion.turn_to(math.atan2(east, north), step)

    def _has_arrived(self, goal: Goal, measured: Measurement) -> bool:
        x, y, z = (there - here for there, here in zip(goal.position, measured.position, strict=True))
        return math.hypot(x, y) <= goal.radius and abs(z) <= self._settings.altitude_radius


def turn_angle(yaw: float, angle: float, direction: int, is_relative: bool) -> float:
    """Return by which angle (rad, clockwise) to turn from ``yaw`` to ``angle``, or by that if it ``is_relative``.

    ``direction`` 1 clockwise, -1 counter-clockwise, 0 the shorter way; of a relative angle as its sign says.
    """
    if is_relative:
        return angle * direction if direction else angle
    whole = 2.0 * math.pi
    ahead = (angle - yaw) % whole
    if direction == 0:
        return math.remainder(ahead, whole)
    return ahead if direction > 0 or ahead == 0.0 else ahead - whole


def filled(place: Vector, here: Vector) -> Vector:
    """Return ``place``, of which what is NaN is that of ``here``."""
    x, y, z = (own if math.isnan(there) else there for there, own in zip(place, here, strict=True))
    return x, y, z
