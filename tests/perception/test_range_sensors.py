"""Validity of the vehicles' range sensors on the ground: failed, invalid, stuck, and recovered."""

import numpy as np
import pytest

from idc_controller.estimation.measurements import Attitude, Position
from idc_controller.perception.pose_history import PoseHistory
from idc_controller.perception.range_sensors import RangeSensors
from idc_controller.perception.settings import ScanSettings

S = ScanSettings()
TEAM = range(3)


@pytest.fixture
def sensors():
    return RangeSensors(True, S)


def scan(seed, count=10):
    return np.random.default_rng(seed).normal(size=(count, 3))


def test_failure_counts_after_patience_and_ends_when_it_is_no_longer_reported(sensors):
    sensors.set_failed({1}, 10.0)
    sensors.set_failed({1}, 10.4)
    assert sensors.valid(TEAM, 10.4) == (0, 2)
    assert sensors.valid(TEAM, 10.4, 0.5) == (0, 1, 2)
    assert sensors.valid(TEAM, 10.5, 0.5) == (0, 2)
    sensors.set_failed(set(), 11.0)
    assert sensors.valid(TEAM, 11.0) == (0, 1, 2)
    sensors.set_failed({1}, 12.0)
    assert sensors.valid(TEAM, 12.4, 0.5) == (0, 1, 2)


@pytest.mark.parametrize(("elapsed", "is_valid"), [(-0.01, True), (0.01, False)])
def test_impossible_detections_make_a_sensor_invalid_after_a_while_without_valid_ones(sensors, elapsed, is_valid):
    assert not sensors.check(0, 10.0, scan(0))
    sensors.add_invalid(0, 10.0 + S.invalid_after + elapsed)
    assert (0 in sensors.valid(TEAM, 10.0 + S.invalid_after + elapsed)) is is_valid


@pytest.mark.parametrize(("elapsed", "is_valid"), [(-0.01, False), (0.01, True)])
def test_invalid_sensor_recovers_a_while_after_the_last_impossible_detection(sensors, elapsed, is_valid):
    sensors.add_invalid(2, 20.0)
    assert sensors.valid(TEAM, 20.0) == (0, 1)
    assert (2 in sensors.valid(TEAM, 20.0 + S.recovery + elapsed)) is is_valid


def test_sensing_is_lost_when_all_sensors_are_and_there_is_one(sensors):
    sensors.set_failed({0, 1}, 10.0)
    assert not sensors.lost((), 99.0)
    assert not sensors.lost(TEAM, 99.0)
    assert not sensors.lost((0, 1), 9.99 + S.invalid_after)
    assert sensors.lost((0, 1), 10.0 + S.invalid_after)


def test_sensor_is_stuck_where_most_points_repeat_earlier_ones(sensors):
    first = scan(1)
    assert not sensors.check(0, 1.0, first)
    assert not sensors.check(1, 1.0, first)  # another vehicle's
    half = np.concatenate([first[:5], scan(2, 5)])
    assert not sensors.check(0, 1.1, half)
    assert sensors.check(0, 1.2, half[:9])
    assert sensors.check(0, 1.3, np.concatenate([half[9:], half[:3]]))  # out of view meanwhile
    assert not sensors.check(0, 1.4, scan(3))


def test_points_of_sensors_without_noise_may_repeat():
    sensors = RangeSensors(False, S)
    assert [sensors.check(0, 0.1 * k, scan(1)) for k in range(20)] == [False] * 20


# Silent sensors


def add_poses(poses, uav, first, last):
    for time in np.arange(first, last, 1.0 / S.rate):
        poses.add_measured(Position(time, uav, np.zeros(3), np.zeros(3)))
        poses.add_measured(Attitude(time, uav, np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3)))


@pytest.mark.parametrize(("elapsed", "silent"), [(-0.1, set()), (0.1, {1})])
def test_sensor_is_silent_when_poses_come_and_scans_do_not(sensors, elapsed, silent):
    poses, until = PoseHistory(S), 10.0 + S.silent_after + elapsed
    for uav in (0, 1):
        add_poses(poses, uav, 9.0, until)
    sensors.add_scan(0, until - 0.1)
    sensors.add_scan(1, 10.0)
    sensors.update_silent(poses, until)
    assert set(sensors.silent) == silent
    assert sensors.valid((0, 1), until) == ((0,) if silent else (0, 1))
    sensors.add_scan(1, until)
    sensors.update_silent(poses, until)
    assert not sensors.silent


def test_all_silent_sensors_are_lost_sensing(sensors):
    poses = PoseHistory(S)
    for uav in (0, 1):
        add_poses(poses, uav, 9.0, 12.0)
        sensors.add_scan(uav, 10.0)
    sensors.update_silent(poses, 12.0)
    assert set(sensors.silent) == {0, 1} and not sensors.lost((0, 1), 12.0)
    sensors.update_silent(poses, 12.0 + S.invalid_after)
    assert sensors.lost((0, 1), 12.0 + S.invalid_after)


def test_vehicle_that_is_not_heard_has_no_silent_sensor(sensors):
    poses = PoseHistory(S)
    add_poses(poses, 0, 9.0, 10.2)
    sensors.add_scan(0, 10.0)
    add_poses(poses, 0, 15.0, 15.1)  # heard again, its next scan is not there yet
    sensors.update_silent(poses, 15.1)
    assert not sensors.silent


def test_team_that_has_never_sent_a_scan_has_no_silent_sensors(sensors):
    poses = PoseHistory(S)
    add_poses(poses, 0, 9.0, 12.0)
    add_poses(poses, 1, 9.0, 12.0)
    sensors.update_silent(poses, 12.0)
    assert not sensors.silent
    sensors.add_scan(1, 12.0)  # they have sensors: the other one's is silent
    sensors.update_silent(poses, 12.0)
    assert set(sensors.silent) == {0}


def test_displaced_sensor_is_not_valid_until_it_is_none(sensors):
    sensors.set_displaced(2, True, 10.0)
    sensors.set_displaced(2, True, 10.4)
    assert sensors.valid(TEAM, 10.0) == (0, 1) and set(sensors.displaced) == {2}
    assert sensors.lost((2,), 10.0 + S.invalid_after)
    sensors.set_displaced(2, False, 11.0)
    assert sensors.valid(TEAM, 11.0) == (0, 1, 2)
