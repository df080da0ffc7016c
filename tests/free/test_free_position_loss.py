"""Loss of the position on board of a free vehicle, and its accelerometer."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import NAN, OFFBOARD, FreeBench, config_of, mode

from gcs.mavlink import px4
from gcs.mission.model import Fault
from vehicle_sim.faults.fault_injector import FaultInjector

REJECTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED
HIGHRES_IMU, ESTIMATOR_STATUS = mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS
ACCELEROMETERS = 0b111


def losing_position(start, duration=None, **options):
    """Return a bench whose vehicle loses its position ``start`` s after its take-off."""
    fault = Fault("position_lost", start, duration=duration)
    return FreeBench(faults=FaultInjector((fault,), 1, config_of(1)), **options)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_vehicle_that_loses_its_position_brakes_descends_and_disarms(seed):
    with losing_position(10.0, seed=seed) as bench:
        bench.take_off(6.0)
        bench.vehicles[0].autopilot.go_to((60.0, 0.0, -6.0), NAN, NAN, bench.now)
        bench.send(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
        assert bench.run(12.0, lambda: bench.vehicles[0].autopilot.failsafe)
        assert "Position lost: descending" in bench.texts() and bench.mode_of() == "AUTO.LAND"
        begin = bench.position().copy()
        assert bench.swarm.world.states()[0, 7] > 4.0  # it was on its way
        assert bench.run(25.0, lambda: not bench.armed())
        assert bench.position()[2] == pytest.approx(-0.02, abs=0.02)
        assert 3.0 < bench.position()[0] - begin[0] < 12.0 and abs(bench.position()[1]) < 2.0
        path = bench.path()
        sinking = path[(path[:, 2] > -0.6) & (path[:, 2] < -0.1), 9][-10:]
        assert np.all(sinking < 1.2) and np.all(sinking > 0.3)
        speed = np.hypot(path[:, 7], path[:, 8])[-60:]
        assert speed.max() < 0.8


def test_modes_that_need_a_position_are_refused_without_one():
    with losing_position(8.0) as bench:
        bench.take_off(8.0)
        assert bench.run(12.0, lambda: bench.vehicles[0].autopilot.failsafe)
        for command in (mode(px4.AutoMode.LOITER), (mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH,), mode(px4.AutoMode.TAKEOFF)):
            assert bench.command(*command) == REJECTED
            assert "denied: no position" in bench.texts()
        answer = bench.vehicles[0].autopilot.go_to((5.0, 0.0, -8.0), NAN, NAN, bench.now)
        assert answer.result == REJECTED and answer.text == "Reposition denied: no position"
        bench.streaming[1] = mavlink.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, 1, 0b1101_1111_1000, 0, 0, -5, *[0.0] * 8
        )
        bench.run(0.3)
        assert bench.command(*OFFBOARD) == REJECTED and "OFFBOARD by position denied: no position" in bench.texts()
        assert bench.requested(ESTIMATOR_STATUS).flags == mavlink.ESTIMATOR_ATTITUDE
        assert bench.mode_of() == "AUTO.LAND" and bench.armed()


def test_attitudes_of_offboard_are_flown_without_a_position():
    with losing_position(8.0) as bench:
        bench.take_off(5.0)
        hover = 0.7 * 9.81 / 30.0
        bench.streaming[1] = mavlink.MAVLink_set_attitude_target_message(0, 1, 1, 0b111, [1, 0, 0, 0], 0, 0, 0, hover)
        bench.run(0.3)
        assert bench.command(*OFFBOARD) == mavlink.MAV_RESULT_ACCEPTED
        bench.run(8.0)
        assert not bench.vehicles[0].autopilot.state.has_position(bench.now)
        assert bench.mode_of() == "OFFBOARD" and not bench.vehicles[0].autopilot.failsafe


def test_position_that_is_back_is_flown_by_again():
    with losing_position(8.0, duration=3.0) as bench:
        bench.take_off(9.0)
        assert bench.run(12.0, lambda: bench.vehicles[0].autopilot.failsafe)
        bench.run(3.5)
        assert bench.command(*mode(px4.AutoMode.LOITER)) == mavlink.MAV_RESULT_ACCEPTED
        bench.run(4.0)
        place = bench.position().copy()
        bench.run(4.0)
        assert bench.position() == pytest.approx(place, abs=0.15)
        assert not bench.vehicles[0].autopilot.failsafe


def test_imu_measures_the_specific_force():
    with FreeBench() as bench:
        bench.run(0.5)
        imu = bench.requested(HIGHRES_IMU)
        assert imu.fields_updated & ACCELEROMETERS == ACCELEROMETERS
        assert (imu.xacc, imu.yacc, imu.zacc) == pytest.approx((0.0, 0.0, -9.81), abs=0.02)  # it stands
        bench.take_off()
        bench.vehicles[0].autopilot.go_to((50.0, 0.0, -5.0), NAN, NAN, bench.now)
        bench.run(0.8)
        imu = bench.requested(HIGHRES_IMU)
        thrust = bench.swarm.world.thrusts[0] / 0.7
        assert imu.zacc == pytest.approx(-thrust, abs=0.2)  # along the rotors, whatever it does
        assert math.hypot(imu.xacc, imu.yacc) < 0.2


def test_vehicle_is_not_armed_before_its_position_is_back():
    with losing_position(6.0, duration=16.0) as bench:
        bench.take_off(3.0)
        assert bench.run(12.0, lambda: bench.vehicles[0].autopilot.failsafe)
        assert bench.run(12.0, lambda: not bench.armed())
        state = bench.vehicles[0].autopilot.state
        assert not state.has_position(bench.now)
        assert bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == REJECTED
        assert bench.run(16.0, lambda: state.has_position(bench.now))
        assert bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED


def test_loss_of_the_position_in_offboard_by_position_lands_though_set_points_come():
    with losing_position(8.0) as bench:
        bench.take_off(5.0)
        bench.streaming[1] = mavlink.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, 1, 0b1101_1111_1000, 3, 0, -5, *[0.0] * 8
        )
        bench.run(0.3)
        assert bench.command(*OFFBOARD) == mavlink.MAV_RESULT_ACCEPTED
        bench.messages.clear()
        assert bench.run(12.0, lambda: bench.vehicles[0].autopilot.failsafe)
        assert bench.run(15.0, lambda: not bench.armed())
        assert bench.texts().count("Position lost") == 1 and "Set-points are back" not in bench.texts()
