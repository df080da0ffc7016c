"""Keeps the UAVs upright over a payload on the ground, while the thrust grows or fades.

The ground holds the payload, so the model of flight does not apply: each UAV is a pendulum above its attachment point,

    m l s'' = -(f - m g) s - f n,

with the link in tension as soon as the thrust f exceeds the UAV's weight. One linear-quadratic regulator serves the
whole range of thrust; the payload's own error is left to the ground.
"""

import numpy as np
from scipy.linalg import solve_discrete_are

from idc_controller.arrays import Array
from idc_controller.control.mpc import TrackingOutput
from idc_controller.control.settings import GroundControlSettings
from idc_controller.model.linear import LinearModel, discretised
from idc_controller.trajectory.flatness import FlatReference


class GroundController:
    """A tracker for the time on the ground; see :class:`~idc_controller.control.mpc.Tracker`."""

    def __init__(
        self, model: LinearModel, period: float, settings: GroundControlSettings = GroundControlSettings()
    ) -> None:
        """``period`` is the control period (s)."""
        self.layout = model.layout
        self._lean = settings.lean_deadband
        self._step, self._held_max = settings.lean_gain * period, settings.lean_tilt_max
        self._held = np.zeros((model.layout.number_of_uavs, 2))
        """Tilt set-points (N, 2) against what makes links lean."""
        self.gains = np.array([pendulum_gain(model, i, period, settings) for i in range(model.layout.number_of_uavs)])

    def track(self, error: Array, reference: FlatReference) -> TrackingOutput:
        """Tilt set-points from the UAVs' own errors; thrusts as the reference has them."""
        layout = self.layout
        parts = (layout.s, layout.s_dot, layout.n, layout.n_dot, layout.n_acc)
        states = np.stack([error[part].reshape(-1, 2) for part in parts], axis=1)  # (N, 5, 2)
        lean = states[:, 0]
        held = self._held + self._step * (lean - np.clip(lean, -self._lean, self._lean))
        self._held = np.clip(held, -self._held_max, self._held_max)
        tilt = self._held - np.einsum("ik,ikc->ic", self.gains, states)
        return TrackingOutput(np.concatenate([tilt.ravel(), np.zeros(layout.number_of_uavs)]))

    def release(self) -> None:
        """Forget what made links lean: the payload is in the air."""
        self._held[:] = 0.0


def pendulum_dynamics(model: LinearModel, uav: int, share: float) -> tuple[Array, Array]:
    """Continuous ``A`` (5, 5), ``B`` (5, 1) of (s, s', n, n', n'') of one axis at ``share`` of the hover thrust."""
    p = model.parameters
    f, weight, ml = share * p.hover_thrust[uav], p.m[uav] * p.g, p.m[uav] * p.l[uav]
    T_m, kp, kd = p.motor_time_constant, p.attitude_kp, p.attitude_kd
    A = np.zeros((5, 5))
    A[0, 1] = A[2, 3] = A[3, 4] = 1.0
    A[1, 0], A[1, 2] = -(f - weight) / ml, -f / ml
    A[4, 2:] = -kp / T_m, -kd / T_m, -1.0 / T_m
    return A, np.array([[0.0], [0.0], [0.0], [0.0], [kp / T_m]])


def pendulum_gain(model: LinearModel, uav: int, period: float, settings: GroundControlSettings) -> Array:
    """Return the regulator gain (5,) for one axis of one UAV."""
    A, B = pendulum_dynamics(model, uav, settings.design_share)
    Q, R = np.diag(settings.state), np.array([[settings.setpoint]])
    A_k, B_k = discretised(A, B, period)
    P = solve_discrete_are(A_k, B_k, Q, R)
    return np.asarray(np.linalg.solve(R + B_k.T @ P @ B_k, B_k.T @ P @ A_k)[0])
