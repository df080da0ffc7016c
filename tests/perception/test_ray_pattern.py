"""The rays of a range sensor: evenly over the field of view, and interleaved from scan to scan."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

from idc_controller.perception.range_sensors import RayPattern, scan_index

FIELDS = [(500, -70.0, 30.0), (200, -50.0, 30.0), (1000, -7.0, 52.0), (300, -15.0, 15.0)]


def pattern_of(rays, low, high):
    return RayPattern(rays, math.radians(low), math.radians(high))


def directions_in(pattern, count, seed=1):
    """Evenly distributed directions in the field of view."""
    rng = np.random.default_rng(seed)
    up = rng.uniform(math.sin(pattern.elevation_min), math.sin(pattern.elevation_max), count)
    azimuth, level = rng.uniform(0.0, math.tau, count), np.sqrt(1.0 - up * up)
    return np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), -up])


@pytest.mark.parametrize("field", FIELDS, ids=str)
def test_directions_are_unit_vectors_in_the_field_of_view_the_lowest_first(field):
    pattern = pattern_of(*field)
    for scan in (0, 1, 12345):
        directions = pattern.directions(scan)
        assert directions.shape == (field[0], 3)
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, atol=1e-12)
        elevations = np.degrees(np.arcsin(-directions[:, 2]))
        assert field[1] < elevations.min() and elevations.max() < field[2]
        assert np.all(np.diff(elevations) > 0.0)


@pytest.mark.parametrize("field", FIELDS, ids=str)
def test_one_scan_leaves_no_gap_larger_than_the_mean_spacing(field):
    """The largest circle without a ray has a radius of a spacing (7.7 deg by default), at the edge of the field."""
    pattern = pattern_of(*field)
    gaps, _ = KDTree(pattern.directions(7)).query(directions_in(pattern, 20_000))
    assert gaps.max() < 1.03 * pattern.spacing
    # Evenly: shares of the rays in six parts of equal size.
    azimuth = np.arctan2(*pattern.directions(7)[:, 1::-1].T) % math.tau
    shares = np.histogram(azimuth, 6, (0.0, math.tau))[0] / field[0]
    np.testing.assert_allclose(shares, 1.0 / 6.0, rtol=0.06)


@pytest.mark.parametrize("field", FIELDS, ids=str)
def test_successive_scans_interleave(field):
    """Of K scans, the largest gap is below 1.45 times the spacing of as many rays at once, from wherever they begin."""
    pattern, places = pattern_of(*field), directions_in(pattern_of(*field), 20_000)
    for first in (0, 4711):
        for count in (2, 3, 4, 5, 8, 16, 32):
            rays = np.concatenate([pattern.directions(first + k) for k in range(count)])
            gaps, _ = KDTree(rays).query(places)
            assert gaps.max() < 1.45 * pattern.spacing / math.sqrt(count)


def test_spacing_is_that_of_a_square_of_a_rays_share():
    assert math.degrees(pattern_of(500, -70.0, 30.0).spacing) == pytest.approx(7.71, abs=0.01)
    assert pattern_of(100, -90.0, 90.0).spacing == pytest.approx(math.sqrt(4.0 * math.pi / 100.0))


@settings(deadline=None, derandomize=True)
@given(st.integers(0, 2**31), st.sampled_from((1, 5, 10, 20, 25)), st.integers(-1, 1))
def test_scan_index_counts_scans_by_their_stamps(scan, rate, rounding):
    """Stamps are whole milliseconds: one more or less does not matter."""
    assert scan_index(scan * 1000 // rate + rounding, rate) == scan


def test_pattern_is_a_function_of_settings_and_index():
    np.testing.assert_array_equal(
        pattern_of(500, -70.0, 30.0).directions(43), pattern_of(500, -70.0, 30.0).directions(43)
    )
    assert np.abs(pattern_of(500, -70.0, 30.0).directions(44) - pattern_of(500, -70.0, 30.0).directions(43)).max() > 0.1
