"""Placement of scans, and vehicles whose range sensors are lost or invalid."""

import math

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from obstacle_scene import (
    HERE,
    REACH,
    SENSORS,
    Scene,
    detections_of,
    map_of,
    messages_of,
    run,
    sphere,
)

from idc_controller.estimation.measurements import Attitude, Position, VehicleStates
from idc_controller.perception.scan_assembly import Detections, ScanAssembly
from idc_controller.perception.scan_kernels import grouped, possible_points
from idc_controller.perception.settings import ScanSettings
from vehicle_sim.world.range_sensor import RangeSample


def test_detections_are_placed_by_estimate_when_position_is_unusable():
    m, scene, truth = map_of(), Scene(0), np.array([5.0, 0.0, -6.0])
    away, everyone = np.array([0.0, 1.0, 0.0]), frozenset(range(4))
    for k in range(10):
        t = 0.1 * k
        scene.feed(m, t, HERE, [sphere(truth)], off=away)
        m.update(t, unusable_positions=everyone)
    (track,) = m.confirmed_tracks(0.9)
    assert np.linalg.norm(track.position - truth) < 0.1


def test_pose_is_extrapolated_by_estimated_motion_when_none_is_measured():
    scans, t, turning = ScanAssembly(SENSORS), 0.02, np.array([0.0, 1.0, 0.0])
    level, unknown, moving = np.array([1.0, 0.0, 0.0, 0.0]), np.full(3, np.nan), np.array([0.0, 2.0, 0.0])
    scans.poses.add_measured(Attitude(0.0, 0, level, unknown))
    scans.poses.add_measured(Position(0.0, 0, HERE, unknown))
    scans.poses.add_estimated(VehicleStates(0.0, np.hstack([HERE + 1.0, moving, level, turning])[None]))
    for message in messages_of(RangeSample(t, REACH, np.array([1]), np.array([[5.0, 0.0, 0.0]]))):
        scans.add(detections_of(message), 0, t)
    [[cluster]] = scans.frames(t)
    assert cluster.surface_points.points[0] == pytest.approx(HERE + np.array([5.0, 2.0 * t, -5.0 * t]), abs=2e-3)


def test_points_of_a_scan_are_used_without_those_that_are_impossible():
    scans, level = ScanAssembly(SENSORS), np.array([1.0, 0.0, 0.0, 0.0])
    scans.poses.add_measured(Attitude(0.0, 0, level, np.zeros(3)))
    scans.poses.add_measured(Position(0.0, 0, HERE, np.zeros(3)))
    points = np.array([[5.0, 0.0, 0.0], [np.nan, 0.0, 0.0], [6.0, 1.0, 0.0], [1e6, 0.0, 0.0]])
    scans.add(Detections(7, np.array([1, 1, 2, 2]), points, np.full(4, REACH)), 0, 0.0)
    [clusters] = scans.frames(0.0)
    placed = [cluster.surface_points.points for cluster in clusters]
    assert [p.tolist() for p in placed] == [[[*(HERE + points[0])]], [[*(HERE + points[2])]]]
    assert scans.discarded == 2


@pytest.mark.parametrize(("time", "nearest"), [(0.29, 3), (0.21, 2), (0.16, 2), (0.14, 1), (0.0, 0), (0.36, 4)])
def test_scan_is_placed_by_the_pose_nearest_in_time(time, nearest):
    """The poses jump from sample to sample, and claim to stand still: the place shows which was taken."""
    scans = ScanAssembly(SENSORS)
    half = np.radians(10.0) / 2.0
    for k in range(5):
        quaternion = np.array([np.cos(k * half), 0.0, 0.0, np.sin(k * half)])
        scans.poses.add_measured(Attitude(0.1 * k, 0, quaternion, np.zeros(3)))
        scans.poses.add_measured(Position(0.1 * k, 0, HERE + k, np.zeros(3)))
    for message in messages_of(RangeSample(time, REACH, np.array([1]), np.array([[5.0, 0.0, 0.0]]))):
        scans.add(detections_of(message), 0, time)
    [[cluster]] = scans.frames(0.4)
    heading = nearest * np.radians(10.0)
    expected = HERE + nearest + 5.0 * np.array([np.cos(heading), np.sin(heading), 0.0])
    assert cluster.surface_points.points[0] == pytest.approx(expected, abs=2e-3)


def test_scan_of_a_vehicle_that_sends_no_pose_is_placed_by_its_estimate():
    scans, settings = ScanAssembly(SENSORS), ScanSettings()
    level = np.array([1.0, 0.0, 0.0, 0.0])
    scans.poses.add_estimated(VehicleStates(0.0, np.hstack([HERE, np.zeros(3), level, np.zeros(3)])[None]))
    for message in messages_of(RangeSample(0.0, REACH, np.array([1]), np.array([[5.0, 0.0, 0.0]]))):
        scans.add(detections_of(message), 0, 0.0)
    assert scans.frames(settings.pose_wait) == []
    [[cluster]] = scans.frames(settings.pose_wait + 0.01)
    assert cluster.surface_points.points[0] == pytest.approx([5.0, 0.0, -6.0])


def test_scan_is_discarded_without_pose_and_estimate():
    m, scene = map_of(), Scene(0)
    for k in range(10):
        scene.feed(m, 0.1 * k, HERE, [sphere((5.0, 0.0, -6.0))])
        m.update(0.1 * k, unusable_attitudes=frozenset(range(4)))
    assert m.tracks == []


def test_scan_waits_for_pose_and_impossible_detections_are_discarded():
    m = map_of()
    scene = Scene(0)
    ((i, position, quaternion, scan),) = scene.look(1.0, HERE, [sphere((5.0, 0.0, -6.0))])[:1]
    for message in messages_of(scan):
        m.scans.add(detections_of(message), i, 1.0)
    m.update(1.0)
    assert m.tracks == []
    m.scans.poses.add_measured(Position(1.0, i, position, np.full(3, np.nan)))  # of its motion nothing is known
    m.scans.poses.add_measured(Attitude(1.0, i, quaternion, np.full(3, np.nan)))
    m.update(1.05)
    assert len(m.tracks) == 1
    assert m.scans.discarded == 0

    def nonsense(**changes):
        fields = {
            "time_boot_ms": 1100, "sensor_type": 0, "frame": mavlink.MAV_FRAME_BODY_FRD, "obstacle_id": 1,
            "x": 1.0, "y": 0.0, "z": 0.0, "min_distance": 0.1, "max_distance": 10.0,
        } | changes  # fmt: skip
        return mavlink.MAVLink_obstacle_distance_3d_message(**fields)

    for bad in (
        {"frame": mavlink.MAV_FRAME_GLOBAL}, {"x": float("nan")}, {"y": float("inf")}, {"x": 0.0}, {"x": 1e6},
        {"max_distance": 0.0}, {"max_distance": float("nan")},
    ):  # fmt: skip
        m.scans.add(detections_of(nonsense(**bad)), 0, 1.1)
    assert m.scans.discarded == 7
    m.scans.add(detections_of(nonsense()), 3, 1.1)  # of a vehicle whose pose never comes
    m.update(1.1)
    m.update(1.5)
    assert m.scans.discarded == 8
    for k in range(5000):  # a flood
        m.scans.add(detections_of(nonsense(time_boot_ms=2000 + k)), 2, 2.0)
    assert m.scans.discarded > 3000


# Obstacles of the mission


def with_invalid_sensors(kind):
    """Yield a map whose vehicles detect an obstacle for a second and whose sensors are invalid from then on."""
    m, scene, here = map_of(), Scene(0), [sphere((5.0, 0.0, -6.0))]
    run(m, lambda t: here, 1.0, scene=scene)
    stuck = [messages_of(scan) for _, _, _, scan in scene.look(1.0, HERE, here)]
    for k in range(20, 80):
        t = k / 20
        scene.feed(m, t, HERE, [])
        if kind == "broken":
            m.scans.range_sensors.set_failed({0, 1, 2, 3}, t)
        elif k % 2 == 0:
            for uav, messages in enumerate(stuck):
                # How many points there are, and under which number, may still follow what is in field of view.
                for message in messages[: 3 + k // 2 % 4] if kind == "stuck points" else messages:
                    message.obstacle_id += kind == "stuck points"
                    message.time_boot_ms = round(t * 1e3)
                    if kind == "nan":
                        message.x = np.nan
                    m.scans.add(detections_of(message), uav, t)
        m.update(t)
        yield m


def test_sensing_is_not_lost_with_one_valid_sensor():
    m = map_of()
    scene, here = Scene(0), [sphere((5.0, 0.0, -6.0))]
    run(m, lambda t: here, 1.0, scene=scene)
    for k in range(20, 80):
        scene.feed(m, k / 20, HERE, [])
        m.scans.range_sensors.set_failed({0, 1, 3}, k / 20)
        m.update(k / 20)
        assert not m.sensing_lost
    assert m.predict(np.array([4.0])) == []


@pytest.mark.parametrize("kind", ["nan", "stuck", "stuck points", "broken"])
def test_sensing_lost_is_detected_and_tracks_are_retained(kind):
    lost = [m.sensing_lost for m in with_invalid_sensors(kind)]
    assert not lost[0] and all(lost[20:])
    *_, last = with_invalid_sensors(kind)
    (left,) = last.predict(np.array([4.0]))
    # The first stuck scan is used, with the attitude of the second.
    assert "stuck" in kind or np.linalg.norm(left.positions[0] - [5.0, 0.0, -6.0]) < 0.3


def test_track_deleted_before_sensing_loss_is_restored():
    """Until the loss is detected, the track of an obstacle in view is deleted."""
    m, scene = map_of(), Scene(0)
    run(m, lambda t: [sphere((5.0, 0.0, -6.0))], 1.0, scene=scene)
    run(m, lambda t: [], 2.5, begin=1.0, scene=scene)
    assert m.predict(np.array([2.5])) == []
    for k in range(50, 75):
        scene.feed(m, k / 20, HERE, [])
        m.scans.range_sensors.set_failed({0, 1, 2, 3}, k / 20)
        m.update(k / 20)
    assert m.sensing_lost
    for k in range(75, 135):  # and is kept, although they report valid health again
        scene.feed(m, k / 20, HERE, [])
        m.scans.range_sensors.set_failed(set(), k / 20)
        m.update(k / 20)
    assert not m.sensing_lost
    (back,) = m.predict(np.array([6.75]))
    assert np.linalg.norm(back.positions[0] - [5.0, 0.0, -6.0]) < 0.3


def test_possible_points_agree_with_plain_conditions():
    rng = np.random.default_rng(3)
    special = np.array([0.0, -0.0, 1.0, 25.0, np.nan, np.inf, -np.inf, 3e38])
    points, ranges = rng.choice(special, (2000, 3)), rng.choice([10.0, 1.0, np.nan, np.inf, -1.0, 0.0], 2000)
    expected = [
        k
        for k, (point, reach) in enumerate(zip(points.tolist(), ranges.tolist(), strict=True))
        if math.isfinite(sum(point) + reach) and 0.0 < math.hypot(*point) < 2.0 * reach
    ]
    assert possible_points(points, ranges, 2.0).tolist() == expected


@pytest.mark.parametrize("seed", range(20))
def test_points_are_grouped_by_number_in_the_order_of_their_coming(seed):
    rng = np.random.default_rng(seed)
    numbers = rng.integers(0, rng.integers(1, 9), rng.integers(0, 40))
    groups = {}
    for i, number in enumerate(numbers.tolist()):
        groups.setdefault(number, []).append(i)
    order, found, ends = grouped(numbers)
    assert order.tolist() == [i for members in groups.values() for i in members]
    assert found.tolist() == list(groups)
    assert ends.tolist() == np.cumsum([len(members) for members in groups.values()]).tolist()
