"""The paper's tracking controller (eq:J_MPC): a linear MPC with thrust and torque as inputs, 20 steps of 0.05 s.

It is built on the minimal state, since on the paper's own the Riccati equation for Q_f has no stabilising solution.
State constraints hold from stage 1 on and softly: stage 0, which the paper constrains, is what it is. A step whose
printed QP would have had no solution is marked. The paper gives no weights; it says that position and attitude
of the payload weigh most, links and UAVs a little less, and yaw much.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_discrete_are

from idc_controller.arrays import Array
from idc_controller.control.mpc import CondensedPrediction
from idc_controller.errors import SolverError
from idc_controller.model.linear import discretised
from idc_controller.paper.state_space import Layout, minimal
from idc_controller.parameters import SystemParameters
from idc_controller.qp.parametric import ParametricQp

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Weights:
    """Diagonal of Q and R, a unit of squared error each."""

    position: Triple = (60.0, 60.0, 80.0)
    velocity: Triple = (20.0, 20.0, 20.0)
    attitude: Triple = (300.0, 300.0, 800.0)
    rates: Triple = (40.0, 40.0, 120.0)
    link: float = 30.0
    link_rate: float = 20.0
    uav_attitude: Triple = (5.0, 5.0, 100.0)
    uav_rates: Triple = (0.5, 0.5, 10.0)
    thrust: float = 0.02
    torque: float = 5.0

    @classmethod
    def of_named_outputs(cls) -> Weights:
        """Return weights on what the paper's y' names: position, attitudes and links, but no rates."""
        none = (0.0, 0.0, 0.0)
        return replace(cls(), velocity=none, rates=none, link_rate=0.0, uav_rates=none)

    def state(self, number_of_uavs: int) -> Array:
        """Q (12 + 10 N squared)."""
        uav = [*[self.link] * 2, *[self.link_rate] * 2, *self.uav_attitude, *self.uav_rates]
        return np.diag([*self.position, *self.velocity, *self.attitude, *self.rates, *uav * number_of_uavs])

    def inputs(self, number_of_uavs: int) -> Array:
        """R (4 N squared)."""
        return np.diag([self.thrust, *[self.torque] * 3] * number_of_uavs)


@dataclass(frozen=True)
class Settings:
    """Settings of the paper where it states them; it does not state its input bounds."""

    period: float = 0.05
    horizon: int = 20
    tilt_limit: float = float(np.radians(5.0))
    """Limit of the payload's roll, pitch and yaw (rad), eq:consOsc."""
    thrust_bounds: tuple[float, float] = (0.0, 30.0)
    torque_bound: float = 2.0
    """N m, in both directions."""
    weights: Weights = Weights()
    terminal_outputs_alone: bool = False
    """True: Q_f weights only the outputs y of the paper's terminal cost."""


@dataclass(frozen=True, eq=False)
class Move:
    """The first input ``delta_u`` (4 N,) from the reference's, and the outcome of the QP."""

    delta_u: Array
    infeasible_as_printed: bool
    failed: bool


class ThrustTorqueMpc:
    """Condensed; :meth:`solve` once a period."""

    def __init__(self, parameters: SystemParameters, settings: Settings | None = None) -> None:
        s = self.settings = settings or Settings()
        N = parameters.number_of_uavs
        self.layout = Layout.minimal(N)
        A, B = discretised(*minimal(parameters), s.period)
        Q, R = s.weights.state(N), s.weights.inputs(N)
        Q_f = solve_discrete_are(A, B, Q, R)
        if s.terminal_outputs_alone:
            named = np.diag(Q) > 0.0
            Q_f = Q_f * np.outer(named, named)
        n, m, N_p = self.layout.size, 4 * N, s.horizon
        self.prediction = prediction = CondensedPrediction(A, B, (1,) * N_p)
        self.F, H = prediction.F, prediction.H
        self._gradient = np.concatenate(prediction.gradients(Q, Q_f), axis=1)
        rows = np.zeros((7, n))
        rows[np.arange(6), self.layout.payload("Theta_0").start + np.repeat(np.arange(3), 2)] = np.tile([1.0, -1.0], 3)
        rows[6, 2] = 1.0  # z of the payload cannot be positive
        self._rows = rows
        G = np.vstack([np.eye(N_p * m), -np.eye(N_p * m), *(rows @ H[k] for k in range(1, N_p + 1))])
        slack = np.concatenate([np.full(2 * N_p * m, -1), np.tile([0, 0, 1, 1, 2, 2, 3], N_p)])
        self._qp = ParametricQp(prediction.hessian(Q, R, Q_f), G, slack, slack_linear=1e4, slack_quadratic=1e5)
        bound = np.array([s.thrust_bounds[1], *[s.torque_bound] * 3] * N)
        self.upper, self.lower = bound, np.where(np.arange(m) % 4 == 0, s.thrust_bounds[0], -bound)
        self._m = m

    def solve(self, free: Array, state: Array, u_reference: Array) -> Move:
        """The first move.

        ``free`` (N_p + 1, n): predicted error of every stage if the inputs were ``u_reference`` (N_p, 4 N), absolute.
        ``state`` (N_p + 1, n): the state then, in deviations from hover, on which the constraints are.
        """
        gradient = self._gradient @ free[1:].ravel()
        bounds = np.array([self.settings.tilt_limit] * 6 + [0.0]) - state @ self._rows.T
        upper, lower = self.upper - u_reference, u_reference - self.lower
        h = np.concatenate([upper.ravel(), lower.ravel(), bounds[1:].ravel()])
        beyond_now = bool(np.any(bounds[0] < -1e-9))
        try:
            moves = self._qp.solve(gradient, h).x
        except SolverError:
            moves = self._qp.unconstrained(gradient)
            return Move(np.clip(moves[: self._m], -lower[0], upper[0]), True, True)
        later = self._qp.G[2 * len(moves) :] @ moves - h[2 * len(moves) :]
        # The printed stages are 0 .. N_p - 1.
        return Move(moves[: self._m], beyond_now or bool(np.any(later[: -len(self._rows)] > 1e-4)), False)
