"""Poses of the vehicles, by which their scans are placed: the sample next to a time, and the motion from there."""

import numpy as np
import pytest

from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position, VehicleStates
from idc_controller.perception.pose_history import PoseHistory
from idc_controller.perception.settings import ScanSettings

SETTINGS = ScanSettings()
GAP = SETTINGS.pose_gap
NOTHING = np.full(3, np.nan)
LEVEL = np.array([1.0, 0.0, 0.0, 0.0])


def place(time, uav=0, at=(1.0, 2.0, -3.0), velocity=(0.5, -1.0, 2.0)):
    return Position(time, uav, np.array(at), np.array(velocity))


def heading(time, uav=0, yaw=0.0, rates=(0.0, 0.0, 0.8)):
    return Attitude(time, uav, np.array([np.cos(yaw / 2.0), 0.0, 0.0, np.sin(yaw / 2.0)]), np.array(rates))


def history(*samples):
    poses = PoseHistory(SETTINGS)
    for sample in samples:
        poses.add_measured(sample)
    return poses


def yaw_of(quaternion):
    assert quaternion[1:3] == pytest.approx((0.0, 0.0)) and np.linalg.norm(quaternion) == pytest.approx(1.0)
    return 2.0 * np.arctan2(quaternion[3], quaternion[0])


@pytest.mark.parametrize("after", [-0.05, 0.0, 0.05])
def test_pose_moves_with_the_measured_motion_of_the_sample(after):
    poses = history(place(10.0), heading(10.0, yaw=0.3))
    position, quaternion = poses.pose(0, 10.0 + after, False, False)
    np.testing.assert_allclose(position, np.array([1.0, 2.0, -3.0]) + after * np.array([0.5, -1.0, 2.0]))
    assert yaw_of(quaternion) == pytest.approx(0.3 + 0.8 * after, abs=1e-4)


def test_pose_is_of_the_sample_next_to_the_time():
    poses = history(*(place(10.0 + 0.02 * k, at=(k, 0.0, 0.0), velocity=(0.0,) * 3) for k in range(5)), heading(10.04))
    for time, expected in ((9.95, 0), (10.009, 0), (10.011, 1), (10.05, 3), (10.069, 3), (10.071, 4), (10.1, 4)):
        assert poses.pose(0, time, False, False)[0][0] == expected, time


@pytest.mark.parametrize(("apart", "known"), [(-1.01, False), (-0.99, True), (0.99, True), (1.01, False)])
def test_pose_is_unknown_beyond_the_gap(apart, known):
    poses = history(place(10.0), heading(10.0))
    assert (poses.pose(0, 10.0 + apart * GAP, False, False) is not None) is known
    assert poses.pose(1, 10.0, False, False) is None
    assert history(place(10.0)).pose(0, 10.0, False, False) is None
    assert history(heading(10.0)).pose(0, 10.0, False, False) is None


def test_estimated_parts_take_the_place_of_measured_ones():
    poses = history(place(10.0), heading(10.0, yaw=0.3))
    values = np.zeros((2, 13))
    values[0, :3], values[0, 3:6] = (9.0, 8.0, -7.0), (1.0, 0.0, 0.0)
    values[:, 6:10] = LEVEL
    poses.add_estimated(VehicleStates(10.02, values))
    position, quaternion = poses.pose(0, 10.04, True, False)
    np.testing.assert_allclose(position, [9.02, 8.0, -7.0])
    assert yaw_of(quaternion) == pytest.approx(0.332, abs=1e-4)
    position, quaternion = poses.pose(0, 10.04, False, True)
    np.testing.assert_allclose(position, [1.02, 1.96, -2.92])
    np.testing.assert_allclose(quaternion, LEVEL)


def test_motion_that_was_not_measured_is_the_estimated_one():
    poses = history(place(10.0, velocity=NOTHING), heading(10.0, yaw=0.3, rates=NOTHING))
    position, quaternion = poses.pose(0, 10.05, False, False)
    np.testing.assert_allclose(position, [1.0, 2.0, -3.0])
    assert yaw_of(quaternion) == pytest.approx(0.3)
    values = np.zeros((1, 13))
    values[0, 3:6], values[0, 6:10], values[0, 12] = (1.0, 2.0, 3.0), LEVEL, 1.0
    poses.add_estimated(VehicleStates(10.04, values))
    position, quaternion = poses.pose(0, 10.05, False, False)
    np.testing.assert_allclose(position, [1.05, 2.1, -2.85])
    assert yaw_of(quaternion) == pytest.approx(0.35, abs=1e-4)


def test_last_pose_counts_within_its_time_and_the_payload_and_motions_alone_do_not():
    poses = history(
        place(10.0), place(10.5, at=(4.0, 5.0, -6.0)), heading(10.4), place(11.0, uav=PAYLOAD), heading(10.0, uav=2)
    )
    poses.add_measured(Position(12.0, 1, NOTHING, np.zeros(3)))
    assert poses.uavs == (0,)
    for time in (10.9, 10.0):
        position, attitude = poses.last_pose(0, time, 0.5)
        np.testing.assert_array_equal(position, [4.0, 5.0, -6.0])
        np.testing.assert_array_equal(attitude, heading(10.4).pose)
    assert poses.last_pose(0, 10.91, 0.5) is None and poses.last_pose(0, 9.99, 0.5) is None
    assert poses.last_pose(1, 12.0, 0.5) is None and poses.last_pose(2, 10.0, 0.5) is None
    assert poses.last_pose(PAYLOAD, 11.0, 0.5) is None


def test_poses_since_a_time_are_counted_of_either_kind():
    poses = history(*(place(10.0 + 0.1 * k) for k in range(5)), *(heading(10.0 + 0.1 * k, uav=2) for k in range(5)))
    assert poses.has_since(0, 10.15, 3) and not poses.has_since(0, 10.25, 3)
    assert poses.has_since(2, 9.0, 5) and not poses.has_since(2, 9.0, 6)
    assert not poses.has_since(1, 0.0, 1)
