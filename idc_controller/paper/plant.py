"""The system of Section II with the link tensions eliminated: 6 unknowns instead of 6 + 3 N, for long simulations.

Newton and Euler for each body, links and their rates in the world. The link of UAV i carries the tension

    T_i = m_i (q_i . a_i'' + l_i |q_i'|^2) - q_i . (F_i + m_i g e3),   a_i: the attachment point,

which leaves the payload's six accelerations as the only unknowns. It is a second derivation beside
:mod:`idc_controller.model.nonlinear`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import hat, rotation_from_quaternion


@dataclass(frozen=True, eq=False)
class PlantState:
    """Payload, links and UAVs; world NED, quaternions w first.

    ``r_0``, ``v_0`` (3,) in the world; ``quaternion_0`` (4,); ``omega_0`` (3,) in the payload frame; ``q``, ``q_dot``
    (N, 3) unit vectors from UAV to payload and their rates, in the world; ``quaternion`` (N, 4); ``omega`` (N, 3) in
    the UAV frames.
    """

    r_0: Array
    v_0: Array
    quaternion_0: Array
    omega_0: Array
    q: Array
    q_dot: Array
    quaternion: Array
    omega: Array

    @classmethod
    def hovering(cls, parameters: SystemParameters, position: Array) -> PlantState:
        """Level, links upright, at rest, payload at ``position`` (3,) (m)."""
        N = parameters.number_of_uavs
        level = np.array([1.0, 0.0, 0.0, 0.0])
        return cls(
            np.array(position, dtype=float), np.zeros(3), level, np.zeros(3), np.tile([0.0, 0.0, 1.0], (N, 1)),
            np.zeros((N, 3)), np.tile(level, (N, 1)), np.zeros((N, 3)),
        )  # fmt: skip


class Plant:
    """Moves a :class:`PlantState` on under thrusts (N,) and torques (N, 3) held over a step."""

    def __init__(self, parameters: SystemParameters) -> None:
        self.parameters = parameters
        self._p_hat = hat(parameters.p)
        self._J_inverse = np.linalg.inv(parameters.J)
        self._mass = np.zeros((6, 6))
        self._mass[:3, :3], self._mass[3:, 3:] = parameters.m_0 * np.eye(3), parameters.J_0
        self._weight = np.array([0.0, 0.0, parameters.m_0 * parameters.g, 0.0, 0.0, 0.0])

    def uav_positions(self, state: PlantState) -> Array:
        """(N, 3), NED (m)."""
        R_0 = rotation_from_quaternion(state.quaternion_0)
        return np.asarray(state.r_0 + self.parameters.p @ R_0.T - self.parameters.l[:, None] * state.q)

    def accelerations(self, state: PlantState, thrust: Array, torque: Array) -> tuple[Array, Array, Array, Array]:
        """r_0'' (3,), omega_0' (3,) in the payload frame, q'' (N, 3) in the world, omega' (N, 3) in the UAV frames."""
        p = self.parameters
        R_0 = rotation_from_quaternion(state.quaternion_0)
        q, omega_0 = state.q, state.omega_0
        w, x, y, z = state.quaternion.T
        # Thrust per mass along the third axis of each UAV, against it, and gravity.
        own = np.empty_like(q)
        scale = thrust / p.m
        own[:, 0] = -2.0 * scale * (x * z + w * y)
        own[:, 1] = -2.0 * scale * (y * z - w * x)
        own[:, 2] = p.g - scale * (1.0 - 2.0 * (x * x + y * y))
        W = hat(omega_0)
        c = p.p @ (R_0 @ W @ W).T
        # Acceleration of the attachment point along the link: q . a'' = row y + q . c, y = (r_0'', omega_0').
        rows = np.concatenate([q, _cross(p.p, q @ R_0)], axis=1)
        turning = (state.q_dot * state.q_dot).sum(axis=1)
        pull = p.m * (((c - own) * q).sum(axis=1) + p.l * turning)
        M = self._mass + (rows.T * p.m) @ rows
        right = self._weight - rows.T @ pull
        right[3:] -= W @ (p.J_0 @ omega_0)
        second = np.linalg.solve(M, right)
        relative = (second[:3] - (self._p_hat @ second[3:]) @ R_0.T + c - own) / p.l[:, None]
        q_ddot = relative - ((q * relative).sum(axis=1) + turning)[:, None] * q
        momentum = (p.J @ state.omega[:, :, None])[:, :, 0]
        omega_dot = (self._J_inverse @ (torque - _cross(state.omega, momentum))[:, :, None])[:, :, 0]
        return second[:3], second[3:], q_ddot, omega_dot

    def step(self, state: PlantState, thrust: Array, torque: Array, dt: float) -> PlantState:
        """The state ``dt`` seconds later (Runge-Kutta of fourth order), on its manifold."""
        N = self.parameters.number_of_uavs
        begin = _flat(state)
        k_1 = self._derivative(state, thrust, torque)
        k_2 = self._derivative(_on_manifold(begin + (dt / 2.0) * k_1, N), thrust, torque)
        k_3 = self._derivative(_on_manifold(begin + (dt / 2.0) * k_2, N), thrust, torque)
        k_4 = self._derivative(_on_manifold(begin + dt * k_3, N), thrust, torque)
        return _on_manifold(begin + (dt / 6.0) * (k_1 + 2.0 * (k_2 + k_3) + k_4), N)

    def _derivative(self, state: PlantState, thrust: Array, torque: Array) -> Array:
        r_0_ddot, omega_0_dot, q_ddot, omega_dot = self.accelerations(state, thrust, torque)
        # All attitudes at once: the payload's first.
        quaternions = np.vstack([state.quaternion_0, state.quaternion])
        rates = np.vstack([state.omega_0, state.omega])
        turned = np.empty_like(quaternions)
        scalar, vector = quaternions[:, :1], quaternions[:, 1:]
        turned[:, 0] = -0.5 * (vector * rates).sum(axis=1)
        turned[:, 1:] = 0.5 * (scalar * rates + _cross(vector, rates))
        return np.concatenate(
            [
                state.v_0, r_0_ddot, turned[0], omega_0_dot,
                state.q_dot.ravel(), q_ddot.ravel(), turned[1:].ravel(), omega_dot.ravel(),
            ]
        )  # fmt: skip


def _flat(state: PlantState) -> Array:
    return np.concatenate(
        [
            state.r_0, state.v_0, state.quaternion_0, state.omega_0,
            state.q.ravel(), state.q_dot.ravel(), state.quaternion.ravel(), state.omega.ravel(),
        ]
    )  # fmt: skip


def _on_manifold(y: Array, N: int) -> PlantState:
    a, b, c = 13 + 3 * N, 13 + 6 * N, 13 + 10 * N
    q = _unit(y[13:a].reshape(N, 3))
    q_dot = y[a:b].reshape(N, 3)
    q_dot = q_dot - (q_dot * q).sum(axis=1, keepdims=True) * q
    return PlantState(
        y[:3], y[3:6], _unit(y[6:10]), y[10:13], q, q_dot, _unit(y[b:c].reshape(N, 4)), y[c:].reshape(N, 3)
    )


def _unit(v: Array) -> Array:
    return np.asarray(v / np.sqrt((v * v).sum(axis=-1, keepdims=True)))


def _cross(a: Array, b: Array) -> Array:
    # numpy's own takes five times as long for so few vectors.
    result = np.empty_like(b)
    result[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    result[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    result[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return result
