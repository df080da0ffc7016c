"""Range sensors in the system file and on the wire: returns without identity, and the end of each scan."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from scripted_ground import ScriptedGround, exchange

from gcs.config import read_system
from gcs.flight.stack import sensor_rays
from gcs.mission.model import Obstacle
from gcs.mission.motion import HarmonicMotion
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from idc_controller.perception.range_sensors import scan_index
from idc_controller.perception.scan_placement_kernels import rays_of_returns
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.mavlink.scan_kernels import nearest_by_sector
from vehicle_sim.swarm import Swarm

CONFIG = read_system()
CONFIG = replace(CONFIG, range_sensor=replace(CONFIG.range_sensor, rays=500))


# On the wire

MISSION = (
    Obstacle("known", (6.0, 0.0, -3.0), Sphere(0.5)),
    Obstacle("unknown", (0.0, 6.0, -3.0), Sphere(0.4), known=False, motion=HarmonicMotion((1.0, 0.0, 0.0), 1.0)),
    Obstacle("far", (40.0, 0.0, -4.5), Pole(0.3, 9.0), known=False),
    Obstacle("wall", (-6.0, 0.0, -2.0), Wall((0.3, 4.0, 4.0)), known=False),
)
RETURNS, END = "OBSTACLE_DISTANCE_3D", "OBSTACLE_DISTANCE"


def scanned(seed=1, obstacles=MISSION, faults=None, until=1.5, config=CONFIG):
    """What a ground receives of vehicles on the ground."""
    system = config.parameters()
    addresses = [("uav", i) for i in range(1, system.number_of_uavs + 1)]
    ground = ScriptedGround(addresses, float(system.hover_thrust.mean()), system.thrust_max)
    with Swarm(config, seed=seed, obstacles=obstacles, faults=faults) as swarm:
        exchange(swarm, ground, until)
    return ground


def points_of(messages):
    return np.array([(m.x, m.y, m.z) for m in messages]).reshape(-1, 3)


def test_vehicles_send_returns_of_their_rays():
    ground, rays = scanned(), sensor_rays(CONFIG.range_sensor)
    for vehicle in (1, 2, 3, 4):
        own = ground.of_type(RETURNS, vehicle)
        assert len(own) > 100
        stamps = sorted({m.time_boot_ms for m in own})
        assert {b - a for a, b in pairwise(stamps)} == {100}
        poses = {m.time_boot_ms for m in ground.of_type("LOCAL_POSITION_NED", vehicle)}
        # A pose from which it can be placed: not older or newer than half an interval.
        assert all(min(abs(stamp - pose) for pose in poses) <= 20 for stamp in stamps)
        for stamp in stamps:
            points = points_of(m for m in own if m.time_boot_ms == stamp)
            numbers, angles = rays_of_returns(points, rays.pattern.directions(scan_index(stamp, rays.rate)))
            assert angles.max() < 1e-6
            assert len(set(numbers.tolist())) == len(numbers)
        for m in own:
            assert m.frame == mavlink.MAV_FRAME_BODY_FRD
            assert m.get_srcComponent() == 1
            assert (m.min_distance, m.max_distance) == (pytest.approx(0.05), 10.0)
            assert math.hypot(m.x, m.y, m.z) < 10.5


def test_nothing_of_the_obstacles_identity_crosses_the_wire():
    def sent(obstacles):
        ground = scanned(obstacles=obstacles, until=0.6)
        return [m.to_dict() for m in (*ground.of_type(RETURNS), *ground.of_type(END))]

    names = tuple(replace(o, name=f"obstacle {i}", known=not o.known) for i, o in enumerate(MISSION))
    assert {m["obstacle_id"] for m in sent(MISSION) if "obstacle_id" in m} == {65535}
    assert sent(MISSION) == sent(names) == sent(MISSION[::-1])
    # A wall in two pieces is the same surface.
    north, south = Wall((0.3, 2.0, 4.0)), Wall((0.3, 2.0, 4.0))
    halves = Obstacle("a", (-6.0, 1.0, -2.0), north), Obstacle("b", (-6.0, -1.0, -2.0), south)
    [whole, parts] = (
        points_of(scanned(obstacles=o, until=0.6).of_type(RETURNS, 1)) for o in (MISSION[3:], halves)
    )  # fmt: skip
    np.testing.assert_allclose(whole, parts, atol=1e-5)


def test_each_scan_ends_with_the_nearest_returns_of_its_sectors():
    ground = scanned()
    for vehicle in (1, 2, 3, 4):
        messages = [m for m in ground.messages if m.get_srcSystem() == vehicle and m.get_srcComponent() == 1]
        ends = [m for m in messages if m.get_type() == END]
        assert [m.time_usec for m in ends] == [100_000 * k for k in range(len(ends))]
        assert len(ends) == 15
        for end in ends:
            assert (end.increment, end.min_distance, end.max_distance, end.frame) == (5, 5, 1000, 12)
            own = [m for m in messages if m.get_type() == RETURNS and m.time_boot_ms * 1000 == end.time_usec]
            nearest = [65535.0] * 72
            for m in own:
                sector = round(math.degrees(math.atan2(m.y, m.x)) / 5.0) % 72
                nearest[sector] = min(nearest[sector], 100.0 * math.hypot(m.x, m.y, m.z))
            # Positions are sent in single precision, which may round a distance up to a full centimetre.
            for distance, own_nearest in zip(end.distances, nearest, strict=True):
                assert distance in (int(own_nearest - 1e-4), int(own_nearest))
            # Its returns are sent before it, without a gap.
            numbers = [m.get_seq() for m in own] + [end.get_seq()]
            assert all((b - a) % 256 == 1 for a, b in pairwise(numbers))


def test_nearest_by_sector_agrees_with_a_plain_formula():
    rng = np.random.default_rng(1)
    points = rng.normal(0.0, 4.0, (400, 3))
    points[:4] = [[math.nan, 1.0, 1.0], [math.inf, 0.0, 0.0], [1e30, 0.0, 0.0], [-3.0, -0.0, 0.0]]
    expected = [65535] * 72
    for x, y, z in points.tolist():
        if math.isfinite(x + y + z):
            sector = round(math.degrees(math.atan2(y, x)) / 5.0) % 72
            expected[sector] = min(expected[sector], int(min(100.0 * math.hypot(x, y, z), 65534.0)))
    assert nearest_by_sector(points, 72, 65535).tolist() == expected
    assert nearest_by_sector(points[:3].copy(), 72, 65535).tolist() == [65534] + [65535] * 71


def test_scan_that_hits_nothing_is_sent_as_its_end_alone():
    ground = scanned(obstacles=(Obstacle("far", (60.0, 0.0, -4.5), Pole(0.3, 9.0)),), until=0.6)
    assert ground.of_type(RETURNS) == []
    ends = ground.of_type(END, 2)
    assert [m.time_usec for m in ends] == [100_000 * k for k in range(7)]
    assert all(list(m.distances) == [65535] * 72 for m in ends)


def test_swarm_without_obstacles_does_not_scan():
    ground = scanned(obstacles=())
    assert ground.of_type(RETURNS) == ground.of_type(END) == []


def test_failed_sensor_sends_neither_returns_nor_ends():
    """Else what it does not see would count as free."""

    class SensorLoss(FaultInjector):
        def range_sample(self, vehicle, sample):
            return sample._replace(points=sample.points[:0], works=False) if vehicle == 2 else sample

    ground = scanned(faults=SensorLoss(), until=0.6)
    assert ground.of_type(RETURNS, 2) == ground.of_type(END, 2) == []
    assert ground.of_type(RETURNS, 1) and ground.of_type(END, 1)


def test_scans_follow_rate_range_and_rays_of_system_file():
    near = (Obstacle("near", (3.0, 0.0, -3.0), Sphere(0.5)),)
    config = replace(CONFIG, range_sensor=replace(CONFIG.range_sensor, rate=5, range=5.0))
    assert scanned(config=config).of_type(RETURNS) == []  # all are farther away, but for the wall, 5.35 m
    ground = scanned(obstacles=near, config=config)
    assert {b.time_usec - a.time_usec for a, b in pairwise(ground.of_type(END, 1))} == {200_000}
    counts = [
        len(scanned(obstacles=near, until=0.6, config=replace(CONFIG, range_sensor=sensor)).of_type(RETURNS, 1))
        for sensor in (CONFIG.range_sensor, replace(CONFIG.range_sensor, rays=5000))
    ]
    assert counts[1] == pytest.approx(5000 / CONFIG.range_sensor.rays * counts[0], rel=0.3)


def test_pattern_follows_the_clock_of_the_vehicle():
    """Its stamps say which rays there were, whatever its clock shows."""

    class Clock(FaultInjector):
        def clock(self, vehicle, time):
            return time + 12.34

    ground, rays = scanned(faults=Clock(), until=0.6), sensor_rays(CONFIG.range_sensor)
    for m in ground.of_type(RETURNS, 3):
        [_], [angle] = rays_of_returns(points_of([m]), rays.pattern.directions(scan_index(m.time_boot_ms, rays.rate)))
        assert angle < 1e-6
