"""The quadratic program (QP) as every solver takes it, and what a solver returns."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array

SOFT_COST = 1e6
"""Quadratic cost of exceeding a soft row; DAQP's own."""


@dataclass(frozen=True, eq=False)
class QuadraticProgram:
    """min 1/2 x' H x + g' x  subject to  G x <= h,  lower <= x <= upper."""

    H: Array
    """Positive definite (n, n)."""
    g: Array
    """(n,)"""
    G: Array
    """(m, n)"""
    h: Array
    """(m,)"""
    lower: Array | None = None
    """(n,); -inf: none. None: no variable is bounded."""
    upper: Array | None = None
    """(n,); inf: none."""
    soft: NDArray[np.bool_] | None = None
    """Rows of G that may be exceeded where they cannot be kept (m,), by an excess e in units of the row's norm in the
    metric of H^-1, at the cost 1/2 ``SOFT_COST`` e^2; None: no row."""
    lazy: NDArray[np.bool_] | None = None
    """Rows of G that seldom bind (m,): a solver may leave out those that its minimiser keeps anyway; None: no row."""


class QpSolution(NamedTuple):
    """A minimiser (n,) and the solver's iterations (0: no constraint is active)."""

    x: Array
    iterations: int


class QpSolver(Protocol):
    """A solver; it may keep what helps it with the next program, and be made for programs of few kinds only."""

    def solve(self, problem: QuadraticProgram) -> QpSolution:
        """Return the minimiser of ``problem``.

        Raises:
            SolverError: the constraints contradict each other, or the solver did not converge.
        """
        ...
