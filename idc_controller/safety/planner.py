"""The safety QP: the plan nearest to the reference that keeps an exponential barrier to every obstacle.

Decision variables are the knots of the snap of the payload's deviation from the reference. What a plan has to keep is
in :mod:`idc_controller.safety.constraints`; slacks keep the QP feasible and say by how much safety would be missed.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are
from scipy.optimize import linprog

from idc_controller.arrays import Array, Mask
from idc_controller.errors import SolverError
from idc_controller.geometry.formation import Formation
from idc_controller.qp.daqp_solver import DaqpSolver
from idc_controller.qp.problem import QpSolver, QuadraticProgram
from idc_controller.safety.constraints import planner_constraints
from idc_controller.safety.constraints.acceleration_bounds import AccelerationBounds
from idc_controller.safety.constraints.constraint import Constraint, Penalty, PlanningStep
from idc_controller.safety.constraints.exponential_barrier import ExponentialBarrier
from idc_controller.safety.constraints.pop_bounds import PopBounds
from idc_controller.safety.separation import Separation
from idc_controller.safety.settings import PlannerSettings

STEADY = np.zeros(3)
"""The crackle of a plan whose snap does not change."""


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
    standing_slack: float = 0.0
    """Largest slack of an obstacle that stands (m)."""


class Planner:
    """Matrices that do not change, and the QP around them."""

    def __init__(self, formation: Formation, settings: PlannerSettings, solver: QpSolver | None = None) -> None:
        self.formation, self.settings = formation, settings
        self.solver = solver or DaqpSolver()
        self.barrier = ExponentialBarrier(formation, settings)
        self.constraints = planner_constraints(self.barrier, settings)
        self.cost = _condensed_cost(settings)
        self._layout: tuple[int, _Layout] | None = None
        """That of the last QP, with its number of obstacles."""

    def free(self, start: Array) -> Plan:
        """Return the plan back to the reference from a deviation ``start`` (5, 3) with no obstacle near."""
        z = -self.cost.gain @ start.T.ravel()
        knots = z.reshape(3, -1).T
        return Plan(knots, self.settings.chain.roll_out(start, knots), self.cost.of(start, z), 0.0)

    def nearest_rest(self, state: Array) -> Array:
        """Return the place (3,) (m) where motion from ``state`` (5, 3), position to snap, ends for the least cost."""
        to_rest = np.vstack([np.zeros((1, 3)), state[1:]])
        return np.asarray(state[0] + self.cost.cheapest_offset(to_rest))

    def solve(
        self,
        start: Array,
        reference: Array,
        separations: Sequence[Separation],
        acceleration: Array,
        crackle: Array = STEADY,
    ) -> Plan | None:
        """Return the plan that keeps to the planes of ``separations``; None: the QP has no solution.

        Args:
            start: position to snap of the deviation now (5, 3).
            reference: position to snap at the stages (5, K + 1, 3), NED, SI.
            separations: of the obstacles that take part.
            acceleration: of the plan before, about which the hull's shear is linear (K + 1, 3).
            crackle: of the plan in force until now (3,).
        """
        chain = self.settings.chain
        snap = reference[4, 0] + start[4]
        step = PlanningStep(reference, chain.response[0] @ start, acceleration, separations, snap, crackle)
        layout = self._layout_of(len(separations))
        problem = self._problem(start, step, layout)
        try:
            x = self.solver.solve(problem).x
        except SolverError:
            return None
        n = 3 * chain.knots
        slack = x[n:]
        penalty = float(0.5 * slack @ (layout.quadratic * slack) + layout.linear @ slack)
        missed = x[layout.slacks[self.barrier.penalty]].reshape(-1, 2).max(axis=1, initial=0.0)
        stands = np.array([separation.obstacle.stands for separation in separations], dtype=bool)
        knots = x[:n].reshape(3, chain.knots).T
        return Plan(
            knots,
            chain.roll_out(start, knots),
            self.cost.of(start, x[:n]) + penalty,
            float(missed.max(initial=0.0)),
            float(missed[stands].max(initial=0.0)),
        )

    def is_within_limits(self, plan: Plan, reference: Array, crackle: Array = STEADY) -> bool:
        """Return whether a plan about ``reference`` (5, K + 1, 3) keeps pop, snap, acceleration and height.

        ``crackle`` of the plan in force until now (3,).
        """
        z, start = plan.knots.T.ravel(), plan.deviation[0]
        free, snap = self.settings.chain.response[0] @ start, reference[4, 0] + start[4]
        step = PlanningStep(reference, free, reference[2], (), snap, crackle)
        lower, upper = snap_bounds(self.settings, step.reference)
        rows = (constraint.rows(step) for constraint in self.constraints)
        return bool(np.all(z <= upper + 1e-9) and np.all(z >= lower - 1e-9)) and all(
            bool(np.all(G @ z <= h + 1e-9)) for G, h in rows
        )

    def _layout_of(self, obstacles: int) -> _Layout:
        """Return the layout of a QP with that number of obstacles; it is kept until the number changes."""
        if self._layout is None or self._layout[0] != obstacles:
            self._layout = obstacles, _Layout.of(self.constraints, self.cost.H, obstacles)
        return self._layout[1]

    def _problem(self, start: Array, step: PlanningStep, layout: _Layout) -> QuadraticProgram:
        """Return the QP in (z, slacks)."""
        n = 3 * self.settings.chain.knots
        G, bounds, row = layout.G.copy(), [], 0
        for constraint in self.constraints:
            rows, h = constraint.rows(step)
            G[row : row + len(h), :n] = rows
            bounds.append(h)
            row += len(h)
        g = np.concatenate([self.cost.G @ start.T.ravel(), layout.linear])
        least, most = snap_bounds(self.settings, step.reference)
        lower, upper = np.concatenate([least, layout.least]), np.concatenate([most, layout.most])
        return QuadraticProgram(layout.H, g, G, np.concatenate(bounds), lower, upper, lazy=layout.lazy)


@dataclass(frozen=True, eq=False)
class _Layout:
    """The part of the QP in (z, slacks) that depends on the number of obstacles only."""

    H: Array
    """(n, n)"""
    G: Array
    """Rows of all constraints, with the shares of the slacks and no z (m, n)."""
    lazy: Mask
    """Rows of constraints that are lazy (m,)."""
    linear: Array
    quadratic: Array
    """Costs of the slacks (n - 3 knots,)."""
    least: Array
    most: Array
    """Bounds of the slacks."""
    slacks: Mapping[Penalty, slice]
    """Where the slacks of each penalty are."""

    @classmethod
    def of(cls, constraints: Sequence[Constraint], H: Array, obstacles: int) -> Self:
        """Return a new layout for ``constraints`` and the Hessian ``H`` (3 knots, 3 knots) of z."""
        shares = [(constraint.penalty, constraint.slack_shares(obstacles)) for constraint in constraints]
        slacks: dict[Penalty, slice] = {}
        n = len(H)
        for penalty, share in shares:
            if penalty not in slacks:
                slacks[penalty] = slice(n, n := n + share.shape[0] * share.shape[2])
        counts = [share.shape[0] * share.shape[1] for _, share in shares]
        lazy = np.repeat([constraint.is_lazy for constraint in constraints], counts)
        G, row = np.zeros((sum(counts), n)), 0
        for penalty, share in shares:
            column = slacks[penalty].start
            for block in -share:
                G[row : row + len(block), column : column + block.shape[1]] = block
                row, column = row + len(block), column + block.shape[1]
        number = [columns.stop - columns.start for columns in slacks.values()]
        linear = np.repeat([penalty.linear for penalty in slacks], number)
        quadratic = np.repeat([penalty.quadratic for penalty in slacks], number)
        whole = np.diag(np.concatenate([np.zeros(len(H)), quadratic]))
        whole[: len(H), : len(H)] = H
        return cls(
            whole, G, lazy, linear, quadratic,
            np.zeros(n - len(H)), np.full(n - len(H), np.inf), slacks,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class DeviationCost:
    """Cost of the deviation, 1/2 z' H z + (G y)' z + 1/2 y' C y for knots z and start y, both axis by axis."""

    H: Array
    """(3 knots, 3 knots)"""
    G: Array
    """(3 knots, 15)"""
    C: Array
    """(15, 15)"""
    gain: Array
    """H^-1 G (3 knots, 15): the optimum without constraints is -gain y."""

    def cheapest_offset(self, start: Array) -> Array:
        """Return the offset (3,) (m) of the target for which the way there from ``start`` (5, 3) costs least."""
        P = self.C - self.G.T @ self.gain  # of the cost of a start, without constraints
        position = slice(0, None, 5)
        rest = P @ start.T.ravel()
        return np.asarray(np.linalg.solve(P[position, position], rest[position]))

    def of(self, start: Array, z: Array) -> float:
        """Return the cost of a deviation from ``start`` (5, 3) under ``z`` (3 knots,)."""
        y = start.T.ravel()
        return float(0.5 * z @ self.H @ z + (self.G @ y) @ z + 0.5 * y @ self.C @ y)


def _condensed_cost(s: PlannerSettings) -> DeviationCost:
    """Return the cost over all stages, condensed to the knots."""
    chain = s.chain
    Phi, Gamma = chain.response
    parts: list[tuple[Array, Array, Array, Array]] = []
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
        parts.append((H, G, C, np.asarray(np.linalg.solve(H, G))))
    return DeviationCost(*(block_diag(*blocks) for blocks in zip(*parts, strict=True)))


def snap_bounds(settings: PlannerSettings, reference: Array) -> tuple[Array, Array]:
    """Return the lower and the upper bound of z (3 knots,) (m/s4): hard, being of the QP's variables themselves.

    The snap limit less the snap of the ``reference`` (5, K + 1, 3), which is always allowed.
    """
    snap = reference[4, np.cumsum(settings.blocks)]
    limit = np.maximum(settings.snap_limit, np.abs(snap).max(axis=0) + settings.snap_spare)
    return (-limit - snap).T.ravel(), (limit - snap).T.ravel()


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


_HARD = Penalty(0.0, 0.0)
_ASIDE = 1
"""The axis along which it moves aside: level, where acceleration and snap are limited most."""


def give_way_time(settings: PlannerSettings, distance: float) -> float:
    """Return the time (s) in which a plan from steady motion is a ``distance`` (m) aside of it, at the earliest.

    The farthest place at a stage is the solution of a linear programme: the limits of acceleration, snap and pop of
    the safety QP, kept without slack, on the snap at its knots. Between stages the place is linear, beyond the horizon
    at the mean speed until then.
    """
    chain = settings.chain
    count = chain.stages + 1
    steady = np.zeros((5, count, 3))
    step = PlanningStep(steady, np.zeros((count, 5, 3)), steady[2], (), np.zeros(3), np.zeros(3))
    rows = [bounds(settings, _HARD).rows(step) for bounds in (AccelerationBounds, PopBounds)]
    G, h = np.vstack([G for G, _ in rows]), np.concatenate([h for _, h in rows])
    limits = np.column_stack(snap_bounds(settings, steady))

    def farthest(k: int) -> float:
        aside = np.zeros((3, chain.knots))
        aside[_ASIDE] = chain.response[1][k, 0]
        return -float(linprog(-aside.ravel(), A_ub=G, b_ub=h, bounds=limits).fun)

    last = farthest(count - 1)
    if last < distance:
        return float(chain.times[-1] * distance / last)
    k = bisect_left(range(count), distance, key=farthest)
    before = farthest(k - 1)
    return float(chain.times[k - 1] + chain.period * (distance - before) / (farthest(k) - before))
