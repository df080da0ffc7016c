"""A family of quadratic programs with one H and G and many g and h, some rows softly."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from idc_controller.arrays import Array
from idc_controller.qp.problem import QpSolution, QpSolver, QuadraticProgram
from idc_controller.qp.proxqp_solver import ProxqpSolver


class ParametricQp:
    """min 1/2 x' P x + g' x  subject to  G x <= h, some rows softly.

    Rows of ``G`` (m, n) with ``slack_of_row`` (m,) >= 0 may be exceeded by the slack of that number, at a linear
    and a quadratic cost; -1 marks a hard row. The linear cost is exact: a slack is zero whenever the rows can be kept.

    The unconstrained optimum is one matrix-vector product and is the answer whenever it keeps all rows, so it is
    checked first; the solver is called only when it does not.
    """

    def __init__(
        self,
        P: Array,
        G: Array,
        slack_of_row: NDArray[np.int_],
        *,
        slack_linear: float,
        slack_quadratic: float,
        solver: QpSolver | None = None,
    ) -> None:
        self.P, self.G, self.slack_of_row = P, G, slack_of_row
        self.solver = solver or ProxqpSolver()
        self._optimum = -np.linalg.inv(P)
        n, m = len(P), len(G)
        slacks = int(slack_of_row.max()) + 1 if m else 0
        columns = np.zeros((m, slacks))
        soft = slack_of_row >= 0
        columns[soft, slack_of_row[soft]] = -1.0
        self._rows = np.block([[G, columns], [np.zeros((slacks, n)), -np.eye(slacks)]])
        self._hessian = block_diag(P, slack_quadratic * np.eye(slacks))
        self._slack_gradient = np.full(slacks, slack_linear)
        self._slack_bound = np.zeros(slacks)

    def unconstrained(self, g: Array) -> Array:
        """Return the optimum (n,) without constraints for gradient ``g`` (n,)."""
        return self._optimum @ g

    def problem(self, g: Array, h: Array) -> QuadraticProgram:
        """Return the program with its slacks as variables, for gradient ``g`` (n,) and bounds ``h`` (m,)."""
        return QuadraticProgram(
            self._hessian,
            np.concatenate([g, self._slack_gradient]),
            self._rows,
            np.concatenate([h, self._slack_bound]),
        )

    def solve(self, g: Array, h: Array) -> QpSolution:
        """Return the minimiser, without slacks, for gradient ``g`` (n,) and bounds ``h`` (m,).

        Raises:
            SolverError: the hard rows cannot be kept, or the solver does not converge.
        """
        free = self.unconstrained(g)
        if np.all(self.G @ free <= h):
            return QpSolution(free, 0)
        solution = self.solver.solve(self.problem(g, h))
        return QpSolution(solution.x[: len(g)].copy(), solution.iterations)
