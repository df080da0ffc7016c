"""Quadratic programmes that differ only in gradient and bounds from step to step, solved by ProxQP."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from proxsuite import proxqp
from scipy.linalg import block_diag

from idc_controller.errors import SolverError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class QpSolution:
    """A minimiser (n,), without slacks, and the solver's iterations (0: no constraint is active)."""

    x: Array
    iterations: int


class ParametricQp:
    """min 1/2 x' P x + g' x  subject to  G x <= h, some rows softly, for one P, G and many g, h.

    Rows of ``G`` (m, n) with ``slack_of_row`` (m,) >= 0 may be exceeded by the slack of that number, at a linear
    and a quadratic cost; -1 marks a hard row. The linear cost is exact: a slack is zero whenever the rows can be kept.

    The unconstrained optimum is one matrix-vector product and is the answer whenever it keeps all rows, so it is
    checked first; ProxQP, warm-started, is called only when it does not.
    """

    def __init__(
        self,
        P: Array,
        G: Array,
        slack_of_row: Array,
        *,
        slack_linear: float,
        slack_quadratic: float,
        tolerance: float = 1e-6,
        iterations: int = 200,
    ) -> None:
        self.G, self.slack_of_row = G, slack_of_row
        self._inverse = np.linalg.inv(P)
        n, m = len(P), len(G)
        slacks = int(slack_of_row.max()) + 1 if m else 0
        columns = np.zeros((m, slacks))
        soft = slack_of_row >= 0
        columns[soft, slack_of_row[soft]] = -1.0
        rows = np.block([[G, columns], [np.zeros((slacks, n)), -np.eye(slacks)]])
        hessian = block_diag(P, slack_quadratic * np.eye(slacks))
        self._slack_gradient = np.full(slacks, slack_linear)
        self._slack_bound = np.zeros(slacks)
        self._lower = np.full(m + slacks, -1e20)

        self._qp = proxqp.dense.QP(n + slacks, 0, m + slacks)
        self._qp.settings.eps_abs = tolerance
        self._qp.settings.max_iter = iterations
        self._qp.settings.max_iter_in = 100
        self._qp.settings.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
        self._qp.init(hessian, np.zeros(n + slacks), None, None, rows, self._lower, np.full(m + slacks, 1e20))

    def unconstrained(self, g: Array) -> Array:
        """The optimum (n,) without constraints."""
        return -self._inverse @ g

    def solve(self, g: Array, h: Array) -> QpSolution:
        """Minimiser for gradient ``g`` (n,) and bounds ``h`` (m,).

        Raises :class:`SolverError` when the hard rows cannot be kept or the solver does not converge.
        """
        free = self.unconstrained(g)
        if np.all(self.G @ free <= h):
            return QpSolution(free, 0)
        # ProxQP takes a bound that is not a number for none.
        if not (np.all(np.isfinite(g)) and np.all(np.isfinite(h))):
            raise SolverError("the quadratic programme is not finite")
        self._qp.update(
            g=np.concatenate([g, self._slack_gradient]), l=self._lower, u=np.concatenate([h, self._slack_bound])
        )
        self._qp.solve()
        results = self._qp.results
        # There is something to start from only after a solution; ProxQP crashes when told otherwise.
        self._qp.settings.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
        if results.info.status != proxqp.QPSolverOutput.PROXQP_SOLVED or not np.all(np.isfinite(results.x)):
            raise SolverError(f"the quadratic programme ended with {results.info.status.name}")
        self._qp.settings.initial_guess = proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT
        return QpSolution(results.x[: len(g)].copy(), int(results.info.iter))
