"""What a free vehicle reports of its targets."""

import math

import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import FRAME, NAN, OFFBOARD, FreeBench

LOCAL_TARGET = mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED
GLOBAL_TARGET = mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT
NAV_OUTPUT = mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT
VELOCITY_ONLY = 0b1101_1100_0111
YAW_RATE_IGNORE, NO_POSITION = 0b1000_0000_0000, 0b111


def test_targets_of_a_go_to_are_its_moving_set_point_and_its_place():
    with FreeBench() as bench:
        bench.take_off()
        bench.vehicles[0].autopilot.go_to((30.0, 40.0, -8.0), NAN, NAN, bench.now)
        bench.run(3.0)
        local = bench.requested(LOCAL_TARGET)
        assert math.dist((local.x, local.y, local.z), bench.position()) < 1.5
        assert math.hypot(local.vx, local.vy) == pytest.approx(5.0, abs=0.3)  # MPC_XY_CRUISE
        assert local.type_mask == YAW_RATE_IGNORE
        place = bench.requested(GLOBAL_TARGET)
        found = FRAME.local(place.lat_int * 1e-7, place.lon_int * 1e-7, place.alt)
        assert found == pytest.approx((30.0, 40.0, -8.0), abs=0.05)
        assert place.coordinate_frame == mavlink.MAV_FRAME_GLOBAL_INT
        output = bench.requested(NAV_OUTPUT)
        x, y, z = bench.position()
        assert output.wp_dist == pytest.approx(math.hypot(30.0 - x, 40.0 - y), abs=1.0)
        assert output.target_bearing == pytest.approx(53, abs=1)
        assert output.alt_error == pytest.approx(z - local.z, abs=0.1)


def test_targets_of_a_landing_end_on_the_ground():
    with FreeBench() as bench:
        bench.take_off(4.0)
        bench.command(mavlink.MAV_CMD_NAV_LAND)
        bench.run(2.0)
        place = bench.requested(GLOBAL_TARGET)
        assert FRAME.local(place.lat_int * 1e-7, place.lon_int * 1e-7, place.alt)[2] == pytest.approx(0.0, abs=0.1)
        assert bench.requested(LOCAL_TARGET).vz == pytest.approx(0.7, abs=0.05)  # MPC_LAND_SPEED


def test_targets_of_velocity_set_points_leave_the_position_out():
    with FreeBench() as bench:
        bench.take_off()
        bench.streaming[1] = mavlink.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, VELOCITY_ONLY, 0, 0, 0, 2.0, 1.0, 0.0, 0, 0, 0, 0, 0
        )
        bench.run(0.3)
        assert bench.command(*OFFBOARD) == mavlink.MAV_RESULT_ACCEPTED
        bench.run(1.0)
        target = bench.requested(LOCAL_TARGET)
        assert (target.vx, target.vy, target.vz) == (2.0, 1.0, 0.0)
        assert target.type_mask & 0b1_1111_1111 == 0b1_1100_0111
        assert target.type_mask & YAW_RATE_IGNORE
        assert bench.requested(GLOBAL_TARGET) is None
        assert bench.requested(NAV_OUTPUT).wp_dist == 0


def test_no_target_while_an_attitude_is_flown_or_nothing():
    with FreeBench() as bench:
        bench.run(0.5)
        assert bench.requested(LOCAL_TARGET) is None and bench.requested(GLOBAL_TARGET) is None
        bench.take_off()
        assert bench.requested(LOCAL_TARGET) is not None
        hover = 0.7 * 9.81 / 30.0
        bench.streaming[1] = mavlink.MAVLink_set_attitude_target_message(0, 1, 1, 0b111, [1, 0, 0, 0], 0, 0, 0, hover)
        bench.run(0.3)
        assert bench.command(*OFFBOARD) == mavlink.MAV_RESULT_ACCEPTED
        bench.run(0.3)
        assert bench.requested(LOCAL_TARGET) is None and bench.requested(GLOBAL_TARGET) is None
