"""What a vehicle's attitude loop and mixer are to do."""

import math
from typing import NamedTuple

from idc_controller.rotations_float import IDENTITY, Quaternion, Vector
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint

LEVEL = IDENTITY
NO_RATES: Vector = (0.0, 0.0, 0.0)


class AttitudeTarget(NamedTuple):
    """Attitude (unit quaternion body to world; None: the rates alone), body rates (rad/s) and thrust (0 .. 1)."""

    attitude: Quaternion | None
    rates: Vector
    thrust: float


_NOTHING = AttitudeTarget(LEVEL, NO_RATES, 0.0)


class Actuation:
    """The target of the attitude loop, which works on it with those of the whole team.

    See :func:`.onboard_kernels.control_attitudes`. ``thrust`` (N) as commanded last; ``target`` as flown last, and
    ``target_since`` (s) when it began to act.
    """

    def __init__(self, thrust_max: float, arrays: OnboardArrays) -> None:
        """``arrays`` of one vehicle; its largest thrust in N."""
        self._thrust_max = thrust_max
        self._row, self._acceleration = arrays.targets[0], arrays.accelerations[0]
        self._followed: AttitudeSetpoint | None = None
        self.thrust = 0.0
        self.target = _NOTHING
        self.target_since = -math.inf

    @property
    def commanded_acceleration(self) -> Vector:
        """The angular acceleration (rad/s2) for which the torque was last set."""
        x, y, z = self._acceleration.tolist()
        return x, y, z

    def follow(self, setpoint: AttitudeSetpoint, now: float) -> None:
        """Fly a set-point from now on; without a thrust of its own it keeps the last one."""
        if setpoint is self._followed:
            return
        thrust = self.thrust if setpoint.thrust is None else setpoint.thrust * self._thrust_max
        self.command(setpoint.attitude, setpoint.rates, thrust, now)
        self._followed = setpoint

    def command(self, attitude: Quaternion | None, rates: Vector, thrust: float, now: float) -> None:
        """Fly an attitude, rates and a thrust (N) from now on."""
        self._followed = None
        self.thrust = min(thrust, self._thrust_max)
        target = AttitudeTarget(attitude, rates, self.thrust / self._thrust_max)
        if target != self.target:
            self.target, self.target_since = target, now
        self._row[:] = (attitude is not None, *(attitude or LEVEL), *rates, self.thrust)

    def stop(self, now: float) -> None:
        """Command no thrust."""
        self.command(LEVEL, NO_RATES, 0.0, now)
