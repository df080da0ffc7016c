"""The linear model predictive controller (eq:J_MPC with eq:inpCon and eq:stateCon), corrected and condensed.

Corrections to the printed form: inputs are set-points with the attitude loop and the motor lag in the model; errors are
taken about the exact flat reference; the model is minimal, so the Riccati equation has a solution; states are
constrained at stages 1 .. N_p (stage 0 cannot be changed) and softly, so that no state makes the QP infeasible.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, solve_discrete_are

from idc_controller.arrays import Array
from idc_controller.control.constraints import state_constraints
from idc_controller.control.constraints.input_limits import InputLimits
from idc_controller.control.settings import MpcSettings, MpcWeights
from idc_controller.errors import SolverError
from idc_controller.model.linear import LinearModel, StateLayout
from idc_controller.qp.parametric import ParametricQp
from idc_controller.trajectory.flatness import FlatReference


class TrackingOutput(NamedTuple):
    """Set-points of a tracker, and how they came about."""

    delta_u: Array
    """Set-points less the reference's, in force components (3 N,): :mod:`idc_controller.control.force_kernels`."""
    iterations: int = 0
    """Solver iterations; 0 when no constraint was active."""
    infeasible: bool = False
    """The constraints could not be met and a fall-back was taken."""


class Tracker(Protocol):
    """Turns the error about a reference into set-points."""

    horizon: int
    """Number N_p of the last stage of the reference that it needs."""

    def track(self, error: Array, reference: FlatReference, age: float) -> TrackingOutput:
        """``error`` (12 + 11 N,) now, ``reference`` over the horizon's stages 0 .. N_p.

        ``age`` of the newest measurement that the error follows from, when the set-points act (s).
        """
        ...


BLOCKS = (1, 1, 1, 2, 2, 3, 4, 6)
"""Stages over which each move is held, as far as the horizon reaches; beyond them the last goes on."""


def move_blocks(horizon: int) -> tuple[int, ...]:
    """Return blocks that sum to ``horizon`` stages: single stages first, then longer and longer ones."""
    blocks: list[int] = []
    while (rest := horizon - sum(blocks)) > 0:
        blocks.append(min(BLOCKS[min(len(blocks), len(BLOCKS) - 1)], rest))
    return tuple(blocks)


class CondensedPrediction:
    """Time-invariant matrices of e_k+1 = A e_k + B v for moves v that are held over ``blocks`` of stages."""

    def __init__(self, A: Array, B: Array, blocks: Sequence[int]) -> None:
        self.A, self.B, self.blocks = A, B, tuple(blocks)
        (n, m), stages, moves = B.shape, sum(blocks), len(blocks)
        move_of_stage = np.repeat(np.arange(moves), blocks)
        self.first_stages = np.array([sum(blocks[:i]) for i in range(moves)])
        """Stage at which each move begins."""
        self.F = np.zeros((stages + 1, n, n))
        """(N_p + 1, n, n)"""
        self.H = np.zeros((stages + 1, n, moves * m))
        """(N_p + 1, n, moves m)"""
        self.F[0] = np.eye(n)
        for k, move in enumerate(move_of_stage):
            self.F[k + 1], self.H[k + 1] = A @ self.F[k], A @ self.H[k]
            self.H[k + 1][:, move * m : (move + 1) * m] += B

    def hessian(self, Q: Array, R: Array, Q_f: Array) -> Array:
        """Return the cost's Hessian (moves m, moves m) for weights of the errors, the moves and the last error."""
        P = block_diag(*(held * R for held in self.blocks))
        for H, weight in self._weighted(Q, Q_f):
            P += H.T @ weight @ H
        return np.asarray((P + P.T) / 2.0)

    def gradients(self, Q: Array, Q_f: Array) -> list[Array]:
        """Return, of stages 1 .. N_p, the gradient (moves m, n) of the cost by the error that no move would leave."""
        return [H.T @ weight for H, weight in self._weighted(Q, Q_f)]

    def _weighted(self, Q: Array, Q_f: Array) -> list[tuple[Array, Array]]:
        return [(H, Q_f if k == len(self.H) - 1 else Q) for k, H in enumerate(self.H) if k]


class ModelPredictiveController:
    """Tracks a flat reference. Time-invariant matrices are built once; a step is a QP for the error."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self.settings, self.layout = settings, model.layout
        self.horizon = N_p = settings.tuning.horizon
        blocks = move_blocks(N_p)
        A, B, _ = model.discretised(round(settings.period * 1e6))
        self.prediction = prediction = CondensedPrediction(A, B, blocks)
        Q, R = state_weight(settings.tuning.weights, self.layout), input_weight(settings.tuning.weights, self.layout)
        Q_f = solve_discrete_are(A, B, Q, R)
        F, H = prediction.F, prediction.H
        gradient = sum(
            (gradient @ F_k for gradient, F_k in zip(prediction.gradients(Q, Q_f), F[1:], strict=True)),
            np.zeros((H.shape[2], len(A))),
        )
        # Input bounds of every move are hard; the states' bounds are soft.
        self._input_limits, self.state_constraints = InputLimits(model, settings), state_constraints(model, settings)
        rows = np.vstack([constraint.G for constraint in self.state_constraints])
        self._stages = stages = np.array(settings.constraint_stages)
        G = np.vstack([np.kron(np.eye(len(blocks)), self._input_limits.G), *(rows @ H[k] for k in stages)])
        limits = np.concatenate([constraint.limits for constraint in self.state_constraints])
        self._bounds = np.concatenate([np.zeros(2 * H.shape[2]), np.tile(limits, len(stages))])
        ends = np.cumsum([len(constraint.limits) for constraint in self.state_constraints]).tolist()
        self._columns = [slice(*of) for of in pairwise([0, *ends])]
        slack_of_constraint = _numbered([constraint.slack for constraint in self.state_constraints])
        slack_of_row = np.concatenate([np.full(2 * H.shape[2], -1), np.tile(slack_of_constraint, len(stages))])
        response = np.vstack([np.zeros((2 * H.shape[2], len(A))), *(rows @ F[k] for k in stages)])
        self.qp = ParametricQp(
            prediction.hessian(Q, R, Q_f), G, slack_of_row,
            slack_linear=settings.slack_linear, slack_quadratic=settings.slack_quadratic,
            gradient=gradient, response=response,
        )  # fmt: skip

    def track(self, error: Array, reference: FlatReference) -> TrackingOutput:
        """Optimal first move for ``error`` (12 + 11 N,) in force components about ``reference``.

        ``reference`` holds the stages 0 .. N_p. When the QP cannot be solved the unconstrained move, cut to the
        input limits, is taken and the step is marked infeasible.
        """
        h = self.bounds(reference)
        m = self.layout.inputs
        try:
            solution = self.qp.solve(error, h)
        except SolverError:
            first_move = self.qp.unconstrained(error)[:m]
            return TrackingOutput(np.clip(first_move, -h[m : 2 * m], h[:m]), infeasible=True)
        return TrackingOutput(solution.x[:m], solution.iterations)

    def bounds(self, reference: FlatReference) -> Array:
        """Return h of the QP: of the inputs of every move, then of the states at every constrained stage."""
        h = self._bounds.copy()
        self._input_limits.fill(h, reference.u, self.prediction.first_stages)
        states = h[2 * self.prediction.H.shape[2] :].reshape(len(self._stages), -1)
        for constraint, columns in zip(self.state_constraints, self._columns, strict=True):
            used = constraint.used(reference, self._stages)
            if used is not None:
                states[:, columns] -= used
        return h


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
