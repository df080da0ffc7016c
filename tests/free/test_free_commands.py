"""Commands to a free vehicle beside its modes: home, heading, speed."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import FRAME, NAN, OFFBOARD, FreeBench, item, mode

from gcs.mavlink import px4
from gcs.mission.model import DEFAULT_HOME

ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
REJECTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED
ARM, RETURN = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH
SET_HOME, YAW, SPEED = mavlink.MAV_CMD_DO_SET_HOME, mavlink.MAV_CMD_CONDITION_YAW, mavlink.MAV_CMD_DO_CHANGE_SPEED


def go_to(bench, north, east, up, speed=NAN):
    return bench.vehicles[0].autopilot.go_to((north, east, -up), NAN, speed, bench.now)


def set_home(bench, north, east, up=0.0):
    """Set home, in single precision as on the wire, and return where that is (NED, m)."""
    places = [float(np.float32(value)) for value in FRAME.geodetic(north, east, -up)]
    assert bench.command(SET_HOME, 0, 0, 0, 0, *places) == ACCEPTED
    return FRAME.local(*places)


def home_of(bench):
    return bench.requested(mavlink.MAVLINK_MSG_ID_HOME_POSITION)


def test_home_that_was_set_is_reported_and_returned_to():
    with FreeBench() as bench:
        bench.set_parameter("RTL_RETURN_ALT", 6.0)
        bench.set_parameter("RTL_DESCEND_ALT", 3.0)
        bench.take_off()
        place = set_home(bench, 14.0, -9.0)
        reported = home_of(bench)
        assert (reported.x, reported.y, reported.z) == pytest.approx(place, abs=0.01)
        assert bench.command(RETURN) == ACCEPTED
        assert bench.run(50.0, lambda: not bench.armed())
        assert bench.position()[:2] == pytest.approx(place[:2], abs=0.3)
        assert bench.swarm.world.contacts().pairs == 0
        assert bench.command(ARM, 1) == ACCEPTED  # arming does not change it
        assert home_of(bench).x == pytest.approx(place[0], abs=0.01)


def test_home_where_it_is_changes_with_the_next_arming(flying):
    go_to(flying, 7.0, 0.0, 5.0)
    flying.run(6.0)
    assert flying.command(SET_HOME, 1) == ACCEPTED
    assert (home_of(flying).x, home_of(flying).z) == pytest.approx((7.0, -5.0), abs=0.2)
    go_to(flying, 0.0, 3.0, 2.0)
    flying.run(7.0)
    flying.command(mavlink.MAV_CMD_NAV_LAND)
    assert flying.run(20.0, lambda: not flying.armed())
    flying.run(1.0)
    assert flying.command(ARM, 1) == ACCEPTED
    assert (home_of(flying).x, home_of(flying).y) == pytest.approx((0.0, 3.0), abs=0.3)


def test_home_set_while_it_returns_is_flown_to(flying):
    go_to(flying, 30.0, 0.0, 5.0)
    flying.run(9.0)
    flying.set_parameter("RTL_RETURN_ALT", 6.0)
    flying.command(RETURN)
    flying.run(3.0)
    place = set_home(flying, 30.0, 12.0)
    assert flying.run(60.0, lambda: not flying.armed())
    assert flying.position()[:2] == pytest.approx(place[:2], abs=0.3)


def test_relative_altitudes_are_above_a_home_that_was_set(flying):
    flying.vehicles[0].aircraft.take_mission(
        [item(mavlink.MAV_CMD_NAV_WAYPOINT, 10.0, 0.0, 6.0)], 0, lambda index: None
    )
    flying.run(1.5)
    set_home(flying, 0.0, 0.0, up=4.0)
    position = flying.requested(mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)
    assert position.relative_alt * 1e-3 == pytest.approx(1.0, abs=0.15)
    altitude = flying.requested(mavlink.MAVLINK_MSG_ID_ALTITUDE)
    assert altitude.altitude_relative == pytest.approx(1.0, abs=0.15)
    assert altitude.altitude_local == pytest.approx(5.0, abs=0.15)
    assert flying.command(*mode(px4.AutoMode.MISSION)) == ACCEPTED
    flying.run(8.0)
    assert flying.position() == pytest.approx((10.0, 0.0, -10.0), abs=0.4)
    flying.command(RETURN)
    assert flying.run(60.0, lambda: not flying.armed())
    assert flying.position()[2] == pytest.approx(-0.02, abs=0.02)  # it lands on the ground, not at home's altitude


@pytest.mark.parametrize("up", [-30.0, 12.0])
def test_return_to_a_home_off_the_ground_lands_gently(up):
    with FreeBench() as bench:
        bench.set_parameter("RTL_RETURN_ALT", 8.0)
        bench.take_off()
        set_home(bench, 8.0, 0.0, up=up)
        bench.command(RETURN)
        assert bench.run(90.0, lambda: not bench.armed())
        path = bench.path()
        low = (path[:, 2] > -1.0) & (path[:, 2] < -0.1)
        assert path[low, 9][-10:] == pytest.approx(0.7, abs=0.15)  # MPC_LAND_SPEED


@pytest.mark.parametrize(
    ("parameters", "heading", "turned"),
    [
        ((90.0, 0.0, 0.0, 0.0), 90.0, 90.0),
        ((350.0, 0.0, 1.0, 0.0), 350.0, 350.0),
        ((90.0, 0.0, -1.0, 0.0), 90.0, -270.0),
        ((40.0, 0.0, -1.0, 1.0), -40.0, -40.0),
        ((40.0, 10.0, 0.0, 1.0), 40.0, 40.0),
    ],
)
def test_turn_is_made_in_its_direction_with_its_rate(flying, parameters, heading, turned):
    began = len(flying.track)
    assert flying.command(YAW, *parameters) == ACCEPTED
    flying.run(0.6)
    rate = flying.swarm.world.states()[0, 12]
    assert rate == pytest.approx(math.copysign(math.radians(parameters[1]) or 0.8, turned), abs=0.08)
    flying.run(9.0)
    assert math.degrees(math.remainder(flying.heading() - math.radians(heading), 2 * math.pi)) == pytest.approx(
        0.0, abs=2.0
    )
    rates = flying.path()[began:, 12]
    assert math.degrees(rates.sum() * 0.02) == pytest.approx(turned, abs=4.0)
    assert flying.position() == pytest.approx((0.0, 0.0, -5.0), abs=0.3)


def test_turn_on_the_way_to_a_place_is_kept(flying):
    go_to(flying, 20.0, 0.0, 5.0)
    flying.run(2.0)
    assert flying.command(YAW, 180.0) == ACCEPTED
    flying.run(8.0)
    assert abs(math.degrees(flying.heading())) == pytest.approx(180.0, abs=2.0)
    assert flying.position() == pytest.approx((20.0, 0.0, -5.0), abs=0.3)


def test_turn_that_would_not_happen_is_refused_with_the_reason(bench):
    assert bench.command(YAW, 90.0) == REJECTED and "Turn denied: not flying" in bench.texts()
    bench.take_off()
    assert bench.command(YAW, 90.0, 120.0) == DENIED and "the limit is 45.84 deg/s" in bench.texts()
    bench.command(RETURN)
    bench.run(0.1)
    assert bench.command(YAW, 90.0) == REJECTED and "AUTO.RTL has its own heading" in bench.texts()


def speed_of(bench):
    return math.hypot(*bench.swarm.world.states()[0, 7:9])


def test_change_of_speed_acts_in_every_phase_that_flies_ahead(bench):
    assert bench.command(SPEED, 1, 2.0) == REJECTED and "not flying" in bench.texts()
    items = [item(mavlink.MAV_CMD_NAV_WAYPOINT, 60.0, 0.0, 4.0)]
    bench.vehicles[0].aircraft.take_mission(items, 0, lambda index: None)
    assert bench.command(mavlink.MAV_CMD_MISSION_START) == ACCEPTED
    bench.run(1.0)
    assert bench.command(SPEED, 1, 2.0) == ACCEPTED  # in the climb
    bench.run(7.0)
    assert speed_of(bench) == pytest.approx(2.0, abs=0.2)
    assert bench.command(*mode(px4.AutoMode.LOITER)) == ACCEPTED
    bench.run(2.0)
    assert bench.command(SPEED, 1, 3.0) == ACCEPTED
    go_to(bench, 60.0, 30.0, 4.0)  # without a speed of its own
    bench.run(4.0)
    assert speed_of(bench) == pytest.approx(3.0, abs=0.2)
    bench.set_parameter("RTL_RETURN_ALT", 10.0)
    bench.command(RETURN)
    bench.run(1.0)
    assert bench.command(SPEED, 1, 1.5) == ACCEPTED
    assert bench.run(30.0, lambda: -bench.position()[2] > 9.5)
    bench.run(4.0)
    assert speed_of(bench) == pytest.approx(1.5, abs=0.2)
    bench.command(mavlink.MAV_CMD_NAV_LAND)
    bench.run(0.1)
    assert bench.command(SPEED, 1, 2.0) == REJECTED and "AUTO.LAND has no horizontal speed" in bench.texts()


def test_change_of_speed_in_offboard_is_refused(flying):
    flying.streaming[1] = mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, 0b1101_1111_1000, 0, 0, -5, *[0.0] * 8
    )
    flying.run(0.3)
    assert flying.command(*OFFBOARD) == ACCEPTED
    assert flying.command(SPEED, 1, 2.0) == REJECTED and "speed of its set-points" in flying.texts()


def test_take_off_altitude_is_above_the_ground_also_with_another_home(bench):
    set_home(bench, 20.0, 0.0, up=30.0)
    assert bench.command(ARM, 1) == ACCEPTED
    assert bench.vehicles[0].aircraft.take_off(DEFAULT_HOME.altitude + 4.0, bench.now).result == ACCEPTED
    bench.run(6.0)
    assert bench.position() == pytest.approx((0.0, 0.0, -4.0), abs=0.2)


def test_refused_mode_leaves_the_altitude_of_the_next_take_off(bench):
    assert bench.vehicles[0].aircraft.take_off(DEFAULT_HOME.altitude + 4.0, bench.now).result == ACCEPTED
    assert bench.command(RETURN) == REJECTED
    assert bench.command(ARM, 1) == ACCEPTED
    bench.run(7.0)
    assert bench.position() == pytest.approx((0.0, 0.0, -4.0), abs=0.2)
