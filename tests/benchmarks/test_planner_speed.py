"""Cost of the safety filter in a control step, and of solvers for its QP and the MPC's.

    python tests/benchmarks/test_planner_speed.py            both tables
    python tests/benchmarks/test_planner_speed.py --quick    fewer steps

Figures are CPU times in yardsticks, measured in turns with what they are compared with.
"""

import argparse
import importlib.util
import sys
import time
from functools import partial
from pathlib import Path

import daqp
import numpy as np
from proxsuite import proxqp
from threadpoolctl import threadpool_limits

sys.path.insert(0, str(Path(__file__).parents[2]))
sys.path.insert(0, str(Path(__file__).parents[1]))

from avoidance_scene import STEP, avoidance, estimate_at, pole, sphere, straight
from paper_system import system
from yardstick import cpu_seconds, yardstick

from idc_controller.control.controller import IntegratedDecisionController
from idc_controller.control.mpc import ModelPredictiveController
from idc_controller.control.settings import ControllerSettings, MpcSettings
from idc_controller.model.linear import LinearModel

OBSTACLES = (2, 10, 50, 200)
TEAMS = (3, 4, 6, 8, 10, 12)
FAR = 1e20


def field(count):
    """``count`` obstacles: a sphere and a pole on the path, the rest about it, thinner further off."""
    rng = np.random.default_rng(count)
    obstacles = [sphere("s0", (8.0, 0.2, -5.0)), pole("p0", 14.0, 2.6)]
    while len(obstacles) < count:
        north, east = rng.uniform(0.0, 24.0), rng.uniform(3.0, 30.0) * rng.choice([-1.0, 1.0])
        if len(obstacles) % 2:
            obstacles.append(pole(f"p{len(obstacles)}", north, east))
        else:
            obstacles.append(sphere(f"s{len(obstacles)}", (north, east, rng.uniform(-9.0, -2.0))))
    return obstacles


class Recorded:
    """A flight whose control steps are timed, in yardsticks, and whose QPs are kept."""

    def __init__(self, count, n, steps):
        parameters = system(n)
        model = LinearModel(parameters)
        avoided = avoidance(field(count), n=n)
        safety = avoided.safety
        mpc = ModelPredictiveController(model, MpcSettings())
        controller = IntegratedDecisionController(model, mpc, safety, ControllerSettings(), guidance=avoided.guidance)
        mission, rng = straight(24.0), np.random.default_rng(n)
        self.planner, self.mpc, self.filter_cost, self.step_cost = [], [], [], []
        solve, track, real_filter = safety.planner.solver.solve, mpc.qp.solve, safety.filter

        def kept(problem):
            self.planner.append(problem)
            return solve(problem)

        def kept_mpc(p, h):
            solution = track(p, h)
            if solution.iterations:
                self.mpc.append((p.copy(), h.copy()))
            return solution

        def timed(*arguments):
            begin = time.process_time()
            trajectory = real_filter(*arguments)
            self.filter_cost.append(time.process_time() - begin)
            return trajectory

        safety.filter, mpc.qp.solve = timed, kept_mpc
        safety.planner.solver.solve = kept
        for k in range(steps):
            now = k * STEP
            reference = controller.reference(mission)
            x = reference.at(np.array([now])).x[0]
            # Errors as in a flight with noise, large enough now and then to wake the MPC's constraints.
            x[model.layout.r_0] += 0.03 * rng.normal(size=3)
            x[model.layout.Theta] += (0.08 if k % 4 == 0 else 0.008) * rng.normal(size=3)
            x[model.layout.omega] += 0.03 * rng.normal(size=3)
            estimate = estimate_at(now, x[:3], model.layout.size)
            estimate.x[:] = x
            begin = time.process_time()
            controller.decide(estimate, mission, learn_load=False)
            spent, unit = time.process_time() - begin, yardstick()
            self.step_cost.append(spent / unit)
            self.filter_cost[-1] /= unit
        mpc.qp.solve = track  # what is timed later is not recorded
        self.qp = mpc.qp


def percentiles(values):
    return f"{np.percentile(values, 50):8.3g} {np.percentile(values, 99):8.3g} {np.max(values):8.3g}"


def steps_table(steps):
    """Print filter and control step (filter, reference, MPC) against obstacles and team size."""
    columns = f"{'p50':>8} {'p99':>8} {'max':>8}"
    print(f"\n{'':14} | {'filter':>26} | {'control step':>26}")
    print(f"{'UAVs':>4} {'obstacles':>9} | {columns} | {columns}")
    cases = [(4, count) for count in OBSTACLES] + [(n, 2) for n in TEAMS if n != 4]
    for n, count in cases:
        run = Recorded(count, n, steps)
        print(f"{n:>4} {count:>9} | {percentiles(run.filter_cost)} | {percentiles(run.step_cost)}")


# Solvers, on the same recorded QPs: each returns (seconds, x)


def stacked(problem):
    """Bounds of the variables and rows together: upper and lower (n + m,), with FAR for none."""
    n, m = len(problem.g), len(problem.h)
    lower = np.full(n, -np.inf) if problem.lower is None else problem.lower
    upper = np.full(n, np.inf) if problem.upper is None else problem.upper
    upper, lower = np.concatenate([upper, problem.h]), np.concatenate([lower, np.full(m, -np.inf)])
    return np.minimum(upper, FAR), np.maximum(lower, -FAR)


def by_daqp(p):
    upper, lower = stacked(p)
    begin = time.process_time()
    x, _, flag, _ = daqp.solve(p.H, p.g, p.G, upper, lower, np.zeros(len(upper), dtype=np.int32))
    return time.process_time() - begin, (x if flag > 0 else None)


def by_proxqp(p):
    upper, lower = stacked(p)
    n, m = len(p.g), len(p.h)
    begin = time.process_time()
    qp = proxqp.dense.QP(n, 0, m, True)
    qp.settings.eps_abs, qp.settings.max_iter = 1e-6, 2000
    qp.init(p.H, p.g, None, None, p.G, lower[n:], upper[n:], lower[:n], upper[:n])
    qp.solve()
    solved = qp.results.info.status == proxqp.QPSolverOutput.PROXQP_SOLVED
    return time.process_time() - begin, (qp.results.x if solved else None)


def by_osqp(p):
    import osqp
    from scipy.sparse import csc_matrix, triu, vstack

    upper, lower = stacked(p)
    begin = time.process_time()
    rows = vstack([csc_matrix(np.eye(len(p.g))), csc_matrix(p.G)], format="csc")
    solver = osqp.OSQP()
    solver.setup(
        triu(csc_matrix(p.H), format="csc"), p.g, rows, lower, upper, verbose=False, eps_abs=1e-5, eps_rel=1e-5
    )
    result = solver.solve()
    return time.process_time() - begin, (result.x if result.info.status == "solved" else None)


def by_piqp(p):
    import piqp

    upper, lower = stacked(p)
    n = len(p.g)
    begin = time.process_time()
    solver = piqp.DenseSolver()
    low, high = np.maximum(lower[:n], -1e6), np.minimum(upper[:n], 1e6)
    solver.setup(p.H, p.g, np.zeros((0, n)), np.zeros(0), p.G, p.h, low, high)
    status = solver.solve()
    return time.process_time() - begin, (solver.result.x if status == piqp.PIQP_SOLVED else None)


SOLVERS = {"daqp": by_daqp, "proxsuite": by_proxqp, "osqp": by_osqp, "piqp": by_piqp}


def solvers_table(steps, most=150):
    """Print every installed solver on the same QPs, with its ratio to the first."""
    run = Recorded(10, 4, steps)
    for name, problems in (
        ("planner", run.planner),
        ("MPC, constrained, cold", [run.qp.problem(g, h) for g, h in run.mpc]),
    ):
        chosen = problems[:: max(1, len(problems) // most)]
        if not chosen:
            continue
        print(f"\n{name}: {len(chosen)} QPs, e.g. {len(chosen[0].g)} variables, {len(chosen[0].h)} rows")
        print(f"{'solver':>10} {'p50':>8} {'p99':>8} {'max':>8} {'ratio':>7} {'failed':>7} {'cost above':>11}")
        spent = {s: [] for s in SOLVERS if importlib.util.find_spec(s)}
        costs = {s: [] for s in spent}
        for problem in chosen:  # in turn: what disturbs one disturbs all
            for solver in spent:
                seconds, x = SOLVERS[solver](problem)
                spent[solver].append(seconds / yardstick())
                costs[solver].append(np.nan if x is None else 0.5 * x @ problem.H @ x + problem.g @ x)
        best = np.nanmin(np.array(list(costs.values())), axis=0)
        first = np.median(next(iter(spent.values())))
        for solver, times in spent.items():
            above = np.nanmax((np.array(costs[solver]) - best) / np.maximum(np.abs(best), 1.0), initial=0.0)
            failed = int(np.isnan(costs[solver]).sum())
            print(f"{solver:>10} {percentiles(times)} {np.median(times) / first:7.1f} {failed:>7} {above:>11.1e}")
    if times := [cpu_seconds(partial(run.qp.solve, g, h)) / yardstick() for g, h in run.mpc]:
        print(f"{'as flown':>10} {percentiles(times)}   (ProxQP, set up once, warm)")


def test_planner_benchmark():
    main([])


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer steps")
    steps = 60 if parser.parse_args(arguments).quick else 300
    with threadpool_limits(1):
        steps_table(steps)
        solvers_table(max(steps, 160))


if __name__ == "__main__":
    main()
