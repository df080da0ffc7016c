"""The physical parameters of one vehicle, as its autopilot knows them."""

from dataclasses import dataclass
from typing import Self

from gcs.config import UavConfig
from idc_controller.parameters import SystemParameters
from vehicle_sim.world.errors import SimulationError
from vehicle_sim.world.rotors import RotorGeometry

Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Airframe:
    """One UAV: mass (kg), inertia about its centre (kg m2), rotors, motor lag (s), attitude gains, gravity.

    ``attitude_kp`` (1/s2) and ``attitude_kd`` (1/s): torque = J (kp e - kd omega), both positive.
    """

    mass: float
    inertia: Matrix
    rotors: RotorGeometry
    motor_time_constant: float
    attitude_kp: float
    attitude_kd: float
    g: float = 9.81

    def __post_init__(self) -> None:
        if not (self.attitude_kp > 0.0 and self.attitude_kd > 0.0):
            raise SimulationError(f"attitude gains must be positive, got {self.attitude_kp} and {self.attitude_kd}")

    @classmethod
    def of_config(cls, uav: UavConfig, g: float = 9.81) -> Self:
        """Return a UAV of a system file that flies alone."""
        x, y, z = uav.inertia
        return cls(
            mass=uav.mass,
            inertia=((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)),
            rotors=RotorGeometry(uav.thrust_max, uav.rotor_speed_max, uav.arm_length, uav.torque_to_thrust),
            motor_time_constant=uav.motor_time_constant,
            attitude_kp=uav.attitude_kp,
            attitude_kd=uav.attitude_kd,
            g=g,
        )

    @classmethod
    def of_system(cls, system: SystemParameters, index: int, uav: UavConfig) -> Self:
        """Return UAV ``index`` (from 0) of a system; ``uav`` adds what the controller does not model."""
        a, b, c = ((float(x), float(y), float(z)) for x, y, z in system.J[index])
        return cls(
            mass=float(system.m[index]),
            inertia=(a, b, c),
            rotors=RotorGeometry(system.thrust_max, uav.rotor_speed_max, uav.arm_length, uav.torque_to_thrust),
            motor_time_constant=system.motor_time_constant,
            attitude_kp=system.attitude_kp,
            attitude_kd=system.attitude_kd,
            g=system.g,
        )
