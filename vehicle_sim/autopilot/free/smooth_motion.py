"""A set-point that moves to goals with limited speed, acceleration and jerk, as PX4's trajectory generator."""

import math

from gcs.config.vehicle_settings import FreeFlightSettings
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.free.position_control import Reference, SpeedLimits


class SmoothMotion:
    """Position (m), velocity (m/s), acceleration (m/s2) in the world (NED) and yaw (rad) of the set-point."""

    def __init__(self, settings: FreeFlightSettings) -> None:
        self._settings = settings
        self.position: Vector = (0.0, 0.0, 0.0)
        self.velocity: Vector = (0.0, 0.0, 0.0)
        self._acceleration: Vector = (0.0, 0.0, 0.0)
        self._jerk = 0.0, 0.0
        """Horizontal, of the last step (m/s3)."""
        self.yaw = 0.0

    def start(self, position: Vector, velocity: Vector, yaw: float) -> None:
        """Begin from a state of the vehicle."""
        self.position, self.velocity, self._acceleration, self.yaw = position, velocity, (0.0, 0.0, 0.0), yaw
        self._jerk = 0.0, 0.0

    @property
    def reference(self) -> Reference:
        """The set-point now, its acceleration ahead of it by as much as the attitude lags."""
        (a_x, a_y, a_z), lead = self._acceleration, self._settings.attitude_lag
        ahead = a_x + lead * self._jerk[0], a_y + lead * self._jerk[1], a_z
        return Reference(self.position, self.velocity, ahead, self.yaw)

    def to(self, goal: Vector, limits: SpeedLimits, step: float) -> None:
        """Move on towards a ``goal`` for a ``step`` (s).

        The slower of the horizontal and the vertical part gives the time for both, so that the path is about straight.
        """
        settings = self._settings
        x, y, z = (there - here for there, here in zip(goal, self.position, strict=True))
        side, climb = math.hypot(x, y), abs(z)
        v_side = min(limits.horizontal, self._stopping_speed(side, settings.acceleration))
        v_climb = min(
            limits.up if z < 0.0 else limits.down, self._stopping_speed(climb, settings.vertical_acceleration)
        )
        if side > settings.straight_from and climb > settings.straight_from:
            time = max(side / v_side, climb / v_climb)
            v_side, v_climb = side / time, climb / time
        share = v_side / side if side > 0.0 else 0.0
        self.with_velocity((x * share, y * share, math.copysign(v_climb, z)), step)

    def with_velocity(self, velocity: Vector, step: float) -> None:
        """Move on towards a ``velocity`` (m/s) for a ``step`` (s)."""
        settings = self._settings
        off_x, off_y, off_z = (wanted - now for wanted, now in zip(velocity, self.velocity, strict=True))
        side = math.hypot(off_x, off_y)
        share = self._acceleration_for(side, settings.acceleration) / side if side > 0.0 else 0.0
        a_x, a_y = share * off_x, share * off_y
        a_z = math.copysign(self._acceleration_for(abs(off_z), settings.vertical_acceleration), off_z)
        change_max = settings.jerk * step
        b_x, b_y, b_z = (
            before + min(max(wanted - before, -change_max), change_max)
            for wanted, before in zip((a_x, a_y, a_z), self._acceleration, strict=True)
        )
        self._jerk = (b_x - self._acceleration[0]) / step, (b_y - self._acceleration[1]) / step
        self._acceleration = b_x, b_y, b_z
        v_x, v_y, v_z = self.velocity
        w_x, w_y, w_z = self.velocity = v_x + b_x * step, v_y + b_y * step, v_z + b_z * step
        x, y, z = self.position
        half = 0.5 * step
        self.position = x + half * (v_x + w_x), y + half * (v_y + w_y), z + half * (v_z + w_z)

    def turn_to(self, yaw: float, step: float) -> None:
        """Turn towards a ``yaw`` (rad), the shorter way, for a ``step`` (s)."""
        change_max = self._settings.yaw_rate * step
        left = math.remainder(yaw - self.yaw, 2.0 * math.pi)
        self.yaw = math.remainder(self.yaw + min(max(left, -change_max), change_max), 2.0 * math.pi)

    def turn_by(self, angle: float, rate: float, step: float) -> float:
        """Turn by at most ``angle`` (rad) with ``rate`` (rad/s) for a ``step`` (s); return what was turned."""
        change = min(max(angle, -rate * step), rate * step)
        self.yaw = math.remainder(self.yaw + change, 2.0 * math.pi)
        return change

    def _acceleration_for(self, change: float, limit: float) -> float:
        """Return the acceleration (m/s2) for a ``change`` of the velocity (m/s), which the jerk can still take back."""
        settings = self._settings
        return min(settings.velocity_rate * change, math.sqrt(1.6 * settings.jerk * change), limit)

    def _stopping_speed(self, distance: float, acceleration: float) -> float:
        """Return the speed (m/s) from which it comes to rest within a ``distance`` (m).

        Braking with ``acceleration`` (m/s2), which the jerk allows after a while; near the goal in proportion to the
        distance.
        """
        b = 4.0 * acceleration * acceleration / self._settings.jerk
        braking = 0.5 * (math.sqrt(b * b + 8.0 * acceleration * distance) - b)
        return min(braking, self._settings.approach_rate * distance)
