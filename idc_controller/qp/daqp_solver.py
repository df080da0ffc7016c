"""DAQP: a dual active-set method for small dense programs, exact, without a warm start."""

import daqp
import numpy as np

from idc_controller.errors import SolverError
from idc_controller.qp.problem import QpSolution, QuadraticProgram

UNBOUNDED = 1e30
"""Number that DAQP takes for no bound."""
_SOFT = 8  # DAQP's code of a constraint that may be violated


class DaqpSolver:
    """Adapter; see :class:`~idc_controller.qp.problem.QpSolver`."""

    def solve(self, problem: QuadraticProgram) -> QpSolution:
        """Return the minimiser of ``problem``."""
        bounded = len(problem.g) if problem.is_bounded else 0
        upper = np.full(bounded + len(problem.h), UNBOUNDED)
        lower = np.full(bounded + len(problem.h), -UNBOUNDED)
        upper[bounded:] = problem.h
        if problem.lower is not None:
            lower[:bounded] = np.maximum(problem.lower, -UNBOUNDED)
        if problem.upper is not None:
            upper[:bounded] = np.minimum(problem.upper, UNBOUNDED)
        sense = np.zeros(len(upper), dtype=np.int32)
        if problem.soft is not None:
            sense[bounded:][problem.soft] = _SOFT
        x, _, flag, info = daqp.solve(problem.H, problem.g, np.ascontiguousarray(problem.G), upper, lower, sense)
        if flag < 1 or not np.all(np.isfinite(x)):
            raise SolverError(f"DAQP found no solution of the QP (exit flag {flag})")
        return QpSolution(x, int(info["iterations"]))
