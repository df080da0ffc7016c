"""ProxQP: a proximal method with a warm start, for programs that differ only in g and h from step to step."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from proxsuite import proxqp

from idc_controller.errors import SolverError
from idc_controller.qp.problem import QpSolution, QuadraticProgram

UNBOUNDED = 1e20
"""Number that ProxQP takes for no bound."""
TOLERANCE = 1e-6
ITERATIONS, INNER_ITERATIONS = 200, 100

_LARGE = 128 * 1024  # bytes, from which on glibc gives a block pages of its own until blocks of more have been freed
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt
_LARGEST_THRESHOLD = 32 * 1024 * 1024  # bytes, up to which glibc raises the threshold by itself, until it is set
_IS_MAPPED = 2  # in the size of a block, which stands before it


class ProxqpSolver:
    """Adapter; see :class:`~idc_controller.qp.problem.QpSolver`. QPs with the same H and G objects start warm.

    All rows are hard, and no variable has bounds of its own: none of the programs that are solved by it needs either.
    """

    def __init__(self) -> None:
        self._set_up: QuadraticProgram | None = None
        self._qp: Any = None

    def solve(self, problem: QuadraticProgram) -> QpSolution:
        """Return the minimiser of ``problem``."""
        if problem.lower is not None or problem.upper is not None or problem.soft is not None:
            raise SolverError("ProxQP is given programs without soft rows and bounds of variables only")
        # ProxQP takes a bound that is not a number for none.
        if not (np.all(np.isfinite(problem.g)) and np.all(np.isfinite(problem.h))):
            raise SolverError("the QP is not finite")
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
        n, m = len(problem.H), len(problem.G)
        with pages_of_their_own():  # it sums in an order that depends on the alignment of its factor
            self._set_up, self._qp = problem, proxqp.dense.QP(n, 0, m)
        settings = self._qp.settings
        settings.eps_abs, settings.max_iter, settings.max_iter_in = TOLERANCE, ITERATIONS, INNER_ITERATIONS
        # The residuals of feasibility and stationarity alone let some solutions be off the minimum by a few per cent.
        settings.check_duality_gap, settings.eps_duality_gap_abs = True, TOLERANCE
        settings.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
        self._qp.init(problem.H, np.zeros(n), None, None, problem.G, np.full(m, -UNBOUNDED), np.full(m, UNBOUNDED))


@contextmanager
def pages_of_their_own() -> Iterator[None]:
    """Let each block that is allocated within, of 128 KiB or more, begin at the same place in a page of its own.

    Nothing is done where the C library is not glibc.
    """
    c = ctypes.CDLL(None)
    if not hasattr(c, "mallopt") or not hasattr(c, "gnu_get_libc_version"):
        yield
        return
    c.malloc.restype, c.malloc.argtypes, c.free.argtypes = ctypes.c_void_p, [ctypes.c_size_t], [ctypes.c_void_p]
    c.mallopt(_MMAP_THRESHOLD, _LARGE)
    taken: list[int] = []  # what is free between the blocks of others
    while not _is_mapped(block := c.malloc(_LARGE)):
        taken.append(block)
    c.free(block)
    try:
        yield
    finally:
        for block in taken:
            c.free(block)
        # With pages of their own, the arrays of a flight would have each page cleared at every use.
        c.mallopt(_MMAP_THRESHOLD, _LARGEST_THRESHOLD)
        c.mallopt(_TRIM_THRESHOLD, 2 * _LARGEST_THRESHOLD)


def _is_mapped(block: int) -> bool:
    size = ctypes.c_size_t.from_address(block - ctypes.sizeof(ctypes.c_size_t)).value
    return bool(size & _IS_MAPPED)
