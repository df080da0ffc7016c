"""DAQP: a dual active-set method for small dense programs, exact. Lazy rows are taken in as they are broken."""

import daqp
import numpy as np

from idc_controller.errors import SolverError
from idc_controller.qp.problem import QpSolution, QuadraticProgram

UNBOUNDED = 1e30
"""Number that DAQP takes for no bound."""
TOLERANCE = 1e-9
"""By how much a row may be exceeded; within DAQP in units of the row's norm in the metric of H^-1."""
_SOFT = 8  # DAQP's code of a constraint that may be violated
_ACTIVE = np.array([0, 1, 3], dtype=np.int32)  # and of one that begins inactive, active above, active below


class DaqpSolver:
    """Adapter; see :class:`~idc_controller.qp.problem.QpSolver`."""

    def solve(self, problem: QuadraticProgram) -> QpSolution:
        """Return the minimiser of ``problem``.

        Its lazy rows are left out at first. Those that the minimiser breaks are taken in, with the variables that are
        in them, until it breaks none; each time the active set is that of before.
        """
        H, g, G, h = problem.H, problem.g, problem.G, problem.h
        n, m = len(g), len(h)
        least = np.full(n, -UNBOUNDED) if problem.lower is None else np.maximum(problem.lower, -UNBOUNDED)
        most = np.full(n, UNBOUNDED) if problem.upper is None else np.minimum(problem.upper, UNBOUNDED)
        lower, upper = np.concatenate([least, np.full(m, -UNBOUNDED)]), np.concatenate([most, h])
        sense = np.zeros(n + m, dtype=np.int32)
        if problem.soft is not None:
            sense[n:][problem.soft] = _SOFT
        kinds = sense.copy()
        taken = np.ones(m, dtype=bool) if problem.lazy is None else ~problem.lazy
        coupled = np.count_nonzero(H, axis=1) > 1
        # A variable on its own, in no row, is at its own minimum within its bounds.
        x, iterations = np.clip(-g / H.diagonal(), least, most), 0
        sense[:n][~coupled & (x == least)] = _ACTIVE[-1]
        while True:
            variables, rows = np.flatnonzero(coupled | G[taken].any(axis=0)), np.flatnonzero(taken)
            both = np.concatenate([variables, n + rows])
            found, _, flag, info = daqp.solve(
                H[np.ix_(variables, variables)], g[variables], G[np.ix_(rows, variables)], upper[both], lower[both],
                sense[both], primal_tol=TOLERANCE,
            )  # fmt: skip
            if flag < 1 or not np.all(np.isfinite(found)):
                raise SolverError(f"DAQP found no solution of the QP (exit flag {flag})")
            x[variables], iterations = found, iterations + int(info["iterations"])
            broken = ~taken & (G @ x > h + TOLERANCE)
            if not broken.any():
                return QpSolution(x, iterations)
            taken |= broken
            sense[both] = kinds[both] | _ACTIVE[np.sign(info["lam"]).astype(int)]
