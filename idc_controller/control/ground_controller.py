"""Keeps the UAVs upright over a payload on the ground, while the thrust grows or fades.

The ground holds the payload, so the model of flight does not apply: each UAV is a pendulum above its attachment point,

    m l s'' = -(f - m g) s - f (n + b) - w,

with the link in tension as soon as the thrust f exceeds the UAV's weight; b and w as in
:mod:`idc_controller.estimation.grounded_links`. One linear-quadratic regulator serves the whole range of thrust, about
the tilt that holds the link; the payload's own error is left to the ground.
"""

import numpy as np
from scipy.linalg import solve_discrete_are

from idc_controller.arrays import Array
from idc_controller.control.settings import GroundControlSettings
from idc_controller.estimation.grounded_links import N_DOT, OFF, S_DOT, LinkStates, N, S
from idc_controller.model.linear import LinearModel, discretised
from idc_controller.trajectory.flatness import FlatReference


class GroundController:
    """Tilt set-points of the time on the ground."""

    def __init__(
        self, model: LinearModel, period: float, settings: GroundControlSettings = GroundControlSettings()
    ) -> None:
        """``period`` is the control period (s)."""
        self.layout, self._weight = model.layout, model.parameters.m * model.parameters.g
        self._tilt_max, self._off_max = settings.tilt_max, settings.attitude_error_max
        self.gains = np.array([pendulum_gain(model, i, period, settings) for i in range(model.layout.number_of_uavs)])

    def setpoints(self, links: LinkStates, reference: FlatReference) -> Array:
        """Return tilts and thrusts (3 N,) that bring ``links`` to those of the ``reference``, with its thrusts."""
        layout, x, f, weight = self.layout, reference.x[0], links.thrust[:, None], self._weight[:, None]
        lean, rate = (x[part].reshape(-1, 2) for part in (layout.s, layout.s_dot))
        off = _bounded(links.x[OFF], self._off_max)
        holding = -off - (links.drag + (f - weight) * lean) / np.maximum(f, weight)
        states = np.stack([links.x[S] - lean, links.x[S_DOT] - rate, links.x[N] - holding, *links.x[N_DOT:]], axis=1)
        tilts = holding - np.einsum("ik,ikc->ic", self.gains, states)
        u = reference.u[0].copy()
        # The thrust is bounded, not the attitude, which may be wrong on board by as much.
        u[layout.n_setpoint] = (_bounded(tilts + off, self._tilt_max) - off).ravel()
        return np.asarray(u)


def _bounded(tilts: Array, largest: float) -> Array:
    """Return ``tilts`` (N, 2), none larger than the ``largest``."""
    size = np.maximum(np.linalg.norm(tilts, axis=1, keepdims=True), largest)
    return np.asarray(tilts * (largest / size))


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
