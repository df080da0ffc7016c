"""The kernels of trajectories against plain numpy, and the succession of plans against each plan by itself."""

import numpy as np
import pytest
from scipy.interpolate import BSpline, PPoly

from idc_controller.safety.safe_trajectory import Piece, SafeTrajectory
from idc_controller.safety.settings import PlannerSettings
from idc_controller.trajectory import trajectory_kernels as kernels
from idc_controller.trajectory.lissajous import LissajousTrajectory
from idc_controller.trajectory.lissajous_curve import LissajousCurve
from idc_controller.trajectory.scaled import ScaledReference
from idc_controller.trajectory.settings import Limits
from idc_controller.trajectory.spline import DEGREE, SUPPORT, evaluate

CHAIN = PlannerSettings().chain
CURVE = LissajousCurve((6.0, 3.0), -5.0, (1.0, -2.0))
EIGHT = LissajousTrajectory(CURVE, 0.5, 20.0, Limits(4.5, 3.6, 5.0, 6.0), start=10.0)


def chain_plainly(states, period, elapsed):
    """Taylor's formula from the stage before; beyond the last stage at its velocity."""
    stages = len(states) - 1
    stage = np.clip((elapsed / period).astype(int), 0, stages - 1)
    dt = np.clip(elapsed - stage * period, 0.0, period)[:, None]
    at = [states[stage, d] for d in range(5)] + [(states[stage + 1, 4] - states[stage, 4]) / period]
    result = np.empty((5, len(elapsed), 3))
    for d in range(5):
        value = at[5]
        for c in range(4, d - 1, -1):
            value = at[c] + value * dt / (c + 1 - d)
        result[d] = value
    over = elapsed - stages * period
    result[0] += np.maximum(over, 0.0)[:, None] * states[-1, 1]
    result[2:, over > 0.0] = 0.0
    return result


def figure_eight_plainly(phases):
    """The chain rule over the curve's own derivatives by its phase."""
    r, p = CURVE.by_phase(phases[0], 4), phases[:, :, None]
    derivatives = [
        r[0],
        r[1] * p[1],
        r[2] * p[1] ** 2 + r[1] * p[2],
        r[3] * p[1] ** 3 + 3.0 * r[2] * p[1] * p[2] + r[1] * p[3],
        r[4] * p[1] ** 4 + 6.0 * r[3] * p[1] ** 2 * p[2] + r[2] * (3.0 * p[2] ** 2 + 4.0 * p[1] * p[3]) + r[1] * p[4],
    ]
    return np.array(derivatives)


def deviation(seed):
    rng = np.random.default_rng(seed)
    return CHAIN.roll_out(rng.normal(size=(5, 3)), rng.normal(size=(CHAIN.knots, 3)))


def test_span_of_times_is_nan_unless_all_are_finite():
    assert kernels.span(np.array([3.0, -1.0, 2.0])) == (-1.0, 3.0)
    for bad in (np.nan, np.inf, -np.inf):
        assert np.isnan(kernels.span(np.array([0.0, bad, 1.0]))).all()


@pytest.mark.parametrize("order", range(5))
def test_spline_kernel_equals_scipy(order):
    rng = np.random.default_rng(order)
    points, interval = rng.normal(size=(9, 3)), 0.3
    arguments = rng.uniform(-3.0, 20.0, 200)
    found = evaluate(points, interval, arguments, order)
    padded = np.vstack([np.repeat(points[:1], DEGREE, axis=0), points, np.repeat(points[-1:], 2 * SUPPORT, axis=0)])
    curve = BSpline(np.arange(-DEGREE, len(padded) + 1.0) * interval, padded, DEGREE)
    times = np.clip(arguments, 0.0, len(points) + SUPPORT) * interval
    for d in range(order + 1):
        np.testing.assert_allclose(found[d], curve(times, d), rtol=1e-9, atol=1e-9 * 10.0**d)


@pytest.mark.parametrize("order", range(5))
def test_phase_kernel_equals_scipy(order):
    rng = np.random.default_rng(order)
    knots = np.array([0.0, 1.0, 2.5, 3.0])
    phase = PPoly(rng.normal(size=(9, 3)), knots)
    times = np.append(rng.uniform(-0.5, 3.5, 100), knots)
    found = kernels.phase(phase.c, phase.x, times, order, False)
    for d in range(order + 1):
        np.testing.assert_allclose(found[d], phase(times, d), rtol=1e-11, atol=1e-9)
    resting = kernels.phase(phase.c, phase.x, times, order, True)
    moves = (times > 0.0) & (times < 3.0)
    np.testing.assert_array_equal(resting[:, moves], found[:, moves])
    np.testing.assert_array_equal(resting[1:, ~moves], 0.0)
    np.testing.assert_allclose(resting[0, ~moves], phase(np.clip(times[~moves], 0.0, 3.0)), rtol=1e-12)


@pytest.mark.parametrize("order", range(5))
def test_figure_eight_kernel_equals_the_chain_rule(order):
    phases = np.random.default_rng(order).normal(size=(5, 50)) * 3.0
    found = kernels.figure_eight(CURVE.as_array(), phases[: order + 1])
    np.testing.assert_allclose(found, figure_eight_plainly(phases)[: order + 1], rtol=1e-12, atol=1e-10)


def test_chain_kernel_equals_taylors_formula():
    states = deviation(1)
    elapsed = np.random.default_rng(1).uniform(0.0, 1.5 * CHAIN.stages * CHAIN.period, 100)
    found = kernels.chain(states, CHAIN.period, elapsed)
    np.testing.assert_allclose(found, chain_plainly(states, CHAIN.period, elapsed), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("order", [0, 2, 4])
@pytest.mark.parametrize("rates", [(1.0, 1.0, 1.0), (1.0, 0.6, 0.0)])
@pytest.mark.parametrize("deflected", [(), (1,), (0, 2)])
@pytest.mark.parametrize("detours", [False, True])
def test_succession_of_plans_equals_each_plan_by_itself(order, rates, deflected, detours):
    other = LissajousTrajectory(CURVE, 0.4, 20.0, Limits(4.5, 3.6, 5.0, 6.0), start=8.0)
    pieces = [
        Piece(
            ScaledReference(other if detours and i == 1 else EIGHT, 14.0 + 0.1 * i, 15.0 + 0.2 * i, rate),
            deviation(i) if i in deflected else None,
        )
        for i, rate in enumerate(rates)
    ]
    times = np.random.default_rng(5).uniform(13.0, 18.0, 60)
    found = SafeTrajectory(pieces, CHAIN).derivatives(times, order)
    assert found.shape == (order + 1, 60, 3)
    for i, time in enumerate(times):
        piece = max(pieces, key=lambda p: p.start if p.start <= time else -1.0) if time >= 14.0 else pieces[0]
        at = piece.reference.derivatives(np.array([time]), order)
        if piece.deviation is not None:
            elapsed = np.array([max(time - piece.start, 0.0)])
            at = at + chain_plainly(piece.deviation, CHAIN.period, elapsed)[: order + 1]
        np.testing.assert_allclose(found[:, i], at[:, 0], rtol=1e-12, atol=1e-12)


def test_piece_with_integers_equals_the_one_with_floats():
    times = np.linspace(13.0, 18.0, 11)
    integers, floats = (
        SafeTrajectory([Piece(ScaledReference(EIGHT, of(14), of(15), of(1)), None)], CHAIN).derivatives(times)
        for of in (int, float)
    )
    assert np.array_equal(integers, floats)
