"""Four rotors: the linear map between thrust, torques and squared rotor speeds, and the motors' lag.

Rotors stand in PX4's X layout, seen in the FRD body frame: 1 front right, 2 rear left (both turn counter-clockwise
seen from above), 3 front left, 4 rear right (clockwise).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.rotor_kernels import advance_rotors

Four = tuple[float, float, float, float]

Wrenches = tuple[list[list[float]], list[list[list[float]]]]
"""Thrusts (N) of N vehicles in each of some physics steps, and their body torques (N m, FRD)."""


@dataclass(frozen=True)
class RotorGeometry:
    """Parameters that the mixer and the rotors share.

    - ``thrust_max`` of all four rotors together at ``rotor_speed_max`` (N, rad/s)
    - ``arm_length`` from the centre to a rotor (m)
    - ``torque_to_thrust`` ratio of a rotor's drag torque to its thrust (m)

    Raises :class:`SimulationError` for values that are not positive.
    """

    thrust_max: float
    rotor_speed_max: float
    arm_length: float
    torque_to_thrust: float

    def __post_init__(self) -> None:
        for name in ("thrust_max", "rotor_speed_max", "arm_length", "torque_to_thrust"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise SimulationError(f"{name} must be positive, got {value}")

    @property
    def k_f(self) -> float:
        """Thrust of one rotor per squared speed (N s2)."""
        return self.thrust_max / (4.0 * self.rotor_speed_max**2)

    @property
    def lever(self) -> float:
        """Distance of a rotor from the roll and from the pitch axis (m)."""
        return self.arm_length / math.sqrt(2.0)


class Rotors:
    """Rotor speeds of N vehicles that follow their commands with a first-order lag, advanced by the physics step.

    The speeds are exact for a command that stays constant over the steps. The wrenches are those at the beginning of
    each step: the engine, a leapfrog, lets a step's forces act from half a step before its beginning to half a step
    after it, so that their impulse is of second order in the step, and not early. ``speeds`` (N, 4) in rad/s.
    """

    def __init__(
        self,
        geometries: Sequence[RotorGeometry],
        motor_time_constants: Sequence[float],
        physics_step: float,
        steps: int = 1,
    ) -> None:
        """Rotors at rest; time constants and physics step in s, both positive (else :class:`SimulationError`).

        ``steps``: physics steps for which commands are held.
        """
        if not (min(motor_time_constants) > 0.0 and physics_step > 0.0):
            raise SimulationError("motor_time_constant and physics_step must be positive")
        decays = [math.exp(-physics_step / time_constant) for time_constant in motor_time_constants]
        self._motors = np.array(
            [
                (decay, g.k_f, g.lever, g.torque_to_thrust, g.rotor_speed_max)
                for decay, g in zip(decays, geometries, strict=True)
            ]
        )
        """A row of each vehicle, for :func:`advance_rotors`."""
        n = len(self._motors)
        self.speeds = np.zeros((n, 4))
        self._thrusts, self._torques = np.zeros((steps, n)), np.zeros((steps, n, 3))

    def advance(self, commands: Array) -> Wrenches:
        """Take the physics steps under the commanded speeds (N, 4) (rad/s), and return the wrenches that begin them."""
        advance_rotors(self._motors, commands, self.speeds, self._thrusts, self._torques)
        return self._thrusts.tolist(), self._torques.tolist()
