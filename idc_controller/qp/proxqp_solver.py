"""ProxQP: a proximal method with a warm start, for programs that differ only in g, h and bounds from step to step."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from proxsuite import proxqp
from scipy.linalg import block_diag

from idc_controller.arrays import Array
from idc_controller.errors import SolverError
from idc_controller.qp.problem import SOFT_COST, QpSolution, QuadraticProgram

_LARGE = 128 * 1024  # bytes, from which on glibc gives a block pages of its own until blocks of more have been freed
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt
_LARGEST_THRESHOLD = 32 * 1024 * 1024  # bytes, up to which glibc raises the threshold by itself, until it is set
_IS_MAPPED = 2  # in the size of a block, which stands before it


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


UNBOUNDED = 1e20
"""Number that ProxQP takes for no bound."""
TOLERANCE = 1e-6
ITERATIONS, INNER_ITERATIONS = 200, 100


class ProxqpSolver:
    """Adapter; see :class:`~idc_controller.qp.problem.QpSolver`. QPs with the same H and G objects start warm."""

    def __init__(self) -> None:
        self._set_up: QuadraticProgram | None = None
        self._qp: Any = None

    def solve(self, problem: QuadraticProgram) -> QpSolution:
        """Return the minimiser of ``problem``."""
        n = len(problem.g)
        # ProxQP takes a bound that is not a number for none.
        if not (np.all(np.isfinite(problem.g)) and np.all(np.isfinite(problem.h))):
            raise SolverError("the QP is not finite")
        if not _same_rows(problem, self._set_up):
            self._initialise(problem)
        lower, upper = _row_bounds(problem)
        slacks = np.zeros(self._qp.model.dim - n)
        self._qp.update(g=np.concatenate([problem.g, slacks]) if len(slacks) else problem.g, l=lower, u=upper)
        self._qp.solve()
        results = self._qp.results
        # Without a solution before there is nothing to start from: ProxQP crashes with a warm start then.
        self._qp.settings.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
        if results.info.status != proxqp.QPSolverOutput.PROXQP_SOLVED or not np.all(np.isfinite(results.x)):
            raise SolverError(f"ProxQP ended with {results.info.status.name}")
        self._qp.settings.initial_guess = proxqp.InitialGuess.WARM_START_WITH_PREVIOUS_RESULT
        return QpSolution(results.x[:n].copy(), int(results.info.iter))

    def _initialise(self, problem: QuadraticProgram) -> None:
        H, rows = _hessian_and_rows(problem)
        m = len(rows)
        with pages_of_their_own():  # it sums in an order that depends on the alignment of its factor
            self._set_up, self._qp = problem, proxqp.dense.QP(len(H), 0, m)
        settings = self._qp.settings
        settings.eps_abs, settings.max_iter, settings.max_iter_in = TOLERANCE, ITERATIONS, INNER_ITERATIONS
        # The residuals of feasibility and stationarity alone let some solutions be off the minimum by a few per cent.
        settings.check_duality_gap, settings.eps_duality_gap_abs = True, TOLERANCE
        settings.initial_guess = proxqp.InitialGuess.NO_INITIAL_GUESS
        self._qp.init(H, np.zeros(len(H)), None, None, rows, np.full(m, -UNBOUNDED), np.full(m, UNBOUNDED))


def _same_rows(problem: QuadraticProgram, other: QuadraticProgram | None) -> bool:
    return (
        other is not None
        and problem.H is other.H
        and problem.G is other.G
        and problem.soft is other.soft
        and problem.is_bounded == other.is_bounded
    )


def _row_bounds(problem: QuadraticProgram) -> tuple[Array, Array]:
    """Bounds of the rows: those of G, then the variables themselves."""
    lower, upper = np.full(len(problem.h), -UNBOUNDED), problem.h
    if not problem.is_bounded:
        return lower, upper
    none = np.full(len(problem.g), UNBOUNDED)
    least = -none if problem.lower is None else np.maximum(problem.lower, -UNBOUNDED)
    most = none if problem.upper is None else np.minimum(problem.upper, UNBOUNDED)
    return np.concatenate([lower, least]), np.concatenate([upper, most])


def _hessian_and_rows(problem: QuadraticProgram) -> tuple[Array, Array]:
    """H and the rows of G and of the variables, with a slack for every soft row."""
    H, rows = problem.H, problem.G
    if problem.is_bounded:
        rows = np.vstack([rows, np.eye(len(H))])
    if problem.soft is None:
        return H, rows
    soft = np.flatnonzero(problem.soft)
    norms = np.einsum("ij,ji->i", problem.G[soft], np.linalg.solve(H, problem.G[soft].T))
    slacks = np.zeros((len(rows), len(soft)))
    slacks[soft, np.arange(len(soft))] = -np.sqrt(norms)
    return block_diag(H, SOFT_COST * np.eye(len(soft))), np.hstack([rows, slacks])
