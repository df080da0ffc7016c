"""The model predictive controller against the Riccati equation and against a solver of another kind."""

from types import SimpleNamespace

import numpy as np
import pytest
from flights import MISSIONS
from mpc_oracle import optimal_moves
from scipy.linalg import solve_discrete_are

from gcs.config import read_system
from idc_controller.control.force_kernels import setpoints, tracking_error
from idc_controller.control.mpc import ModelPredictiveController, input_weight, state_weight
from idc_controller.control.settings import MpcSettings, MpcTuning
from idc_controller.errors import SolverError
from idc_controller.model.linear import LinearModel
from idc_controller.qp.parametric import ParametricQp
from idc_controller.trajectory.flatness import Load, Reference
from idc_controller.trajectory.trajectory import RestTrajectory

pytestmark = pytest.mark.numerics

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


def in_force_components(u):
    """Tilts and thrusts (12,) as F_xy / f_hover and -F_z."""
    n, f = u[LAYOUT.n_setpoint].reshape(-1, 2), u[LAYOUT.f_setpoint]
    lateral = n * (f / MODEL.parameters.hover_thrust)[:, None]
    return np.concatenate([lateral.ravel(), f * np.sqrt(1.0 - (n**2).sum(axis=1))])


def free_move(error):
    """The move without limits: linear in the error, and a small one reaches no limit."""
    output = DEFAULT.track(1e-3 * error, STAGES)
    assert output.iterations == 0
    return 1e3 * output.delta_u


@pytest.mark.slow
@pytest.mark.parametrize("vehicles", [3, 6])
def test_mpc_without_active_constraints_is_the_linear_quadratic_regulator(monkeypatch, vehicles):
    model = LinearModel(CONFIG.with_vehicles(vehicles).parameters())
    monkeypatch.setattr("idc_controller.control.mpc.BLOCKS", (1,))  # each move is held over one stage
    mpc = ModelPredictiveController(model, MpcSettings())
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


@pytest.mark.parametrize(
    "parts",
    [
        {"Theta": (np.radians(7.0), 0.0, 0.0)},  # outside the soft limit already
        {"Theta": (np.radians(4.5), 0.0, 0.0), "omega": (0.4, 0.0, 0.0)},
        {"r_0": (0.0, 0.0, -2.0)},  # thrusts at their lower limit
        {"r_0": (3.0, 0.0, 0.0)},  # tilts at their limit
        {"v_0": (0.0, 0.0, 0.8), "height": 0.3},  # about to hit the ground
        {"s": (0.3, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)},  # a vehicle comes close to its neighbours
    ],
    ids=["tilted", "tilting", "high", "far", "sinking", "close"],
)  # fmt: skip
def test_mpc_with_active_constraints_finds_the_optimum_of_the_problem_as_the_paper_has_it(parts):
    height = parts.get("height", 5.0)
    error = error_of(**{name: value for name, value in parts.items() if name != "height"})
    output = DEFAULT.track(error, stages_at(height))
    assert output.iterations > 0
    assert not output.infeasible
    moves = optimal_moves(MODEL, DEFAULT.settings, DEFAULT.prediction.blocks, error, height)
    assert output.delta_u == pytest.approx(moves[0], abs=2e-3)


def test_hard_input_limits_are_kept_whatever_the_error():
    rng = np.random.default_rng(7)
    s, p = DEFAULT.settings, MODEL.parameters
    for _ in range(30):
        error = rng.standard_normal(LAYOUT.size) * rng.choice([0.1, 0.5])
        output = DEFAULT.track(error, STAGES)
        u = in_force_components(STAGES.u[0]) + output.delta_u
        assert np.all(np.abs(u[LAYOUT.n_setpoint]) <= np.tan(s.tuning.uav_tilt_limit) + 1e-5)
        assert np.all(u[LAYOUT.f_setpoint] <= 0.95 * p.thrust_max + 1e-4)
        assert np.all(u[LAYOUT.f_setpoint] >= s.least_lift * p.m * p.g - 1e-4)


@pytest.mark.parametrize(
    "parts",
    [{"r_0": (3.0, -2.0, -4.0)}, {"r_0": (-3.0, 2.0, 4.0)}, {"r_0": (0.02, -0.01, 0.01)}],
    ids=["upper and lower", "lower and upper", "within"],
)
def test_mpc_marks_step_and_cuts_move_to_both_input_limits_when_qp_has_no_solution(parts, monkeypatch):
    mpc = ModelPredictiveController(MODEL, DEFAULT.settings)
    s = mpc.settings

    def fail(g, h):
        raise SolverError("no")

    with monkeypatch.context() as patched:
        patched.setattr(mpc.qp, "solve", fail)
        output = mpc.track(error_of(**parts), STAGES)
    assert output.infeasible
    u = in_force_components(STAGES.u[0])
    tilt, thrust_max = np.full(8, np.tan(s.tuning.uav_tilt_limit)), s.thrust_share_max * MODEL.parameters.thrust_max
    lower, upper = (
        np.append(-tilt, s.least_lift * MODEL.parameters.m * MODEL.parameters.g),
        np.append(tilt, [thrust_max] * 4),
    )
    assert u + output.delta_u == pytest.approx(np.clip(u + free_move(error_of(**parts)), lower, upper), abs=1e-6)
    assert not mpc.track(error_of(**parts), STAGES).infeasible


@pytest.mark.parametrize("where", ["gradient", "bound"])
def test_qp_refuses_values_that_are_not_finite(where):
    qp = ParametricQp(np.eye(2), np.eye(2), np.array([-1, -1]), slack_linear=1.0, slack_quadratic=1.0)
    bad, good = np.array([np.nan, 1.0]), np.ones(2)
    with pytest.raises(SolverError, match="not finite"):
        qp.solve(bad, good) if where == "gradient" else qp.solve(-2.0 * good, bad)
    assert qp.solve(-2.0 * good, good).x == pytest.approx([1.0, 1.0], abs=1e-5)


@pytest.mark.parametrize("seed", range(20))
def test_optimum_without_active_constraint_is_that_of_plain_products_and_needs_no_solver(seed):
    rng, solved = np.random.default_rng(seed), []
    P, gradient = np.diag(rng.uniform(1.0, 2.0, 4)), rng.normal(size=(4, 3))
    some = rng.normal(size=(2, 4))
    G = np.vstack([np.eye(4), -np.eye(4), some, some[::-1], -some, np.zeros((1, 4))])
    response = np.vstack([np.zeros((8, 3)), np.ones((7, 3))])
    qp = ParametricQp(P, G, np.full(len(G), -1), slack_linear=1.0, slack_quadratic=1.0, gradient=gradient,
                      response=response, solver=SimpleNamespace(solve=solved.append))  # fmt: skip
    p = rng.normal(size=3)
    x = -np.linalg.solve(P, gradient @ p)
    assert qp.unconstrained(p) == pytest.approx(x)
    left = G @ x + response @ p
    solution = qp.solve(p, left + 1e-9)
    assert solution.x == pytest.approx(x)
    assert solution.iterations == 0
    for row in range(len(G)):
        with pytest.raises(AttributeError):  # the solver returns nothing
            qp.solve(p, left + np.where(np.arange(len(G)) == row, -1e-6, 1e-9))
        assert len(solved) == row + 1


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


def test_force_components_are_inverted_exactly():
    rng = np.random.default_rng(5)
    hover = MODEL.parameters.hover_thrust
    u = np.concatenate([0.2 * rng.standard_normal(8), hover + rng.standard_normal(4)])
    target = np.concatenate([0.2 * rng.standard_normal(8), hover + rng.standard_normal(4)])
    delta = in_force_components(target) - in_force_components(u)
    assert setpoints(delta, u, hover) == pytest.approx(target)
    x = np.zeros(LAYOUT.size)
    x[LAYOUT.n], x[LAYOUT.f] = u[:8], u[8:]
    error = tracking_error(x, np.zeros(LAYOUT.size), hover, LAYOUT.n.start, np.inf, np.inf)
    assert np.concatenate([error[LAYOUT.n], error[LAYOUT.f]]) == pytest.approx(in_force_components(u))
