"""The model predictive controller against the Riccati equation and against a solver of another kind."""

import numpy as np
import pytest
from flight_in_process import MISSIONS
from scipy.linalg import block_diag, solve_discrete_are
from scipy.optimize import nnls

from gcs.config import read_system
from idc_controller.control.force_components import (
    inputs_in_force_components,
    setpoints_from_force_components,
    state_in_force_components,
)
from idc_controller.control.mpc import ModelPredictiveController, input_weight, state_weight
from idc_controller.control.prediction import move_blocks
from idc_controller.control.settings import MpcSettings, MpcTuning
from idc_controller.errors import ParameterError, SolverError
from idc_controller.model.linear import LinearModel
from idc_controller.qp.parametric import ParametricQp
from idc_controller.trajectory.flatness import Load
from idc_controller.trajectory.reference import Reference
from idc_controller.trajectory.trajectory import RestTrajectory

CONFIG = read_system(MISSIONS / "system.toml")
MODEL = LinearModel(CONFIG.parameters())
LAYOUT = MODEL.layout
DEFAULT = ModelPredictiveController(MODEL, MpcSettings())


def stages_at(height, settings=DEFAULT.settings, model=MODEL):
    rest = RestTrajectory(np.array([0.0, 0.0, -height]), 0.0)
    reference = Reference(model.parameters, rest, Load(model.parameters.m_0, np.zeros(3)))
    return reference.at(settings.period * np.arange(settings.tuning.horizon + 1))


STAGES = stages_at(5.0)


def error_of(**parts):
    error = np.zeros(LAYOUT.size)
    for name, value in parts.items():
        error[getattr(LAYOUT, name)] = value
    return error


def next_error(mpc, error):
    return mpc.prediction.A @ error + mpc.prediction.B @ mpc.track(error, STAGES).delta_u


@pytest.mark.slow
@pytest.mark.parametrize("vehicles", [3, 6])
def test_mpc_without_active_constraints_is_the_linear_quadratic_regulator(vehicles):
    model = LinearModel(CONFIG.with_vehicles(vehicles).parameters())
    mpc = ModelPredictiveController(model, MpcSettings(), blocks=(1,) * 20)
    A, B, weights = mpc.prediction.A, mpc.prediction.B, MpcTuning().weights
    Q, R = state_weight(weights, model.layout), input_weight(weights, model.layout)
    P = solve_discrete_are(A, B, Q, R)
    K = np.linalg.solve(R + B.T @ P @ B, B.T @ P @ A)
    rng = np.random.default_rng(vehicles)
    stages = stages_at(5.0, mpc.settings, model)
    for _ in range(5):
        error = 1e-3 * rng.standard_normal(model.layout.size)
        output = mpc.track(error, stages)
        assert output.iterations == 0
        assert np.allclose(output.delta_u, -K @ error, rtol=1e-6, atol=1e-9)


def test_blocked_moves_cost_little_and_bring_the_system_to_rest():
    rng = np.random.default_rng(3)
    error = 0.02 * rng.standard_normal(LAYOUT.size)
    for _ in range(400):
        error = next_error(DEFAULT, error)
    assert np.max(np.abs(error)) < 1e-4


def reference_solution(mpc, error, stages):
    """The same QP, slacks and all, as a least-distance problem (Lawson and Hanson, chapter 23)."""
    qp, s = mpc.qp, mpc.settings
    m, slacks = len(qp.G), int(qp.slack_of_row.max()) + 1
    P = block_diag(qp.P, s.slack_quadratic * np.eye(slacks))
    g = np.append(mpc._gradient @ error, np.full(slacks, s.slack_linear))
    columns = np.zeros((m, slacks))
    soft = np.flatnonzero(qp.slack_of_row >= 0)
    columns[soft, qp.slack_of_row[soft]] = -1.0
    G = np.block([[qp.G, columns], [np.zeros((slacks, qp.G.shape[1])), -np.eye(slacks)]])
    h = np.append(mpc.bounds(error, stages), np.zeros(slacks))
    L = np.linalg.cholesky((P + P.T) / 2)
    shift = np.linalg.solve(L, g)  # y = L'x + shift: the nearest point to zero in A y >= b
    A = -np.linalg.solve(L, G.T).T
    b = -h + A @ shift
    scale = np.linalg.norm(np.column_stack([A, b]), axis=1)
    E = np.vstack([A.T, b]) / scale
    f = np.append(np.zeros(len(P)), 1.0)
    u, _ = nnls(E, f, maxiter=20 * len(h))
    r = E @ u - f
    return np.linalg.solve(L.T, -r[:-1] / r[-1] - shift)


@pytest.mark.parametrize(
    "parts",
    [
        {"Theta": (np.radians(7.0), 0.0, 0.0)},  # outside the soft limit already
        {"Theta": (np.radians(4.5), 0.0, 0.0), "omega": (0.4, 0.0, 0.0)},
        {"r_0": (0.0, 0.0, -2.0)},  # thrusts at their lower limit
        {"r_0": (3.0, 0.0, 0.0)},  # tilts at their limit
    ],
    ids=["tilted", "tilting", "high", "far"],
)  # fmt: skip
def test_mpc_with_active_constraints_agrees_with_reference_solver(parts):
    error = error_of(**parts)
    output = DEFAULT.track(error, STAGES)
    assert output.iterations > 0
    assert not output.infeasible
    moves_found = reference_solution(DEFAULT, error, STAGES)
    assert output.delta_u == pytest.approx(moves_found[: LAYOUT.inputs], abs=2e-3)


def test_hard_input_limits_are_kept_whatever_the_error():
    rng = np.random.default_rng(7)
    s, p = DEFAULT.settings, MODEL.parameters
    for _ in range(30):
        error = rng.standard_normal(LAYOUT.size) * rng.choice([0.1, 0.5])
        output = DEFAULT.track(error, STAGES)
        u = inputs_in_force_components(STAGES.u[0], LAYOUT, p.hover_thrust) + output.delta_u
        assert np.all(np.abs(u[LAYOUT.n_setpoint]) <= np.tan(s.tuning.uav_tilt_limit) + 1e-5)
        assert np.all(u[LAYOUT.f_setpoint] <= 0.95 * p.thrust_max + 1e-4)
        assert np.all(u[LAYOUT.f_setpoint] >= s.thrust_min - 1e-4)


def test_payload_tilt_limit_binds_before_it_is_reached():
    # A rate that would carry the payload over the limit: with the limit it is stopped sooner than without.
    loose = ModelPredictiveController(MODEL, MpcSettings(tuning=MpcTuning(payload_tilt_limit_deg=80.0)))
    peaks = {}
    for name, mpc in (("limited", DEFAULT), ("loose", loose)):
        error = error_of(Theta=(np.radians(3.0), 0.0, 0.0), omega=(0.9, 0.0, 0.0))
        peak = 0.0
        for _ in range(40):
            error = next_error(mpc, error)
            peak = max(peak, error[LAYOUT.Theta][0])
        peaks[name] = np.degrees(peak)
    assert peaks["limited"] < peaks["loose"] - 0.1


def test_ground_is_a_soft_limit():
    stages = stages_at(0.3)
    error = error_of(v_0=(0.0, 0.0, 0.8))  # sinking fast, 5 cm above the ground
    free = DEFAULT.qp.unconstrained(DEFAULT._gradient @ error)
    output = DEFAULT.track(error, stages)
    assert output.iterations > 0
    assert np.sum(output.delta_u[LAYOUT.f_setpoint]) > np.sum(free[: LAYOUT.inputs][LAYOUT.f_setpoint])


def test_mpc_marks_step_and_clips_move_when_qp_has_no_solution(monkeypatch):
    mpc = ModelPredictiveController(MODEL, DEFAULT.settings)
    far = error_of(r_0=(3.0, 0.0, 0.0))

    def fail(g, h):
        raise SolverError("no")

    with monkeypatch.context() as patched:
        patched.setattr(mpc.qp, "solve", fail)
        output = mpc.track(far, STAGES)
    assert output.infeasible
    u = inputs_in_force_components(STAGES.u[0], LAYOUT, MODEL.parameters.hover_thrust) + output.delta_u
    assert np.abs(u[LAYOUT.n_setpoint]).max() == pytest.approx(np.tan(mpc.settings.tuning.uav_tilt_limit))
    assert not mpc.track(far, STAGES).infeasible


@pytest.mark.parametrize("where", ["gradient", "bound"])
def test_qp_refuses_values_that_are_not_finite(where):
    qp = ParametricQp(np.eye(2), np.eye(2), np.array([-1, -1]), slack_linear=1.0, slack_quadratic=1.0)
    bad, good = np.array([np.nan, 1.0]), np.ones(2)
    with pytest.raises(SolverError, match="not finite"):
        qp.solve(bad, good) if where == "gradient" else qp.solve(-2.0 * good, bad)
    assert qp.solve(-2.0 * good, good).x == pytest.approx([1.0, 1.0], abs=1e-5)


def test_contradictory_hard_rows_raise():
    qp = ParametricQp(
        np.eye(2), np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([-1, -1]), slack_linear=1.0, slack_quadratic=1.0
    )
    with pytest.raises(SolverError):
        qp.solve(np.zeros(2), np.array([-1.0, -1.0]))
    assert qp.solve(np.zeros(2), np.array([-1.0, 2.0])).x == pytest.approx([-1.0, 0.0], abs=1e-5)


def test_soft_row_is_kept_exactly_when_feasible_and_exceeded_otherwise():
    G = np.array([[1.0, 0.0], [-1.0, 0.0], [1.0, 0.0]])
    qp = ParametricQp(np.eye(2), G, np.array([-1, -1, 0]), slack_linear=100.0, slack_quadratic=1.0)
    kept = qp.solve(np.array([-5.0, 0.0]), np.array([10.0, 10.0, 2.0]))
    assert kept.x == pytest.approx([2.0, 0.0], abs=1e-5)
    exceeded = qp.solve(np.array([-5.0, 0.0]), np.array([10.0, -3.0, 2.0]))
    assert exceeded.x == pytest.approx([3.0, 0.0], abs=2e-3)


def test_warm_start_saves_iterations_with_equal_solution():
    error = error_of(Theta=(np.radians(4.5), 0.0, 0.0), omega=(0.4, 0.0, 0.0))
    cold = ModelPredictiveController(MODEL, DEFAULT.settings)
    first = cold.track(error, STAGES)
    again = cold.track(error, STAGES)
    assert again.iterations <= first.iterations
    assert again.delta_u == pytest.approx(first.delta_u, abs=1e-3)


def test_force_components_are_inverted_exactly():
    rng = np.random.default_rng(5)
    hover = MODEL.parameters.hover_thrust
    u = np.concatenate([0.2 * rng.standard_normal(8), hover + rng.standard_normal(4)])
    target = np.concatenate([0.2 * rng.standard_normal(8), hover + rng.standard_normal(4)])
    delta = inputs_in_force_components(target, LAYOUT, hover) - inputs_in_force_components(u, LAYOUT, hover)
    assert setpoints_from_force_components(delta, u, LAYOUT, hover, 0.05) == pytest.approx(target)
    x = np.zeros(LAYOUT.size)
    x[LAYOUT.n], x[LAYOUT.f] = u[:8], u[8:]
    converted = state_in_force_components(x, LAYOUT, hover)
    as_inputs = np.concatenate([converted[LAYOUT.n], converted[LAYOUT.f]])
    assert as_inputs == pytest.approx(inputs_in_force_components(u, LAYOUT, hover))


@pytest.mark.parametrize("horizon", [2, 7, 20, 33])
def test_move_blocks_sum_to_any_horizon(horizon):
    assert sum(move_blocks(horizon)) == horizon


def test_mpc_refuses_move_blocks_that_do_not_sum_to_the_horizon():
    for blocks in ((1, 1), (0,) * 20):
        with pytest.raises(ParameterError, match="move blocks"):
            ModelPredictiveController(MODEL, MpcSettings(), blocks)


def test_states_are_constrained_from_the_first_stage_at_the_interval_to_the_horizon():
    settings = MpcSettings(tuning=MpcTuning(horizon=8), constraint_interval=3)
    assert settings.constraint_stages == [1, 4, 7]
