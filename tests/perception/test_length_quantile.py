"""Quantile of the length of normal errors."""

import numpy as np
import pytest

from idc_controller.estimation.health.chi_squared import length_quantile, upper_quantile


def test_length_quantile_is_exact_for_one_axis_and_for_equal_ones():
    covariance = np.array([np.diag([4.0, 0.0, 0.0]), 4.0 * np.eye(3)])
    expected = 2.0 * np.sqrt(upper_quantile(0.01, np.array([1.0, 3.0])))
    np.testing.assert_allclose(length_quantile(0.01, covariance), expected)
    assert length_quantile(0.01, np.zeros((1, 3, 3)))[0] == 0.0


@pytest.mark.parametrize("seed", range(5))
def test_about_one_error_of_a_hundred_is_longer_than_its_quantile(seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(3, 3)) * rng.uniform(0.1, 3.0, 3)
    errors = rng.normal(size=(40_000, 3)) @ root.T
    longer = np.linalg.norm(errors, axis=1) > length_quantile(0.01, (root @ root.T)[None])[0]
    assert 0.006 < longer.mean() < 0.014
