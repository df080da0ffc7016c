"""HOLD and LAND: brake along the velocity, hold position and altitude, descend.

A vehicle must do the same as its neighbours, which carry the same payload and from which it receives nothing. So all
follow the stop plan that came with the last set-point, which the ground made for all of them from one moment; a vehicle
without one plans from its state at the moment of the loss.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import mul
from typing import Any, NamedTuple, Self

import numpy as np
from scipy.optimize import brentq

from gcs.config.vehicle_settings import HoldSettings
from idc_controller.rotations_float import Quaternion, Vector, attitude_of_force
from idc_controller.trajectory.settings import BrakingSettings
from vehicle_sim.world.sensors import Measurement

AT_REST: Vector = (0.0, 0.0, 0.0)


class PlannedState(NamedTuple):
    """Reference that a plan gives the vehicle: m, m/s, m/s2 in the world (NED)."""

    position: Vector
    velocity: Vector
    acceleration: Vector


@dataclass(frozen=True)
class HoldPlan:
    """A stop along a Bezier curve of degree 4, then a descent from ``descent_start`` on.

    ``control_points``: five, in the world (NED, m), passed from ``start`` on in ``duration`` (times in s); ``yaw`` in
    rad, ``descent_speed`` in m/s, reached in ``descent_ramp`` (s), ``descent_start`` infinite for a plan that stays. A
    descent that begins while what sinks is still braked takes over where it is as fast.
    """

    start: float
    duration: float
    control_points: tuple[Vector, ...]
    yaw: float
    descent_start: float = math.inf
    descent_speed: float = HoldSettings.land_speed
    descent_ramp: float = HoldSettings.descent_ramp
    is_common: bool = False
    """All vehicles descend at that time: no command puts it off, or brings it forward."""

    @classmethod
    def to_rest(
        cls, start: float, position: Vector, velocity: Vector, yaw: float, braking: BrakingSettings, *descent: Any
    ) -> Self:
        """Return a plan from a state to rest along the horizontal velocity, as 1 - 3 s^2 + 2 s^3 of it.

        The altitude is that of the start: a vertical velocity is not braked along, because four noisy integrals of it
        would part.
        """
        v_x, v_y, _ = velocity
        duration = max(braking.time, 1.5 * math.hypot(v_x, v_y) / braking.deceleration)
        x, y, z = position
        quarter = (x + duration * v_x / 4, y + duration * v_y / 4, z)
        end = (x + duration * v_x / 2, y + duration * v_y / 2, z)
        return cls(start, duration, (position, quarter, end, end, end), yaw, *descent)

    def displaced(self, offset: Vector) -> Self:
        """Return the plan, all of it displaced by an ``offset`` (m)."""
        return replace(self, control_points=tuple(displaced(point, offset) for point in self.control_points))

    def at(self, now: float) -> PlannedState:
        """The planned state at a time (s)."""
        position, velocity, acceleration = braked = self._braked(now)
        since, depth_before, level = self._takeover
        if now <= since:
            return braked
        depth, sinking, faster = self._descent(now)
        z, v_z, a_z = (position[2], velocity[2], acceleration[2]) if level is None else (level, 0.0, 0.0)
        return PlannedState(
            (*position[:2], z + depth - depth_before), (*velocity[:2], v_z + sinking), (*acceleration[:2], a_z + faster)
        )

    def _braked(self, now: float) -> PlannedState:
        """Return the state at a time (s) without the descent."""
        share = min(max(now - self.start, 0.0), self.duration) / self.duration
        (x, y, z), (v_x, v_y, v_z), (a_x, a_y, a_z) = (on_bezier_curve(points, share) for points in self._curves)
        return PlannedState((x, y, z), (v_x, v_y, v_z), (a_x, a_y, a_z))

    def _descent(self, now: float) -> tuple[float, float, float]:
        """Return depth (m), speed (m/s) and acceleration (m/s2) at a time (s) of the descent alone, from rest."""
        descending, rate = max(now - self.descent_start, 0.0), self.descent_speed / self.descent_ramp
        if descending < self.descent_ramp:
            return 0.5 * rate * descending**2, rate * descending, rate
        return self.descent_speed * (descending - 0.5 * self.descent_ramp), self.descent_speed, 0.0

    @cached_property
    def _takeover(self) -> tuple[float, float, float | None]:
        """From when on it descends (s), the descent's depth then (m), and the altitude (m, NED), where it sinks then.

        Where it rises instead, the descent is added to the stop.
        """

        def slower(now: float) -> float:
            return self._descent(now)[1] - self._braked(now).velocity[2]

        since, braked = max(self.descent_start, self.start), self.start + self.duration
        if since < braked and slower(since) < 0.0:
            since = float(brentq(slower, since, braked))
        elif since == math.inf:
            return since, 0.0, None
        position, velocity, _ = self._braked(since)
        return since, self._descent(since)[0], position[2] if velocity[2] > 0.0 else None

    @cached_property
    def _curves(self) -> tuple[list[list[float]], ...]:
        """Control points, axis by axis, of the position (3, 5), of the velocity (3, 4), of the acceleration (3, 3)."""
        position = np.array(self.control_points).T
        velocity = 4 / self.duration * np.diff(position)
        acceleration = 3 / self.duration * np.diff(velocity)
        return position.tolist(), velocity.tolist(), acceleration.tolist()

    def is_descending(self, now: float) -> bool:
        """Return True if the descent has begun."""
        return now > self.descent_start

    def is_at_descent_speed(self, now: float) -> bool:
        """Return True if the descent has reached its speed."""
        return now - self.descent_start > self.descent_ramp


def on_bezier_curve(axes: Sequence[Sequence[float]], share: float) -> list[float]:
    """Return the point after a ``share`` of the time of a curve with the control points of ``axes``, by Bernstein."""
    n = len(axes[0]) - 1
    rest = 1.0 - share
    weights = [math.comb(n, i) * share**i * rest ** (n - i) for i in range(n + 1)]
    return [sum(map(mul, weights, points)) for points in axes]


def displacement(start: Vector, end: Vector) -> Vector:
    """Return the displacement (3,) from one place to another."""
    (x, y, z), (u, v, w) = start, end
    return u - x, v - y, w - z


def displaced(place: Vector, offset: Vector) -> Vector:
    """Return a ``place`` displaced by an ``offset``."""
    (x, y, z), (u, v, w) = place, offset
    return x + u, y + v, z + w


class HoldController:
    """Follows a plan: from what is measured to an attitude and a thrust.

    The weight to carry is the thrust that the vehicle has learned to hover with: its own weight and its payload's
    share.
    """

    def __init__(
        self, plan: HoldPlan, hover_thrust: float, lean: tuple[float, float], thrust_min: float, g: float,
        settings: HoldSettings, offset: Vector | None = None,
    ) -> None:  # fmt: skip
        """``hover_thrust`` and the least thrust while in the air in N, ``g`` in m/s2.

        ``lean``: level part of the thrust that holds against the wind, of the vertical one, north and east. ``offset``:
        position by dead reckoning less that of the plan (m); None: the position is measured.
        """
        self.plan = plan
        self.hover_thrust = hover_thrust
        self._thrust_min = thrust_min
        self._up_min = min(thrust_min / hover_thrust, 1.0) * g
        self._g = g
        self._settings = settings
        self._integral_x, self._integral_y = lean[0] * g, lean[1] * g
        self._offset = offset
        self._drift = [0.0] * 4
        """Low-passed errors of position (m) and velocity (m/s), north and east, by dead reckoning."""
        self._last_time = plan.start
        self._thrust = hover_thrust
        """Last one commanded (N)."""
        self._supported: tuple[float, Vector, float] | None = None
        """Since when the payload stands (s), where the vehicle was then (m), and its thrust (N)."""

    def command(
        self, measured: Measurement, now: float, supported: bool = False, reckoned: bool = False
    ) -> tuple[Quaternion, float]:
        """Attitude set-point (unit quaternion body to world) and thrust (N).

        ``reckoned``: position and velocity go on by dead reckoning. They drift, and otherwise on each vehicle: what
        lasts of their errors is not followed, and links hang as they are pulled. Once the position is measured, a plan
        of all is followed where it is, and one of its own goes on where the vehicle is.

        ``supported``: the payload stands on the ground. The vehicle then hands it over, where it is. The integral that
        held the payload against the wind goes with the payload's weight: the link, which leans by both, stays as it is.
        """
        gains = self._settings
        x, y, z = measured.position
        if supported:
            since, place, thrust = self._supported = self._supported or (now, measured.position, self._thrust)
            position, velocity, acceleration = PlannedState(place, AT_REST, AT_REST)
            share = max(1.0 - (now - since) / gains.unload_time, 0.0)
            thrust_max = carried = self._thrust_min + share * (thrust - self._thrust_min)
        else:
            self._supported = None
            position, velocity, acceleration = self._planned(measured.position, now, reckoned)
            carried, thrust_max = self.hover_thrust, math.inf
        v_x, v_y, v_z = measured.velocity
        error_x, error_y = position[0] - x, position[1] - y
        step = min(max(now - self._last_time, 0.0), gains.step_max)
        self._last_time = now
        off_x, off_y = velocity[0] - v_x, velocity[1] - v_y
        if reckoned:
            share = step / (gains.reckoning_washout + step)
            errors = error_x, error_y, off_x, off_y
            self._drift = [drift + share * (error - drift) for error, drift in zip(errors, self._drift, strict=True)]
            error_x, error_y, off_x, off_y = (e - drift for e, drift in zip(errors, self._drift, strict=True))
        else:
            self._drift = [0.0] * 4
        i_x = self._integral_x + gains.horizontal_ki * error_x * step
        i_y = self._integral_y + gains.horizontal_ki * error_y * step
        size = math.hypot(i_x, i_y)
        if size > gains.integral_max:
            i_x, i_y = i_x * gains.integral_max / size, i_y * gains.integral_max / size
        if supported:
            i_x, i_y = self._integral_x, self._integral_y
        else:
            self._integral_x, self._integral_y = i_x, i_y
        g = self._g
        a_z = acceleration[2] + gains.vertical_kp * (position[2] - z) + gains.vertical_kd * (velocity[2] - v_z)
        # Downwards as far as the least thrust allows: of a load that was lost, the learned thrust still carries all.
        up = min(max(g - a_z, self._up_min), (1.0 + gains.vertical_max) * g)
        # The integral holds a link that leans: it goes with the link's tension, which the ground takes over.
        pulls = (carried * up / g - self._thrust_min) / max(self.hover_thrust - self._thrust_min, 1e-3)
        i_x, i_y = min(max(pulls, 0.0), 1.0) * i_x, min(max(pulls, 0.0), 1.0) * i_y

        a_x = acceleration[0] + gains.horizontal_kp * error_x + gains.horizontal_kd * off_x + i_x
        a_y = acceleration[1] + gains.horizontal_kp * error_y + gains.horizontal_kd * off_y + i_y
        size = math.hypot(a_x, a_y)
        if size > gains.horizontal_max * g:
            a_x, a_y = a_x * gains.horizontal_max * g / size, a_y * gains.horizontal_max * g / size
        thrust = carried / g * math.sqrt(a_x * a_x + a_y * a_y + up * up)
        # Over a payload that stands the thrust is bounded, whatever the altitude says, which may drift.
        self._thrust = min(max(thrust, self._thrust_min), thrust_max)
        return attitude_of_force(a_x, a_y, -up, self.plan.yaw), self._thrust

    def _planned(self, measured: Vector, now: float, reckoned: bool) -> PlannedState:
        """Return the planned state at a time (s) of a vehicle at a ``measured`` position (m)."""
        planned = self.plan.at(now)
        if self._offset is None:
            return planned
        if reckoned:
            return planned._replace(position=displaced(planned.position, self._offset))
        self._offset = None
        if not self.plan.is_common:
            self.plan = self.plan.displaced(displacement(planned.position, measured))
        return self.plan.at(now)
