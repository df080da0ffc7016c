"""What the filter's linear model leaves out, by the equations of the paper."""

import numpy as np
import pytest
from paper_system import system

from idc_controller.estimation.process_model import ProcessModel
from idc_controller.estimation.settings import ProcessNoiseSettings
from idc_controller.model.linear import LinearModel
from idc_controller.model.nonlinear import Inputs, SystemState, accelerations
from idc_controller.rotations import quaternion_from_euler

P = system()
PROCESS = ProcessModel(LinearModel(P), ProcessNoiseSettings())
LAYOUT = PROCESS.layout
DURATION = 0.04  # s
DOWN = np.array([0.0, 0.0, 1.0])


def random_state(rng, size):
    """Return a state (n,) with leaning links, unequal thrusts, forces and another mass, all about ``size``."""
    x = size * rng.normal(size=PROCESS.size)
    x[LAYOUT.f] = P.hover_thrust + 5.0 * x[LAYOUT.f]
    x[PROCESS.mass] = abs(x[PROCESS.mass])
    return x


def upright(lateral):
    return np.column_stack([lateral, np.sqrt(1.0 - np.sum(lateral**2, axis=1))])


def changes_by_the_paper(x):
    """Return v_0' (3,), omega' (3,) and s'' (2 N,) of a state (n,) by :mod:`idc_controller.model.nonlinear`."""
    s, s_dot, n = (x[part].reshape(-1, 2) for part in (LAYOUT.s, LAYOUT.s_dot, LAYOUT.n))
    mass = P.m_0 + x[PROCESS.mass] + x[PROCESS.force][2] / P.g
    q, thrust = upright(s), x[LAYOUT.f, None] * upright(n) * [1.0, 1.0, -1.0]
    q_dot = np.column_stack([s_dot, -np.sum(s * s_dot, axis=1) / q[:, 2]])
    force = thrust + np.column_stack([x[PROCESS.uav_force].reshape(-1, 2), np.zeros(len(q))])
    attitude = quaternion_from_euler(*x[LAYOUT.Theta])
    still = np.zeros((len(q), 3))
    state = SystemState(
        np.zeros(3), x[LAYOUT.v_0], attitude, x[LAYOUT.omega], q, still, np.tile([1.0, 0.0, 0.0, 0.0], (len(q), 1)),
        still,
    )  # fmt: skip
    R, swing = state.R_0, np.cross(q, q_dot)
    state = SystemState(
        state.r_0, state.r_0_dot, attitude, state.omega_0, q @ R, swing @ R, state.quaternion, state.omega
    )
    found = accelerations(P.with_payload_mass(mass), state, Inputs(force, still, x[PROCESS.force] * [1.0, 1.0, 0.0]))
    turned = (found.Omega_dot + np.cross(state.omega_0, state.Omega)) @ R.T
    s_acc = np.cross(turned, q) + np.cross(swing, np.cross(swing, q))
    return np.concatenate([found.r_0_ddot, found.omega_0_dot, s_acc[:, :2].ravel()])


@pytest.mark.parametrize("seed", range(3))
def test_linear_model_and_what_it_leaves_out_are_the_equations_of_the_paper(seed):
    rng = np.random.default_rng(seed)
    nominal, there = random_state(rng, 0.05), random_state(rng, 0.15)
    direction = PROCESS.force_of_mass(np.zeros(3))
    part = PROCESS.nonlinear_part(there - nominal, nominal, direction, round(DURATION * 1e6)) / DURATION
    A = np.zeros((LAYOUT.size, PROCESS.size))
    A[:, : LAYOUT.size], A[:, PROCESS.forces] = PROCESS.model.A, PROCESS.model.B_d
    A[:, PROCESS.mass] = PROCESS.model.B_d[:, :3] @ direction
    rates = np.r_[LAYOUT.v_0, LAYOUT.omega, LAYOUT.s_dot]
    change = (A @ (there - nominal))[rates] + part[rates]
    assert change == pytest.approx(changes_by_the_paper(there) - changes_by_the_paper(nominal), abs=1e-9)


def test_linear_model_leaves_out_nothing_near_hover():
    hover = np.zeros(PROCESS.size)
    hover[LAYOUT.f] = P.hover_thrust
    error = 1e-4 * np.random.default_rng(1).normal(size=PROCESS.size)
    part = PROCESS.nonlinear_part(error, hover, PROCESS.force_of_mass(np.zeros(3)), round(DURATION * 1e6))
    assert np.abs(part).max() < 1e-6 * DURATION


@pytest.mark.parametrize("lean", [1.0, 3.0])
def test_link_that_is_estimated_to_lean_beyond_the_level_is_taken_to_lean_less(lean):
    hover = np.zeros(PROCESS.size)
    hover[LAYOUT.f] = P.hover_thrust
    error = np.zeros(PROCESS.size)
    error[LAYOUT.s.start] = lean
    part = PROCESS.nonlinear_part(error, hover, PROCESS.force_of_mass(np.zeros(3)), round(DURATION * 1e6)) / DURATION
    assert np.abs(part).max() < 10.0 * P.g
