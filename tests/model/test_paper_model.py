"""The paper's equations: what is printed against what is correct, each confirmed on its own."""

import numpy as np
import pytest
from nonlinear_motion import hover_inputs, hover_state, uav_positions
from paper_system import system
from test_nonlinear_model import make_parameters, newton_euler, random_state

from idc_controller.model.linear import discretised
from idc_controller.model.nonlinear import Inputs, accelerations, matrix_P, thrust_forces, vector_Q
from idc_controller.paper import printed_equations as printed
from idc_controller.paper.plant import Plant, PlantState
from idc_controller.paper.state_space import (
    Layout,
    derivative,
    embedding,
    hover,
    linearised,
    minimal,
    relative_degrees,
    uncontrollable_modes,
)
from idc_controller.rotations import hat, rotation_from_quaternion


def random_case(n, seed):
    rng = np.random.default_rng(seed)
    parameters = make_parameters(n, rng=rng)
    state = random_state(n, rng)
    thrust, torque = rng.uniform(5.0, 20.0, n), rng.normal(size=(n, 3))
    return parameters, state, Inputs(thrust_forces(state.quaternion, thrust), torque), thrust, torque


def plant_state(state):
    R_0 = state.R_0
    return PlantState(
        state.r_0, state.r_0_dot, state.quaternion_0, state.omega_0, state.q @ R_0.T,
        np.cross(state.Omega, state.q) @ R_0.T, state.quaternion, state.omega,
    )  # fmt: skip


@pytest.mark.parametrize("n", [3, 4, 6])
def test_plant_without_tensions_agrees(n):
    for seed in range(10):
        parameters, state, inputs, thrust, torque = random_case(n, seed)
        expected = accelerations(parameters, state, inputs)
        plant = Plant(parameters)
        r_ddot, omega_0_dot, q_ddot, omega_dot = plant.accelerations(plant_state(state), thrust, torque)
        np.testing.assert_allclose(r_ddot, expected.r_0_ddot, atol=1e-9)
        np.testing.assert_allclose(omega_0_dot, expected.omega_0_dot, atol=1e-9)
        np.testing.assert_allclose(omega_dot, expected.omega_dot, atol=1e-9)
        R_0, w = state.R_0, state.Omega @ state.R_0.T
        w_dot = (expected.Omega_dot + np.cross(state.omega_0, state.Omega)) @ R_0.T
        q = state.q @ R_0.T
        np.testing.assert_allclose(q_ddot, np.cross(w_dot, q) + np.cross(w, np.cross(w, q)), atol=1e-9)
        np.testing.assert_allclose(plant.uav_positions(plant_state(state)), uav_positions(parameters, state))


def test_state_has_12_plus_12_N_coordinates():
    parameters = system()
    assert len(hover(parameters)[0]) == len(Layout.full(4).names()) == 60
    assert printed.printed_state_dimension(4) == 76
    assert Layout.minimal(4).size == 52


def test_hover_thrust_depends_on_the_number_of_uavs():
    for n, right in ((3, False), (4, True), (6, False)):
        parameters = make_parameters(n)
        thrust = printed.printed_hover_thrust(parameters)
        F = np.outer(thrust, [0.0, 0.0, -1.0])
        rest = accelerations(parameters, hover_state(parameters), Inputs(F, np.zeros((n, 3))))
        assert (np.abs(rest.r_0_ddot).max() < 1e-9) == right
        np.testing.assert_allclose(parameters.hover_thrust, (0.7 + 3.1 / n) * 9.81)


def test_printed_thrust_points_down():
    parameters = system()
    state = hover_state(parameters)
    F = printed.printed_thrust_forces(state.quaternion, parameters.hover_thrust)
    down = accelerations(parameters, state, Inputs(F, np.zeros((4, 3)))).r_0_ddot
    np.testing.assert_allclose(down, [0.0, 0.0, 2 * 9.81], atol=1e-9)
    # Read with b_i3 in the world, it is turned twice.
    rng = np.random.default_rng(0)
    q = rng.normal(size=4)
    R = rotation_from_quaternion(q / np.linalg.norm(q))
    assert np.linalg.norm(R @ (R @ [0, 0, 1.0]) - R @ [0, 0, 1.0]) > 0.1


def test_printed_P_is_not_symmetric_and_gives_other_accelerations():
    parameters, state, inputs, _, _ = random_case(4, 1)
    P, corrected = printed.printed_matrix_P(parameters, state.q), matrix_P(parameters, state.q)
    assert np.abs(P - P.T).max() > 0.5
    np.testing.assert_allclose(corrected, corrected.T, atol=1e-14)
    # The printed rows of the other links are right: only the first block differs.
    changed = np.argwhere(np.abs(P - corrected) > 1e-12)
    assert changed[:, 0].min() >= 6
    assert changed[:, 0].max() < 9
    assert changed[:, 1].max() < 3
    wrong = printed.printed_accelerations(parameters, state, inputs)
    truth = newton_euler(parameters, state, inputs)
    right = np.linalg.solve(corrected, vector_Q(parameters, state, inputs))
    np.testing.assert_allclose(right[3:6], truth[1], atol=1e-9)
    assert np.abs(wrong - right).max() > 0.5


def test_moment_equation_requires_cross_product():
    parameters, state, inputs, _, _ = random_case(4, 2)
    assert printed.moment_residual(parameters, state, inputs, printed=False) < 1e-10
    assert printed.moment_residual(parameters, state, inputs, printed=True) > 0.1


def test_link_equation_requires_link_rate():
    """With hat(omega_0) Omega, Omega any one rate, the equations of all links could not hold at once."""
    parameters, state, inputs, _, _ = random_case(4, 3)
    second = accelerations(parameters, state, inputs)
    v_dot = state.R_0.T @ second.r_0_ddot - np.cross(state.omega_0, state.v_0)
    k = state.R_0.T @ [0.0, 0.0, 1.0]

    def residual(i, rate):
        m, l, q, p = parameters.m[i], parameters.l[i], hat(state.q[i]), parameters.p[i]
        w = hat(state.omega_0)
        left = m * l**2 * (second.Omega_dot[i] + w @ rate) - m * l * q @ (v_dot + w @ state.v_0)
        left += m * l * q @ hat(p) @ second.omega_0_dot - m * l * q @ w @ w @ p
        return np.linalg.norm(left + l * q @ (state.R_0.T @ inputs.F[i] + m * parameters.g * k))

    for i in range(4):
        assert residual(i, state.Omega[i]) < 1e-9
        assert residual(i, state.Omega.mean(axis=0)) > 0.1


def test_generalised_forces_are_virtual_work():
    """F_i . dr_i for a turn of the payload and for a turn of a link, by differences of r_i itself."""
    parameters, state, inputs, _, _ = random_case(4, 4)
    e = 1e-6

    def positions(turn=np.zeros(3), q=state.q):  # noqa: B008
        R = state.R_0 @ (np.eye(3) + hat(turn))
        return state.r_0 + (parameters.p - parameters.l[:, None] * q) @ R.T

    moment = [np.sum(inputs.F * (positions(e * a) - positions(-e * a))) / (2 * e) for a in np.eye(3)]
    np.testing.assert_allclose(printed.generalised_moment(parameters, state, inputs, printed=False), moment, atol=1e-6)
    assert np.linalg.norm(printed.generalised_moment(parameters, state, inputs, printed=True) - moment) > 1.0
    for i in range(4):
        work = []
        for axis in np.eye(3):
            q = np.tile(state.q, (2, 1, 1))
            q[0, i] += e * np.cross(axis, state.q[i])
            q[1, i] -= e * np.cross(axis, state.q[i])
            work.append(np.sum(inputs.F * (positions(q=q[0]) - positions(q=q[1]))) / (2 * e))
        l, in_payload = parameters.l[i], state.R_0.T @ inputs.F[i]
        np.testing.assert_allclose(work, -l * np.cross(state.q[i], in_payload), atol=1e-6)
        assert np.linalg.norm(work + l * np.cross(state.q[i], inputs.F[i])) > 1.0  # as printed, without R_0^T


def test_hat_maps_into_the_algebra_not_the_group():
    matrix = hat([1.0, 2.0, 3.0])
    np.testing.assert_array_equal(matrix, -matrix.T)
    assert abs(np.linalg.det(matrix)) < 1e-12  # a rotation has 1


def test_hover_is_an_equilibrium_of_the_paper_s_state():
    for n in (3, 4, 6):
        parameters = make_parameters(n)
        np.testing.assert_allclose(derivative(parameters, *hover(parameters)), 0.0, atol=1e-10)
    assert np.all(hover_inputs(system()).F[:, 2] < 0.0)


@pytest.mark.parametrize("n", [3, 4, 6])
def test_minimal_form_is_the_full_one_on_its_manifold(n):
    parameters = make_parameters(n)
    A, B = linearised(parameters)
    A_small, B_small = minimal(parameters)
    T = embedding(parameters)
    np.testing.assert_allclose(A @ T, T @ A_small, atol=1e-6)
    np.testing.assert_allclose(B, T @ B_small, atol=1e-6)
    assert np.linalg.matrix_rank(T) == 12 + 10 * n


def test_riccati_equation_has_no_solution_on_full_state():
    parameters = system()
    A, B = discretised(*linearised(parameters), 0.05)
    lost = uncontrollable_modes(A, B)
    assert len(lost) == 8  # q_z and Omega_z of each link
    np.testing.assert_allclose(lost, 1.0, atol=1e-3)
    assert uncontrollable_modes(*discretised(*minimal(parameters), 0.05)) == []


def test_relative_degrees():
    parameters = system()
    A, B = minimal(parameters)
    degrees = relative_degrees(A, B, np.eye(3, len(A)))
    thrust, roll, pitch, yaw = degrees[:, 0::4], degrees[:, 1::4], degrees[:, 2::4], degrees[:, 3::4]
    np.testing.assert_array_equal(thrust, [[4] * 4, [4] * 4, [2] * 4])
    np.testing.assert_array_equal(pitch[0], 6)
    np.testing.assert_array_equal(roll[1], 6)
    assert np.all(yaw[:2] == 0)
    # The full state says the same.
    A, B = linearised(parameters)
    np.testing.assert_array_equal(relative_degrees(A, B, np.eye(3, len(A)), 1e-7)[:, 0::4], thrust)
