"""A family of quadratic programs with one H and G, whose g and h follow from few parameters; some rows softly."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from idc_controller.arrays import Array, Indices
from idc_controller.qp.parametric_kernels import optimum_and_rows
from idc_controller.qp.problem import QpSolution, QpSolver, QuadraticProgram
from idc_controller.qp.proxqp_solver import ProxqpSolver


class ParametricQp:
    """min 1/2 x' P x + (K p)' x  subject to  G x + E p <= h, some rows softly, for many parameters p (q,) and h (m,).

    Rows of ``G`` (m, n) with ``slack_of_row`` (m,) >= 0 may be exceeded by the slack of that number, at a linear
    and a quadratic cost; -1 marks a hard row. The linear cost is exact: a slack is zero whenever the rows can be kept.

    The unconstrained optimum and what it makes of the rows are one product with p. It is the answer whenever it keeps
    all rows, so it is checked first; the solver is called only when it does not.
    """

    def __init__(
        self,
        P: Array,
        G: Array,
        slack_of_row: NDArray[np.int_],
        *,
        slack_linear: float,
        slack_quadratic: float,
        gradient: Array | None = None,
        response: Array | None = None,
        solver: QpSolver | None = None,
    ) -> None:
        """``gradient``: K (n, q), and ``response``: E (m, q); None: p is the gradient itself."""
        self.P, self.G, self.slack_of_row = P, G, slack_of_row
        self.solver = solver or ProxqpSolver()
        n, m = len(P), len(G)
        self._gradient = np.eye(n) if gradient is None else gradient
        self._response = np.zeros((m, n)) if response is None else response
        self._optimum = -np.linalg.inv(P) @ self._gradient
        rows_at_optimum = G @ self._optimum + self._response
        self._products = _distinct_up_to_sign(np.vstack([self._optimum, rows_at_optimum]))
        slacks = int(slack_of_row.max()) + 1 if m else 0
        columns = np.zeros((m, slacks))
        soft = slack_of_row >= 0
        columns[soft, slack_of_row[soft]] = -1.0
        self._rows = np.block([[G, columns], [np.zeros((slacks, n)), -np.eye(slacks)]])
        self._hessian = block_diag(P, slack_quadratic * np.eye(slacks))
        self._slack_gradient = np.full(slacks, slack_linear)
        self._slack_bound = np.zeros(slacks)

    def unconstrained(self, p: Array) -> Array:
        """Return the optimum (n,) without constraints for parameters ``p`` (q,)."""
        return self._optimum @ p

    def problem(self, p: Array, h: Array) -> QuadraticProgram:
        """Return the program with its slacks as variables, for parameters ``p`` (q,) and bounds ``h`` (m,)."""
        return QuadraticProgram(
            self._hessian,
            np.concatenate([self._gradient @ p, self._slack_gradient]),
            self._rows,
            np.concatenate([h - self._response @ p, self._slack_bound]),
        )

    def solve(self, p: Array, h: Array) -> QpSolution:
        """Return the minimiser, without slacks, for parameters ``p`` (q,) and bounds ``h`` (m,).

        Raises:
            SolverError: the hard rows cannot be kept, or the solver does not converge.
        """
        is_kept, optimum = optimum_and_rows(p, *self._products, h)
        if is_kept:
            return QpSolution(optimum, 0)
        solution = self.solver.solve(self.problem(p, h))
        return QpSolution(solution.x[: len(self.P)].copy(), solution.iterations)


def _distinct_up_to_sign(rows: Array) -> tuple[Array, Indices, Array]:
    """Return distinct rows as columns (q, D), and which of them each row is (R,), with which sign (R,)."""
    seen: dict[bytes, int] = {}
    which, sign = np.empty(len(rows), dtype=int), np.ones(len(rows))
    for r, row in enumerate(rows):
        key, opposite = (row + 0.0).tobytes(), (0.0 - row).tobytes()  # no zero has a sign
        if opposite in seen and key not in seen:
            sign[r], key = -1.0, opposite
        which[r] = seen.setdefault(key, len(seen))
    distinct = np.array([np.frombuffer(key) for key in seen]).reshape(len(seen), rows.shape[1])
    return np.ascontiguousarray(distinct.T), which, sign
