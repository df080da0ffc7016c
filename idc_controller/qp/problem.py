"""The quadratic program (QP) as every solver takes it, and what a solver returns."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array


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
    """Rows of G that may be exceeded, by as little as possible, where they cannot be kept (m,); None: no row."""


@dataclass(frozen=True, eq=False)
class QpSolution:
    """A minimiser (n,) and the solver's iterations (0: no constraint is active)."""

    x: Array
    iterations: int


class QpSolver(Protocol):
    """A solver; it may keep what helps it with the next program."""

    def solve(self, problem: QuadraticProgram) -> QpSolution:
        """Return the minimiser of ``problem``.

        Raises:
            SolverError: the constraints contradict each other, or the solver did not converge.
        """
        ...
