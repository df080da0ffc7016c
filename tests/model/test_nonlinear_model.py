"""The nonlinear model against a second derivation."""

from dataclasses import replace

import numpy as np
import pytest
from nonlinear_motion import hover_inputs, hover_state
from paper_system import system

from idc_controller.model.nonlinear import Inputs, SystemState, accelerations, matrix_P, thrust_forces
from idc_controller.rotations import hat


def make_parameters(n, *, rng=None):
    """Table I for ``n`` UAVs; with a generator, every UAV, link and attachment point is different."""
    same = system(n)
    if rng is None:
        return same
    p = same.p + rng.uniform(-0.1, 0.1, same.p.shape)
    m, l = same.m * rng.uniform(0.8, 1.2, n), same.l * rng.uniform(0.8, 1.2, n)
    A = rng.normal(size=(n, 3, 3))
    B = rng.normal(size=(3, 3))
    return replace(
        same, p=p, m=m, l=l, J=same.J + 0.001 * A @ np.swapaxes(A, 1, 2), J_0=same.J_0 + 0.01 * B @ B.T
    )  # fmt: skip


def random_state(n, rng, rate=1.0):
    """Any attitude, any links, any rates: the equations hold everywhere, not only near hover."""
    unit = lambda shape: (lambda v: v / np.linalg.norm(v, axis=-1, keepdims=True))(rng.normal(size=shape))  # noqa: E731
    q = unit((n, 3))
    Omega = rate * rng.normal(size=(n, 3))
    return SystemState(
        r_0=rng.normal(size=3), r_0_dot=rng.normal(size=3), quaternion_0=unit(4), omega_0=rate * rng.normal(size=3),
        q=q, Omega=Omega - np.sum(Omega * q, axis=1, keepdims=True) * q,
        quaternion=unit((n, 4)), omega=rate * rng.normal(size=(n, 3)),
    )  # fmt: skip


def newton_euler(parameters, state, inputs):
    """Second derivation, in the world frame, each body for itself, with the link tensions as unknowns.

    Unknowns: payload acceleration and angular acceleration (world), UAV accelerations, tensions T_i along the links.
    A tension pulls the payload towards the UAV (-q) and the UAV towards the payload (+q). The rigid links close the
    system: |r_i - a_i| = l_i twice differentiated, a_i the attachment point.
    """
    n, g = parameters.number_of_uavs, np.array([0, 0, parameters.g])
    R_0 = state.R_0
    omega_0 = R_0 @ state.omega_0
    J_0 = R_0 @ parameters.J_0 @ R_0.T
    arm = parameters.p @ R_0.T
    q = state.q @ R_0.T
    Omega = state.Omega @ R_0.T
    size = 6 + 4 * n
    A, b = np.zeros((size, size)), np.zeros(size)
    A[:3, :3] = parameters.m_0 * np.eye(3)
    b[:3] = parameters.m_0 * g + inputs.F_0
    A[3:6, 3:6] = J_0
    b[3:6] = R_0 @ inputs.tau_0 - np.cross(omega_0, J_0 @ omega_0)
    for i in range(n):
        body, tension = slice(6 + 3 * i, 9 + 3 * i), 6 + 3 * n + i
        A[:3, tension] = q[i]
        A[3:6, tension] = np.cross(arm[i], q[i])
        A[body, body] = parameters.m[i] * np.eye(3)
        A[body, tension] = -q[i]
        b[body] = parameters.m[i] * g + inputs.F[i]
        # d = r_i - a_i = -l q: d . (r_i'' - a_i'') + |d'|^2 = 0
        d, d_dot = -parameters.l[i] * q[i], -parameters.l[i] * np.cross(Omega[i], q[i])
        A[tension, body] = d
        A[tension, :3] = -d
        A[tension, 3:6] = d @ hat(arm[i])  # a_i'' contains omega_0' x arm = -hat(arm) omega_0'
        b[tension] = d @ np.cross(omega_0, np.cross(omega_0, arm[i])) - d_dot @ d_dot
    x = np.linalg.solve(A, b)
    r_0_ddot, omega_0_dot_world, r_ddot = x[:3], x[3:6], x[6 : 6 + 3 * n].reshape(n, 3)
    # Omega x q = q', so Omega = q x q' and Omega' = q x q'' in the world; then into the payload frame.
    attachment = r_0_ddot + np.cross(omega_0_dot_world, arm) + np.cross(omega_0, np.cross(omega_0, arm))
    Omega_dot_world = np.cross(q, -(r_ddot - attachment) / parameters.l[:, None])
    Omega_dot = (Omega_dot_world - np.cross(omega_0, Omega)) @ R_0
    omega_dot = np.array(
        [
            np.linalg.solve(J, t - np.cross(w, J @ w))
            for J, t, w in zip(parameters.J, inputs.tau, state.omega, strict=True)
        ]
    )
    return r_0_ddot, R_0.T @ omega_0_dot_world, Omega_dot, omega_dot


@pytest.mark.parametrize("n", [3, 4, 6])
def test_two_derivations_agree(n):
    rng = np.random.default_rng(n)
    for _ in range(20):
        parameters = make_parameters(n, rng=rng)
        state = random_state(n, rng, rate=2.0)
        inputs = Inputs(
            F=10 * rng.normal(size=(n, 3)),
            tau=rng.normal(size=(n, 3)),
            F_0=rng.normal(size=3),
            tau_0=rng.normal(size=3),
        )
        for got, expected in zip(
            accelerations(parameters, state, inputs), newton_euler(parameters, state, inputs), strict=True
        ):
            assert np.linalg.norm(got - expected) <= 1e-10 * max(1.0, np.linalg.norm(expected))


def test_P_is_symmetric_and_positive_definite():
    rng = np.random.default_rng(0)
    parameters = make_parameters(5, rng=rng)
    P = matrix_P(parameters, random_state(5, rng).q)
    np.testing.assert_allclose(P, P.T, rtol=0, atol=1e-14)
    assert np.linalg.eigvalsh(P)[0] > 0


@pytest.mark.parametrize("n", [3, 4, 7])
def test_hover_is_an_equilibrium(n):
    parameters = make_parameters(n)
    for part in accelerations(parameters, hover_state(parameters), hover_inputs(parameters)):
        np.testing.assert_allclose(part, 0.0, atol=1e-12)


def test_hover_thrust_along_the_rotor_axis_points_up():
    parameters = make_parameters(4)
    F = thrust_forces(hover_state(parameters).quaternion, parameters.hover_thrust)
    np.testing.assert_allclose(F, hover_inputs(parameters).F)
    assert np.all(F[:, 2] < 0)
