"""Motion of the nonlinear model for the tests: hover, UAV positions and velocities, integration in time."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quaternions import quaternion_product

from idc_controller.model.nonlinear import Inputs, SystemState, accelerations
from idc_controller.parameters import SystemParameters

Array = NDArray[np.float64]

_K = np.array([0.0, 0.0, 1.0])  # the paper's k: down


def hover_state(parameters: SystemParameters, position: ArrayLike = (0.0, 0.0, 0.0)) -> SystemState:
    """The equilibrium x_e of eq:EqPt: level payload at ``position`` (3,) (world, m), links upright, all at rest."""
    n = parameters.number_of_uavs
    level = np.array([1.0, 0.0, 0.0, 0.0])
    return SystemState(
        r_0=np.array(position, dtype=float), r_0_dot=np.zeros(3), quaternion_0=level, omega_0=np.zeros(3),
        q=np.tile(_K, (n, 1)), Omega=np.zeros((n, 3)), quaternion=np.tile(level, (n, 1)), omega=np.zeros((n, 3)),
    )  # fmt: skip


def hover_inputs(parameters: SystemParameters) -> Inputs:
    """The equilibrium inputs of eq:EqPt, corrected for any layout: the hover thrusts straight up, no torques."""
    F = np.outer(parameters.hover_thrust, -_K)
    return Inputs(F=F, tau=np.zeros_like(F))


def uav_positions(parameters: SystemParameters, state: SystemState) -> Array:
    """r_i = r_0 + R_0 (p_i - l_i q_i) in the world (N, 3) (m)."""
    return state.r_0 + (parameters.p - parameters.l[:, None] * state.q) @ state.R_0.T


def uav_velocities(parameters: SystemParameters, state: SystemState) -> Array:
    """Derivative of r_i: r_0_dot + R_0 (omega_0 x p_i - l_i Omega_i x q_i), in the world (N, 3) (m/s)."""
    in_payload = np.cross(state.omega_0, parameters.p) - parameters.l[:, None] * np.cross(state.Omega, state.q)
    return state.r_0_dot + in_payload @ state.R_0.T


def rk4_step(
    parameters: SystemParameters, state: SystemState, inputs: Inputs | Callable[[float, SystemState], Inputs], dt: float
) -> SystemState:
    """The state ``dt`` seconds later, by the classical Runge-Kutta method of fourth order.

    ``inputs`` is held over the step, or is a function of the time since the step began (s) and the state there.
    Quaternions and links are brought back to unit length and Omega normal to q at every stage, which keeps the state
    on its manifold without lowering the order.
    """
    law = inputs if callable(inputs) else lambda _time, _state: inputs
    k_1 = _derivative(parameters, state, law(0.0, state))
    middle = _moved(state, k_1, dt / 2)
    k_2 = _derivative(parameters, middle, law(dt / 2, middle))
    middle = _moved(state, k_2, dt / 2)
    k_3 = _derivative(parameters, middle, law(dt / 2, middle))
    end = _moved(state, k_3, dt)
    k_4 = _derivative(parameters, end, law(dt, end))
    mean = tuple((a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(k_1, k_2, k_3, k_4, strict=True))
    return _moved(state, mean, dt)


def _derivative(parameters: SystemParameters, state: SystemState, inputs: Inputs) -> tuple[Array, ...]:
    """Time derivatives of the fields of :class:`SystemState`, in their order (eq:kinBeg .. eq:EqEnd)."""
    second = accelerations(parameters, state, inputs)
    return (
        state.r_0_dot,
        second.r_0_ddot,
        0.5 * quaternion_product(state.quaternion_0, np.append(0.0, state.omega_0)),
        second.omega_0_dot,
        np.cross(state.Omega - state.omega_0, state.q),
        second.Omega_dot,
        0.5 * quaternion_product(state.quaternion, np.insert(state.omega, 0, 0.0, axis=1)),
        second.omega_dot,
    )


def _moved(state: SystemState, derivative: tuple[Array, ...], dt: float) -> SystemState:
    """``state + dt * derivative``, returned to the manifold."""
    q = _unit(state.q + dt * derivative[4])
    Omega = state.Omega + dt * derivative[5]
    return SystemState(
        r_0=state.r_0 + dt * derivative[0],
        r_0_dot=state.r_0_dot + dt * derivative[1],
        quaternion_0=_unit(state.quaternion_0 + dt * derivative[2]),
        omega_0=state.omega_0 + dt * derivative[3],
        q=q,
        Omega=Omega - np.sum(Omega * q, axis=1, keepdims=True) * q,
        quaternion=_unit(state.quaternion + dt * derivative[6]),
        omega=state.omega + dt * derivative[7],
    )


def _unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))
