"""Both solvers find the same minimiser; what are bounds and soft rows to DAQP are rows and slacks to ProxQP."""

from dataclasses import replace

import daqp
import numpy as np
import pytest
from scipy.linalg import block_diag

from idc_controller.errors import SolverError
from idc_controller.qp.daqp_solver import DaqpSolver
from idc_controller.qp.problem import SOFT_COST, QuadraticProgram
from idc_controller.qp.proxqp_solver import ProxqpSolver

pytestmark = pytest.mark.numerics

INF = np.inf
LOWER = np.array([-0.2, -0.2, -INF, -INF, -0.3, -INF])
UPPER = np.array([0.2, INF, 0.2, INF, 0.3, INF])


def program(seed, lower=None, upper=None, soft=None, feasible=True):
    """A random program of 6 variables and 8 rows; the origin keeps all rows where it is feasible."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(6, 6))
    h = rng.uniform(0.05, 0.5, 8) if feasible else -rng.uniform(0.05, 0.5, 8)
    return QuadraticProgram(
        root @ root.T + np.eye(6), 3.0 * rng.normal(size=6), rng.normal(size=(8, 6)), h, lower, upper, soft
    )


def with_hard_rows(problem):
    """The same program with rows in place of the variables' bounds, and a slack for every soft row."""
    n = len(problem.g)
    soft = np.flatnonzero(np.zeros(len(problem.h), dtype=bool) if problem.soft is None else problem.soft)
    norms = np.sqrt(np.einsum("ij,ji->i", problem.G[soft], np.linalg.solve(problem.H, problem.G[soft].T)))
    slacks = np.zeros((len(problem.h), len(soft)))
    slacks[soft, np.arange(len(soft))] = -norms
    G, h = [np.hstack([problem.G, slacks])], [problem.h]
    for sign, bound in ((-1.0, problem.lower), (1.0, problem.upper)):
        for at in () if bound is None else np.flatnonzero(np.isfinite(bound)):
            G.append(sign * np.eye(n + len(soft))[[at]])
            h.append(sign * bound[[at]])
    H = block_diag(problem.H, SOFT_COST * np.eye(len(soft)))
    return QuadraticProgram(H, np.append(problem.g, np.zeros(len(soft))), np.vstack(G), np.concatenate(h))


def by_proxqp(problem):
    return ProxqpSolver().solve(with_hard_rows(problem)).x[: len(problem.g)]


@pytest.mark.parametrize(
    ("lower", "upper"), [(None, None), (LOWER, UPPER), (LOWER, None), (None, UPPER)], ids=["rows", "both", "low", "up"]
)
def test_solvers_agree_on_rows_and_bounds_of_variables(lower, upper):
    for seed in range(20):
        problem = program(seed, lower, upper)
        found = DaqpSolver().solve(problem).x
        assert by_proxqp(problem) == pytest.approx(found, abs=1e-5)
        assert np.all(problem.G @ found <= problem.h + 1e-5)
        assert lower is None or np.all(found >= lower - 1e-5)
        assert upper is None or np.all(found <= upper + 1e-5)


@pytest.mark.parametrize("bounded", [False, True])
def test_solvers_agree_on_soft_rows_that_cannot_be_kept(bounded):
    lower, upper = (LOWER, UPPER) if bounded else (None, None)
    for seed in range(20):
        problem = program(seed, lower, upper, np.ones(8, dtype=bool), feasible=False)
        assert by_proxqp(problem) == pytest.approx(DaqpSolver().solve(problem).x, abs=1e-4)


def test_proxqp_agrees_from_a_warm_start_with_other_gradients_and_bounds():
    first, warm = program(1), ProxqpSolver()
    for seed in range(2, 12):
        other = program(seed)
        problem = QuadraticProgram(first.H, other.g, first.G, other.h)
        assert warm.solve(problem).x == pytest.approx(DaqpSolver().solve(problem).x, abs=1e-5)


def test_proxqp_refuses_what_it_does_not_take():
    for problem in (program(1, LOWER), program(1, None, UPPER), program(1, soft=np.ones(8, dtype=bool))):
        with pytest.raises(SolverError, match="without soft rows and bounds"):
            ProxqpSolver().solve(problem)


def lazy_program(seed):
    """A program of 6 variables, 60 lazy rows and 4 others; rows 20 to 39 share a slack, those from 40 on another.

    In a quarter of the programs rows contradict each other, in half of them those with a slack.
    """
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(6, 6))
    H, G = np.eye(8), np.zeros((64, 8))
    H[:6, :6], G[:, :6] = root @ root.T + 0.1 * np.eye(6), rng.normal(size=(64, 6))
    G[20:40, 6] = G[40:60, 7] = -rng.uniform(0.2, 1.0, 20)
    h = rng.uniform(0.05, 0.5, 64)
    if seed % 4 == 3:
        G[5], h[5] = -G[4], -2.0 * h[4]
    if seed % 2:
        G[45, :6], h[45] = -G[44, :6], -2.0 * h[44]
    g = np.concatenate([5.0 * rng.normal(size=6), [10.0, 1.0]])
    lower, upper = np.concatenate([np.full(6, -0.5), np.zeros(2)]), np.concatenate([np.full(6, 0.5), np.full(2, INF)])
    return QuadraticProgram(H, g, G, h, lower, upper, lazy=np.arange(64) < 60)


def test_lazy_rows_change_neither_the_optimum_nor_whether_there_is_one():
    solved, slacks = 0, 0
    for seed in range(200):
        problem = lazy_program(seed)
        try:
            optimum = DaqpSolver().solve(replace(problem, lazy=None)).x
        except SolverError:
            with pytest.raises(SolverError):
                DaqpSolver().solve(problem)
            continue
        solved, slacks = solved + 1, slacks + (optimum[6:] > 0.01).any()
        assert DaqpSolver().solve(problem).x == pytest.approx(optimum, rel=0.0, abs=1e-9)
    assert 100 < solved < 200 and 50 < slacks < solved, (solved, slacks)


def test_lazy_rows_are_left_out_until_they_are_broken(monkeypatch):
    sizes, solve = [], daqp.solve

    def counted(H, g, G, *others, **options):
        sizes.append(G.shape)
        return solve(H, g, G, *others, **options)

    monkeypatch.setattr(daqp, "solve", counted)
    H = np.array([[2.0, 1.0, 0.0, 0.0], [1.0, 2.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    G, h = np.array([[-1.0, 0.0, -1.0, 0.0], [0.0, -1.0, 0.0, -1.0]]), np.array([-1.0, 9.0])
    lower = np.array([-INF, -INF, 0.0, 0.0])
    DaqpSolver().solve(QuadraticProgram(H, np.array([0.0, 0.0, 9.0, 9.0]), G, h, lower, lazy=np.array([True, True])))
    assert sizes == [(0, 2), (1, 3)]  # the row that is broken, and the variables that are in it or coupled


@pytest.mark.parametrize(
    ("h", "lower"), [([-1.0, -1.0], None), ([1.0, 5.0], np.array([2.0, -INF]))], ids=["rows", "bound"]
)
def test_solvers_refuse_contradicting_constraints(h, lower):
    G = np.array([[1.0, 0.0], [-1.0, 0.0]])
    problem = QuadraticProgram(np.eye(2), np.zeros(2), G, np.array(h), lower)
    for solve in (DaqpSolver().solve, by_proxqp):
        with pytest.raises(SolverError):
            solve(problem)


def test_proxqp_has_one_solution_wherever_its_memory_is():
    """Tracking with three vehicles: of 77 variables and 219 rows; its factor is in what is free, or it is not."""
    rng, used, found = np.random.default_rng(0), [], set()
    root, rows = rng.normal(size=(77, 77)), rng.normal(size=(219, 77))
    problem = QuadraticProgram(root @ root.T + np.eye(77), rng.normal(size=77), rows, rng.uniform(0.1, 1.0, 219))
    for _ in range(40):
        blocks = [bytearray(size) for size in rng.integers(50_000, 120_000, 20)]
        used.append(blocks[-1])
        del blocks
        found.add(ProxqpSolver().solve(problem).x.tobytes())
    assert len(found) == 1
