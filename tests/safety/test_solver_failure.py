"""Planning on ideal tracking while the QP solver fails: the reference is never followed unchecked."""

import math

import numpy as np
import pytest
from avoidance_scene import avoidance, fly, pole, sphere, straight

from idc_controller.errors import SolverError

SCENES = {
    "pole": [pole("p", 9.0, 0.1)],
    "two spheres": [sphere("s", (6.0, 0.2, -5.0)), sphere("m", (22.0, 0.1, -5.0), (-1.2, 0.0, 0.0))],
}


class Failing:
    """A solver that fails from ``begin`` to ``end`` (s)."""

    def __init__(self, solver, begin, end):
        self.solver, self.begin, self.end, self.time, self.failures = solver, begin, end, 0.0, 0

    def solve(self, problem):
        if self.begin <= self.time < self.end:
            self.failures += 1
            raise SolverError("made to fail")
        return self.solver.solve(problem)


def flown_with_failures(scene, begin, end):
    avoided = avoidance(SCENES[scene])
    planner, step = avoided.safety.planner, avoided.step
    solver = planner.solver = Failing(planner.solver, begin, end)

    def timed(time, mission):
        solver.time = time
        return step(time, mission)

    avoided.step = timed
    flown = fly(avoided, straight(16.0), 40.0)
    assert solver.failures
    return flown


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(
    ("begin", "end"), [(0.0, math.inf), (4.0, 6.0), (6.0, 6.05)], ids=["always", "for 2 s", "once"]
)
def test_formation_stays_clear_while_the_solver_fails(scene, begin, end):
    flown = flown_with_failures(scene, begin, end)
    assert min(flown.clearance().values()) > 0.45  # m; 0.5 is planned, by a hull of fewer points
    assert any(report.infeasible for report in flown.reports)
    assert np.linalg.norm(flown.path[0, -1, :2] - [16.0, 0.0]) < 0.1  # arrived all the same


def test_stop_is_flown_where_no_plan_is_in_force_and_the_solver_fails():
    avoided = avoidance([sphere("s", (1.6, 0.0, -5.0))])
    avoided.safety.planner.solver = Failing(avoided.safety.planner.solver, 0.0, math.inf)
    flown = fly(avoided, straight(16.0), 4.0, until_end=False)
    assert flown.reports[0].infeasible and flown.reports[0].active
    assert np.linalg.norm(flown.path[0] - flown.path[0, 0][None], axis=1).max() < 0.3  # it hardly moves


def test_exact_clearance_of_each_plan_is_reported():
    avoided = avoidance(SCENES["pole"])
    flown = fly(avoided, straight(16.0), 8.0)
    margin = avoided.safety.settings.margin
    assert all(report.verified and report.clearance >= margin - 1e-3 for report in flown.reports)
    near = avoidance([sphere("s", (0.9, 0.0, -5.0))])  # 0.1 m from the hull: no plan can keep the margin
    first = fly(near, straight(16.0), 0.05, until_end=False).reports[0]
    assert not first.verified and first.clearance < 0.15
