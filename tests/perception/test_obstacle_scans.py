"""Scans of the vehicles on the obstacle map: by which poses they are placed, and range sensors that are lost."""

import numpy as np
import pytest
from obstacle_scene import HERE, RAYS, SENSORS, Scene, hand_over, map_of, moving_tracks, outside, run, sphere, wall

from idc_controller.estimation.measurements import Attitude, Position, VehicleStates
from idc_controller.perception.scan_placement import ScanPlacement

STANDS = np.array([5.0, 0.0, -6.0])
FRONT = STANDS[None] - [0.5, 0.0, 0.0]
LEVEL = np.array([1.0, 0.0, 0.0, 0.0])
AHEAD = np.array([[5.0, 0.0, 0.0]])


def crossing(t):
    return np.array([5.0, 4.0 - 1.5 * t, -6.0])


def test_returns_are_placed_by_estimate_when_position_is_unusable():
    m, scene = map_of(), Scene(0)
    away, everyone = np.array([0.0, 1.0, 0.0]), frozenset(range(4))
    for k in range(10):
        scene.feed(m, 0.1 * k, HERE, [sphere(STANDS)], off=away)
        m.update(0.1 * k, unusable_positions=everyone)
    assert outside(m, 0.9, FRONT)[0] < 0.1
    assert all(np.linalg.norm(centre - STANDS) < 0.6 for _, _, centre in m.seen.pieces)


def test_pose_is_extrapolated_by_estimated_motion_when_none_is_measured():
    placement, t, turning = ScanPlacement(SENSORS, RAYS), 0.02, np.array([0.0, 1.0, 0.0])
    unknown, moving = np.full(3, np.nan), np.array([0.0, 2.0, 0.0])
    placement.poses.add_measured(Attitude(0.0, 0, LEVEL, unknown))
    placement.poses.add_measured(Position(0.0, 0, HERE, unknown))
    placement.poses.add_estimated(VehicleStates(0.0, np.hstack([HERE + 1.0, moving, LEVEL, turning])[None]))
    hand_over(placement, t, 0, None, AHEAD)
    [scan] = placement.scans(t)
    assert scan.returns[0] == pytest.approx(HERE + np.array([5.0, 2.0 * t, -5.0 * t]), abs=2e-3)


@pytest.mark.parametrize(("time", "nearest"), [(0.29, 3), (0.21, 2), (0.16, 2), (0.14, 1), (0.0, 0), (0.36, 4)])
def test_scan_is_placed_by_the_pose_nearest_in_time(time, nearest):
    """The poses jump from sample to sample, and claim to stand still: the place shows which was taken."""
    placement = ScanPlacement(SENSORS, RAYS)
    half = np.radians(10.0) / 2.0
    for k in range(5):
        quaternion = np.array([np.cos(k * half), 0.0, 0.0, np.sin(k * half)])
        placement.poses.add_measured(Attitude(0.1 * k, 0, quaternion, np.zeros(3)))
        placement.poses.add_measured(Position(0.1 * k, 0, HERE + k, np.zeros(3)))
    hand_over(placement, time, 0, None, AHEAD)
    [scan] = placement.scans(0.4)
    heading = nearest * np.radians(10.0)
    expected = HERE + nearest + 5.0 * np.array([np.cos(heading), np.sin(heading), 0.0])
    assert scan.returns[0] == pytest.approx(expected, abs=2e-3)


def test_scan_waits_for_its_pose_and_is_discarded_without_one():
    m, scene = map_of(), Scene(0)
    found = scene.look(1.0, HERE, [sphere(STANDS)])[0]
    hand_over(m.placement, 1.0, found.uav, None, found.sample.points)
    m.update(1.0)
    assert m.seen.pieces == []
    unknown = np.full(3, np.nan)  # of its motion nothing is known
    m.placement.poses.add_measured(Position(1.0, found.uav, found.position, unknown))
    m.placement.poses.add_measured(Attitude(1.0, found.uav, found.quaternion, unknown))
    m.update(1.05)
    assert m.seen.pieces != [] and m.placement.discarded == 0
    hand_over(m.placement, 1.1, 3, None, AHEAD)
    m.update(1.1)
    m.update(1.5)
    assert m.placement.discarded == 1


# Range sensors that are lost


def with_invalid_sensors(kind):
    """Yield a map whose vehicles detect two obstacles for 3 s and whose sensors are invalid from then on."""
    m, scene, house = map_of(), Scene(0), wall((0.0, -6.0, -6.0), (5.0, 0.3, 5.0), 0.0)
    run(m, lambda t: [sphere(STANDS), house, sphere(crossing(t) - [10.0, 0.0, 0.0])], 3.0, scene=scene)
    stuck = scene.look(3.0, HERE, [sphere(STANDS), house])
    for k in range(60, 120):
        t = k / 20
        if kind == "broken":
            scene.feed(m, t, HERE, [])
            m.placement.range_sensors.set_failed({0, 1, 2, 3}, t)
        elif k % 2 == 0:
            for found in stuck:
                points = found.sample.points
                # How many there are may still follow what is in the field of view.
                points = points[: len(points) - k // 2 % 2] if kind == "stuck points" else points
                hand_over(
                    m.placement, t, found.uav, (found.position, found.quaternion),
                    points * [np.nan, 1.0, 1.0] if kind == "nan" else points,
                )  # fmt: skip
        m.update(t)
        yield m


@pytest.mark.parametrize("kind", ["nan", "stuck", "stuck points", "broken"])
def test_sensing_lost_is_detected_and_obstacles_are_kept(kind):
    lost = []
    for m in with_invalid_sensors(kind):
        lost.append(m.sensing_lost)
    assert not lost[0] and all(lost[20:])
    assert outside(m, 6.0, FRONT, "piece")[0] < 0.1
    assert len(moving_tracks(m)) == 1


def test_sensing_is_not_lost_with_one_valid_sensor():
    m, scene = map_of(), Scene(0)
    run(m, lambda t: [sphere(crossing(t))], 3.0, scene=scene)
    assert len(moving_tracks(m)) == 1
    for k in range(60, 100):
        if k % 2 == 0:
            scene.feed(m, k / 20, HERE, [])
        m.placement.range_sensors.set_failed({0, 1, 3}, k / 20)
        m.update(k / 20)
        assert not m.sensing_lost
    assert m.tracks == []
