"""The onboard attitude and rate loop, in plain floats: it runs hundreds of times a second on every vehicle."""

from collections.abc import Sequence

from idc_controller.rotations_float import IDENTITY, Quaternion, Vector, half_rotation
from vehicle_sim.world.errors import SimulationError

LEVEL = IDENTITY
NO_RATES: Vector = (0.0, 0.0, 0.0)


class AttitudeController:
    """torque = J (kp e - kd (omega - omega_setpoint)), the e of two attitudes being their angle for small angles.

    e = 2 sign(w) (x, y, z) of the rotation from the attitude to the set-point, in the body frame: the shorter way
    round, whichever sign either quaternion has. ``commanded``: the acceleration in brackets, as it was last (rad/s2).
    """

    def __init__(self, inertia: Sequence[Sequence[float]], kp: float, kd: float) -> None:
        """``inertia`` (3, 3) about the centre of mass (kg m2), gains in 1/s2 and 1/s, both positive."""
        if not (kp > 0.0 and kd > 0.0):
            raise SimulationError(f"attitude gains must be positive, got {kp} and {kd}")
        self._j = (
            float(inertia[0][0]), float(inertia[1][1]), float(inertia[2][2]),
            float(inertia[0][1]), float(inertia[0][2]), float(inertia[1][2]),
        )  # fmt: skip
        self._two_kp = 2.0 * kp
        self._kd = kd
        self.commanded: Vector = NO_RATES

    def torque(
        self, attitude: Quaternion, rates: Vector, setpoint: Quaternion | None, setpoint_rates: Vector
    ) -> Vector:
        """Body torques (N m). Unit quaternions body to world; rates in the body frame (rad/s).

        Without an attitude set-point the body rates alone are controlled.
        """
        kd = self._kd
        x = kd * (setpoint_rates[0] - rates[0])
        y = kd * (setpoint_rates[1] - rates[1])
        z = kd * (setpoint_rates[2] - rates[2])
        if setpoint is not None:
            e_x, e_y, e_z = half_rotation(attitude, setpoint)
            x += self._two_kp * e_x
            y += self._two_kp * e_y
            z += self._two_kp * e_z
        self.commanded = x, y, z
        j_xx, j_yy, j_zz, j_xy, j_xz, j_yz = self._j
        return (
            j_xx * x + j_xy * y + j_xz * z,
            j_xy * x + j_yy * y + j_yz * z,
            j_xz * x + j_yz * y + j_zz * z,
        )
