"""Wind estimator: drag of moving air, and the wind estimated from it."""

from __future__ import annotations

import numpy as np
import pytest
from plain_flatness import payload_drag_along

from idc_controller.estimation.settings import WindSettings
from idc_controller.estimation.wind import WindEstimator
from idc_controller.model.drag import Air, drag_coefficients

AREAS = np.array([0.5, 0.5, 1.0])
PERIOD = 0.05
LIMIT = 1e3
TIMES = PERIOD * np.arange(600)


def eight(times):
    """Derivatives 0 .. 4 (5, K, 3) of a figure eight."""
    orders = np.arange(5)[:, None]
    x = 6.0 * 0.5**orders * np.sin(0.5 * times + orders * np.pi / 2)
    y = -3.0 * np.sin(times + orders * np.pi / 2)
    return np.stack([x, y, np.zeros_like(x)], axis=2)


def estimated_wind(force_at, times=TIMES, noise=0.05, seed=5):
    """Return the estimated air after a figure eight; ``force_at`` (velocity) -> force on payload and on each UAV."""
    estimator, generator = WindEstimator(AREAS, PERIOD, LIMIT), np.random.default_rng(seed)
    for velocity in eight(times)[1]:
        force, uav_force = force_at(velocity)
        estimator.learn(force + noise * generator.standard_normal(3), uav_force, velocity)
    return estimator.air


@pytest.mark.parametrize("limit", [np.inf, 12.0], ids=["plain", "fading"])
def test_drag_rates_are_derivatives_of_drag(limit):
    air, h = Air(np.array([2.0, 1.0, 0.2]), drag_coefficients(AREAS), 0.02, limit), 1e-4
    force, rate, acceleration = payload_drag_along(air, eight(TIMES))
    before, after = (payload_drag_along(air, eight(TIMES + d)) for d in (-h, h))
    assert force == pytest.approx(air.on_payload(eight(TIMES)[1]))
    assert rate == pytest.approx((after[0] - before[0]) / (2 * h), abs=1e-3)
    assert acceleration == pytest.approx((after[1] - before[1]) / (2 * h), abs=1e-2)
    assert np.linalg.norm(force, axis=1).max() < limit


@pytest.mark.parametrize("wind", [(2.1, 2.1), (-3.0, 0.5), (0.0, -4.0)])
@pytest.mark.parametrize("factor", [0.7, 1.0, 1.4])
def test_steady_wind_and_drag_factor_are_estimated(wind, factor):
    true = Air(np.array([*wind, 0.0]), factor * drag_coefficients(AREAS), 0.018)
    air = estimated_wind(lambda velocity: (true.on_payload(velocity), true.on_uav(velocity)))
    assert air.wind == pytest.approx(true.wind, abs=0.3)
    for velocity in ([0.0, 0.0, 0.0], [3.0, 2.0, 0.0], [-3.0, 2.0, 0.0], [-2.0, -3.0, 0.0]):
        expected = true.on_payload(np.array(velocity))
        assert air.on_payload(np.array(velocity)) == pytest.approx(expected, abs=0.12 * np.linalg.norm(expected) + 0.3)
    assert air.uav == pytest.approx(true.uav, rel=0.2)


def test_wind_between_the_outermost_nodes_of_the_grid_is_estimated():
    outermost = WindSettings().speed_max
    true = Air(np.array([0.7 - outermost, 0.0, 0.0]), drag_coefficients(AREAS), 0.018)
    air = estimated_wind(lambda velocity: (true.on_payload(velocity), true.on_uav(velocity)), noise=0.0)
    assert air.wind == pytest.approx(true.wind, abs=0.1)


def test_wind_is_zero_without_force():
    assert estimated_wind(lambda _: (np.zeros(3), np.zeros(3))) is None


def test_wind_is_zero_for_force_independent_of_velocity():
    assert estimated_wind(lambda _: (np.array([0.0, 8.0, 0.0]), np.zeros(3))) is None


def test_wind_is_zero_for_force_along_velocity():
    assert estimated_wind(lambda velocity: (1.5 * velocity, np.zeros(3))) is None


def test_wind_estimate_ends_after_wind():
    true = Air(np.array([2.1, 2.1, 0.0]), drag_coefficients(AREAS), 0.018)
    estimator = WindEstimator(AREAS, PERIOD, LIMIT)
    for velocity in eight(TIMES)[1]:
        estimator.learn(true.on_payload(velocity), true.on_uav(velocity), velocity)
    assert estimator.air is not None
    for velocity in eight(TIMES)[1]:
        estimator.learn(np.zeros(3), np.zeros(3), velocity)
    assert estimator.air is None
