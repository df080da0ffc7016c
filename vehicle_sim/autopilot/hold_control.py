"""What a vehicle does on its own: brake along its velocity, hold position and altitude, descend.

It must do the same as its neighbours, who hang on the same payload and whom it does not hear. So all follow the stop
plan that came with the last set-point, which the ground made for all of them from one moment; a vehicle whose ground
sends none makes its own from its state at the moment of the loss.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BPoly

from idc_controller.rotations_float import Quaternion, Vector, attitude_of_force
from idc_controller.trajectory.stop_plan import BRAKING_LIMIT, BRAKING_TIME
from vehicle_sim.world.sensors import Measurement

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

DESCENT_RAMP = 1.0  # s to reach the descent speed
STILL: Vector = (0.0, 0.0, 0.0)


class PlannedState(NamedTuple):
    """Where a plan wants the vehicle: m, m/s, m/s2 in the world (NED)."""

    position: Vector
    velocity: Vector
    acceleration: Vector


@dataclass(frozen=True)
class HoldPlan:
    """To rest along a Bezier curve of degree 4, then down from ``descent_start`` on.

    ``control_points``: five, in the world (NED, m), passed from ``start`` on in ``duration`` (times in s); ``yaw`` in
    rad, ``descent_speed`` in m/s, ``descent_start`` infinite for a plan that stays.
    """

    start: float
    duration: float
    control_points: tuple[Vector, ...]
    yaw: float
    descent_start: float = math.inf
    descent_speed: float = 0.5

    @classmethod
    def braking(
        cls, start: float, position: Vector, velocity: Vector, yaw: float,
        descent_start: float = math.inf, descent_speed: float = 0.5,
    ) -> HoldPlan:  # fmt: skip
        """From an own state to rest along the own horizontal velocity, as 1 - 3 s^2 + 2 s^3 of it.

        The altitude is that of the start: a vertical velocity is not braked along, because four noisy integrals of it
        would part.
        """
        v_x, v_y, _ = velocity
        duration = max(BRAKING_TIME, 1.5 * math.hypot(v_x, v_y) / BRAKING_LIMIT)
        x, y, z = position
        quarter = (x + duration * v_x / 4, y + duration * v_y / 4, z)
        end = (x + duration * v_x / 2, y + duration * v_y / 2, z)
        return cls(start, duration, (position, quarter, end, end, end), yaw, descent_start, descent_speed)

    def at(self, now: float) -> PlannedState:
        """The planned state at a time (s)."""
        t = min(max(now - self.start, 0.0), self.duration)
        (x, y, z), (v_x, v_y, v_z), (a_x, a_y, a_z) = (curve(t).tolist() for curve in self._curves)
        descending = now - self.descent_start
        if descending > 0.0:
            rate = self.descent_speed / DESCENT_RAMP
            if descending < DESCENT_RAMP:
                sinking, down = rate * descending, 0.5 * rate * descending**2
                a_z += rate
            else:
                sinking = self.descent_speed
                down = self.descent_speed * (descending - 0.5 * DESCENT_RAMP)
            z += down
            v_z += sinking
        return PlannedState((x, y, z), (v_x, v_y, v_z), (a_x, a_y, a_z))

    @cached_property
    def _curves(self) -> tuple[BPoly, BPoly, BPoly]:
        """Position, velocity and acceleration over the time since the start."""
        position = BPoly(np.array(self.control_points)[:, None, :], [0.0, self.duration])
        return position, position.derivative(), position.derivative(2)

    def is_descending(self, now: float) -> bool:
        """Whether the descent has begun."""
        return now > self.descent_start


class HoldController:
    """Follows a plan: from what is measured to an attitude and a thrust.

    The weight to carry is the thrust that the vehicle has learned to hover with: its own weight and its payload's
    share.
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
        self._stands: Vector | None = None

    def command(self, measured: Measurement, now: float, standing: bool = False) -> tuple[Quaternion, float]:
        """Attitude set-point (unit quaternion body to world) and thrust (N).

        ``standing``: the payload stands on the ground. The vehicle then carries itself alone, where it is: what it has
        learned to hold the payload against the wind would drive it aside, and its link over.
        """
        x, y, z = measured.position
        if standing:
            self._stands = self._stands or measured.position
            position, velocity, acceleration = PlannedState(self._stands, STILL, STILL)
            carried = self._thrust_min
        else:
            self._stands = None
            position, velocity, acceleration = self.plan.at(now)
            carried = self._hover_thrust
        v_x, v_y, v_z = measured.velocity
        error_x, error_y = position[0] - x, position[1] - y
        step = min(max(now - self._last_time, 0.0), 0.1)
        self._last_time = now
        i_x = self._integral_x + HORIZONTAL_KI * error_x * step
        i_y = self._integral_y + HORIZONTAL_KI * error_y * step
        size = math.hypot(i_x, i_y)
        if size > INTEGRAL_LIMIT:
            i_x, i_y = i_x * INTEGRAL_LIMIT / size, i_y * INTEGRAL_LIMIT / size
        if standing:
            i_x = i_y = 0.0
        else:
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
        thrust = carried / g * math.sqrt(a_x * a_x + a_y * a_y + up * up)
        return attitude_of_force(a_x, a_y, -up, self.plan.yaw), max(thrust, self._thrust_min)
