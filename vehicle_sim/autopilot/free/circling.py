"""Flight on a circle, as a phase of what a free vehicle flies by itself."""

import math
from dataclasses import dataclass
from enum import IntEnum

from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.free.smooth_motion import SmoothMotion


class Heading(IntEnum):
    """Where the vehicle looks: MAVLink's ORBIT_YAW_BEHAVIOUR without that of a remote control."""

    CENTRE = 0
    INITIAL = 1
    UNCONTROLLED = 2
    TANGENT = 3


@dataclass(frozen=True)
class CirclePath:
    """A flight about a ``centre`` (NED, m; with the altitude of the flight) from the nearest point of the circle on.

    ``radius`` (m, negative: counter-clockwise), ``speed`` (m/s), ``angle`` (rad) after which it ends.
    """

    centre: Vector
    radius: float
    speed: float
    heading: Heading
    angle: float

    def start_from(self, place: Vector, yaw: float) -> Vector:
        """Return the point of the circle that is nearest to a ``place``; from the centre that ahead (``yaw``, rad)."""
        north, east = place[0] - self.centre[0], place[1] - self.centre[1]
        angle = math.atan2(east, north) if math.hypot(north, east) > 0.0 else yaw
        radius = abs(self.radius)
        return self.centre[0] + radius * math.cos(angle), self.centre[1] + radius * math.sin(angle), self.centre[2]


class Circling:
    """A :class:`CirclePath` that is being flown."""

    def __init__(self, circle: CirclePath, acceleration: float) -> None:
        """``acceleration`` (m/s2) up to its speed."""
        self._circle = circle
        self._acceleration = acceleration
        self._speed = self._angle = 0.0

    @property
    def is_over(self) -> bool:
        """Return True if its angle has been flown."""
        return self._angle >= self._circle.angle

    def advance(self, motion: SmoothMotion, step: float) -> None:
        """Move the set-point on for a ``step`` (s)."""
        circle, before = self._circle, self._speed
        self._speed = min(circle.speed, before + self._acceleration * step)
        turn = 0.5 * (before + self._speed) * step / abs(circle.radius)
        self._angle += turn
        motion.on_circle(circle.centre, abs(circle.radius), math.copysign(turn, circle.radius), self._speed, step)
        north, east = circle.centre[0] - motion.position[0], circle.centre[1] - motion.position[1]
        if circle.heading is Heading.CENTRE:
            motion.turn_to(math.atan2(east, north), step)
        elif circle.heading is Heading.TANGENT:
            motion.turn_to(math.atan2(motion.velocity[1], motion.velocity[0]), step)
