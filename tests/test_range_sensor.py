"""The vehicles' range sensors: geometry, noise, repeatability, and messages."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from mission_files import MISSIONS
from obstacle_scene import pole, sphere, wall
from scripted_ground import ScriptedGround, exchange

from gcs.config import RangeSensorConfig, UnusableFile, read_system
from gcs.mavlink.codec import Codec
from gcs.mission.model import Obstacle
from gcs.mission.motion import HarmonicMotion
from idc_controller.geometry.box import Wall
from idc_controller.geometry.obstacles import Bodies
from idc_controller.geometry.pole import Pole
from idc_controller.geometry.sphere import Sphere
from idc_controller.geometry.visibility_kernels import points_of_pole, points_of_sphere
from idc_controller.rotations import quaternion_from_euler, rotation_from_quaternion
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.obstacle_bodies import ScanTargets
from vehicle_sim.world.range_sensor import RangeSensor, visible_rays
from vehicle_sim.world.range_sensor_kernels import measured, rays_in_reach

CONFIG = read_system()
REACH = 10.0
LEVEL = (1.0, 0.0, 0.0, 0.0)
OBSTACLES = [
    sphere((0.0, 0.0, -6.0), 0.5), sphere((0.0, 0.0, -6.0), 0.3), pole((0.0, 0.0), 0.2), pole((0.0, 0.0), 1.0, 4.0),
    wall((0.0, 0.0, -5.0)), wall((0.0, 0.0, -3.0), (6.0, 0.3, 6.0), -1.1), wall((0.0, 0.0, -4.0), (0.2, 30.0, 30.0)),
]  # fmt: skip


def body_of(obstacle):
    return Bodies([obstacle.shape])


def places(rng, count=40):
    for _ in range(count):
        direction = rng.normal(size=3) * [1.0, 1.0, 0.4]
        yield tuple(direction / np.linalg.norm(direction) * rng.uniform(1.5, 11.0) + [0.0, 0.0, -6.0])


@pytest.mark.parametrize("obstacle", OBSTACLES, ids=lambda o: f"{o.shape.kind} {o.shape.dimensions}")
def test_points_lie_on_the_visible_side_within_range_and_the_first_is_the_nearest(obstacle):
    centre = np.array([obstacle.position_in_world])
    body = body_of(obstacle)
    rng = np.random.default_rng(3)
    detected = 0
    for place in places(rng):
        distance = float(body.distance(np.array([place]), centre)[0, 0])
        points = place + visible_rays(obstacle, place, REACH, rng.uniform())
        if distance <= 0.0 or distance > REACH:
            assert len(points) == 0
            continue
        detected += 1
        on_surface = np.abs(body.distance(points, centre)[0])
        # Points on a pole's end lie within its rim.
        assert on_surface.max() < 1e-6
        ranges = np.linalg.norm(points - place, axis=1)
        assert ranges.max() <= REACH + 1e-6
        assert ranges[0] == pytest.approx(distance, abs=1e-6)
        assert ranges[0] == pytest.approx(ranges.min(), abs=1e-6)
        for share in np.linspace(0.02, 0.98, 25):  # not occluded by the obstacle itself
            between = np.array(place) + share * (points - place)
            assert body.distance(between, centre)[0].min() > -1e-6
    assert detected > 20


def test_kernels_agree_with_plain_functions():
    rng = np.random.default_rng(4)
    attitude = tuple(quaternion_from_euler(0.1, -0.2, 2.0))
    side, ring = rng.uniform(-0.9, 0.9, (6, 2)), rng.uniform(0.1, 0.9, 5)
    for place in places(rng):
        np.testing.assert_allclose(
            points_of_sphere(*place, 0.5, 0.3, ring), points_of_sphere.py_func(*place, 0.5, 0.3, ring), atol=1e-12
        )
        np.testing.assert_allclose(
            points_of_pole(*place, 0.2, 3.0, REACH, side, 0.95),
            points_of_pole.py_func(*place, 0.2, 3.0, REACH, side, 0.95), atol=1e-12,
        )  # fmt: skip
        points, errors = rng.normal(0.0, 6.0, (20, 3)), rng.normal(0.0, 0.05, 20)
        rays = rays_in_reach(points, *place, REACH)
        near = np.linalg.norm(points - place, axis=1) <= REACH
        np.testing.assert_allclose(rays, (points - place)[near], atol=1e-12)
        found, ranges = measured(rays, errors[near], *attitude, 5.0), np.linalg.norm(rays, axis=1)
        expected = rays @ rotation_from_quaternion(attitude) * (1.0 + errors[near] / ranges)[:, None]
        np.testing.assert_allclose(found, np.where(ranges[:, None] < 5.0, np.nan, expected), atol=1e-12)


def scanned_one_by_one(settings, seed, vehicle, scans):
    """Points of scans [(pose, obstacles)], obstacle by obstacle, nan for those too near, and their obstacles' names."""
    generator = np.random.default_rng([seed, 1_000_003, vehicle])
    for place, attitude, obstacles in scans:
        names, points = [], [np.empty((0, 3))]
        for obstacle in obstacles:
            if math.dist(obstacle.position_in_world, place) > settings.range + obstacle.bounding_radius:
                continue
            rays = visible_rays(obstacle, place, settings.range, generator.uniform(0.0, math.pi / 3.0))
            errors = settings.noise * generator.standard_normal(len(rays))
            points.append(measured(rays, errors, *attitude, settings.range_min))
            names += [obstacle.name] * len(rays)
        points = np.concatenate(points)
        is_measured = ~np.isnan(points[:, 0])
        yield np.array(names, dtype=object)[is_measured].tolist(), points[is_measured]


@pytest.mark.parametrize("seed", range(3))
def test_scan_of_many_obstacles_equals_that_of_one_after_another(seed):
    """To the bit: the same points, and the same random numbers in the same order."""
    settings, rng = RangeSensorConfig(range=8.0, noise=0.05), np.random.default_rng(seed)
    sensor, scans = RangeSensor(settings, seed, 2), []
    for _ in range(20):
        obstacles = [
            (
                sphere(rng.normal(0.0, 6.0, 3), rng.uniform(0.1, 1.0), f"sphere {k}"),
                pole(rng.normal(0.0, 6.0, 2), rng.uniform(0.1, 0.5), rng.uniform(1.0, 9.0), f"pole {k}"),
                wall(rng.normal(0.0, 6.0, 3), name=f"wall {k}"),
            )[rng.choice(3, p=[0.45, 0.45, 0.1])]
            for k in range(rng.integers(0, 30))
        ]
        scans.append((tuple(rng.normal(0.0, 1.0, 3)), tuple(quaternion_from_euler(*rng.normal(size=3))), obstacles))
    for (place, attitude, obstacles), (names, points) in zip(
        scans, scanned_one_by_one(settings, seed, 2, scans), strict=True
    ):
        scan = sensor.scan(0.0, place, attitude, ScanTargets.of(obstacles))
        np.testing.assert_array_equal(scan.points, points)
        number_of = dict(zip(names, scan.obstacle_ids.tolist(), strict=True))
        assert [number_of[name] for name in names] == scan.obstacle_ids.tolist()
        assert len(set(number_of.values())) == len(number_of)


def test_ends_are_hit_when_they_are_in_range():
    place = (-4.0, 0.0, -5.0)
    points = place + visible_rays(pole((0.0, 0.0), 0.2, 8.0), place, REACH, 0.0)
    assert points[:, 2].min() == pytest.approx(-8.0)
    assert points[:, 2].max() == pytest.approx(0.0)
    place = (-5.0, 0.0, -8.5)
    points = place + visible_rays(wall((0.0, 0.0, -5.0), (0.4, 6.0, 4.0), 0.0), place, REACH, 0.0)
    assert np.ptp(points[:, 1]) == pytest.approx(6.0)
    assert np.ptp(points[:, 2]) == pytest.approx(4.0)
    assert np.ptp(points[:, 0]) == pytest.approx(0.4)  # the top shows how thick it is


def test_noise_is_along_the_line_of_sight_with_the_given_deviation():
    obstacle = sphere((8.0, 0.0, -6.0), 0.5)
    attitude = tuple(quaternion_from_euler(0.2, -0.1, 1.0))
    noisy, exact = (
        RangeSensor(RangeSensorConfig(range=REACH, noise=0.05), 1, 1),
        RangeSensor(RangeSensorConfig(range=REACH, noise=0.0), 1, 1),
    )
    errors = []
    for k in range(300):
        p, q = (
            sensor.scan(0.1 * k, (0.0, 0.0, -6.0), attitude, ScanTargets.of([obstacle])).points
            for sensor in (noisy, exact)
        )
        # The nearest point does not depend on how the pattern is turned.
        assert np.linalg.norm(np.cross(p[0], q[0])) < 1e-9
        errors.append(np.linalg.norm(p[0]) - np.linalg.norm(q[0]))
    # Of 300 samples: the mean has a deviation of 0.05 / sqrt(300) = 0.0029 m, the deviation one of 1 / sqrt(600) = 4 %.
    assert np.mean(errors) == pytest.approx(0.0, abs=0.01)
    assert np.std(errors) == pytest.approx(0.05, rel=0.15)
    world = rotation_from_quaternion(np.array(attitude)) @ q[0]
    np.testing.assert_allclose(world, [7.5, 0.0, 0.0], atol=1e-9)


def test_seed_and_vehicle_decide_the_noise():
    def run(seed, vehicle):
        sensor = RangeSensor(RangeSensorConfig(range=REACH, noise=0.05), seed, vehicle)
        scans = [sensor.scan(0.1 * k, (0.0, 0.0, -6.0), LEVEL, ScanTargets.of(OBSTACLES_AROUND)) for k in range(5)]
        return [(scan.obstacle_ids.tolist(), scan.points.tolist()) for scan in scans]

    assert run(1, 1) == run(1, 1)
    assert run(1, 1) != run(1, 2)
    assert run(1, 1) != run(2, 1)


OBSTACLES_AROUND = [sphere((5.0, 0.0, -6.0), name="a"), pole((0.0, 6.0), name="b")]


def test_detection_numbers_are_per_vehicle_and_new_after_absence():
    sensor = RangeSensor(RangeSensorConfig(range=REACH, noise=0.05), 1, 1)
    first, second = sphere((9.0, 0.0, -6.0), name="first"), sphere((0.0, 9.0, -6.0), name="second")

    def numbers(position):
        return set(sensor.scan(0.0, position, LEVEL, ScanTargets.of([first, second])).obstacle_ids.tolist())

    assert numbers((0.0, 6.0, -6.0)) == {0}  # the second of the mission is the first that is detected
    assert numbers((2.0, 2.0, -6.0)) == {0, 1}
    assert numbers((-20.0, 0.0, -6.0)) == set()
    assert numbers((2.0, 2.0, -6.0)) == {2, 3}


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("range = 10.0", "range = 0.0", "range_sensor.range: "),
        ("rate = 10 ", "rate = 0 ", "range_sensor.rate: "),
        ("rate = 10 ", "rate = 30 ", "range_sensor.rate: 30 Hz does not divide physics"),
        ("rate = 10 ", "rate = 100 ", "range_sensor.rate: 100 Hz is faster than telemetry"),
        ("noise = 0.05 ", "noise = -0.1 ", "range_sensor.noise: "),
        ("noise = 0.05 ", "nose = 0.05 ", "range_sensor.nose: unknown key"),
    ],
)
def test_sensor_keys_of_system_file_are_read_strictly(tmp_path, old, new, reason):
    text = (MISSIONS / "system.toml").read_text()
    assert text.count(old) == 1
    path = tmp_path / "system.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(UnusableFile) as caught:
        read_system(path)
    assert any(reason in r for r in caught.value.reasons)


# On the wire

MISSION = (
    Obstacle("known", (6.0, 0.0, -3.0), Sphere(0.5)),
    Obstacle("unknown", (0.0, 6.0, -3.0), Sphere(0.4), known=False, motion=HarmonicMotion((1.0, 0.0, 0.0), 1.0)),
    Obstacle("far", (40.0, 0.0, -4.5), Pole(0.3, 9.0), known=False),
    Obstacle("wall", (-6.0, 0.0, -2.0), Wall((0.3, 4.0, 4.0)), known=False),
)


def detections(seed=1, obstacles=MISSION, faults=None, until=1.5, config=CONFIG):
    system = config.parameters()
    addresses = [("uav", i) for i in range(1, system.number_of_uavs + 1)]
    ground = ScriptedGround(addresses, float(system.hover_thrust.mean()), system.thrust_max)
    with Swarm(config, seed=seed, obstacles=obstacles, faults=faults) as swarm:
        exchange(swarm, ground, until)
    return ground


def test_swarm_sends_detected_obstacles():
    ground = detections()
    messages = ground.of_type("OBSTACLE_DISTANCE_3D")
    for vehicle in (1, 2, 3, 4):
        own = [m for m in messages if m.get_srcSystem() == vehicle]
        assert {m.obstacle_id for m in own} == {0, 1, 2}
        stamps = sorted({m.time_boot_ms for m in own})
        assert {b - a for a, b in pairwise(stamps)} == {100}
        poses = {m.time_boot_ms for m in ground.of_type("LOCAL_POSITION_NED", vehicle)}
        # A pose from which it can be placed: not older or newer than half an interval.
        assert all(min(abs(stamp - pose) for pose in poses) <= 20 for stamp in stamps)
        for m in own:
            assert m.frame == mavlink.MAV_FRAME_BODY_FRD
            assert m.get_srcComponent() == 1
            assert (m.min_distance, m.max_distance) == (pytest.approx(0.05), 10.0)
            assert math.hypot(m.x, m.y, m.z) < 10.5


def test_swarm_without_obstacles_sends_no_detections():
    assert detections(obstacles=()).of_type("OBSTACLE_DISTANCE_3D") == []


def test_equal_seeds_send_equal_messages():
    def points(seed):
        return [m.to_dict() for m in detections(seed, until=0.6).of_type("OBSTACLE_DISTANCE_3D")]

    assert points(3) == points(3)
    assert points(3) != points(4)


def test_detections_are_independent_of_names_shapes_and_map():
    def renamed(known):
        return tuple(replace(o, name=f"obstacle {i}", known=known) for i, o in enumerate(MISSION))

    def points(obstacles):
        return [m.to_dict() for m in detections(obstacles=obstacles, until=0.6).of_type("OBSTACLE_DISTANCE_3D")]

    assert points(renamed(True)) == points(renamed(False)) == points(MISSION)


def test_fault_injector_may_suppress_scans():
    class SensorLoss(FaultInjector):
        def range_sample(self, vehicle, sample):
            return (
                None
                if vehicle == 2
                else sample._replace(obstacle_ids=sample.obstacle_ids[:1], points=sample.points[:1])
            )

    ground = detections(faults=SensorLoss(), until=0.6)
    assert ground.of_type("OBSTACLE_DISTANCE_3D", 2) == []
    own = ground.of_type("OBSTACLE_DISTANCE_3D", 1)
    assert own
    assert len({m.time_boot_ms for m in own}) == len(own)


def test_detections_follow_rate_and_range_of_system_file():
    config = replace(CONFIG, range_sensor=replace(CONFIG.range_sensor, rate=5, range=5.0))
    ground = detections(config=config)
    assert ground.of_type("OBSTACLE_DISTANCE_3D") == []  # all are further away, but for the wall's distance of 5.35 m
    ground = detections(obstacles=(Obstacle("near", (3.0, 0.0, -3.0), Sphere(0.5)),), config=config)
    stamps = sorted({m.time_boot_ms for m in ground.of_type("OBSTACLE_DISTANCE_3D", 1)})
    assert {b - a for a, b in pairwise(stamps)} == {200}


def test_detections_are_encoded_by_the_dialect():
    codec = Codec(3, 1)
    message = mavlink.MAVLink_obstacle_distance_3d_message(
        1234, mavlink.MAV_DISTANCE_SENSOR_LASER, mavlink.MAV_FRAME_BODY_FRD, 7, 1.5, -2.0, 0.25, 0.0625, 10.0
    )
    frame = codec.encode(message)
    assert frame[7:10] == (11037).to_bytes(3, "little")
    expected = "d20400000000c03f000000c00000803e0000803d000020410700000c"
    assert frame[10:-2].hex() == expected
    [received] = Codec(255, 190).decode(frame)
    assert received.message.to_dict() == message.to_dict()
    broken = bytearray(frame)
    broken[15] ^= 1
    assert Codec(255, 190).decode(bytes(broken)) == []
