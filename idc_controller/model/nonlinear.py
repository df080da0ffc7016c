"""The nonlinear dynamics of Section II of the paper, corrected, for any number of UAVs. Pure functions.

World frame north-east-down, body frames forward-right-down, SI units. The state differs from eq:stateqn of the paper
in two ways that change nothing physical: attitudes are unit quaternions instead of Euler angles (no singularity), and
the payload's velocity is kept in the world frame, ``r_0_dot`` = R_0 v_0 (eq:kinBeg); the paper's v_0 is a property.

Corrections to the printed equations, each confirmed by an independent Newton-Euler derivation (tests):

- the UAV force is F_i = -f_i R_i e_3 (z points down; R_i b_i3 would rotate twice): :func:`thrust_forces`
- payload moment equation: l_i hat(q_i) dOmega_i, not l_i q_i dOmega_i
- link equation: hat(omega_0) Omega_i, not hat(omega_0) Omega; its forces enter as R_0^T F_i, since q_i is in the
  payload frame
- P: the block of link 1 and dv_0 is -m_1 l_1 hat(q_1), which makes P symmetric: :func:`matrix_P`
- P and Q lack the rows of eq:EqEnd: J_i domega_i = tau_i - omega_i x J_i omega_i: :func:`accelerations`
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from idc_controller.arrays import Array
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import hat, rotation_from_quaternion

_K = np.array([0.0, 0.0, 1.0])  # the paper's k: down


@dataclass(frozen=True, eq=False)
class SystemState:
    """State of payload, links and UAVs.

    - ``r_0`` payload centre of mass in the world (3,) (m)
    - ``r_0_dot`` its velocity in the world (3,) (m/s); the paper's v_0 is R_0^T r_0_dot
    - ``quaternion_0`` payload frame to world, w first (4,); the paper's R_0
    - ``omega_0`` angular velocity of the payload in the payload frame (3,) (rad/s)
    - ``q`` unit vectors along the links towards the payload, in the payload frame (N, 3)
    - ``Omega`` angular velocities of the links against the world, in the payload frame, normal to q (N, 3) (rad/s)
    - ``quaternion`` UAV frames to world, w first (N, 4); the paper's R_i
    - ``omega`` angular velocities of the UAVs, each in its own frame (N, 3) (rad/s)
    """

    r_0: Array
    r_0_dot: Array
    quaternion_0: Array
    omega_0: Array
    q: Array
    Omega: Array
    quaternion: Array
    omega: Array

    @property
    def R_0(self) -> Array:
        """Rotation payload frame to world (3, 3)."""
        return rotation_from_quaternion(self.quaternion_0)

    @property
    def v_0(self) -> Array:
        """The paper's v_0: velocity of the payload in the payload frame (3,) (m/s), eq:kinBeg."""
        return self.R_0.T @ self.r_0_dot


@dataclass(frozen=True, eq=False)
class Inputs:
    """Forces and torques on the system besides gravity.

    - ``F`` force on each UAV in the world frame (N, 3) (N): thrust (:func:`thrust_forces`) and anything external
    - ``tau`` torque on each UAV in its own frame (N, 3) (N m)
    - ``F_0`` external force on the payload's centre of mass in the world frame (3,) (N)
    - ``tau_0`` external torque on the payload in the payload frame (3,) (N m)
    """

    F: Array
    tau: Array
    F_0: Array = field(default_factory=lambda: np.zeros(3))
    tau_0: Array = field(default_factory=lambda: np.zeros(3))


class Accelerations(NamedTuple):
    """The second derivatives: payload in the world (3,), omega_0 (3,), Omega (N, 3), omega (N, 3) in their frames."""

    r_0_ddot: Array
    omega_0_dot: Array
    Omega_dot: Array
    omega_dot: Array


def thrust_forces(quaternion: ArrayLike, f: ArrayLike) -> Array:
    """F_i = -f_i R_i e_3 in the world (N, 3) (N) of UAV attitudes (N, 4) and thrusts (N,) (N)."""
    return -np.asarray(f, dtype=float)[:, None] * rotation_from_quaternion(quaternion)[:, :, 2]


def matrix_P(parameters: SystemParameters, q: Array) -> Array:
    """The matrix P of x_b' = P^-1 Q for links ``q`` (N, 3): symmetric, (6 + 3N, 6 + 3N), of (v_0, omega_0, Omega)."""
    m, l, n = parameters.m, parameters.l, parameters.number_of_uavs
    p_hat, q_hat = hat(parameters.p), hat(q)
    P = np.zeros((6 + 3 * n, 6 + 3 * n))
    P[:3, :3] = parameters.m_T * np.eye(3)
    P[3:6, :3] = np.einsum("i,ijk->jk", m, p_hat)
    P[:3, 3:6] = -P[3:6, :3]
    P[3:6, 3:6] = parameters.J_0 - np.einsum("i,ijk,ikl->jl", m, p_hat, p_hat)  # the paper's J_0 bar
    for i in range(n):
        link = slice(6 + 3 * i, 9 + 3 * i)
        P[:3, link] = m[i] * l[i] * q_hat[i]
        P[3:6, link] = m[i] * l[i] * p_hat[i] @ q_hat[i]
        P[link, :6] = P[:6, link].T
        P[link, link] = m[i] * l[i] ** 2 * np.eye(3)
    return P


def vector_Q(parameters: SystemParameters, state: SystemState, inputs: Inputs) -> Array:
    """The vector Q of x_b' = P^-1 Q (6 + 3N,), with the external load on the payload added."""
    m, l, p, g = parameters.m[:, None], parameters.l[:, None], parameters.p, parameters.g
    q, Omega, omega_0, R_0, v_0 = state.q, state.Omega, state.omega_0, state.R_0, state.v_0
    J_0_bar = parameters.J_0 - np.einsum("i,ijk,ikl->jl", parameters.m, hat(p), hat(p))
    F = inputs.F @ R_0  # R_0^T F_i, row by row
    k = R_0.T @ _K
    transport = np.cross(omega_0, v_0)
    centripetal = np.cross(omega_0, np.cross(omega_0, p))
    # What the links' rotation adds to the accelerations of the UAVs, apart from dOmega.
    swing = l * (np.sum(Omega**2, axis=1, keepdims=True) * q + np.cross(q, np.cross(omega_0, Omega)))
    Q = np.empty(6 + 3 * len(q))
    Q[:3] = -parameters.m_T * transport - np.sum(m * (centripetal + swing), axis=0)
    Q[:3] += parameters.m_T * g * k + F.sum(axis=0) + R_0.T @ inputs.F_0
    Q[3:6] = -np.cross(omega_0, J_0_bar @ omega_0) - np.sum(m * np.cross(p, transport + swing), axis=0)
    Q[3:6] += np.cross(p, F + m * g * k).sum(axis=0) + inputs.tau_0
    links = m * l * (np.cross(q, centripetal + transport) - l * np.cross(omega_0, Omega))
    Q[6:] = (links - l * np.cross(q, F + m * g * k)).ravel()
    return Q


def accelerations(parameters: SystemParameters, state: SystemState, inputs: Inputs) -> Accelerations:
    """Solve eq:EqBeg .. eq:EqEnd for the second derivatives."""
    x_b_dot = _solve(matrix_P(parameters, state.q), vector_Q(parameters, state, inputs))
    momentum = np.einsum("ijk,ik->ij", parameters.J, state.omega)
    torque = inputs.tau - np.cross(state.omega, momentum)
    omega_dot = _solve(parameters.J, torque[:, :, None])[:, :, 0]
    return Accelerations(
        r_0_ddot=state.R_0 @ (x_b_dot[:3] + np.cross(state.omega_0, state.v_0)),
        omega_0_dot=x_b_dot[3:6],
        Omega_dot=x_b_dot[6:].reshape(-1, 3),
        omega_dot=omega_dot,
    )


def _solve(A: Array, b: Array) -> Array:
    return np.asarray(np.linalg.solve(A, b), dtype=np.float64)
