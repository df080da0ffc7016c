"""The linear model against the nonlinear dynamics, by finite differences."""

from dataclasses import replace

import numpy as np
import pytest
from flights import MISSIONS
from nonlinear_motion import uav_positions, uav_velocities
from paper_system import UNSYMMETRIC
from scipy.linalg import expm

from gcs.config import read_system
from idc_controller.model.linear import LinearModel
from idc_controller.model.nonlinear import Inputs, SystemState, accelerations
from idc_controller.rotations import euler_from_quaternion, quaternion_from_euler

CONFIG = read_system(MISSIONS / "system.toml")


def parameters_of(layout):
    if layout == "unsymmetric":
        return replace(CONFIG.parameters(), p=UNSYMMETRIC)
    return CONFIG.with_vehicles(layout).parameters()


@pytest.fixture(params=[3, 4, 6, 8, "unsymmetric"], ids=str)
def model(request):
    return LinearModel(parameters_of(request.param))


def nonlinear_state(model, x):
    """The nonlinear state of coordinates x; the UAVs' own attitude moves neither payload nor links."""
    layout, N = model.layout, model.layout.number_of_uavs
    quaternion = quaternion_from_euler(*x[layout.Theta])
    R_0 = SystemState(
        np.zeros(3), np.zeros(3), quaternion, np.zeros(3), np.zeros((N, 3)), np.zeros((N, 3)), np.zeros((N, 4)),
        np.zeros((N, 3)),
    ).R_0  # fmt: skip
    s, s_dot = x[layout.s].reshape(N, 2), x[layout.s_dot].reshape(N, 2)
    upward = np.sqrt(1.0 - np.sum(s**2, axis=1))
    q = np.column_stack([s, upward])
    q_dot = np.column_stack([s_dot, -np.sum(s * s_dot, axis=1) / upward])
    return SystemState(
        r_0=x[layout.r_0], r_0_dot=x[layout.v_0], quaternion_0=np.asarray(quaternion), omega_0=x[layout.omega],
        q=q @ R_0, Omega=np.cross(q, q_dot) @ R_0,
        quaternion=np.tile([1.0, 0, 0, 0], (N, 1)), omega=np.zeros((N, 3)),
    )  # fmt: skip


def nonlinear_derivative(model, x, d, on_uavs=0.0):
    """Second derivatives of payload and links, in the model's coordinates: dv_0, domega, dds."""
    p, layout, N = model.parameters, model.layout, model.layout.number_of_uavs
    state = nonlinear_state(model, x)
    n = x[layout.n].reshape(N, 2)
    f = x[layout.f]
    F = f[:, None] * np.column_stack([n, -np.sqrt(1.0 - np.sum(n**2, axis=1))])
    second = accelerations(p, state, Inputs(F=F + on_uavs, tau=np.zeros((N, 3)), F_0=d))
    R_0, Omega, q = state.R_0, state.Omega, state.q
    # The links against the world: w = R_0 Omega, and R_0 q turns with it.
    w, dw = Omega @ R_0.T, (second.Omega_dot + np.cross(state.omega_0, Omega)) @ R_0.T
    q_w = q @ R_0.T
    q_ddot = np.cross(dw, q_w) + np.cross(w, np.cross(w, q_w))
    return np.concatenate([second.r_0_ddot, second.omega_0_dot, q_ddot[:, :2].ravel()])


def equilibrium(model):
    x = np.zeros(model.layout.size)
    x[model.layout.f] = model.parameters.hover_thrust
    return x


def test_A_and_disturbance_are_the_nonlinear_dynamics_derivatives(model):
    layout = model.layout
    rows = np.r_[layout.v_0, layout.omega, layout.s_dot]
    x_e, step = equilibrium(model), 1e-6
    assert np.allclose(nonlinear_derivative(model, x_e, np.zeros(3)), 0.0, atol=1e-9)
    for k in range(layout.size):
        if layout.n_dot.start <= k < layout.f.start:
            assert np.all(model.A[rows, k] == 0.0)  # the attitude loop's own states move nothing themselves
            continue
        change = np.zeros(layout.size)
        change[k] = step
        column = (
            nonlinear_derivative(model, x_e + change, np.zeros(3))
            - nonlinear_derivative(model, x_e - change, np.zeros(3))
        ) / (2 * step)
        assert np.allclose(model.A[rows, k], column, atol=2e-6), k
    for axis in range(3):
        d = np.zeros(3)
        d[axis] = step
        column = (nonlinear_derivative(model, x_e, d) - nonlinear_derivative(model, x_e, -d)) / (2 * step)
        assert np.allclose(model.B_d[rows, axis], column, atol=1e-7)
    for k, (i, axis) in enumerate(np.ndindex(layout.number_of_uavs, 2)):
        w = np.zeros((layout.number_of_uavs, 3))
        w[i, axis] = step
        column = (
            nonlinear_derivative(model, x_e, np.zeros(3), w) - nonlinear_derivative(model, x_e, np.zeros(3), -w)
        ) / (2 * step)
        assert np.allclose(model.B_d[rows, 3 + k], column, atol=1e-7)


def test_rows_of_uav_positions_and_velocities(model):
    layout, x_e, step = model.layout, equilibrium(model), 1e-6
    rng = np.random.default_rng(1)
    change = np.zeros(layout.size)
    for part in (layout.r_0, layout.v_0, layout.Theta, layout.omega, layout.s, layout.s_dot):
        change[part] = rng.standard_normal(part.stop - part.start)
    plus, minus = (nonlinear_state(model, x_e + sign * step * change) for sign in (1, -1))
    p = model.parameters
    for rows, function in ((model.uav_position_rows, uav_positions), (model.uav_velocity_rows, uav_velocities)):
        slope = (function(p, plus) - function(p, minus)).ravel() / (2 * step)
        assert np.allclose(rows @ change, slope, atol=1e-6)
    assert np.allclose(euler_from_quaternion(plus.quaternion_0), step * change[layout.Theta], atol=1e-10)


@pytest.mark.slow
def test_every_state_is_controllable(model):
    A, B, _ = model.discretised(50_000)
    eigenvalues = np.linalg.eigvals(A)
    for value in eigenvalues[eigenvalues.imag >= 0.0]:  # of a complex pair one
        rank = np.linalg.matrix_rank(np.hstack([A - value * np.eye(len(A)), B]), tol=1e-9)
        assert rank == len(A), value


def test_discretisation_is_exact_and_composes(model):
    A_50, B_50, B_d50 = model.discretised(50_000)
    A_20, B_20, B_d20 = model.discretised(20_000)
    A_30, B_30, B_d30 = model.discretised(30_000)
    assert np.allclose(A_50, expm(model.A * 0.05))
    assert np.allclose(A_50, A_30 @ A_20)
    assert np.allclose(B_50, A_30 @ B_20 + B_30)
    assert np.allclose(B_d50, A_30 @ B_d20 + B_d30)


def test_model_contains_attitude_loop_and_motor_lag():
    model = LinearModel(CONFIG.parameters())
    p, layout = model.parameters, model.layout
    x = np.zeros(layout.size)
    u = np.zeros(layout.inputs)
    u[0], u[layout.f_setpoint] = 0.1, 1.0
    A, B, _ = model.discretised(2_000_000)
    after = A @ x + B @ u
    assert after[layout.n][0] == pytest.approx(0.1, abs=1e-4)
    assert after[layout.f] == pytest.approx(np.ones(4), abs=1e-6)
    A, B, _ = model.discretised(round(p.motor_time_constant * 1e6))
    assert (B @ u)[layout.f] == pytest.approx(np.full(4, 1.0 - np.exp(-1.0)))
