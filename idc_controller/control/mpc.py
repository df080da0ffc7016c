"""The linear model predictive controller (eq:J_MPC with eq:inpCon and eq:stateCon), corrected and condensed.

Corrections to the printed form: inputs are set-points with the attitude loop and the motor lag in the model; errors are
taken about the exact flat reference; the model is minimal, so the Riccati equation has a solution; states are
constrained at stages 1 .. N_p (stage 0 cannot be changed) and softly, so that no state makes the QP infeasible.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, solve_discrete_are

from idc_controller.arrays import Array
from idc_controller.control.constraints import state_constraints
from idc_controller.control.constraints.input_limits import InputLimits
from idc_controller.control.settings import MpcSettings, MpcWeights
from idc_controller.control.tracker import TrackingOutput
from idc_controller.errors import SolverError
from idc_controller.model.linear import LinearModel, StateLayout
from idc_controller.qp.parametric import ParametricQp
from idc_controller.trajectory.flatness import FlatReference


class ModelPredictiveController:
    """Tracks a flat reference. Time-invariant matrices are built once; a step is a gradient and a QP."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self.settings = settings
        self.layout = model.layout
        self.A, self.B, _ = model.discretised(round(settings.period * 1e6))
        self.Q = state_weight(settings.weights, self.layout)
        self.R = input_weight(settings.weights, self.layout)
        self.Q_f = solve_discrete_are(self.A, self.B, self.Q, self.R)
        self._input_limits = InputLimits(model, settings)
        self.state_constraints = state_constraints(model, settings)
        self._condense()

    def track(self, error: Array, reference: FlatReference) -> TrackingOutput:
        """Optimal first move for ``error`` (12 + 11 N,) in force components about ``reference``.

        ``reference`` holds the stages 0 .. N_p. When the QP cannot be solved the unconstrained move, cut to the
        input limits, is taken and the step is marked infeasible.
        """
        g = self._gradient @ error
        h = self.bounds(error, reference)
        m = self.layout.inputs
        try:
            solution = self.qp.solve(g, h)
        except SolverError:
            first_move = self.qp.unconstrained(g)[:m]
            return TrackingOutput(np.clip(first_move, -h[m : 2 * m], h[:m]), infeasible=True)
        return TrackingOutput(solution.x[:m], solution.iterations)

    def _condense(self) -> None:
        """Predict all stages from error and moves: E = F e_0 + H V, and condense the cost and the constraints."""
        s, n, m = self.settings, self.layout.size, self.layout.inputs
        N_p, moves = s.horizon, len(s.moves)
        move_of_stage = np.repeat(np.arange(moves), s.moves)
        F = np.zeros((N_p + 1, n, n))
        H = np.zeros((N_p + 1, n, moves * m))
        F[0] = np.eye(n)
        for k in range(N_p):
            F[k + 1] = self.A @ F[k]
            H[k + 1] = self.A @ H[k]
            block = slice(move_of_stage[k] * m, (move_of_stage[k] + 1) * m)
            H[k + 1][:, block] += self.B
        P = block_diag(*(held * self.R for held in s.moves))
        gradient = np.zeros((moves * m, n))
        for k in range(1, N_p + 1):
            weight = self.Q_f if k == N_p else self.Q
            P += H[k].T @ weight @ H[k]
            gradient += H[k].T @ weight @ F[k]

        # Input bounds of every move are hard; the states' bounds are soft.
        rows = np.vstack([constraint.G for constraint in self.state_constraints])
        G = np.vstack([np.kron(np.eye(moves), self._input_limits.G), *(rows @ H[k] for k in s.constraint_stages)])
        slack_of_constraint = _numbered([constraint.slack for constraint in self.state_constraints])
        slack_of_row = np.concatenate(
            [np.full(2 * moves * m, -1), np.tile(slack_of_constraint, len(s.constraint_stages))]
        )
        self._gradient = gradient
        self._free_response = np.vstack([rows @ F[k] for k in s.constraint_stages])
        self._first_stage_of_move = np.concatenate([[0], np.cumsum(s.moves)[:-1]])
        self.qp = ParametricQp(
            (P + P.T) / 2, G, slack_of_row, slack_linear=s.slack_linear, slack_quadratic=s.slack_quadratic
        )

    def bounds(self, error: Array, reference: FlatReference) -> Array:
        """Return h of the QP: of the inputs of every move, then of the states at every constrained stage."""
        stages = list(self.settings.constraint_stages)
        inputs = self._input_limits.h(reference.u[self._first_stage_of_move])
        states = np.concatenate([constraint.h(reference, stages) for constraint in self.state_constraints], axis=1)
        return np.concatenate([inputs.ravel(), states.ravel() - self._free_response @ error])


def _numbered(slacks: list[NDArray[np.int_]]) -> NDArray[np.int_]:
    """Return the slacks of all constraints, each counted from 0, numbered one after the other."""
    first = np.cumsum([0, *(int(own.max()) + 1 for own in slacks)])
    return np.concatenate([own + begin for own, begin in zip(slacks, first, strict=False)])


def state_weight(weights: MpcWeights, layout: StateLayout) -> Array:
    """Q (n, n) of eq:JMPC in the model's coordinates."""
    N = layout.number_of_uavs
    Q = np.zeros((layout.size, layout.size))
    for part, value in (
        (layout.r_0, weights.position), (layout.v_0, weights.velocity),
        (layout.Theta, weights.attitude), (layout.omega, weights.rates),
    ):  # fmt: skip
        Q[part, part] = np.diag(value)
    differential = np.kron(np.eye(N) - np.full((N, N), 1.0 / N), np.eye(2))
    for part, common, different in (
        (layout.s, weights.link_tilt, weights.differential_link_tilt),
        (layout.s_dot, weights.link_rate, weights.differential_link_rate),
    ):
        Q[part, part] = common * np.eye(2 * N) + different * differential
    Q[layout.n, layout.n] = weights.uav_tilt * np.eye(2 * N)
    Q[layout.n_dot, layout.n_dot] = weights.uav_tilt_rate * np.eye(2 * N)
    Q[layout.f, layout.f] = weights.thrust * np.eye(N)
    return Q


def input_weight(weights: MpcWeights, layout: StateLayout) -> Array:
    """R (m, m) of eq:JMPC."""
    N = layout.number_of_uavs
    return np.diag([*[weights.tilt_setpoint] * 2 * N, *[weights.thrust_setpoint] * N])
