"""The linear model predictive controller (eq:J_MPC with eq:inpCon and eq:stateCon), corrected and condensed.

Corrections to the printed form: inputs are set-points with the attitude loop and the motor lag in the model; errors are
taken about the exact flat reference; the model is minimal, so the Riccati equation has a solution; states are
constrained at stages 1 .. N_p (stage 0 cannot be changed) and softly, so that no state makes the programme infeasible.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, solve_discrete_are

from idc_controller.control.force_components import inputs_in_force_components
from idc_controller.control.qp import ParametricQp
from idc_controller.control.tracker import TrackingOutput
from idc_controller.errors import ParameterError, SolverError
from idc_controller.model.linear import LinearModel, StateLayout
from idc_controller.trajectory.flatness import FlatReference

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MpcWeights:
    """Diagonal of the cost, a unit of squared error each; lists are x, y, z or roll, pitch, yaw."""

    position: tuple[float, float, float] = (60.0, 60.0, 80.0)
    velocity: tuple[float, float, float] = (20.0, 20.0, 20.0)
    attitude: tuple[float, float, float] = (300.0, 300.0, 800.0)
    rates: tuple[float, float, float] = (40.0, 40.0, 120.0)
    link_tilt: float = 100.0
    link_rate: float = 30.0
    differential_link_tilt: float = 200.0
    """On each link's tilt less the mean of all: keeps the UAVs apart."""
    differential_link_rate: float = 50.0
    uav_tilt: float = 1.0
    uav_tilt_rate: float = 0.02
    thrust: float = 0.002
    tilt_setpoint: float = 8.0
    thrust_setpoint: float = 0.02


@dataclass(frozen=True)
class MpcSettings:
    """Horizon, limits and weights of the controller. Angles in rad."""

    period: float = 0.05
    """Control period (s)."""
    horizon: int = 20
    """Stages N_p."""
    moves: tuple[int, ...] = (1, 1, 1, 2, 2, 3, 4, 6)
    """Stages over which each move is held; they sum to the horizon."""
    constraint_stages: tuple[int, ...] = (1, 4, 7, 10, 13, 16, 19)
    """Stages at which states are constrained."""
    payload_tilt_limit: float = float(np.radians(5.0))
    uav_tilt_limit: float = float(np.radians(35.0))
    thrust_min: float = 1.0
    """Least thrust of a UAV (N)."""
    lowest_payload: float = -0.25
    """Greatest z of the payload's centre (m, NED): it stands on the ground."""
    uav_separation: float = 0.77
    """Least distance between neighbouring UAVs (m)."""
    slack_linear: float = 1e3
    slack_quadratic: float = 1e4
    weights: MpcWeights = field(default_factory=MpcWeights)

    def __post_init__(self) -> None:
        if sum(self.moves) != self.horizon or min(self.moves) < 1:
            raise ParameterError(f"moves {self.moves} do not sum to the horizon of {self.horizon} stages")
        if not all(1 <= k <= self.horizon for k in self.constraint_stages):
            raise ParameterError(f"constraint stages {self.constraint_stages} leave 1 .. {self.horizon}")


class ModelPredictiveController:
    """Tracks a flat reference. Time-invariant matrices are built once; a step is a gradient and a programme."""

    def __init__(self, model: LinearModel, settings: MpcSettings) -> None:
        self.settings = settings
        self.parameters = model.parameters
        self.layout = model.layout
        self.A, self.B, _ = model.discretised(round(settings.period * 1e6))
        self.Q = state_weight(settings.weights, self.layout)
        self.R = input_weight(settings.weights, self.layout)
        self.Q_f = solve_discrete_are(self.A, self.B, self.Q, self.R)
        self._condense(model)

    def track(self, error: Array, reference: FlatReference) -> TrackingOutput:
        """Optimal first move for ``error`` (12 + 11 N,) in force components about ``reference``.

        ``reference`` holds the stages 0 .. N_p. When the programme cannot be solved the unconstrained move, cut to the
        input limits, is taken and the step is marked infeasible.
        """
        g = self._gradient @ error
        h = self._bounds(error, reference)
        m = self.layout.inputs
        try:
            solution = self._qp.solve(g, h)
        except SolverError:
            first_move = self._qp.unconstrained(g)[:m]
            return TrackingOutput(np.clip(first_move, -h[m : 2 * m], h[:m]), infeasible=True)
        return TrackingOutput(solution.x[:m], solution.iterations)

    def _condense(self, model: LinearModel) -> None:
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

        # Input bounds of every move, both ways, are hard; the states' bounds are soft.
        rows, self._room, slack_of_constraint = self._constrained_rows(model)
        both_ways = np.vstack([np.eye(m), -np.eye(m)])
        G = np.vstack([np.kron(np.eye(moves), both_ways), *(rows @ H[k] for k in s.constraint_stages)])
        slack_of_row = np.concatenate(
            [np.full(2 * moves * m, -1), np.tile(slack_of_constraint, len(s.constraint_stages))]
        )
        self._gradient = gradient
        self._free_response = np.vstack([rows @ F[k] for k in s.constraint_stages])
        self._first_stage_of_move = np.concatenate([[0], np.cumsum(s.moves)[:-1]])
        self._qp = ParametricQp(
            (P + P.T) / 2, G, slack_of_row, slack_linear=s.slack_linear, slack_quadratic=s.slack_quadratic
        )

    def _constrained_rows(self, model: LinearModel) -> tuple[Array, Array, Array]:
        """Rows (c, n) on the error, their bounds (c,) on the reference, and the slack of each.

        Roll, pitch and yaw both ways; the payload's height; the distance between neighbouring UAVs. On the reference
        the payload is level and the links are parallel; the height's bound moves with it and is set at each step.
        """
        s, layout, p = self.settings, self.layout, self.parameters
        rows, room, slack = [], [], []
        for axis in range(3):
            for sign in (1.0, -1.0):
                row = np.zeros(layout.size)
                row[layout.Theta.start + axis] = sign
                rows.append(row)
                room.append(s.payload_tilt_limit)
                slack.append(axis)
        height = np.zeros(layout.size)
        height[layout.r_0.start + 2] = 1.0
        rows.append(height)
        room.append(np.nan)
        slack.append(3)
        self._height_row = len(rows) - 1
        hover = p.p - np.outer(p.l, [0.0, 0.0, 1.0])
        C = model.uav_position_rows
        apart = {(i, j): hover[i] - hover[j] for i in range(len(hover)) for j in range(i)}
        nearest = min(float(np.linalg.norm(d)) for d in apart.values())
        for (i, j), d in apart.items():
            distance = float(np.linalg.norm(d))
            if distance < 1.3 * nearest:
                rows.append(-(d / distance) @ (C[3 * i : 3 * i + 3] - C[3 * j : 3 * j + 3]))
                room.append(max(distance - s.uav_separation, 0.0))
                slack.append(4)
        return np.array(rows), np.array(room), np.array(slack)

    def _bounds(self, error: Array, reference: FlatReference) -> Array:
        s, N = self.settings, self.layout.number_of_uavs
        stages = list(s.constraint_stages)
        first = self._first_stage_of_move
        u = inputs_in_force_components(reference.u[first], self.layout, self.parameters.hover_thrust)
        tilt = np.full(2 * N, np.tan(s.uav_tilt_limit))
        upper = np.concatenate([tilt, np.full(N, 0.95 * self.parameters.thrust_max)])
        lower = np.concatenate([-tilt, np.full(N, s.thrust_min)])
        inputs = np.stack([upper - u, u - lower], axis=1).ravel()
        states = np.tile(self._room, (len(stages), 1))
        states[:, self._height_row] = s.lowest_payload - reference.payload[0, stages, 2]
        return np.concatenate([inputs, states.ravel() - self._free_response @ error])


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
