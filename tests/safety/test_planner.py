"""The safety QP: its barrier, its optimum against another solver, its slacks and its limits."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_system import system
from proxsuite import proxqp

from idc_controller.errors import ParameterError
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import PredictedObstacle
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.qp.daqp_solver import DaqpSolver
from idc_controller.safety.constraints.acceleration_bounds import AccelerationBounds
from idc_controller.safety.constraints.constraint import Penalty, PlanningStep
from idc_controller.safety.constraints.exponential_barrier import barrier_operator
from idc_controller.safety.planner import Planner, terminal_weight
from idc_controller.safety.separation import PredictedObstacles, separations
from idc_controller.safety.settings import PlannerSettings

SETTINGS = PlannerSettings()
K = SETTINGS.chain.stages
LOWEST = -(system().payload.below + SETTINGS.ground_clearance)


def cruising(speed=1.5, altitude=5.0, stages=K, period=0.1):
    """A mission (5, K + 1, 3) north at constant speed."""
    mission = np.zeros((5, stages + 1, 3))
    mission[0, :, 0] = speed * period * np.arange(stages + 1)
    mission[0, :, 2] = -altitude
    mission[1, :, 0] = speed
    return mission


def standing(shape, position, growth=0.0, name="o"):
    return PredictedObstacle(name, shape, np.tile(position, (K + 1, 1)), np.full(K + 1, growth))


@pytest.fixture(scope="module")
def planner():
    return Planner(Formation(system()), SETTINGS)


def solved(planner, start, mission, obstacles, passes=3):
    """The plan after some rounds of convexification, and the planes it kept to."""
    position, acceleration, plan = mission[0], mission[2], None
    for _ in range(passes):
        near = separations(planner.formation, position, acceleration, PredictedObstacles(obstacles), 2.5)
        about = acceleration
        plan = planner.solve(start, mission, near, about)
        assert plan is not None
        position, acceleration = mission[0] + plan.deviation[:, 0], mission[2] + plan.deviation[:, 2]
    return plan, near, about


# The barrier


@pytest.mark.parametrize("rates", [(), (5.0,), (2.0, 7.0), (6.0, 6.0, 6.0, 6.0)])
def test_operator_is_the_product_of_its_factors(rates):
    s = PlannerSettings(barrier_rates=rates)
    rng = np.random.default_rng(len(rates))
    h = rng.normal(size=K + 1)
    rows = barrier_operator(rates, s.chain) @ h
    for k in range(1, K + 1):
        # (E - p_1) .. (E - p_m) h, with as many factors as there is past for.
        row = h
        for rate in rates[: min(len(rates), k)]:
            row = row[1:] - np.exp(-rate * s.chain.period) * row[:-1]
        degree = min(len(rates), k)
        assert rows[k - 1] == pytest.approx(row[k - degree])


@pytest.mark.parametrize("rates", [(0.0,), (-1.0,), (3.0, float("nan")), (3.0, -0.5)])
def test_poles_must_be_real_and_stable(rates):
    with pytest.raises(ParameterError, match="barrier rates"):
        PlannerSettings(barrier_rates=rates)


@given(
    st.lists(st.floats(0.2, 30.0), min_size=0, max_size=4),
    st.lists(st.floats(0.0, 5.0), min_size=K, max_size=K),
    st.floats(0.0, 5.0),
)
@settings(max_examples=60)
def test_safe_sets_are_nested(rates, rows, first):
    """Whenever h_0 >= 0 and all rows hold, h stays at zero or more: the rows' first stages put it in every set."""
    operator = barrier_operator(rates, SETTINGS.chain)
    h = np.concatenate([[first], np.linalg.solve(operator[:, 1:], np.array(rows) - operator[:, 0] * first)])
    assert h.min() >= -1e-9
    # Every partial product is in its set, too.
    psi = h
    for rate in rates:
        psi = psi[1:] - np.exp(-rate * 0.1) * psi[:-1]
        assert psi.min() >= -1e-7 * max(1.0, np.abs(h).max())


@pytest.mark.parametrize("rates", [(3.0,), (4.0, 4.0)])
def test_barrier_limits_how_fast_an_obstacle_is_approached(rates):
    """Plain rows let it run up to the margin; with the barrier every row holds on the plan itself."""
    s = PlannerSettings(barrier_rates=rates)
    planner = Planner(Formation(system()), s)
    mission = cruising()
    obstacle = standing(Sphere(0.5), [4.5, 0.4, -6.5])
    plan, near, about = solved(planner, np.zeros((5, 3)), mission, [obstacle])
    assert plan.slack < 1e-6
    position = mission[0] + plan.deviation[:, 0]
    n, lever = near[0].normals, planner.formation.lengths[0] / (planner.formation.g - about[:, 2])
    change = plan.deviation[:, 2] + mission[2] - about
    barrier_values = planner.barrier.values(near[:1], position, about)[0]
    barrier_values[1] -= lever * np.sum(n[:, :2] * change[:, :2], axis=1)
    for h in barrier_values:
        assert (planner.barrier.operator @ h).min() > -1e-6
        assert h.min() > -1e-6
    # The mission itself would break them.
    assert (
        min((planner.barrier.operator @ h).min() for h in planner.barrier.values(near[:1], mission[0], mission[2])[0])
        < -0.05
    )


# The optimum


def random_problem(rng):
    mission = cruising(rng.uniform(0.5, 2.0))
    start = rng.normal(size=(5, 3)) * np.array([0.3, 0.3, 0.2, 0.2, 0.5])[:, None]
    shapes = [Sphere(0.5), Pole(0.3, 15.0), Wall(size=(0.3, 3.0, 4.0), yaw=0.5)]
    obstacles = []
    for i in range(rng.integers(1, 4)):
        place = np.array([rng.uniform(2.5, 6.0), rng.uniform(-3.0, 3.0), rng.uniform(-8.0, -4.0)])
        obstacles.append(standing(shapes[rng.integers(3)], place, rng.uniform(0.0, 0.2), f"o{i}"))
    return start, mission, obstacles


class RecordingSolver(DaqpSolver):
    """Keeps the last problem and its solution."""

    def solve(self, problem):
        self.problem, self.solution = problem, super().solve(problem)
        return self.solution


@pytest.mark.parametrize("seed", range(6))
def test_optimum_is_that_of_another_solver(seed):
    start, mission, obstacles = random_problem(np.random.default_rng(seed))
    solver = RecordingSolver()
    planner = Planner(Formation(system()), SETTINGS, solver)
    plan, _, _ = solved(planner, start, mission, obstacles, passes=1)
    p, x = solver.problem, solver.solution.x
    n = len(p.g)
    value = 0.5 * x @ p.H @ x + p.g @ x
    assert plan.cost == pytest.approx(value + planner.cost.of(start, np.zeros(3 * SETTINGS.chain.knots)), abs=1e-6)
    rows = np.vstack([np.eye(n), p.G])
    upper, lower = np.concatenate([p.upper, p.h]), np.concatenate([p.lower, np.full(len(p.h), -np.inf)])
    assert np.all(rows @ x <= upper + 1e-6)
    assert np.all(rows @ x >= lower - 1e-6)
    qp = proxqp.dense.QP(n, 0, len(rows))
    qp.settings.eps_abs, qp.settings.max_iter = 1e-7, 20000
    qp.settings.eps_primal_inf = 1e-12  # slacks make it feasible, but some of them have to be large
    qp.init(p.H, p.g, None, None, rows, np.maximum(lower, -1e20), np.minimum(upper, 1e20))
    qp.solve()
    other = qp.results.x
    assert 0.5 * other @ p.H @ other + p.g @ other == pytest.approx(value, rel=1e-4, abs=1e-4)
    # Stationarity: the multipliers of upper bounds are positive, of lower ones negative.
    multipliers = qp.results.z
    np.testing.assert_allclose(p.H @ x + p.g + rows.T @ multipliers, 0.0, atol=1e-2)
    assert np.all(multipliers[upper - rows @ x > 1e-5] <= 1e-4)
    assert np.all(multipliers[rows @ x - lower > 1e-5] >= -1e-4)


def test_free_plan_is_the_linear_quadratic_optimum(planner):
    rng = np.random.default_rng(1)
    start = rng.normal(size=(5, 3)) * 0.1
    free = planner.free(start)
    s, chain = SETTINGS, SETTINGS.chain

    def cost(knots):
        """Written out over the stages, without the planner's matrices but the terminal one."""
        y = chain.roll_out(start, knots)
        total = 0.0
        for axis in range(3):
            weights = np.array([s.position[axis], s.velocity[axis], s.acceleration, s.jerk, s.snap[axis]])
            total += (y[1:, :, axis] ** 2 @ weights).sum()
            total += s.crackle * (np.diff(y[:, 4, axis]) ** 2).sum() / chain.period**2
            W = np.diag(weights)
            last = y[-1, :4, axis]
            total += last @ terminal_weight(chain.period, W) @ last
        return 0.5 * total

    assert free.cost == pytest.approx(cost(free.knots))
    for _ in range(20):
        assert cost(free.knots + 0.05 * rng.normal(size=free.knots.shape)) > free.cost
    # With nothing near and no limit touched the QP finds the same.
    unlimited = Planner(planner.formation, PlannerSettings(pop_limit=(1e6, 1e6, 1e6)))
    plan = unlimited.solve(start, cruising(), [], np.zeros((K + 1, 3)))
    np.testing.assert_allclose(plan.knots, free.knots, atol=1e-5)
    assert plan.cost == pytest.approx(free.cost, rel=1e-6)
    assert plan.slack == 0.0


# Slacks and limits


def test_slack_is_zero_when_rows_are_feasible(planner):
    obstacle = standing(Sphere(0.5), [4.0, 0.3, -7.0])
    plan, _, _ = solved(planner, np.zeros((5, 3)), cruising(1.0), [obstacle])
    assert plan.slack == pytest.approx(0.0, abs=1e-7)


def test_slack_equals_violation_of_infeasible_rows(planner):
    # It begins 0.2 m from the surface: 0.33 m of margin and tracking cannot be had at the first stages.
    position = np.array([0.0, 0.0, -5.0])
    surface = position + np.array([0.5 + 0.2 + 0.5, 0.0, 0.0])
    obstacle = standing(Sphere(0.5), surface)
    plan, _, _ = solved(planner, np.zeros((5, 3)), cruising(0.0), [obstacle])
    missing = SETTINGS.margin + SETTINGS.tracking - 0.2
    p = np.exp(-SETTINGS.barrier_rates[0] * 0.1)
    # h hardly changes in the first stage. Its row, of h and a slack that fades, is kept with this much of it.
    fading = np.exp(-SETTINGS.chain.period / SETTINGS.slack_time_constant)
    assert plan.slack == pytest.approx((1.0 - p) / (fading - p) * missing, rel=0.25)
    assert plan.slack > missing
    assert plan.cost > SETTINGS.slack_linear * plan.slack * 0.9


def test_infeasible_row_of_one_obstacle_does_not_relax_another(planner):
    near = standing(Sphere(0.5), [1.2, 0.0, -5.0], name="near")
    ahead = standing(Sphere(0.5), [-4.5, 0.4, -6.5], name="other")
    single, _, _ = solved(planner, np.zeros((5, 3)), cruising(-1.5), [near])
    assert single.slack > 0.01
    _, planes, about = solved(planner, np.zeros((5, 3)), cruising(-1.5), [near, ahead])
    both = planner.solve(np.zeros((5, 3)), cruising(-1.5), planes, about)
    other = next(s for s in planes if s.obstacle.name == "other")
    position = cruising(-1.5)[0] + both.deviation[:, 0]
    assert planner.barrier.values([other], position, both.deviation[:, 2])[0, 0].min() > -1e-6


def test_margin_includes_growth_of_uncertainty(planner):
    sure, unsure = (standing(Sphere(0.5), [3.5, 0.0, -7.4], growth) for growth in (0.0, 0.3))
    heights = []
    for obstacle in (sure, unsure):
        plan, _, _ = solved(planner, np.zeros((5, 3)), cruising(1.0), [obstacle])
        assert plan.slack < 1e-6
        heights.append(np.linalg.norm(plan.deviation[:, 0], axis=1).max())
    assert heights[1] > heights[0] + 0.1


@pytest.mark.parametrize("start", [[3.0, 0.0, 0.0], [0.0, -4.0, 0.0], [2.0, 2.0, 3.0], [0.0, 0.0, -3.0]])
def test_limits_hold_far_from_the_mission(planner, start):
    y = np.zeros((5, 3))
    y[0] = start
    mission = cruising(0.0)
    plan = planner.solve(y, mission, [], np.zeros((K + 1, 3)))
    limited = np.arange(3, K + 1, 3)
    assert np.all(np.abs(plan.deviation[limited, 2]) <= np.array(SETTINGS.acceleration_limit) + 1e-6)
    assert np.all(np.abs(plan.deviation[1:, 4]) <= np.array(SETTINGS.snap_limit) + 1e-6)
    assert np.all(mission[0, limited, 2] + plan.deviation[limited, 0, 2] <= LOWEST + 1e-6)


def pops(plan, start, mission, crackle):
    """Pop at the knots of a plan's snap, the one at its start included (knots, 3)."""
    intervals = SETTINGS.chain.period * np.array(SETTINGS.blocks)
    at = np.cumsum([0, *SETTINGS.blocks])
    snap = mission[4, at] + np.vstack([start[4], plan.knots])
    crackles = np.vstack([crackle, np.diff(snap, axis=0) / intervals[:, None]])
    spans = 0.5 * (intervals + np.concatenate([intervals[:1], intervals[:-1]]))
    return np.diff(crackles, axis=0) / spans[:, None]


@pytest.mark.parametrize("crackle", [[0.0, 0.0, 0.0], [12.0, -8.0, 20.0]])
def test_pop_of_an_evasion_is_bounded_from_the_crackle_in_force_on(planner, crackle):
    mission, start = cruising(1.5), np.zeros((5, 3))
    start[4] = [1.0, 0.5, -2.0]
    obstacle = standing(Sphere(0.6), [2.5, 0.2, -5.0])
    near = separations(planner.formation, mission[0], mission[2], PredictedObstacles([obstacle]), 2.5)
    plan = planner.solve(start, mission, near, mission[2], np.array(crackle))
    found = pops(plan, start, mission, crackle)
    limit = np.array(SETTINGS.pop_limit)
    assert np.all(np.abs(found) <= limit + 1e-4)
    # The evasion needs it: without the bound it would be exceeded.
    free = Planner(planner.formation, PlannerSettings(pop_limit=(1e6, 1e6, 1e6)))
    assert np.abs(pops(free.solve(start, mission, near, mission[2]), start, mission, crackle)).max() > limit.max()


def test_pop_of_the_mission_is_always_allowed(planner):
    mission = cruising(1.0)
    mission[4, 3::2, 0] = 8.0
    assert planner.is_within_limits(planner.free(np.zeros((5, 3))), mission)
    plan = planner.solve(np.zeros((5, 3)), mission, [], mission[2])
    np.testing.assert_allclose(plan.knots, 0.0, atol=1e-6)


def test_acceleration_is_bounded_along_the_axes_and_between_north_and_east():
    chain, z = SETTINGS.chain, np.random.default_rng(3).standard_normal(3 * SETTINGS.chain.knots)
    bounds = AccelerationBounds(SETTINGS, Penalty(1.0, 1.0))
    step = PlanningStep(
        np.zeros((5, K + 1, 3)), np.zeros((K + 1, 5, 3)), np.zeros((K + 1, 3)), (), np.zeros(3), np.zeros(3)
    )
    north, east, down = chain.roll_out(np.zeros((5, 3)), z.reshape(3, -1).T)[SETTINGS.limited_stages, 2].T
    rows, limits = bounds.rows(step)
    along = np.array([north, east, down, (north + east) / np.sqrt(2.0), (north - east) / np.sqrt(2.0)])
    expected = np.stack([along, -along], axis=1).ravel()
    np.testing.assert_allclose(rows @ z, expected, atol=1e-12)
    x, y, z = SETTINGS.acceleration_limit
    np.testing.assert_allclose(limits, np.repeat([x, y, z, min(x, y), min(x, y)], 2 * len(north)))


def test_limits_never_forbid_the_mission_itself(planner):
    mission = cruising(1.0)
    mission[2, :, 1], mission[4, :, 0], mission[0, :, 2] = 4.5, 9.0, -0.25
    plan = planner.solve(np.zeros((5, 3)), mission, [], mission[2])
    np.testing.assert_allclose(plan.knots, 0.0, atol=1e-6)
    assert plan.cost == pytest.approx(0.0, abs=1e-6)


def test_plan_stays_above_ground_with_mission_near_it(planner):
    mission = cruising(1.0, altitude=1.2)
    above = standing(Wall(size=(0.5, 40.0, 2.0)), [3.0, 0.0, -6.2])
    plan, _, _ = solved(planner, np.zeros((5, 3)), mission, [above])
    limited = np.arange(3, K + 1, 3)
    assert np.all(mission[0, limited, 2] + plan.deviation[limited, 0, 2] <= LOWEST + 0.02)


def test_plan_is_feasible_with_other_integrator_chains():
    coarse = PlannerSettings(stage=0.2, blocks=(1, 1, 2, 3, 4), barrier_rates=(3.0, 3.0))
    planner, chain = Planner(Formation(system(6)), coarse), coarse.chain
    mission = cruising(1.0, stages=chain.stages, period=chain.period)
    k = chain.stages + 1
    obstacle = PredictedObstacle("o", Sphere(0.4), np.tile([2.0, 0.3, -7.0], (k, 1)), np.zeros(k))
    near = separations(planner.formation, mission[0], mission[2], PredictedObstacles([obstacle]), 2.5)
    assert planner.solve(np.zeros((5, 3)), mission, near, mission[2]) is not None


# Planes of a hull that leads through an obstacle


def through(planner, thickness, at):
    """Separations of a mission that leads through a plate (its thickness and distance in m)."""
    mission = cruising(speed=2.4)
    obstacles = PredictedObstacles([standing(Wall((thickness, 30.0, 30.0)), [at, 0.0, -5.0])])
    return mission, separations(planner.formation, mission[0], mission[2], obstacles, 2.5)


@pytest.mark.parametrize("at", [4.0, 4.5, 5.0])
def test_plan_does_not_lead_through_a_thin_obstacle(planner, at):
    mission, near = through(planner, 0.3, at)
    start = np.zeros((5, 3))
    tunnelling = planner.solve(start, mission, near, mission[2])
    assert (mission[0] + tunnelling.deviation[:, 0])[-1, 0] > at  # planes on both sides keep it from neither
    plan = planner.solve(start, mission, [s.one_sided() for s in near], mission[2])
    ends = (mission[0] + plan.deviation[:, 0])[:, 0]
    assert ends.max() < at


def test_planes_change_sides_nowhere_inside_an_obstacle(planner):
    _, [separation] = through(planner, 0.3, 4.5)
    normals = separation.one_sided().normals
    assert separation.normals[:, 0].min() < -0.9
    assert (normals[1:] * normals[:-1]).sum(axis=1).min() >= 0.0
    unchanged = int((separation.normals != normals).any(axis=1).argmax())
    assert (normals[unchanged:] == normals[unchanged - 1]).all()


def test_planes_about_an_obstacle_that_is_passed_stay_as_they_are(planner):
    mission = cruising()
    obstacles = PredictedObstacles([standing(Pole(0.2, 10.0), [3.0, 2.5, -5.0])])
    [separation] = separations(planner.formation, mission[0], mission[2], obstacles, 2.5)
    assert separation.distance.min() > 0.0
    assert separation.one_sided() is separation


def test_slack_of_what_stands_is_separate_from_that_of_what_moves(planner):
    mission = cruising(speed=2.4)
    ball = standing(Sphere(0.5), [2.0, 0.0, -5.0])
    moving = replace(ball, positions=ball.positions + np.linspace(0.0, 0.1, K + 1)[:, None])
    for obstacle, stands in ((ball, True), (moving, False), (replace(ball, may_leave=True), False)):
        near = separations(planner.formation, mission[0], mission[2], PredictedObstacles([obstacle]), 2.5)
        plan = planner.solve(np.zeros((5, 3)), mission, near, mission[2])
        assert plan.slack > 0.1
        assert plan.standing_slack == (plan.slack if stands else 0.0)
