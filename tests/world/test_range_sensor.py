"""Range sensors: first hits of rays, noise, misses, the ground, repeatability."""

import math
from statistics import NormalDist

import numpy as np
import pybullet
import pytest
from bodies import random_scene

from gcs.config import RangeSensorConfig
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.perception.range_sensors import RayPattern
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion
from vehicle_sim.world.obstacle_bodies import ObstacleBodies
from vehicle_sim.world.range_sensor import RangeSensor, RayBodies
from vehicle_sim.world.ray_cast_kernels import first_hits
from vehicle_sim.world.sensors import Measurement
from vehicle_sim.world.world_state import flipped

REACH = 10.0
LEVEL = (1.0, 0.0, 0.0, 0.0)
HIGH = (0.0, 0.0, -50.0)
"""Out of reach of the ground."""


def hits(directions, place, bodies, attitude=LEVEL, reach=REACH):
    return first_hits(np.array(directions, dtype=float), np.array([*place, *attitude]), reach, *RayBodies.of(bodies))


def random_directions(rng, count):
    directions = rng.normal(size=(count, 3))
    directions[: min(count, 6)] = np.vstack([np.eye(3), -np.eye(3)])[:count]  # along the axes, too
    return directions / np.linalg.norm(directions, axis=1)[:, None]


# First hits


def test_rays_meet_the_ground():
    directions = [(0.0, 0.0, 1.0), (0.8, 0.0, 0.6), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)]
    assert hits(directions, (3.0, -2.0, -4.5), ()).tolist() == pytest.approx([4.5, 7.5, math.inf, math.inf])
    assert hits(directions, (0.0, 0.0, -11.0), ()).tolist() == [math.inf] * 4
    assert hits(directions, (0.0, 0.0, 0.5), ())[0] == 0.0


@pytest.mark.parametrize("seed", range(12))
def test_first_hits_agree_with_signed_distances(seed):
    """Up to the hit every body is off the ray, and the hit lies on the surface of one; without a hit, all the way."""
    rng = np.random.default_rng(seed)
    bodies = random_scene(seed, 12)
    attitude = tuple(quaternion_from_euler(*rng.normal(size=3)))
    directions = random_directions(rng, 200)
    found = hits(directions, HIGH, bodies, attitude)
    rays = directions @ rotation_from_quaternion(np.array(attitude)).T
    shapes, centres = Bodies([shape for shape, _ in bodies]), np.array([centre for _, centre in bodies])
    assert np.isfinite(found).any()
    for ray, distance in zip(rays, found, strict=True):
        if distance == 0.0:
            assert shapes.distance(np.array([HIGH]), centres).min() <= 1e-9
            continue
        steps = np.linspace(0.0, min(distance, REACH), 100)[:, None]
        apart = shapes.distance(np.array(HIGH) + steps * ray, centres).min(axis=0)
        assert apart.min() > -1e-7
        if distance < math.inf:
            assert abs(apart[-1]) < 1e-7


@pytest.mark.parametrize("kind", range(6))
def test_first_hits_agree_with_the_physics_engine(kind):
    """Rays that graze an edge may hit in one and pass in the other: the engine's bodies have margins."""
    found, expected = [], []
    for seed in range(5):
        rng, client = np.random.default_rng([seed, kind]), pybullet.connect(pybullet.DIRECT)
        try:
            obstacles = ObstacleBodies(client)
            for k, (shape, centre) in enumerate(random_scene(seed, 12, kind)):
                obstacles.add(str(k), shape, centre)
            first = obstacles.all()[0]
            x, y, z = first.position_in_world
            obstacles.move(first.name, (1.1 * x, 1.1 * y, z))
            directions = random_directions(rng, 1000)
            found.append(first_hits(directions, np.array([*HIGH, *LEVEL]), REACH, *obstacles.ray_bodies))
            ends = [flipped(tuple(np.array(HIGH) + REACH * direction)) for direction in directions]
            engine = pybullet.rayTestBatch([flipped(HIGH)] * len(ends), ends, physicsClientId=client)
        finally:
            pybullet.disconnect(client)
        expected.append([REACH * share if body >= 0 else math.inf for body, _, share, _, _ in engine])
    ours, theirs = np.concatenate(found), np.concatenate(expected)
    hit = np.isfinite(ours) & np.isfinite(theirs)
    assert hit.sum() > 200
    assert (np.isfinite(ours) != np.isfinite(theirs)).sum() < 0.02 * hit.sum()
    differences = np.abs(ours[hit] - theirs[hit])
    assert np.median(differences) < 0.003
    assert np.mean(differences > 0.02) < 0.01


# Scans


def scan_of(config, bodies, place=HIGH, attitude=LEVEL, index=0, estimate=None, seed=1, vehicle=1):
    return RangeSensor(config, seed, vehicle).scan(0.0, 100 * index, place, attitude, estimate, RayBodies.of(bodies))


def estimate_at(place, attitude=LEVEL):
    return Measurement(0.0, tuple(attitude), (0.0,) * 3, tuple(place), (0.0,) * 3)


AROUND = [(Wall((0.2, 12.0, 12.0)), (5.0, 0.0, -50.0)), (Pole(0.3, 8.0), (-3.0, 2.0, -50.0))]
EXACT = RangeSensorConfig(noise=0.0, missed_share=0.0)


def test_returns_lie_on_the_rays_of_the_pattern_in_their_order():
    config = RangeSensorConfig(noise=0.1, missed_share=0.0)
    attitude = tuple(quaternion_from_euler(0.2, -0.1, 1.0))
    pattern = RayPattern(config.rays, math.radians(config.elevation_min_deg), math.radians(config.elevation_max_deg))
    for index in (0, 1, 77):
        noisy, exact = (scan_of(c, AROUND, attitude=attitude, index=index) for c in (config, EXACT))
        unit = noisy.points / np.linalg.norm(noisy.points, axis=1)[:, None]
        rays = np.argmax(unit @ pattern.directions(index).T, axis=1)
        np.testing.assert_allclose(unit, pattern.directions(index)[rays], atol=1e-12)
        assert np.all(np.diff(rays) > 0)
        np.testing.assert_allclose(np.cross(unit, exact.points), 0.0, atol=1e-9)


def test_noise_is_along_the_ray_with_the_given_deviation():
    config = RangeSensorConfig(noise=0.05, missed_share=0.0)
    errors = np.concatenate([
        np.linalg.norm(scan_of(config, AROUND, seed=seed).points, axis=1)
        - np.linalg.norm(scan_of(EXACT, AROUND, seed=seed).points, axis=1)
        for seed in range(40)
    ])  # fmt: skip
    assert len(errors) > 2000
    sigma = 0.05
    assert abs(errors.mean()) < 4.0 * sigma / math.sqrt(len(errors))
    assert errors.std() == pytest.approx(sigma, rel=4.0 / math.sqrt(2.0 * len(errors)))


def test_missed_share_is_that_of_the_settings():
    """Within the bound that a right share passes in all but one of a million runs."""
    share, hit, missed = 0.02, 0, 0
    sensors = [
        RangeSensor(RangeSensorConfig(noise=0.0, missed_share=s), 5, 1) for s in (0.0, share)
    ]  # fmt: skip
    bodies = RayBodies.of(AROUND)
    for index in range(400):
        full, thinned = (len(sensor.scan(0.0, 100 * index, HIGH, LEVEL, None, bodies).points) for sensor in sensors)
        hit, missed = hit + full, missed + full - thinned
    bound = NormalDist().inv_cdf(1.0 - 0.5e-6) * math.sqrt(hit * share * (1.0 - share))
    assert hit > 20_000
    assert abs(missed - share * hit) < bound


def test_returns_nearer_than_the_least_distance_are_not_made():
    near = [(Sphere(0.5), (1.0, 0.0, -50.0))]
    counts = [len(scan_of(RangeSensorConfig(range_min=least), near).points) for least in (0.05, 0.8, 3.0)]
    assert counts[0] > counts[1] > counts[2] == 0
    # Noise does not bring them nearer.
    points = scan_of(RangeSensorConfig(range_min=0.5, noise=0.2), near).points
    assert np.linalg.norm(points, axis=1).min() >= 0.5 - 1e-12


def test_field_of_view_and_number_of_rays_follow_the_settings():
    room = [
        (
            Wall((0.2, 30.0, 30.0), k * math.pi / 2),
            (6.0 * math.cos(k * math.pi / 2), 6.0 * math.sin(k * math.pi / 2), -50.0),
        )
        for k in range(4)
    ]
    config = RangeSensorConfig(
        noise=0.0, missed_share=0.0, rays=321, elevation_min_deg=-20.0, elevation_max_deg=40.0, range=20.0
    )
    points = scan_of(config, room).points
    assert len(points) == 321
    elevations = np.degrees(np.arcsin(-points[:, 2] / np.linalg.norm(points, axis=1)))
    assert -20.0 < elevations.min() < -19.0 and 39.0 < elevations.max() < 40.0


def test_ground_is_left_out_by_the_vehicles_own_pose():
    place, pole = (0.0, 0.0, -5.0), [(Pole(0.3, 8.0), (4.0, 0.0, -4.0))]
    everything = scan_of(EXACT, pole, place).points  # without a pose it cannot know
    right = scan_of(EXACT, pole, place, estimate=estimate_at(place)).points
    assert len(everything) > 5 * len(right) > 0
    assert (right[:, 2] - 5.0).max() < -0.3
    # One that takes itself to be 0.5 m higher takes the ground for an obstacle; lower: it leaves out more of the pole.
    too_high = scan_of(EXACT, pole, place, estimate=estimate_at((0.0, 0.0, -5.5))).points
    too_low = scan_of(EXACT, pole, place, estimate=estimate_at((0.0, 0.0, -3.5))).points
    assert len(too_high) == len(everything)
    assert len(too_low) < len(right)
    tilted = tuple(quaternion_from_euler(0.1, -0.2, 1.0))
    level_again = scan_of(EXACT, (), place, tilted, estimate=estimate_at(place, tilted)).points
    assert len(level_again) == 0


def test_noise_and_poses_of_the_default_sensors_leave_no_return_of_the_ground():
    """Of 70 000 rays that meet the ground."""
    config, rng, place = RangeSensorConfig(), np.random.default_rng(1), (0.0, 0.0, -4.0)
    sensor, met = RangeSensor(config, 1, 1), 0
    for index in range(400):
        true = tuple(quaternion_from_euler(*rng.normal(0.0, 0.1, 3)))
        turned = quaternion_from_euler(*rng.normal(0.0, math.radians(0.2), 3))
        estimate = estimate_at(np.array(place) + rng.normal(0.0, 0.02, 3), product(true, turned))
        assert len(sensor.scan(0.0, 100 * index, place, true, estimate, RayBodies.of(())).points) == 0
        met += np.isfinite(hits(sensor_directions(config, index), place, (), true)).sum()
    assert met > 70_000


def product(a, b):
    w, x, y, z = a
    s, i, j, k = b
    return (
        w * s - x * i - y * j - z * k, w * i + x * s + y * k - z * j, w * j - x * k + y * s + z * i,
        w * k + x * j - y * i + z * s,
    )  # fmt: skip


def sensor_directions(config, index):
    low, high = math.radians(config.elevation_min_deg), math.radians(config.elevation_max_deg)
    return RayPattern(config.rays, low, high).directions(index)


def test_seed_and_vehicle_decide_the_noise_and_the_scene_does_not():
    def run(seed, vehicle, bodies=AROUND):
        sensor = RangeSensor(RangeSensorConfig(), seed, vehicle)
        return [
            sensor.scan(0.1 * k, 100 * k, HIGH, LEVEL, None, RayBodies.of(bodies)).points.tolist() for k in range(5)
        ]

    assert run(1, 1) == run(1, 1)
    assert run(1, 1) != run(1, 2)
    assert run(1, 1) != run(2, 1)
    sphere = [(Sphere(0.5), (-3.0, -2.0, -50.0))]
    for around, alone, together in zip(run(1, 1), run(1, 1, sphere), run(1, 1, AROUND + sphere), strict=True):
        assert sorted(around + alone) == sorted(together)
