"""From an attitude target to rotor speeds."""

import math
from typing import NamedTuple

from idc_controller.rotations_float import Quaternion, Vector
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.attitude_control import LEVEL, NO_RATES, AttitudeController
from vehicle_sim.world.rotors import IDLE, Four, Mixer
from vehicle_sim.world.sensors import Measurement


class AttitudeTarget(NamedTuple):
    """Attitude (unit quaternion body to world; None: the rates alone), body rates (rad/s) and thrust (0 .. 1)."""

    attitude: Quaternion | None
    rates: Vector
    thrust: float


class Actuation:
    """The attitude loop and the mixer.

    ``thrust`` (N) as commanded last; ``target`` as flown last, and ``target_since`` (s) when it began to act.
    """

    def __init__(self, airframe: Airframe) -> None:
        self._thrust_max = airframe.rotors.thrust_max
        self._attitude_control = AttitudeController(airframe.inertia, airframe.attitude_kp, airframe.attitude_kd)
        self._mixer = Mixer(airframe.rotors)
        self.thrust = 0.0
        self.target = AttitudeTarget(LEVEL, NO_RATES, 0.0)
        self.target_since = -math.inf

    @property
    def commanded_acceleration(self) -> Vector:
        """The angular acceleration (rad/s2) for which the torque was last set."""
        return self._attitude_control.commanded

    def command(
        self, measured: Measurement, attitude: Quaternion | None, rates: Vector, thrust: float, now: float
    ) -> Four:
        """Rotor-speed commands (rad/s) for an attitude, rates and a thrust (N)."""
        if thrust > self._thrust_max:
            thrust = self._thrust_max
        self.thrust = thrust
        self._set_target(AttitudeTarget(attitude, rates, thrust / self._thrust_max), now)
        if thrust <= 0.0:
            self._attitude_control.commanded = NO_RATES
            return IDLE
        tau_x, tau_y, tau_z = self._attitude_control.torque(measured.attitude, measured.rates, attitude, rates)
        return self._mixer.rotor_speeds(thrust, tau_x, tau_y, tau_z)

    def stop(self, now: float) -> None:
        """Command no thrust."""
        self.thrust = 0.0
        self._set_target(AttitudeTarget(LEVEL, NO_RATES, 0.0), now)

    def _set_target(self, target: AttitudeTarget, now: float) -> None:
        if target != self.target:
            self.target, self.target_since = target, now
