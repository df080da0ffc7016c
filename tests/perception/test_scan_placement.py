"""Placement of scans: returns with their covariances, rays without a return, and what may be missing."""

import math
from dataclasses import replace

import numpy as np
import pytest
from bodies import random_scene
from range_scene import return_variance

from gcs.config import RangeSensorConfig
from idc_controller.estimation.measurements import Attitude, Position
from idc_controller.geometry.shapes import Pole, Wall
from idc_controller.perception.placed_scan import PlacedScan
from idc_controller.perception.range_sensors import RayPattern, SensorModel
from idc_controller.perception.scan_placement import Returns, ScanEnd, ScanPlacement, SensorRays
from idc_controller.perception.scan_placement_kernels import (
    free_ends,
    placed_returns,
    rays_of_returns,
    repeated_returns,
)
from idc_controller.perception.settings import ScanSettings
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion
from vehicle_sim.world.range_sensor import RangeSensor, RayBodies
from vehicle_sim.world.ray_cast_kernels import first_hits
from vehicle_sim.world.sensors import Measurement

CONFIG = RangeSensorConfig(rays=500)
PATTERN = RayPattern(CONFIG.rays, math.radians(CONFIG.elevation_min_deg), math.radians(CONFIG.elevation_max_deg))
RAYS = SensorRays(PATTERN, CONFIG.rate, CONFIG.ground_height)
SENSORS = SensorModel(0.05, 0.02, math.radians(0.2))
EXACT = SensorModel(0.0, 0.0, 0.0)
RAY_OFFSET_DURATION = ScanSettings().ray_offset_duration
HERE = np.array([1.0, -2.0, -6.0])
TILTED = quaternion_from_euler(0.1, -0.15, 2.0)
SCENE = [(Wall((0.3, 6.0, 5.0), 0.4), (5.0, -1.0, -3.0)), (Pole(0.2, 12.0), (-2.0, 2.0, -6.0))]
NOT_MISSED = replace(CONFIG, noise=0.0, missed_share=0.0)


def measure(config=NOT_MISSED, stamp=1300, bodies=SCENE, place=HERE, attitude=TILTED, seed=1):
    """The points of a scan (n, 3) as the wire holds them."""
    own = Measurement(0.0, tuple(attitude), (0.0,) * 3, tuple(place), (0.0,) * 3)
    scan = RangeSensor(config, seed, 1).scan(0.0, stamp, place, tuple(attitude), own, RayBodies.of(bodies))
    return scan.points.astype(np.float32).astype(float)


def placement(sensors=EXACT, uav=0, time=1.3, place=HERE, attitude=TILTED):
    """A placement that knows the pose of a vehicle at a time."""
    placing = ScanPlacement(sensors, RAYS)
    placing.poses.add_measured(Position(time, uav, np.array(place), np.zeros(3)))
    placing.poses.add_measured(Attitude(time, uav, np.array(attitude), np.zeros(3)))
    return placing


def returns_of(points, stamp=1300):
    return Returns(stamp, points, np.full(len(points), 10.0))


def placed(points, complete=True, sensors=EXACT, stamp=1300, now=1.4, **pose):
    placing = placement(sensors, **pose)
    placing.add(returns_of(points, stamp), 0, 1.3, 1.31)
    placing.end(ScanEnd(stamp, 10.0, complete), 0, 1.3, 1.31)
    return placing.scans(now)


# Kernels


def brute_rays(points, directions):
    unit = points / np.linalg.norm(points, axis=1)[:, None]
    angles = np.arctan2(np.linalg.norm(np.cross(unit[:, None], directions[None]), axis=2), unit @ directions.T)
    return angles.argmin(axis=1), angles.min(axis=1)


@pytest.mark.parametrize(
    "pattern", [PATTERN, RayPattern(1, -0.3, 0.3), RayPattern(37, -1.5, 1.5)], ids=lambda p: p.rays
)
def test_return_is_assigned_to_the_ray_next_to_it(pattern):
    rng = np.random.default_rng(1)
    for scan in range(10):
        directions = pattern.directions(scan)
        on = (directions * rng.uniform(0.05, 10.0, (pattern.rays, 1))).astype(np.float32).astype(float)
        rays, angles = rays_of_returns(on, directions)
        np.testing.assert_array_equal(rays, np.arange(pattern.rays))
        assert angles.max() < 1e-6
        anywhere = rng.normal(size=(60, 3)) * 5.0
        rays, angles = rays_of_returns(anywhere, directions)
        expected_rays, expected = brute_rays(anywhere, directions)
        np.testing.assert_array_equal(rays, expected_rays)
        np.testing.assert_allclose(angles, expected, atol=1e-9)


def test_repeated_returns_are_those_that_came_before():
    points = np.array([[1.0, 0, 0], [2.0, 0, 0], [1.0, 0, 0], [0, 1.0, 0], [0, 1.0, 0], [1.0, 0, 0], [1.0, 0, 0]])
    rays = np.array([3, 4, 3, 0, 0, 1, 3])
    assert repeated_returns(points, rays, 5).tolist() == [False, False, True, False, True, False, True]


def test_returns_are_placed_once_with_their_distances_from_the_rays():
    rng, directions = np.random.default_rng(1), PATTERN.directions(3)
    points = rng.normal(size=(40, 3)) * 4.0
    points[7], points[30] = points[2], points[2]
    places, rays, (square, angle) = placed_returns(
        points, directions, np.array(HERE), np.ascontiguousarray(rotation_from_quaternion(TILTED))
    )
    kept = np.delete(points, [7, 30], axis=0)
    expected_rays, angles = brute_rays(kept, directions)
    np.testing.assert_allclose(places, HERE + kept @ rotation_from_quaternion(TILTED).T, atol=1e-12)
    np.testing.assert_array_equal(rays, expected_rays)
    assert square == pytest.approx(np.mean((angles * np.linalg.norm(kept, axis=1)) ** 2))
    assert angle == pytest.approx(angles.max())


def test_covariances_are_those_of_noise_along_the_ray_and_of_the_pose():
    points = np.random.default_rng(1).normal(size=(30, 3)) * 4.0
    scan = PlacedScan(0.0, HERE, HERE + points, 0.05, 0.02, 0.03)
    for point, found in zip(points, return_variance(scan), strict=True):
        unit = point / np.linalg.norm(point)
        across = np.array([[0, -point[2], point[1]], [point[2], 0, -point[0]], [-point[1], point[0], 0]])
        expected = 0.05**2 * np.outer(unit, unit) + 0.02**2 * np.eye(3) + 0.03**2 * across @ across.T
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_free_rays_end_at_the_range_and_above_the_ground():
    directions, rotation = PATTERN.directions(5), np.ascontiguousarray(rotation_from_quaternion(TILTED))
    hit = np.arange(0, 500, 7)
    ends = free_ends(directions, hit, np.array(HERE), rotation, 10.0, 0.4)
    world = np.delete(directions, hit, axis=0) @ rotation.T
    with np.errstate(divide="ignore"):
        lengths = np.where(world[:, 2] > 0.0, np.minimum((6.0 - 0.4) / world[:, 2], 10.0), 10.0)
    np.testing.assert_allclose(ends, HERE + lengths[:, None] * world, atol=1e-9)
    assert ends[:, 2].max() <= -0.4 + 1e-9
    assert len(free_ends(directions, hit, np.array([0.0, 0.0, -0.3]), rotation, 10.0, 0.4)) == 0


# Scans


@pytest.mark.parametrize("seed", range(8))
def test_returns_lie_on_surfaces_and_free_rays_meet_nothing(seed):
    """Without noise: in random scenes, by first hits from the sensor towards all of them."""
    bodies = random_scene(seed, 10, high=-6.0)
    place, attitude = (
        np.array([0.0, 0.0, -6.0]),
        quaternion_from_euler(*np.random.default_rng(seed).normal(0.0, 0.2, 3)),
    )
    points = measure(bodies=bodies, place=place, attitude=attitude)
    [scan] = placed(points, place=place, attitude=attitude)
    assert (scan.uav, scan.time) == (0, 1.3)
    np.testing.assert_array_equal(scan.origin, place)
    pose, targets = np.array([*place, 1.0, 0.0, 0.0, 0.0]), RayBodies.of(bodies)
    for ends, are_hits in ((scan.returns, True), (scan.free_rays, False)):
        lengths = np.linalg.norm(ends - place, axis=1)
        first = first_hits((ends - place) / lengths[:, None], pose, 20.0, *targets)
        if are_hits:
            np.testing.assert_allclose(first, lengths, atol=1e-5)
        else:
            assert np.all(first >= lengths - 1e-5)
    assert len(scan.returns) == len(points) > 0
    # The others met the ground's lowest part, or are obstacles' lowest returns.
    assert len(scan.returns) + len(scan.free_rays) == 500


def test_incomplete_scan_has_no_free_rays():
    points = measure()
    [whole], [part] = placed(points), placed(points[::2].copy(), complete=False, now=1.5)
    assert len(whole.free_rays) > 300 and len(part.free_rays) == 0
    np.testing.assert_array_equal(part.returns, whole.returns[::2])


def test_incomplete_scan_waits_for_late_messages_and_a_complete_one_does_not():
    points = measure()
    placing = placement()
    placing.add(returns_of(points[:20]), 0, 1.3, 1.31)
    assert placing.scans(1.35) == []
    placing.end(ScanEnd(1300, 10.0, False), 0, 1.3, 1.35)
    placing.add(returns_of(points[20:40]), 0, 1.3, 1.36)
    [scan] = placing.scans(1.42)
    assert len(scan.returns) == 40
    placing.add(returns_of(points[40:]), 0, 1.3, 1.45)  # too late
    assert placing.discarded == len(points) - 40
    assert placing.scans(2.0) == []


def test_scan_that_hit_nothing_has_only_free_rays():
    placing = placement()
    placing.end(ScanEnd(1300, 10.0, True), 0, 1.3, 1.3)
    [scan] = placing.scans(1.3)
    assert scan.returns.shape == (0, 3) and return_variance(scan).shape == (0, 3, 3)
    assert len(scan.free_rays) == 500
    assert np.linalg.norm(scan.free_rays - HERE, axis=1).max() == pytest.approx(10.0)


def test_duplicated_messages_count_once():
    points = measure()
    placing = placement()
    for _ in range(2):
        placing.add(returns_of(points), 0, 1.3, 1.31)
        placing.end(ScanEnd(1300, 10.0, True), 0, 1.3, 1.31)
    [scan] = placing.scans(1.35)
    assert len(scan.returns) == len(points)
    placing.end(ScanEnd(1300, 10.0, True), 0, 1.3, 1.4)
    assert placing.scans(1.4) == []


def test_impossible_returns_spoil_the_free_rays():
    points = measure()
    points[3] = math.nan
    [scan] = placed(points)
    assert len(scan.returns) == len(points) - 1
    assert len(scan.free_rays) == 0


@pytest.mark.parametrize(
    "disturbed",
    [
        lambda p: p + np.random.default_rng(1).normal(0.0, 0.3, p.shape),
        lambda p: p + 0.3,
        lambda p: p * [1.0, -1.0, 1.0],
    ],
    ids=["noise", "bias", "mirrored"],
)
def test_returns_off_the_rays_have_the_variance_that_they_show_and_no_free_rays(disturbed):
    points = measure()
    [right], [wrong] = placed(points, sensors=SENSORS), placed(disturbed(points), sensors=SENSORS)
    assert len(wrong.free_rays) == 0 < len(right.free_rays)
    smallest = np.linalg.eigvalsh(return_variance(right))[:, 0], np.linalg.eigvalsh(return_variance(wrong))[:, 0]
    assert np.sqrt(smallest[0]).max() < 0.05
    assert np.sqrt(smallest[1]).min() > 0.12


def test_scatter_of_last_scans_counts_for_a_scan_with_few_returns():
    placing, points = placement(SENSORS), measure()

    def sigma(stamp, returned):
        time = stamp * 1e-3
        placing.poses.add_measured(Position(time, 0, HERE, np.zeros(3)))
        placing.poses.add_measured(Attitude(time, 0, np.array(TILTED), np.zeros(3)))
        placing.add(returns_of(returned, stamp), 0, time, time)
        placing.end(ScanEnd(stamp, 10.0, True), 0, time, time)
        [scan] = placing.scans(time)
        return scan.position_sigma

    assert sigma(1300, points) == pytest.approx(SENSORS.position, rel=1e-3)
    right = measure(stamp=1400)
    wrong = sigma(1400, right + np.random.default_rng(1).normal(0.0, 0.3, right.shape))
    assert wrong > 0.15
    assert sigma(1500, measure(stamp=1500)[:1]) > 0.6 * wrong  # of the two scans before
    for k in range(16, 60):  # and is forgotten
        last = sigma(100 * k, measure(stamp=100 * k))
    assert last == pytest.approx(SENSORS.position, rel=0.02)


def test_scan_of_another_index_is_off_the_rays():
    """Old points under a new stamp, as of a sensor that is stuck."""
    [scan] = placed(measure(stamp=1200))
    assert len(scan.free_rays) == 0


def test_placement_scales_and_replaces_poses_as_asked():
    points = measure()
    placing = placement(SENSORS)
    placing.add(returns_of(points), 0, 1.3, 1.31)
    placing.end(ScanEnd(1300, 10.0, True), 0, 1.3, 1.31)
    [scan] = placing.scans(1.35, pose_noise_scale=3.0)
    assert (scan.position_sigma, scan.attitude_sigma) == pytest.approx((0.06, math.radians(0.6)))
    assert placing.scans(1.4) == []
    unknown = placement(SENSORS)
    unknown.add(returns_of(points), 0, 1.3, 1.31)
    assert unknown.scans(1.5, unusable_attitudes=frozenset({0})) == []  # it waits for an estimate
    assert unknown.scans(1.7, unusable_attitudes=frozenset({0})) == []
    assert unknown.discarded == len(points)


def test_flood_of_returns_is_bounded():
    placing = placement()
    for k in range(5000):
        placing.add(returns_of(np.ones((1, 3)), 5000 + k), 0, 5.0, 5.0)
        placing.end(ScanEnd(5000 + k, 10.0, True), 0, 5.0, 5.0)
    assert placing.discarded > 4900
    whole = placement()
    for _ in range(100):
        whole.add(returns_of(np.random.default_rng(1).normal(size=(500, 3))), 0, 1.3, 1.3)
    assert whole.discarded > 40_000


def test_scan_of_many_rays_is_placed_whole():
    pattern = RayPattern(5000, PATTERN.elevation_min, PATTERN.elevation_max)
    placing = ScanPlacement(EXACT, SensorRays(pattern, CONFIG.rate, CONFIG.ground_height))
    placing.poses.add_measured(Position(1.3, 0, HERE, np.zeros(3)))
    placing.poses.add_measured(Attitude(1.3, 0, np.array(TILTED), np.zeros(3)))
    placing.add(returns_of(3.0 * pattern.directions(13)), 0, 1.3, 1.3)
    placing.end(ScanEnd(1300, 10.0, True), 0, 1.3, 1.3)
    [scan] = placing.scans(1.3)
    assert (len(scan.returns), len(scan.free_rays), placing.discarded) == (5000, 0, 0)


def test_stuck_sensor_is_invalid():
    points, placing = measure(), ScanPlacement(SENSORS, RAYS)
    for k in range(20):
        stamp = 1300 + 100 * k
        time = stamp * 1e-3
        placing.poses.add_measured(Position(time, 0, HERE, np.zeros(3)))
        placing.poses.add_measured(Attitude(time, 0, np.array(TILTED), np.zeros(3)))
        placing.add(returns_of(points, stamp), 0, time, time)
        placing.end(ScanEnd(stamp, 10.0, True), 0, time, time)
        scans = placing.scans(time)
        assert bool(scans) == (k == 0)
    assert placing.range_sensors.valid((0,), 3.2) == ()


# Displaced returns


def test_scans_of_returns_beside_the_rays_are_discarded_once_the_sensor_is_displaced():
    placing, offset = placement(), np.array([0.05, -0.05, 0.04])
    for k in range(8):
        stamp, time = 1300 + 100 * k, 1.3 + 0.1 * k
        placing.poses.add_measured(Position(time, 0, HERE, np.zeros(3)))
        placing.poses.add_measured(Attitude(time, 0, np.array(TILTED), np.zeros(3)))
        placing.add(returns_of(measure(stamp=stamp) + offset, stamp), 0, time, time)
        placing.end(ScanEnd(stamp, 10.0, True), 0, time, time)
        is_displaced = 0.1 * k >= RAY_OFFSET_DURATION - 1e-9
        assert len(placing.scans(time)) == (not is_displaced)
        assert set(placing.range_sensors.displaced) == ({0} if is_displaced else set())
    assert placing.discarded > 0 and placing.range_sensors.valid((0,), 2.0) == ()


def test_scans_of_one_moment_are_placed_together_and_in_the_order_of_time():
    placing = placement()
    for uav, time in ((1, 1.3), (0, 1.4)):
        placing.poses.add_measured(Position(time, uav, HERE, np.zeros(3)))
        placing.poses.add_measured(Attitude(time, uav, np.array(TILTED), np.zeros(3)))
    assembly = ScanSettings().assembly
    for uav, stamp, complete in ((0, 1300, True), (1, 1300, False), (0, 1400, True)):
        time = 1e-3 * stamp
        placing.add(returns_of(measure(stamp=stamp), stamp), uav, time, 1.31)
        placing.end(ScanEnd(stamp, 10.0, complete), uav, time, 1.31)
    assert placing.scans(1.31 + 0.9 * assembly) == []
    found = [(scan.uav, round(scan.time, 3)) for scan in placing.scans(1.31 + 1.1 * assembly)]
    assert found == [(0, 1.3), (1, 1.3), (0, 1.4)]
