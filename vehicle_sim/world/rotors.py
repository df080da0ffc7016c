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

IDLE: Four = (0.0, 0.0, 0.0, 0.0)


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


class Mixer:
    """Thrust and torques to rotor speeds, within what four rotors can do.

    What cannot be done is given up in this order: yaw torque, then roll and pitch torque together (scaled, so that
    their direction stays); the thrust is kept.
    """

    def __init__(self, geometry: RotorGeometry) -> None:
        self._force_max = geometry.thrust_max / 4.0
        self._per_roll_pitch = 1.0 / (4.0 * geometry.lever)
        self._per_yaw = 1.0 / (4.0 * geometry.torque_to_thrust)
        self._per_k_f = 1.0 / geometry.k_f

    def forces(self, thrust: float, tau_x: float, tau_y: float, tau_z: float) -> Four:
        """Rotor forces (N), each within 0 .. thrust_max / 4, of a thrust (N) and body torques (N m, FRD)."""
        top = self._force_max
        level = thrust * 0.25
        if level < 0.0:
            level = 0.0
        elif level > top:
            level = top
        roll, pitch, yaw = tau_x * self._per_roll_pitch, tau_y * self._per_roll_pitch, tau_z * self._per_yaw
        # Pairs on a diagonal get opposite shares of roll and pitch and the same share of yaw.
        first, third = pitch - roll, pitch + roll
        headroom = level if level < top - level else top - level
        first_size, third_size = abs(first), abs(third)
        largest = first_size if first_size > third_size else third_size
        if largest > headroom:
            scale = headroom / largest
            first *= scale
            third *= scale
            first_size *= scale
            third_size *= scale
        # +yaw on rotors 1 and 2 (level -+ first), -yaw on rotors 3 and 4 (level -+ third).
        yaw_headroom = headroom - (first_size if first_size > third_size else third_size)
        if yaw > yaw_headroom:
            upper, lower = top - level - first_size, level - third_size
            limit = upper if upper < lower else lower
            yaw = yaw if yaw < limit else limit
        elif yaw < -yaw_headroom:
            upper, lower = top - level - third_size, level - first_size
            limit = upper if upper < lower else lower
            yaw = yaw if -yaw < limit else -limit
        return level + first + yaw, level - first + yaw, level + third - yaw, level - third - yaw

    def rotor_speeds(self, thrust: float, tau_x: float, tau_y: float, tau_z: float) -> Four:
        """Rotor speeds (rad/s) for a thrust (N) and body torques (N m, FRD)."""
        f_1, f_2, f_3, f_4 = self.forces(thrust, tau_x, tau_y, tau_z)
        per_k_f = self._per_k_f
        return (
            math.sqrt(f_1 * per_k_f) if f_1 > 0.0 else 0.0,
            math.sqrt(f_2 * per_k_f) if f_2 > 0.0 else 0.0,
            math.sqrt(f_3 * per_k_f) if f_3 > 0.0 else 0.0,
            math.sqrt(f_4 * per_k_f) if f_4 > 0.0 else 0.0,
        )


class Rotors:
    """Rotor speeds of N vehicles that follow their commands with a first-order lag, advanced by the physics step.

    ``advance`` is exact for a command that stays constant over the step, and gives the mean force and torques over
    the step, so that neither the lag nor the force depends on the step's length. ``speeds`` (N, 4) in rad/s.
    """

    def __init__(
        self, geometries: Sequence[RotorGeometry], motor_time_constants: Sequence[float], physics_step: float
    ) -> None:
        """Rotors at rest; time constants and physics step in s, both positive (else :class:`SimulationError`)."""
        if not (min(motor_time_constants) > 0.0 and physics_step > 0.0):
            raise SimulationError("motor_time_constant and physics_step must be positive")
        self._motors = np.array(
            [
                _motor(geometry, physics_step / time_constant)
                for geometry, time_constant in zip(geometries, motor_time_constants, strict=True)
            ]
        )
        n = len(self._motors)
        self.speeds, self._thrusts, self._torques = np.zeros((n, 4)), np.zeros(n), np.zeros((n, 3))

    def advance(self, commands: Array) -> tuple[list[float], list[list[float]]]:
        """One physics step under the commanded speeds (N, 4) (rad/s): mean thrusts (N), body torques (N m, FRD)."""
        advance_rotors(self._motors, commands, self.speeds, self._thrusts, self._torques)
        return self._thrusts.tolist(), self._torques.tolist()


def _motor(geometry: RotorGeometry, ratio: float) -> tuple[float, ...]:
    """Return the row of one vehicle for :func:`advance_rotors`; ``ratio`` of the physics step to the time constant."""
    return (
        math.exp(-ratio),
        2.0 * (-math.expm1(-ratio) / ratio),
        -math.expm1(-2.0 * ratio) / (2.0 * ratio),
        geometry.k_f,
        geometry.lever,
        geometry.torque_to_thrust,
        geometry.rotor_speed_max,
    )
