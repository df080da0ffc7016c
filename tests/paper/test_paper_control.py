"""The paper's tracking controller and obstacle avoidance controller: what they are, and what is wrong with them."""

import numpy as np
import pytest
from paper_system import system
from scipy.linalg import solve_discrete_are

from gcs.reproduce.controls import PaperControl, PaperVariant, minimal_state
from gcs.reproduce.scene import Sphere, printed_reference, shaped_figure, two_spheres
from idc_controller.geometry.formation import Formation
from idc_controller.paper.avoidance import (
    Encounter,
    corrected_input,
    linear_acceleration,
    nonlinear_acceleration,
    obstacle_row,
)
from idc_controller.paper.plant import Plant, PlantState
from idc_controller.paper.state_space import Layout
from idc_controller.paper.tracking import Settings, ThrustTorqueMpc, Weights
from idc_controller.rotations import quaternion_from_euler

POLES = (2.0, 3.0)


@pytest.fixture(scope="module")
def mpc():
    return ThrustTorqueMpc(system())


def tilted(seed=0):
    rng = np.random.default_rng(seed)
    q = np.column_stack([0.1 * rng.normal(size=(4, 2)), np.ones(4)])
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    q_dot = 0.1 * rng.normal(size=(4, 3))
    q_dot -= np.sum(q_dot * q, axis=1, keepdims=True) * q
    angles = 0.1 * rng.normal(size=(5, 3))
    quaternions = np.array([quaternion_from_euler(*a) for a in angles])
    return PlantState(
        np.array([0.3, -0.2, -5.0]), rng.normal(size=3), quaternions[0], 0.1 * rng.normal(size=3), q, q_dot,
        quaternions[1:], 0.1 * rng.normal(size=(4, 3)),
    )  # fmt: skip


def encounter(mask=(1.0, 1.0, 1.0), closest=(1.0, 0.5, -4.0)):
    return Encounter(
        np.array(closest), np.array([0.5, -0.3, 0.2]), np.array([2.0, 1.5, -3.2]), np.array([-0.4, 0.1, 0.3]),
        np.array([0.2, -0.1, 0.4]), 1.0, np.array(mask),
    )  # fmt: skip


@pytest.mark.parametrize("mask", [(1.0, 1.0, 1.0), (1.0, 1.0, 0.0)], ids=["sphere", "pole"])
def test_A_obs_and_B_obs_are_the_second_derivative_of_h(mask):
    """By differences of h = |c - o|^2 - R^2 along the motion, for any acceleration that is affine in the input."""
    rng = np.random.default_rng(1)
    e, a, G = encounter(mask), rng.normal(size=3), rng.normal(size=(3, 16))
    row, bound = obstacle_row(e, a, G, POLES)
    for _ in range(5):
        u = rng.normal(size=16)

        def h(t, u=u):
            c = e.closest + e.velocity * t + (a + G @ u) * t**2 / 2
            o = e.obstacle + e.obstacle_velocity * t + e.obstacle_acceleration * t**2 / 2
            return np.sum(((c - o) * e.mask) ** 2) - e.radius**2

        s = 1e-3
        h_dot, h_ddot = (h(s) - h(-s)) / (2 * s), (h(s) - 2 * h(0.0) + h(-s)) / s**2
        assert bound - row @ u == pytest.approx(h_ddot + 6.0 * h(0.0) + 5.0 * h_dot, rel=1e-4, abs=1e-4)


def test_A_obs_in_closed_form():
    parameters = system()
    _, G = linear_acceleration(parameters)
    e = encounter()
    row, _ = obstacle_row(e, np.zeros(3), G, POLES)
    d = e.closest - e.obstacle
    # r_0z'' = -sum f_i / m_T for a symmetric layout; sideways, and of torques, there is nothing.
    np.testing.assert_allclose(
        row.reshape(4, 4), np.outer(np.full(4, 2 * d[2] / parameters.m_T), [1, 0, 0, 0]), atol=1e-12
    )
    row, _ = obstacle_row(encounter(mask=(1.0, 1.0, 0.0)), np.zeros(3), G, POLES)
    np.testing.assert_allclose(row, 0.0, atol=1e-12)  # a pole: the filter cannot act


def test_nonlinear_reading_is_exact_in_the_thrusts():
    parameters, state, rng = system(), tilted(), np.random.default_rng(2)
    plant = Plant(parameters)
    a, G = nonlinear_acceleration(plant, state)
    for _ in range(5):
        delta = rng.normal(size=(4, 4))
        second = plant.accelerations(state, parameters.hover_thrust + delta[:, 0], delta[:, 1:])[0]
        np.testing.assert_allclose(a + G @ delta.ravel(), second, atol=1e-10)
    assert np.abs(G[:2]).max() > 1e-3  # with the links tilted, thrust does push sideways
    hover = nonlinear_acceleration(plant, PlantState.hovering(parameters, np.zeros(3)))
    np.testing.assert_allclose(hover[1], linear_acceleration(parameters)[1], atol=1e-12)
    np.testing.assert_allclose(hover[0], 0.0, atol=1e-12)


def test_condition_is_on_the_best_input_not_the_worst():
    """eq:cond_hx with inf_u fails even far away from an obstacle that is no danger; with sup_u it holds."""
    _, G = linear_acceleration(system())
    far = Encounter(np.array([0, 0, -8.0]), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), 1.0, np.ones(3))
    row, bound = obstacle_row(far, np.zeros(3), G, (1.0, 1.0))
    values = [bound - row @ np.tile([thrust - 14.47, 0, 0, 0], 4) for thrust in (0.0, 30.0)]
    assert min(values) < 0.0 < max(values)


def test_negative_poles_are_insufficient():
    """h'' = -K (h, h') keeps h >= 0 for real poles from within the nested sets, not for complex ones."""

    def least(K, h, h_dot):
        values = []
        for _ in range(4000):
            h_dot += 0.002 * -(K[0] * h + K[1] * h_dot)
            h += 0.002 * h_dot
            values.append(h)
        return min(values)

    complex_poles, real_poles = (5.0, 2.0), (4.0, 4.0)  # -1 +- 2i; -2, -2
    assert least(complex_poles, 1.0, 0.0) < -0.1
    assert least(real_poles, 1.0, -1.9) >= 0.0  # h' + p h >= 0
    assert least(real_poles, 1.0, -4.0) < -0.01  # outside the second set


def test_filter_leaves_feasible_inputs_unchanged():
    rng = np.random.default_rng(3)
    u, lower, upper = rng.normal(size=16), np.full(16, -5.0), np.full(16, 5.0)
    rows = rng.normal(size=(2, 16))
    same = corrected_input(u, rows, rows @ u + 0.1, lower, upper)
    assert not same.active
    np.testing.assert_array_equal(same.delta_u, u)
    bounds = rows @ u - 1.0
    changed = corrected_input(u, rows, bounds, lower, upper)
    assert changed.active
    assert not changed.infeasible
    np.testing.assert_allclose(rows @ changed.delta_u, bounds, atol=1e-6)
    # The nearest input: what was added lies in the span of the rows.
    added = changed.delta_u - u
    np.testing.assert_allclose(rows.T @ np.linalg.lstsq(rows.T, added, rcond=None)[0], added, atol=1e-6)
    none = corrected_input(u, rows, np.full(2, -1e6), lower, upper)
    assert none.infeasible
    assert np.all(np.abs(none.delta_u) <= 5.0 + 1e-9)


def test_unconstrained_mpc_equals_the_regulator(mpc):
    s = mpc.settings
    Q, R = s.weights.state(4), s.weights.inputs(4)
    A, B = mpc.prediction.A, mpc.prediction.B
    X = solve_discrete_are(A, B, Q, R)
    K = np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A)
    x = 0.001 * np.random.default_rng(4).normal(size=52)
    move = mpc.solve(
        mpc.F @ x, mpc.F @ x - np.eye(52)[2], np.tile(np.repeat([[14.47, 0, 0, 0]], 4, 0).ravel(), (20, 1))
    )
    np.testing.assert_allclose(move.delta_u, -K @ x, atol=1e-6)
    assert not move.infeasible_as_printed


def test_stage_zero_cannot_be_constrained(mpc):
    """A tilt of 6 degrees has no solution as printed, whatever is done; the corrected QP has one."""
    x = np.zeros(52)
    x[2], x[mpc.layout.payload("Theta_0").start] = -5.0, np.radians(6.0)
    wanted = np.zeros(52)
    wanted[2] = -5.0
    u = np.tile(np.repeat([[14.47, 0, 0, 0]], 4, 0).ravel(), (20, 1))
    move = mpc.solve(mpc.F @ x - wanted, mpc.F @ x, u)
    assert move.infeasible_as_printed
    assert not move.failed
    assert np.all(np.isfinite(move.delta_u))


def test_named_outputs_have_no_rates():
    Q = Weights.of_named_outputs().state(4)
    layout = Layout.minimal(4)
    for name in ("v_0", "omega_0"):
        assert np.all(Q[layout.payload(name), layout.payload(name)] == 0.0)
    assert np.all(np.diag(Q)[layout.of_uavs("s_dot")] == 0.0)
    assert np.all(np.diag(Q)[layout.of_uavs("s")] > 0.0)
    assert Settings().horizon == 20


def test_height_of_a_uav_is_given_by_no_diagonal_c_z():
    """r_iz = r_0z + [R_0 (p_i - l_i q_i)]_z: one state less of it, and the height of the UAV is another."""
    parameters = system()
    plant, state = Plant(parameters), tilted(5)
    level = PlantState.hovering(parameters, state.r_0)
    heights = plant.uav_positions(state)[:, 2], plant.uav_positions(level)[:, 2]
    assert np.abs(heights[0] - heights[1]).max() > 0.02  # the same r_0z


def test_hull_does_not_translate_with_the_payload():
    """At the figure eight's largest acceleration the UAVs stand most of a metre off where hover has them."""
    parameters = system()
    formation = Formation(parameters)
    times = np.linspace(0.0, 4 * np.pi, 400)
    h = 1e-3
    a = (printed_reference(times + h) - 2 * printed_reference(times) + printed_reference(times - h)) / h**2
    shift = np.linalg.norm(formation.hull_points(a)[:, -1] - formation.hull_points(np.zeros((1, 3)))[:, -1], axis=-1)
    assert shift.max() > 0.9


def test_printed_reference_jumps_at_its_start():
    at_rest = printed_reference(np.array([0.0, 1e-4]))
    assert at_rest[0, 2] == -5.0
    np.testing.assert_allclose((at_rest[1] - at_rest[0])[:2] / 1e-4, [3.0, -3.0], rtol=1e-3)


def test_spheres_meet_the_payload_at_positions_of_the_paper():
    shaped = shaped_figure(4.0)
    np.testing.assert_allclose(shaped.trajectory.position(shaped.meets), [6.0, 0.0, -5.0], atol=1e-3)
    for meets in (np.pi, shaped.meets):
        position, velocity, acceleration = two_spheres(meets)[1].motion(np.array([meets]))
        np.testing.assert_allclose(position[0], [6.0, 0.0, -5.0], atol=1e-9)
        assert velocity[0, 0] < 0.0
        np.testing.assert_allclose(acceleration, 0.0, atol=1e-9)


def test_formation_in_world_is_hull_in_hover_when_hovering():
    parameters = system()
    formation, state = Formation(parameters), PlantState.hovering(parameters, np.array([1.0, 2.0, -5.0]))
    uavs = Plant(parameters).uav_positions(state)
    points = formation.points_in_world(state.r_0, state.quaternion_0, uavs, state.quaternion)
    np.testing.assert_allclose(points, formation.hull_points(np.zeros((1, 3)))[0] + state.r_0, atol=1e-12)


@pytest.mark.slow
def test_filter_of_the_paper_does_not_sink_onto_a_sphere():
    parameters = system()
    above = PlantState.hovering(parameters, np.array([0.0, 0.0, -6.0]))  # the reference is at -5
    np.testing.assert_allclose(minimal_state(above)[:3], above.r_0)
    with_sphere = PaperControl(parameters, PaperVariant("states"), None, [Sphere("below", (0.0, 0.0, -4.7))])
    without = PaperControl(parameters, PaperVariant("states"))
    for control in (with_sphere, without):
        control.decide(0.0, above)
    assert with_sphere.avoiding
    assert with_sphere.act(above, 0.01)[0].sum() > without.act(above, 0.01)[0].sum()
