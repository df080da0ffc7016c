"""What a vehicle does on its own: brake along its velocity, hold position and altitude, descend.

It must do the same as its neighbours, who hang on the same payload and whom it does not hear. So all follow a plan
made from their state at the moment of the loss, at times that follow from that moment alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from vehicle_sim.attitude_control import Quaternion, Three
from vehicle_sim.sensors import Measurement

# Horizontal gains 1/s2, 1/s, 1/s3; vertical gains 1/s2, 1/s. There is no vertical integral: four altitudes
# over-constrain a rigid payload, and integrals would load one link against another.
HORIZONTAL_KP = 0.8
HORIZONTAL_KD = 1.5
HORIZONTAL_KI = 0.1
INTEGRAL_LIMIT = 2.5  # m/s2
VERTICAL_KP = 3.2
VERTICAL_KD = 4.5
TILT_LIMIT = 0.35  # horizontal acceleration, in g
VERTICAL_LIMIT = 0.35  # vertical acceleration, in g

BRAKING_TIME = 4.0  # s
BRAKING_LIMIT = 2.0  # m/s2; a faster vehicle takes longer to stop
DESCENT_RAMP = 1.0  # s to reach the descent speed


class PlannedState(NamedTuple):
    """Where a plan wants the vehicle: m, m/s, m/s2 in the world (NED)."""

    position: Three
    velocity: Three
    acceleration: Three


@dataclass(frozen=True)
class HoldPlan:
    """From a state, to rest along the own velocity at the same altitude, then down from ``descent_start`` on.

    ``position`` and ``velocity`` at ``start`` in the world (NED, m, m/s), times in s, ``yaw`` in rad,
    ``descent_speed`` in m/s, ``descent_start`` infinite for a plan that stays.

    The horizontal velocity falls as 1 - 3 s^2 + 2 s^3, so that acceleration begins and ends at zero. The altitude
    is that of the start: a vertical velocity is not braked along, because four noisy integrals of it would part.
    """

    start: float
    position: Three
    velocity: Three
    yaw: float
    descent_start: float = math.inf
    descent_speed: float = 0.5

    @property
    def braking_time(self) -> float:
        """Seconds until the vehicle is to rest."""
        return max(BRAKING_TIME, 1.5 * math.hypot(self.velocity[0], self.velocity[1]) / BRAKING_LIMIT)

    def at(self, now: float) -> PlannedState:
        """The planned state at a time (s)."""
        duration = self.braking_time
        s = min(max((now - self.start) / duration, 0.0), 1.0)
        travelled = duration * (s - s**3 + 0.5 * s**4)
        speed = 1.0 - 3.0 * s * s + 2.0 * s**3
        braking = 6.0 * (s * s - s) / duration
        x, y, z = self.position
        v_x, v_y, _ = self.velocity
        sinking, down, down_acceleration = 0.0, 0.0, 0.0
        descending = now - self.descent_start
        if descending > 0.0:
            rate = self.descent_speed / DESCENT_RAMP
            if descending < DESCENT_RAMP:
                sinking, down, down_acceleration = rate * descending, 0.5 * rate * descending**2, rate
            else:
                sinking = self.descent_speed
                down = self.descent_speed * (descending - 0.5 * DESCENT_RAMP)
        return PlannedState(
            (x + v_x * travelled, y + v_y * travelled, z + down),
            (v_x * speed, v_y * speed, sinking),
            (v_x * braking, v_y * braking, down_acceleration),
        )

    def is_descending(self, now: float) -> bool:
        """Whether the descent has begun."""
        return now > self.descent_start


class HoldController:
    """Follows a plan: from what is measured to an attitude and a thrust.

    The weight to carry is the thrust that the vehicle has learned to hover with: its own weight and its payload's
    share. A later plan (one that every set-point brings along) only needs ``at``, ``yaw`` and ``is_descending``.
    """

    def __init__(self, plan: HoldPlan, hover_thrust: float, thrust_min: float, g: float) -> None:
        """``hover_thrust`` and the least thrust while in the air in N, ``g`` in m/s2."""
        self.plan = plan
        self._hover_thrust = hover_thrust
        self._thrust_min = thrust_min
        self._g = g
        self._integral_x = 0.0
        self._integral_y = 0.0
        self._last_time = plan.start

    def command(self, measured: Measurement, now: float) -> tuple[Quaternion, float]:
        """Attitude set-point (unit quaternion body to world) and thrust (N)."""
        position, velocity, acceleration = self.plan.at(now)
        x, y, z = measured.position
        v_x, v_y, v_z = measured.velocity
        error_x, error_y = position[0] - x, position[1] - y
        step = min(max(now - self._last_time, 0.0), 0.1)
        self._last_time = now
        i_x = self._integral_x + HORIZONTAL_KI * error_x * step
        i_y = self._integral_y + HORIZONTAL_KI * error_y * step
        size = math.hypot(i_x, i_y)
        if size > INTEGRAL_LIMIT:
            i_x, i_y = i_x * INTEGRAL_LIMIT / size, i_y * INTEGRAL_LIMIT / size
        self._integral_x, self._integral_y = i_x, i_y

        a_x = acceleration[0] + HORIZONTAL_KP * error_x + HORIZONTAL_KD * (velocity[0] - v_x) + i_x
        a_y = acceleration[1] + HORIZONTAL_KP * error_y + HORIZONTAL_KD * (velocity[1] - v_y) + i_y
        g = self._g
        size = math.hypot(a_x, a_y)
        if size > TILT_LIMIT * g:
            a_x, a_y = a_x * TILT_LIMIT * g / size, a_y * TILT_LIMIT * g / size
        a_z = acceleration[2] + VERTICAL_KP * (position[2] - z) + VERTICAL_KD * (velocity[2] - v_z)
        a_z = min(max(a_z, -VERTICAL_LIMIT * g), VERTICAL_LIMIT * g)

        up = g - a_z
        thrust = self._hover_thrust / g * math.sqrt(a_x * a_x + a_y * a_y + up * up)
        return attitude_of_force(a_x, a_y, -up, self.plan.yaw), max(thrust, self._thrust_min)


def attitude_of_force(f_x: float, f_y: float, f_z: float, yaw: float) -> Quaternion:
    """Attitude (unit quaternion body to world) whose thrust axis, body -z, lies along a force in the world (NED).

    The shortest turn from level that tilts the axis, after a turn by ``yaw`` (rad). The force points upwards.
    """
    size = math.sqrt(f_x * f_x + f_y * f_y + f_z * f_z)
    # From (0, 0, -1) to the force: w = 1 + cos, axis = (0, 0, -1) x force.
    w, x, y = 1.0 - f_z / size, f_y / size, -f_x / size
    scale = 1.0 / math.sqrt(w * w + x * x + y * y)
    w, x, y = w * scale, x * scale, y * scale
    c, s = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    return w * c, x * c + y * s, y * c - x * s, w * s


def yaw_of(attitude: Quaternion) -> float:
    """Yaw (rad) of a unit quaternion body to world."""
    w, x, y, z = attitude
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
