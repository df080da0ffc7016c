"""The paper's own filter: its rows by finite differences, and that it cannot act on a pole."""

import coal
import numpy as np
import pytest
from avoidance_scene import Scene, estimate_at, pole, sphere, swinging, wall
from paper_system import system

from idc_controller.model.linear import LinearModel
from idc_controller.paper.avoidance import PrintedFilter


@pytest.fixture(scope="module")
def model():
    return LinearModel(system())


def flying(model, velocity=(0.5, -0.3, 0.2), seed=0):
    rng = np.random.default_rng(seed)
    estimate = estimate_at(2.0, [0.0, 0.0, -5.0], model.layout.size)
    x = estimate.x
    x[model.layout.v_0] = velocity
    x[model.layout.s] = 0.05 * rng.normal(size=8)
    x[model.layout.Theta] = 0.02 * rng.normal(size=3)
    x[model.layout.f] = model.parameters.hover_thrust + rng.normal(size=4)
    return estimate


def hover(model):
    u = np.zeros(model.layout.inputs)
    u[model.layout.f_setpoint] = model.parameters.hover_thrust
    return u


@pytest.mark.parametrize(
    "obstacle",
    [
        sphere("below", (0.3, 0.2, -3.0), (0.4, 0.0, -0.6)),
        sphere("beside", (2.5, 0.5, -5.5), (-1.0, 0.3, 0.2)),
        swinging("swinging", (0.5, 1.0, -10.5), (0.0, 0.4, 0.8)),
        wall("low", 0.5, 0.5, (4.0, 4.0, 3.0)),
    ],
    ids=lambda o: o[0],
)
def test_row_is_the_second_derivative_of_h(model, obstacle):
    """h = |c - o|^2 - R^2 along the linear model's motion, with c carried along; h'' + K (h, h') >= 0 is the row."""
    margin, poles = 0.5, (2.0, 3.0)
    source = Scene([obstacle])
    printed = PrintedFilter(model, source, margin, poles)
    estimate, layout = flying(model), model.layout
    deviation = estimate.x.copy()
    deviation[layout.f] -= model.parameters.hover_thrust
    A = model.A[layout.v_0]
    drift = A @ deviation - A[:, layout.f] @ deviation[layout.f]
    times = estimate.time + np.array([0.0, 0.05, 0.10])
    predicted = source.predict(times)[0]
    row, bound = printed.row(predicted, estimate, drift, A[:, layout.f])

    shape, position = predicted.shape, estimate.x[layout.r_0]
    result = coal.DistanceResult()
    points = printed.formation.hull_points(np.zeros((1, 3)))[0]
    coal.distance(
        printed.formation.hull(points), coal.Transform3s.Identity(), shape.geometry(),
        coal.Transform3s(shape.rotation, predicted.positions[0] - position), coal.DistanceRequest(), result,
    )  # fmt: skip
    c = position + np.array(result.getNearestPoint1())
    o = predicted.positions[0] if shape.kind != "wall" else position + np.array(result.getNearestPoint2())
    # The obstacle as the filter takes it to move.
    o_dot = (predicted.positions[1] - predicted.positions[0]) / 0.05
    o_ddot = (predicted.positions[2] - 2 * predicted.positions[1] + predicted.positions[0]) / 0.05**2
    rng = np.random.default_rng(3)
    for _ in range(5):
        f = model.parameters.hover_thrust + rng.normal(size=4) * 3.0
        deviation[layout.f] = f - model.parameters.hover_thrust
        a = A @ deviation

        def h(t, a=a):
            d = c + estimate.x[layout.v_0] * t + a * t**2 / 2 - (o + o_dot * t + o_ddot * t**2 / 2)
            return d @ d - (shape.columns.radius + margin) ** 2

        e = 1e-3
        h_dot, h_ddot = (h(e) - h(-e)) / (2 * e), (h(e) - 2 * h(0.0) + h(-e)) / e**2
        barrier = h_ddot + poles[0] * poles[1] * h(0.0) + (poles[0] + poles[1]) * h_dot
        assert bound - row @ f == pytest.approx(barrier, rel=1e-4, abs=1e-4)


def test_row_of_pole_is_independent_of_thrust(model):
    source = Scene([pole("p", 2.0, 0.3)])
    printed = PrintedFilter(model, source, 0.5)
    estimate, layout = flying(model), model.layout
    predicted = source.predict(np.array([2.0, 2.05, 2.1]))[0]
    row, _ = printed.row(predicted, estimate, np.zeros(3), model.A[layout.v_0][:, layout.f])
    np.testing.assert_array_equal(row, 0.0)
    # So whatever is near, the set-points stay as they are.
    u = hover(model)
    np.testing.assert_allclose(printed.correct(2.0, u, estimate), u, atol=1e-6)


def test_filter_raises_thrust_above_a_sphere(model):
    printed = PrintedFilter(model, Scene([sphere("s", (0.0, 0.0, -3.7))]), 0.5)
    estimate = flying(model, velocity=(0.0, 0.0, 0.5))
    u = printed.correct(2.0, hover(model), estimate)
    thrusts = u[model.layout.f_setpoint]
    assert np.all(thrusts > model.parameters.hover_thrust)
    np.testing.assert_array_equal(u[model.layout.n_setpoint], 0.0)


def test_filter_leaves_thrusts_unchanged_far_from_obstacles(model):
    estimate = flying(model)
    u = hover(model)
    for obstacles in ([], [sphere("s", (20.0, 0.0, -5.0))]):
        np.testing.assert_allclose(PrintedFilter(model, Scene(obstacles), 0.5).correct(2.0, u, estimate), u, atol=1e-9)


def test_thrusts_stay_within_bounds_with_infeasible_rows(model):
    # Rushing at it from above and below at once.
    obstacles = [
        sphere("below", (0.0, 0.0, -3.7), (0.0, 0.0, -6.0)),
        sphere("above", (0.0, 0.0, -9.7), (0.0, 0.0, 6.0)),
    ]
    printed = PrintedFilter(model, Scene(obstacles), 0.5)
    u = printed.correct(2.0, hover(model), flying(model))
    thrusts = u[model.layout.f_setpoint]
    assert np.all(thrusts >= 1.0 - 1e-9)
    assert np.all(thrusts <= 0.95 * model.parameters.thrust_max + 1e-9)
