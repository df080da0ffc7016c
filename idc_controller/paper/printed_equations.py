"""The matrices P and Q exactly as the paper prints them, errors included, to measure what the errors do."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.model.nonlinear import Inputs, SystemState, matrix_P, vector_Q
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import hat, rotation_from_quaternion


def printed_state_dimension(number_of_uavs: int) -> int:
    """12 + 16 N, of eq:stateqn; its own list of coordinates has 12 + 12 N."""
    return 12 + 16 * number_of_uavs


def printed_hover_thrust(parameters: SystemParameters) -> Array:
    """(m_i + m_0 / 4) g of eq:EqPt (N,) (N)."""
    return (parameters.m + parameters.m_0 / 4.0) * parameters.g


def printed_thrust_forces(quaternion: Array, f: Array) -> Array:
    """F_i = f_i R_i b_i3 (N, 3), read with b_i3 in the UAV's frame: down, where it should be up.

    Read with b_i3 = R_i e_3, the third axis in the world, it would be turned twice: R_i R_i e_3.
    """
    return np.asarray(f)[:, None] * rotation_from_quaternion(quaternion)[:, :, 2]


def printed_matrix_P(parameters: SystemParameters, q: Array) -> Array:
    """P with the sign of its first link row, column dv_0, as printed (6 + 3 N squared)."""
    P = matrix_P(parameters, q)
    P[6:9, :3] = parameters.m[0] * parameters.l[0] * hat(q[0])
    return P


def printed_accelerations(parameters: SystemParameters, state: SystemState, inputs: Inputs) -> Array:
    """P^-1 Q of the printed P; Q as printed is right. dv_0, domega_0, dOmega (6 + 3 N,)."""
    return np.asarray(np.linalg.solve(printed_matrix_P(parameters, state.q), vector_Q(parameters, state, inputs)))


def moment_residual(parameters: SystemParameters, state: SystemState, inputs: Inputs, printed: bool) -> float:
    """Return the residual of the moment equation, with l_i q_i dOmega_i (``printed``) or with l_i hat(q_i) dOmega_i.

    In the norm (N m), at the true accelerations. l_i q_i dOmega_i is read element by element: as vectors the product
    does not exist.
    """
    x = np.linalg.solve(matrix_P(parameters, state.q), vector_Q(parameters, state, inputs))
    Q = vector_Q(parameters, state, inputs)
    P = matrix_P(parameters, state.q)
    rest = P[3:6, :6] @ x[:6] - Q[3:6]
    Omega_dot = x[6:].reshape(-1, 3)
    product = state.q * Omega_dot if printed else np.cross(state.q, Omega_dot)
    swing = np.sum((parameters.m * parameters.l)[:, None] * np.cross(parameters.p, product), axis=0)
    return float(np.linalg.norm(rest + swing))


def generalised_moment(parameters: SystemParameters, state: SystemState, inputs: Inputs, printed: bool) -> Array:
    """Right-hand side of the Lagrange equation of R_0 (3,) (N m), payload frame.

    As printed sum p_i x R_0^T F_i; that belongs to links described in the world, as in the paper's source. With q_i in
    the payload frame, as the paper has it, the links turn with R_0 and the lever is p_i - l_i q_i.
    """
    lever = parameters.p if printed else parameters.p - parameters.l[:, None] * state.q
    return np.asarray(np.cross(lever, inputs.F @ state.R_0).sum(axis=0))
