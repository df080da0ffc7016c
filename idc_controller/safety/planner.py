"""The safety QP: the plan nearest to the reference that keeps an exponential barrier to every obstacle.

Decision variables are the knots of the snap of the payload's deviation from the reference. What a plan has to keep is
in :mod:`idc_controller.safety.constraints`; slacks keep the QP feasible and say by how much safety would be missed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are

from idc_controller.arrays import Array
from idc_controller.errors import SolverError
from idc_controller.geometry.formation import Formation
from idc_controller.qp.daqp_solver import DaqpSolver
from idc_controller.qp.problem import QpSolver, QuadraticProgram
from idc_controller.safety.constraints import planner_constraints
from idc_controller.safety.constraints.constraint import Penalty, PlanningStep
from idc_controller.safety.constraints.exponential_barrier import ExponentialBarrier
from idc_controller.safety.constraints.snap_bounds import SnapBounds
from idc_controller.safety.separation import Separation
from idc_controller.safety.settings import PlannerSettings


@dataclass(frozen=True, eq=False)
class Plan:
    """A solution of the safety QP."""

    knots: Array
    """Snap of the deviation (knots, 3)."""
    deviation: Array
    """States of the deviation at all stages (K + 1, 5, 3)."""
    cost: float
    slack: float
    """Largest slack of an obstacle (m)."""


class Planner:
    """Matrices that do not change, and the QP around them."""

    def __init__(self, formation: Formation, settings: PlannerSettings, solver: QpSolver | None = None) -> None:
        self.formation, self.settings = formation, settings
        self.solver = solver or DaqpSolver()
        self.snap_bounds = SnapBounds(settings)
        self.barrier = ExponentialBarrier(formation, settings)
        self.constraints = planner_constraints(self.barrier, settings)
        self.hessians, self.gradients, self._gains, self._constants = _condensed_cost(settings)
        self._hessian = block_diag(*self.hessians)

    def free(self, start: Array) -> Plan:
        """Return the plan back to the reference from a deviation ``start`` (5, 3) with no obstacle near."""
        knots = np.column_stack([-self._gains[axis] @ start[:, axis] for axis in range(3)])
        deviation = self.settings.chain.roll_out(start, knots)
        return Plan(knots, deviation, self.cost(start, knots), 0.0)

    def solve(
        self, start: Array, reference: Array, separations: Sequence[Separation], acceleration: Array
    ) -> Plan | None:
        """Return the plan that keeps to the planes of ``separations``; None: the QP has no solution.

        Args:
            start: position to snap of the deviation now (5, 3).
            reference: position to snap at the stages (5, K + 1, 3), NED, SI.
            separations: of the obstacles that take part.
            acceleration: of the plan before, about which the hull's shear is linear (K + 1, 3).
        """
        chain = self.settings.chain
        step = PlanningStep(reference, chain.response[0] @ start, acceleration, separations)
        problem, slacks = self._problem(start, step)
        try:
            x = self.solver.solve(problem).x
        except SolverError:
            return None
        n = 3 * chain.knots
        z = x[:n].reshape(3, chain.knots).T
        slack, linear, quadratic = x[n:], problem.g[n:], np.diag(problem.H)[n:]
        cost = self.cost(start, z) + float(0.5 * slack @ (quadratic * slack) + linear @ slack)
        missed = x[slacks[self.barrier.penalty]].max(initial=0.0)
        return Plan(z, chain.roll_out(start, z), cost, float(missed))

    def is_within_limits(self, plan: Plan, reference: Array) -> bool:
        """Return whether a plan about ``reference`` (5, K + 1, 3) keeps snap, acceleration and height."""
        z = plan.knots.T.ravel()
        step = PlanningStep(reference, self.settings.chain.response[0] @ plan.deviation[0], reference[2], ())
        lower, upper = self.snap_bounds.bounds(step)
        rows = (constraint.rows(step) for constraint in self.constraints)
        return bool(np.all(z <= upper + 1e-9) and np.all(z >= lower - 1e-9)) and all(
            bool(np.all(G @ z <= h + 1e-9)) for G, h in rows
        )

    def _problem(self, start: Array, step: PlanningStep) -> tuple[QuadraticProgram, dict[Penalty, slice]]:
        """Return the QP in (z, slacks) and where the slacks of each penalty are."""
        knots = self.settings.chain.knots
        blocks = [(c.penalty, *c.rows(step), c.slack_shares(step)) for c in self.constraints]
        slacks: dict[Penalty, slice] = {}
        n, m = 3 * knots, sum(len(h) for _, _, h, _ in blocks)
        for penalty, _, _, shares in blocks:
            if penalty not in slacks:
                slacks[penalty] = slice(n, n := n + shares.shape[1])
        H, g = np.zeros((n, n)), np.zeros(n)
        H[: 3 * knots, : 3 * knots] = self._hessian
        for axis in range(3):
            g[axis * knots : (axis + 1) * knots] = self.gradients[axis] @ start[:, axis]
        for penalty, columns in slacks.items():
            np.fill_diagonal(H[columns, columns], penalty.quadratic)
            g[columns] = penalty.linear
        G, h, row = np.zeros((m, n)), np.zeros(m), 0
        for penalty, G_z, bound, shares in blocks:
            rows = slice(row, row := row + len(bound))
            G[rows, : 3 * knots], G[rows, slacks[penalty]], h[rows] = G_z, -shares, bound
        lower, upper = np.zeros(n), np.full(n, np.inf)
        lower[: 3 * knots], upper[: 3 * knots] = self.snap_bounds.bounds(step)
        return QuadraticProgram(H, g, G, h, lower, upper), slacks

    def cost(self, start: Array, knots: Array) -> float:
        """Return the cost of the deviation from ``start`` (5, 3) under snap ``knots`` (knots, 3), without slacks."""
        total = 0.0
        for axis in range(3):
            z, y = knots[:, axis], start[:, axis]
            total += float(
                0.5 * z @ self.hessians[axis] @ z + (self.gradients[axis] @ y) @ z + 0.5 * y @ self._constants[axis] @ y
            )
        return total


def _condensed_cost(s: PlannerSettings) -> tuple[list[Array], list[Array], list[Array], list[Array]]:
    """Per axis, 1/2 z' H z + (G y)' z + 1/2 y' C y for knots z and start y: H, G, the gain H^-1 G, and C."""
    chain = s.chain
    Phi, Gamma = chain.response
    hessians: list[Array] = []
    gradients: list[Array] = []
    gains: list[Array] = []
    constants: list[Array] = []
    for axis in range(3):
        W = np.diag([s.position[axis], s.velocity[axis], s.acceleration, s.jerk, s.snap[axis]])
        W_f = np.zeros((5, 5))
        W_f[:4, :4] = terminal_weight(chain.period, W)
        steps = (Phi[1:, 4] - Phi[:-1, 4]) / chain.period, (Gamma[1:, 4] - Gamma[:-1, 4]) / chain.period
        H = s.crackle * steps[1].T @ steps[1]
        G = s.crackle * steps[1].T @ steps[0]
        C = s.crackle * steps[0].T @ steps[0]
        for k in range(1, chain.stages + 1):
            weight = W + W_f if k == chain.stages else W
            H = H + Gamma[k].T @ weight @ Gamma[k]
            G = G + Gamma[k].T @ weight @ Phi[k]
            C = C + Phi[k].T @ weight @ Phi[k]
        hessians.append(H)
        gradients.append(G)
        gains.append(np.asarray(np.linalg.solve(H, G), dtype=np.float64))
        constants.append(C)
    return hessians, gradients, gains, constants


def terminal_weight(period: float, W: Array) -> Array:
    """Return the Riccati weight (4, 4) of the chain of position to jerk, driven by a held snap.

    Args:
        period: of a stage (s).
        W: weights of position to snap (5, 5), diagonal.
    """
    factorial = math.factorial
    A = np.array([[period ** (c - r) / factorial(c - r) if c >= r else 0.0 for c in range(4)] for r in range(4)])
    B = np.array([[period ** (4 - r) / factorial(4 - r)] for r in range(4)])
    return np.asarray(solve_discrete_are(A, B, W[:4, :4], W[4:, 4:]))
