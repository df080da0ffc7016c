"""ProxQP: a proximal method with a warm start, for programs that differ only in g and h from step to step."""

from typing import Any

import numpy as np
from proxsuite import proxqp

from idc_controller.errors import SolverError
from idc_controller.qp.problem import QpSolution, QuadraticProgram

UNBOUNDED = 1e20
"""What ProxQP takes for no bound."""
TOLERANCE = 1e-6
ITERATIONS, INNER_ITERATIONS = 200, 100


class ProxqpSolver:
    """Adapter; see :class:`~idc_controller.qp.problem.QpSolver`. Programs with the same H and G objects start warm."""

    def __init__(self) -> None:
        self._set_up: QuadraticProgram | None = None
        self._qp: Any = None

    def solve(self, problem: QuadraticProgram) -> QpSolution:
        """Return the minimiser of ``problem``, which has neither bounds on its variables nor soft rows."""
        # ProxQP takes a bound that is not a number for none.
        if not (np.all(np.isfinite(problem.g)) and np.all(np.isfinite(problem.h))):
            raise SolverError("the QP is not finite")
        if problem.lower is not None or problem.upper is not None or problem.soft is not None:
            raise SolverError("ProxQP is set up for rows alone: state bounds and slacks as rows of G")
        if self._set_up is None or problem.H is not self._set_up.H or problem.G is not self._set_up.G:
            self._initialise(problem)
        self._qp.update(g=problem.g, l=np.full(len(problem.h), -UNBOUNDED), u=problem.h)
        self._qp.solve()
        results = self._qp.results
        # Without a solution before there is nothing to start from: ProxQP crashes with a warm start then.
        self._qp.settings.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
        if results.info.status != proxqp.QPSolverOutput.PROXQP_SOLVED or not np.all(np.isfinite(results.x)):
            raise SolverError(f"ProxQP ended with {results.info.status.name}")
        self._qp.settings.initial_guess = proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT
        return QpSolution(results.x.copy(), int(results.info.iter))

    def _initialise(self, problem: QuadraticProgram) -> None:
        n, m = len(problem.g), len(problem.h)
        self._set_up, self._qp = problem, proxqp.dense.QP(n, 0, m)
        settings = self._qp.settings
        settings.eps_abs, settings.max_iter, settings.max_iter_in = TOLERANCE, ITERATIONS, INNER_ITERATIONS
        settings.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
        lower, upper = np.full(m, -UNBOUNDED), np.full(m, UNBOUNDED)
        self._qp.init(problem.H, np.zeros(n), None, None, problem.G, lower, upper)
