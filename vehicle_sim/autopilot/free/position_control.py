"""Position control of a free vehicle: position P, velocity PI, then attitude and thrust."""

import math
from typing import NamedTuple

from gcs.config.vehicle_settings import FreeFlightSettings
from idc_controller.rotations_float import Quaternion, Vector, attitude_of_force
from vehicle_sim.world.sensors import Measurement

NAN_VECTOR: Vector = (math.nan, math.nan, math.nan)


class Reference(NamedTuple):
    """What is to be flown: m, m/s, m/s2 in the world (NED), rad, rad/s. NaN: that axis is not controlled by it.

    A velocity beside a position, and an acceleration beside a velocity, are fed forward, as in PX4.
    """

    position: Vector
    velocity: Vector
    acceleration: Vector
    yaw: float
    yaw_rate: float = math.nan


class SpeedLimits(NamedTuple):
    """Largest speeds (m/s): horizontal, up and down."""

    horizontal: float
    up: float
    down: float


class PositionController:
    """From a reference and what is measured to an attitude and a thrust; keeps the integral of the velocity error."""

    def __init__(self, mass: float, thrust_max: float, g: float, settings: FreeFlightSettings) -> None:
        """``mass`` in kg, ``thrust_max`` in N, ``g`` in m/s2."""
        self._mass, self._thrust_max, self._g = mass, thrust_max, g
        self._settings = settings
        self._integral: Vector = (0.0, 0.0, 0.0)

    def reset(self) -> None:
        """Forget the integral: the vehicle stands, or another flies it."""
        self._integral = (0.0, 0.0, 0.0)

    def command(
        self, reference: Reference, measured: Measurement, limits: SpeedLimits, step: float
    ) -> tuple[Quaternion, float]:
        """Return attitude (unit quaternion body to world) and thrust (N); ``step`` since the last call (s)."""
        gains, g = self._settings, self._g
        v_x, v_y, v_z = self._velocity(reference, measured, limits)
        errors = [
            0.0 if math.isnan(wanted) else wanted - now
            for wanted, now in zip((v_x, v_y, v_z), measured.velocity, strict=True)
        ]
        kp = gains.velocity_kp, gains.velocity_kp, gains.vertical_velocity_kp
        a_x, a_y, a_z = (
            k * error + integral + (0.0 if math.isnan(forward) else forward)
            for k, error, integral, forward in zip(kp, errors, self._integral, reference.acceleration, strict=True)
        )
        # The thrust: the vertical part first, within what the rotors have, then the horizontal one within the tilt.
        top = self._thrust_max * gains.thrust_share_max / self._mass
        up = min(max(g - a_z, gains.thrust_min * g), top)
        side = math.hypot(a_x, a_y)
        side_max = min(up * math.tan(math.radians(gains.tilt_max_deg)), math.sqrt(max(top * top - up * up, 0.0)))
        if side > side_max:
            a_x, a_y = a_x * side_max / side, a_y * side_max / side
        self._integrate(errors, side > side_max, up != g - a_z, step)
        size = math.sqrt(a_x * a_x + a_y * a_y + up * up)
        return attitude_of_force(a_x, a_y, -up, reference.yaw), self._mass * size

    def _velocity(self, reference: Reference, measured: Measurement, limits: SpeedLimits) -> Vector:
        """Return the velocity set-point (m/s); NaN: not controlled."""
        gains = self._settings
        kp = gains.position_kp, gains.position_kp, gains.vertical_position_kp
        wanted = []
        for k, goal, place, forward in zip(kp, reference.position, measured.position, reference.velocity, strict=True):
            if math.isnan(goal):
                wanted.append(forward)
            else:
                wanted.append(k * (goal - place) + (0.0 if math.isnan(forward) else forward))
        v_x, v_y, v_z = wanted
        speed = math.hypot(v_x, v_y)
        if speed > limits.horizontal:  # False for NaN
            v_x, v_y = v_x * limits.horizontal / speed, v_y * limits.horizontal / speed
        if not math.isnan(v_z):
            v_z = min(max(v_z, -limits.up), limits.down)
        return v_x, v_y, v_z

    def _integrate(self, errors: list[float], tilt_limited: bool, thrust_limited: bool, step: float) -> None:
        """Add the velocity error, except where the rotors or the tilt are at their limit."""
        gains = self._settings
        x, y, z = self._integral
        if not tilt_limited:
            x += gains.velocity_ki * errors[0] * step
            y += gains.velocity_ki * errors[1] * step
            size = math.hypot(x, y)
            if size > gains.integral_max:
                x, y = x * gains.integral_max / size, y * gains.integral_max / size
        if not thrust_limited:
            z += gains.vertical_velocity_ki * errors[2] * step
            z = min(max(z, -gains.integral_max), gains.integral_max)
        self._integral = x, y, z
