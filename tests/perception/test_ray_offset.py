"""Offsets of returns from the rays of their range sensor: found, ended, and not seen in noise."""

import math

import numpy as np
import pytest

from gcs.config import RangeSensorConfig
from idc_controller.perception.range_sensors import RayOffset, RayPattern
from idc_controller.perception.settings import ScanSettings

CONFIG, S = RangeSensorConfig(), ScanSettings()
PATTERN = RayPattern(CONFIG.rays, math.radians(CONFIG.elevation_min_deg), math.radians(CONFIG.elevation_max_deg))
DIAGONAL = np.ones(3)


def wall(scan, rng, azimuth, distance):
    """The returns (n, 3) of a scan of a wall, with noise along the rays, as the wire holds them, and all rays."""
    rays = PATTERN.directions(scan)
    along = distance / (rays @ np.array([math.cos(azimuth), math.sin(azimuth), 0.0]))
    hit = (along > 0.0) & (along < CONFIG.range)
    return rays[hit] * (along[hit] + CONFIG.noise * rng.normal(size=hit.sum()))[:, None], rays


def sent(points):
    return points.astype(np.float32).astype(float)


def flown(seed, displacement, scans=60, scatter=0.0):
    """The offset after scans whose returns are displaced by a function of the time, and when it was detected."""
    rng, offset, at = np.random.default_rng(seed), RayOffset(S), math.nan
    azimuth, distance = rng.uniform(0.0, math.tau), rng.uniform(2.0, 7.0)
    for k in range(scans):
        points, rays = wall(k, rng, azimuth, distance)
        points = points + scatter * rng.normal(size=points.shape) + displacement(0.1 * k)
        offset.add(0.1 * k, sent(points), rays)
        if offset.is_detected and math.isnan(at):
            at = 0.1 * k
    return offset, at


@pytest.mark.parametrize("rate", [0.05, -0.1])
@pytest.mark.parametrize("seed", range(3))
def test_drift_is_detected_once_it_is_large(seed, rate):
    offset, at = flown(seed, lambda t: rate * t * DIAGONAL)
    large = S.ray_offset_min / (abs(rate) * math.sqrt(3.0))
    assert large < at < large + S.ray_offset_duration + 0.8
    assert offset.is_detected


@pytest.mark.parametrize("scatter", [0.0, 0.05, 0.25])
@pytest.mark.parametrize("seed", range(4))
def test_noise_across_the_rays_is_no_offset(seed, scatter):
    offset, at = flown(seed, lambda t: np.zeros(3), scatter=scatter)
    assert math.isnan(at) and not offset.is_detected


def test_small_offset_is_none():
    _, at = flown(1, lambda t: 0.9 * S.ray_offset_min / math.sqrt(3.0) * DIAGONAL)
    assert math.isnan(at)


def test_offset_ends_a_while_after_returns_lie_on_the_rays_again():
    offset, at = flown(1, lambda t: 0.05 * DIAGONAL * (t < 2.0), scans=20 + round(10 * S.recovery) - 2)
    assert at < 2.0 and offset.is_detected
    offset, _ = flown(1, lambda t: 0.05 * DIAGONAL * (t < 2.0), scans=20 + round(10 * S.recovery) + 2)
    assert not offset.is_detected


def test_points_on_one_ray_say_nothing():
    offset, rays = RayOffset(S), PATTERN.directions(0)
    for k in range(20):
        offset.add(0.1 * k, 5.0 * rays[:1] + 0.01, rays)
    assert not offset.is_detected
