"""OFFBOARD of a free vehicle: by position, velocity, acceleration, attitude and rates, and when they stop."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import FRAME, NAN, OFFBOARD, FreeBench

from gcs.mission.model import DEFAULT_HOME
from vehicle_sim.autopilot.position_setpoints import read_global, read_local
from vehicle_sim.autopilot.setpoints import SetpointError

LOCAL, BODY = mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_NED
POSITION_ONLY, VELOCITY_ONLY, ACCELERATION_ONLY = 0b1101_1111_1000, 0b1101_1100_0111, 0b1100_0011_1111
YAW, YAW_RATE = 1024, 2048
GCS_HEARTBEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3)
COMPANION_HEARTBEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_ONBOARD_CONTROLLER, 8, 0, 0, 4, 3)
HOVER = 0.7 * 9.81 / 30.0


def local(mask, position=(0, 0, 0), velocity=(0, 0, 0), acceleration=(0, 0, 0), yaw=0.0, rate=0.0, frame=LOCAL):
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, frame, mask, *position, *velocity, *acceleration, yaw, rate
    )


def offboard(bench, message):
    bench.streaming[1] = message
    bench.run(0.3)
    assert bench.command(*OFFBOARD) == mavlink.MAV_RESULT_ACCEPTED
    assert bench.mode_of() == "OFFBOARD"


def test_position_is_reached_with_yaw():
    with FreeBench() as bench:
        bench.take_off()
        offboard(bench, local(POSITION_ONLY & ~YAW, position=(8.0, 4.0, -7.0), yaw=1.5))
        bench.run(10.0)
        assert bench.position() == pytest.approx((8.0, 4.0, -7.0), abs=0.2)
        assert bench.heading() == pytest.approx(1.5, abs=0.05)
        assert bench.path()[:, 0].max() < 8.5


def test_vehicle_takes_off_by_position_set_points_alone():
    with FreeBench() as bench:
        bench.run(0.5)
        offboard(bench, local(POSITION_ONLY, position=(0.0, 0.0, -3.0)))
        assert bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_ACCEPTED
        bench.run(6.0)
        assert bench.position() == pytest.approx((0.0, 0.0, -3.0), abs=0.2)


def test_velocity_is_flown_and_bounded():
    with FreeBench() as bench:
        bench.take_off()
        offboard(bench, local(VELOCITY_ONLY, velocity=(2.0, -1.0, -0.5)))
        bench.run(3.0)
        began = len(bench.track)
        bench.run(3.0)
        mean = bench.path()[began:, 7:10].mean(axis=0)
        assert mean == pytest.approx((2.0, -1.0, -0.5), abs=0.1)
        bench.streaming[1] = local(VELOCITY_ONLY, velocity=(30.0, 0.0, 0.0))
        bench.run(6.0)
        assert bench.swarm.world.states()[0, 7] == pytest.approx(12.0, abs=0.5)  # MPC_XY_VEL_MAX


def test_velocity_in_the_body_frame_turns_with_the_vehicle():
    with FreeBench() as bench:
        bench.take_off()
        offboard(bench, local(VELOCITY_ONLY & ~YAW, yaw=math.pi / 2))
        bench.run(3.0)
        mask = VELOCITY_ONLY & ~YAW_RATE
        bench.streaming[1] = local(mask, velocity=(1.5, 0.0, 0.0), rate=0.5, frame=BODY)
        bench.run(1.0)
        first = bench.swarm.world.states()[0, 7:9].copy()
        assert first[1] > 1.0 and abs(first[0]) < 0.9  # it faced east
        bench.run(2.0 * math.pi)  # half a turn
        assert bench.swarm.world.states()[0, 7:9] == pytest.approx(-first, abs=0.4)
        x, y = bench.path()[-50:, 0], bench.path()[-50:, 1]
        assert np.hypot(np.diff(x), np.diff(y)).sum() == pytest.approx(1.5 * 49 * 0.02, abs=0.25)


def test_velocity_beyond_single_precision_once_it_is_turned_does_not_stop_telemetry(flying):
    offboard(flying, local(VELOCITY_ONLY & ~YAW, yaw=math.radians(45.0)))
    flying.run(3.0)
    largest = float(np.finfo(np.float32).max)
    flying.streaming[1] = local(VELOCITY_ONLY, velocity=(largest, largest, 0.0), frame=BODY)
    flying.run(0.2)
    target = flying.requested(mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED)
    assert (abs(target.vx) < 0.2 * largest, target.vy) == (True, largest)


def test_horizontal_velocity_with_altitude_keeps_the_altitude():
    with FreeBench() as bench:
        bench.take_off()
        mask = VELOCITY_ONLY & ~4 | 32  # z is given, vz is not
        offboard(bench, local(mask, position=(0.0, 0.0, -6.5), velocity=(3.0, 0.0, 0.0)))
        bench.run(5.0)
        assert bench.position()[2] == pytest.approx(-6.5, abs=0.2)
        assert bench.swarm.world.states()[0, 7] == pytest.approx(3.0, abs=0.2)


def test_acceleration_is_flown():
    with FreeBench() as bench:
        bench.take_off()
        offboard(bench, local(ACCELERATION_ONLY, acceleration=(1.0, 0.0, 0.0)))
        bench.run(0.7)
        before = bench.swarm.world.states()[0, 7]
        bench.run(2.0)
        assert bench.swarm.world.states()[0, 7] - before == pytest.approx(2.0, abs=0.3)


def test_global_position_is_reached_in_both_frames():
    with FreeBench() as bench:
        bench.take_off()
        latitude, longitude, altitude = FRAME.geodetic(5.0, -3.0, -6.0)
        place = round(latitude * 1e7), round(longitude * 1e7)

        def message(frame, up):
            return mavlink.MAVLink_set_position_target_global_int_message(
                0, 1, 1, frame, POSITION_ONLY, *place, up, 0, 0, 0, 0, 0, 0, 0, 0
            )

        offboard(bench, message(mavlink.MAV_FRAME_GLOBAL_INT, altitude))
        bench.run(9.0)
        assert bench.position() == pytest.approx((5.0, -3.0, -6.0), abs=0.2)
        bench.streaming[1] = message(mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT, 4.0)
        bench.run(6.0)
        assert bench.position() == pytest.approx((5.0, -3.0, -4.0), abs=0.2)


def attitude(q, thrust, mask=7, rates=(0, 0, 0)):
    return mavlink.MAVLink_set_attitude_target_message(0, 1, 1, mask, list(q), *rates, thrust)


def test_attitude_and_rates_are_flown():
    with FreeBench() as bench:
        bench.take_off(10.0)
        pitch = -math.radians(8.0)
        offboard(bench, attitude((math.cos(pitch / 2), 0, math.sin(pitch / 2), 0), HOVER / math.cos(pitch)))
        bench.run(0.7)
        w, x, y, z = bench.swarm.world.states()[0, 3:7]
        assert math.asin(2.0 * (w * y - z * x)) == pytest.approx(pitch, abs=0.02)
        before = bench.swarm.world.states()[0, 7]
        bench.run(1.0)
        assert bench.swarm.world.states()[0, 7] - before == pytest.approx(9.81 * math.tan(-pitch), abs=0.3)
        bench.streaming[1] = attitude((1, 0, 0, 0), HOVER, mask=128, rates=(0.0, 0.0, 0.8))
        bench.run(1.0)
        assert bench.swarm.world.states()[0, 12] == pytest.approx(0.8, abs=0.1)


def test_thrust_for_hovering_is_a_parameter():
    with FreeBench() as bench:
        assert bench.vehicles[0].parameters["MPC_THR_HOVER"] == pytest.approx(HOVER)


def test_lost_set_points_hold_then_return_and_land():
    with FreeBench() as bench:
        bench.set_parameter("RTL_RETURN_ALT", 6.0)
        bench.take_off()
        offboard(bench, local(VELOCITY_ONLY, velocity=(3.0, 0.0, 0.0)))
        bench.run(3.0)
        bench.streaming.clear()
        bench.messages.clear()
        bench.run(0.9)
        assert bench.mode_of() == "OFFBOARD"  # COM_OF_LOSS_T is 1 s
        bench.run(0.3)
        assert bench.mode_of() == "AUTO.LOITER" and bench.vehicles[0].autopilot.failsafe
        bench.run(4.0)
        assert np.linalg.norm(bench.swarm.world.states()[0, 7:10]) < 0.1
        bench.run(1.2)  # COM_FAIL_ACT_T is 5 s
        assert bench.mode_of() == "AUTO.RTL"
        assert bench.run(40.0, lambda: not bench.armed())
        assert bench.position() == pytest.approx((0.0, 0.0, -0.02), abs=0.3)
        assert "Set-points lost: holding" in bench.texts() and "Set-points lost: returning" in bench.texts()


def test_set_points_that_come_back_are_flown_again():
    with FreeBench() as bench:
        bench.take_off()
        position = local(POSITION_ONLY, position=(5.0, 0.0, -5.0))
        offboard(bench, position)
        bench.run(2.0)
        bench.streaming.clear()
        bench.run(2.0)
        assert bench.mode_of() == "AUTO.LOITER"
        bench.streaming[1] = position
        bench.run(0.3)
        assert bench.mode_of() == "OFFBOARD" and not bench.vehicles[0].autopilot.failsafe
        bench.run(8.0)
        assert bench.position() == pytest.approx((5.0, 0.0, -5.0), abs=0.2)


def test_lost_set_points_on_the_ground_disarm():
    with FreeBench() as bench:
        bench.run(0.5)
        offboard(bench, local(VELOCITY_ONLY, velocity=(0.0, 0.0, 1.0)))
        bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1)
        bench.run(0.5)
        assert bench.armed()
        bench.streaming.clear()
        bench.run(1.2)
        assert not bench.armed() and bench.mode_of() == "AUTO.LOITER"


def test_vehicle_put_down_by_set_points_disarms():
    with FreeBench() as bench:
        bench.take_off(2.0)
        offboard(bench, local(VELOCITY_ONLY, velocity=(0.0, 0.0, 0.7)))
        assert bench.run(15.0, lambda: not bench.armed())
        assert bench.position()[2] == pytest.approx(-0.02, abs=0.02)


@pytest.mark.parametrize(
    "action, expected", [(0, "AUTO.LOITER"), (1, "AUTO.LOITER"), (2, "AUTO.RTL"), (3, "AUTO.LAND")]
)
def test_silence_of_all_grounds_has_the_effect_of_its_parameter(action, expected):
    with FreeBench() as bench:
        bench.set_parameter("NAV_DLL_ACT", action)
        bench.set_parameter("COM_DL_LOSS_T", 5)
        bench.send(GCS_HEARTBEAT)
        bench.take_off(3.0)
        bench.vehicles[0].autopilot.go_to((6.0, 0.0, -3.0), NAN, NAN, bench.now)
        bench.send(GCS_HEARTBEAT)
        bench.run(4.5)
        assert not bench.vehicles[0].autopilot.failsafe
        bench.run(1.0)
        assert bench.mode_of() == expected
        assert bench.vehicles[0].autopilot.failsafe == (action > 0)


def test_heartbeats_of_ground_stations_alone_are_a_data_link():
    with FreeBench() as bench:
        bench.set_parameter("NAV_DLL_ACT", 1)
        bench.set_parameter("COM_DL_LOSS_T", 5)
        bench.run(0.5)
        bench.send(COMPANION_HEARTBEAT)
        assert bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
        assert "no HEARTBEAT of a ground station" in bench.texts()
        bench.send(GCS_HEARTBEAT)
        bench.take_off(3.0)
        for _ in range(6):
            bench.send(COMPANION_HEARTBEAT)
            bench.run(1.0)
        assert bench.vehicles[0].autopilot.failsafe
        bench.send(GCS_HEARTBEAT)
        assert bench.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == mavlink.MAV_RESULT_ACCEPTED
        bench.run(1.0)
        assert bench.mode_of() == "AUTO.RTL" and not bench.vehicles[0].autopilot.failsafe


def fields_of(message):
    return tuple(getattr(message, name) for name in message.ordered_fieldnames)


def test_set_point_without_anything_to_fly_is_refused():
    with pytest.raises(SetpointError, match="neither position, velocity nor acceleration"):
        read_local(fields_of(local(0b0001_1111_1111)), 0.0)
    with pytest.raises(SetpointError, match="a force cannot be flown"):
        read_local(fields_of(local(POSITION_ONLY | 512)), 0.0)
    with pytest.raises(SetpointError, match="infinite"):
        read_local(fields_of(local(POSITION_ONLY, position=(math.inf, 0, 0))), 0.0)


@pytest.mark.parametrize("frame", [mavlink.MAV_FRAME_LOCAL_OFFSET_NED, mavlink.MAV_FRAME_BODY_OFFSET_NED, 99])
def test_frames_that_px4_does_not_take_are_refused_and_counted(frame):
    message = local(POSITION_ONLY, position=(1, 2, 3), frame=frame)
    with pytest.raises(SetpointError, match=f"frame {frame} is not supported"):
        read_local(fields_of(message), 0.0)
    with FreeBench() as bench:
        bench.run(0.1)
        bench.send(message)
        assert bench.vehicles[0].refused_setpoints == 1


def test_position_in_a_body_frame_is_not_taken():
    message = local(0, position=(1, 2, 3), velocity=(1, 0, 0), frame=BODY)
    found = read_local(fields_of(message), math.pi / 2)
    assert all(map(math.isnan, found.position))
    assert found.velocity == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)


def test_global_frame_above_terrain_is_refused():
    message = mavlink.MAVLink_set_position_target_global_int_message(
        0, 1, 1, mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT, POSITION_ONLY, 0, 0, 5.0, 0, 0, 0, 0, 0, 0, 0, 0
    )
    with pytest.raises(SetpointError, match="frame 11 is not supported"):
        read_global(fields_of(message), FRAME.local, DEFAULT_HOME.altitude)


def test_another_ground_cannot_steer_a_vehicle_in_offboard():
    with FreeBench() as bench:
        bench.take_off()
        offboard(bench, local(POSITION_ONLY, position=(0.0, 0.0, -5.0)))
        refused = bench.vehicles[0].refused_setpoints
        intruder = type(bench.codec)(77, 190)
        message = local(POSITION_ONLY, position=(50.0, 0.0, -5.0))
        bench.swarm.receive(1, intruder.encode(message), ("intruder", 2), bench.now)
        assert bench.vehicles[0].refused_setpoints == refused + 1
        bench.run(2.0)
        assert bench.position()[0] < 0.2


def test_refusal_of_set_points_and_of_offboard_names_the_reason():
    with FreeBench() as bench:
        bench.run(0.5)
        bench.streaming[1] = local(POSITION_ONLY, frame=mavlink.MAV_FRAME_LOCAL_ENU)
        bench.run(1.0)
        assert bench.texts().count("frame 4 is not supported") == 1  # of seventeen set-points
        assert bench.command(*OFFBOARD) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
        assert "OFFBOARD denied: SET_POSITION_TARGET_LOCAL_NED refused" in bench.texts()
        bench.streaming.clear()
        bench.run(2.0)
        assert bench.command(*OFFBOARD) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
        assert "no set-points from you" in bench.texts()


def test_link_loss_in_offboard_holds_though_set_points_of_a_companion_come():
    with FreeBench() as bench:
        bench.set_parameter("NAV_DLL_ACT", 1)
        bench.set_parameter("COM_DL_LOSS_T", 5)
        bench.send(GCS_HEARTBEAT)
        bench.take_off()
        bench.send(GCS_HEARTBEAT)
        offboard(bench, local(VELOCITY_ONLY, velocity=(1.0, 0.0, 0.0)))
        bench.messages.clear()
        bench.run(8.0)
        assert bench.mode_of() == "AUTO.LOITER" and bench.vehicles[0].autopilot.failsafe
        assert bench.texts().count("No ground station") == 1
