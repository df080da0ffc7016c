"""Missions of a free vehicle: what is flown of each item, and how far it has come."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import FRAME, NAN, FreeBench, item, mode

from gcs.mavlink import px4
from gcs.mission.model import DEFAULT_HOME
from vehicle_sim.autopilot.free.mission import Action, Mission, MissionStep
from vehicle_sim.mavlink.mission_steps import steps_of

TAKEOFF, WAYPOINT, LAND = mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_NAV_LAND
MISSION = mode(px4.AutoMode.MISSION)
ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
HOME = (0.0, 0.0, 0.0)


def upload(bench, *items, vehicle=1, current=0):
    """Give a vehicle a mission; returns the list of items that it reports as reached."""
    reached = []
    assert bench.vehicles[vehicle - 1].aircraft.take_mission(items, current, reached.append).result == 0
    return reached


def nearest(path, *place):
    return np.linalg.norm(path[:, :3] - place, axis=1).min()


def test_three_waypoints_are_passed_in_order_then_it_returns_and_disarms(bench):
    bench.set_parameter("RTL_RETURN_ALT", 6.0)
    bench.set_parameter("NAV_ACC_RAD", 1.0)
    reached = upload(
        bench,
        item(TAKEOFF, up=5.0),
        item(mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST),  # a camera that it does not have
        item(WAYPOINT, 10.0, 0.0, 5.0),
        item(WAYPOINT, 10.0, 8.0, 7.0, 2.0, 0.3, NAN, 45.0),  # for 2 s, within 0.3 m, to the north-east
        item(WAYPOINT, 0.0, 8.0, 5.0),
        item(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH),
    )
    assert bench.command(*MISSION) == mavlink.MAV_RESULT_ACCEPTED
    assert bench.command(ARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    headings = []

    def at_third():
        headings.append((bench.vehicles[0].aircraft.current_item, bench.heading()))
        return not bench.armed()

    assert bench.run(80.0, at_third)
    assert reached == [0, 1, 2, 3, 4, 5]
    path = bench.path()
    assert nearest(path, 10.0, 0.0, -5.0) < 1.1
    assert nearest(path, 10.0, 8.0, -7.0) < 0.2
    assert nearest(path, 0.0, 8.0, -5.0) < 1.1
    staying = np.linalg.norm(path[:, :3] - (10.0, 8.0, -7.0), axis=1) < 0.35
    assert 2.0 <= staying.sum() * 0.02 < 4.5
    assert math.degrees([h for i, h in headings if i == 3][-1]) == pytest.approx(45.0, abs=3.0)
    assert bench.position() == pytest.approx((0.0, 0.0, -0.02), abs=0.3)


def test_vehicle_looks_ahead_to_a_waypoint_without_yaw(flying):
    upload(flying, item(WAYPOINT, 0.0, -20.0, 5.0))
    flying.command(*MISSION)
    flying.run(4.0)
    assert math.degrees(flying.heading()) == pytest.approx(-90.0, abs=3.0)


def test_mission_without_take_off_climbs_before_it_leaves_the_ground_sideways(bench):
    upload(bench, item(WAYPOINT, 8.0, 0.0, 4.0))
    bench.command(*MISSION)
    bench.command(ARM, 1)
    assert bench.run(20.0, lambda: bench.mode_of() == "AUTO.LOITER")
    path = bench.path()
    low = path[:, 2] > -2.0
    assert np.abs(path[low, 0]).max() < 0.3
    bench.run(4.0)
    assert bench.position() == pytest.approx((8.0, 0.0, -4.0), abs=0.3)


def test_paused_mission_goes_on_with_its_item(flying):
    reached = upload(flying, item(WAYPOINT, 6.0, 0.0, 5.0), item(WAYPOINT, 30.0, 0.0, 5.0))
    aircraft = flying.vehicles[0].aircraft
    assert aircraft.start_mission(0, flying.now).result == 0
    assert flying.run(10.0, lambda: flying.position()[0] > 12.0)
    assert aircraft.pause(flying.now).result == 0
    flying.run(5.0)
    assert flying.mode_of() == "AUTO.LOITER" and reached == [0] and aircraft.current_item == 1
    assert flying.position()[0] < 25.0
    assert aircraft.resume(flying.now).result == 0
    flying.send(mavlink.MAVLink_mission_ack_message(1, 1, 0))  # it listens, after a long silence
    assert flying.run(15.0, lambda: aircraft.mission_finished)
    assert reached == [0, 1]
    flying.run(5.0)
    assert flying.mode_of() == "AUTO.LOITER"
    assert flying.position()[0] == pytest.approx(30.0, abs=0.3)
    assert "Mission finished" in flying.texts()


def test_current_item_may_be_set_while_it_flies(flying):
    reached = upload(flying, item(WAYPOINT, 40.0, 0.0, 5.0), item(WAYPOINT, 0.0, 6.0, 5.0))
    aircraft = flying.vehicles[0].aircraft
    aircraft.start_mission(0, flying.now)
    flying.run(2.0)
    assert aircraft.set_current_item(1, flying.now).result == 0
    assert aircraft.set_current_item(2, flying.now).result == mavlink.MAV_RESULT_DENIED
    assert flying.run(15.0, lambda: aircraft.mission_finished)
    assert reached == [1]
    assert flying.path()[:, 0].max() < 15.0


def test_mission_lands_at_its_place_and_begins_anew():
    with FreeBench() as bench:
        bench.take_off(3.0)
        reached = upload(bench, item(LAND, 5.0, 4.0))
        bench.command(*MISSION)
        assert bench.run(30.0, lambda: not bench.armed())
        assert bench.position() == pytest.approx((5.0, 4.0, -0.02), abs=0.3)
        assert reached == [0] and bench.vehicles[0].aircraft.mission_finished
        assert bench.command(*MISSION) == mavlink.MAV_RESULT_ACCEPTED
        assert not bench.vehicles[0].aircraft.mission_finished


def test_speed_delay_and_timed_loiter_are_flown(flying):
    reached = upload(
        flying,
        item(mavlink.MAV_CMD_DO_CHANGE_SPEED, 0.0, 0.0, 0.0, 1.0, 2.0),
        item(WAYPOINT, 10.0, 0.0, 5.0),
        item(mavlink.MAV_CMD_NAV_DELAY, 0.0, 0.0, 0.0, 4.0),
        item(mavlink.MAV_CMD_NAV_LOITER_TIME, 10.0, 5.0, 5.0, 3.0),
        item(mavlink.MAV_CMD_NAV_LOITER_UNLIM, 0.0, 5.0, 5.0),
    )
    times = []
    flying.vehicles[0].autopilot.state.mission.on_reached = lambda i: (reached.append(i), times.append(flying.now))
    flying.command(*MISSION)
    began = len(flying.track)
    assert flying.run(40.0, lambda: reached[-1:] == [3])
    path = flying.path()[began:]
    assert np.hypot(path[:, 7], path[:, 8]).max() == pytest.approx(2.0, abs=0.3)
    assert times[2] - times[1] == pytest.approx(4.0, abs=0.1)
    assert times[3] - times[2] > 3.0
    flying.run(12.0)
    assert reached == [0, 1, 2, 3] and flying.mode_of() == "AUTO.MISSION"  # it loiters for ever
    assert flying.position() == pytest.approx((0.0, 5.0, -5.0), abs=0.3)


def test_start_of_a_mission_arms_for_it(bench):
    aircraft = bench.vehicles[0].aircraft
    assert aircraft.start_mission(0, bench.now).result == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert not bench.armed()
    upload(bench, item(WAYPOINT, 50.0, 0.0, 3.0), item(mavlink.MAV_CMD_NAV_LOITER_TO_ALT, 0.0, 0.0, 4.0))
    assert aircraft.start_mission(1, bench.now).result == mavlink.MAV_RESULT_ACCEPTED
    assert bench.armed()
    bench.run(8.0)
    assert bench.position() == pytest.approx((0.0, 0.0, -4.0), abs=0.3)
    assert aircraft.start_mission(2, bench.now).result == mavlink.MAV_RESULT_DENIED


def test_mission_cleared_before_arming_leaves_the_vehicle_on_the_ground(bench):
    upload(bench, item(WAYPOINT, 8.0, 0.0, 4.0))
    assert bench.command(*MISSION) == mavlink.MAV_RESULT_ACCEPTED
    upload(bench)
    assert bench.command(ARM, 1) == mavlink.MAV_RESULT_ACCEPTED
    bench.run(2.0)
    assert bench.mode_of() == "AUTO.LOITER"
    assert bench.position()[2] == pytest.approx(-0.02, abs=0.01)


def test_mode_is_rejected_without_a_mission(bench):
    assert bench.command(*MISSION) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert "no mission" in bench.texts()


def test_cleared_mission_leaves_the_vehicle_holding(flying):
    upload(flying, item(WAYPOINT, 40.0, 0.0, 5.0))
    flying.command(*MISSION)
    flying.run(2.0)
    upload(flying)
    assert flying.mode_of() == "AUTO.LOITER"
    flying.run(4.0)
    assert np.linalg.norm(flying.swarm.world.states()[0, 7:10]) < 0.2


def test_jump_is_made_so_many_times():
    reached = []
    fly = MissionStep(Action.FLY)
    mission = Mission((fly, fly, MissionStep(Action.JUMP, target=1, repeat=2), fly), on_reached=reached.append)
    while not mission.finished:
        mission.done()
    assert reached == [0, 1, 2, 1, 2, 1, 2, 3]
    assert mission.current == 3
    mission.restart()
    assert mission.current == 0 and not mission.finished


def test_altitudes_are_above_home_or_sea_by_the_frame():
    home = (1.0, 2.0, -0.5)
    above_home = item(WAYPOINT, 20.0, 0.0, 10.0)
    above_sea = above_home._replace(frame=mavlink.MAV_FRAME_GLOBAL, z=DEFAULT_HOME.altitude + 10.0)
    first, second = steps_of((above_home, above_sea), FRAME, home)
    assert first.position == pytest.approx((20.0, 0.0, -10.5), abs=0.02)
    assert second.position == pytest.approx((20.0, 0.0, -10.0), abs=0.02)


def test_item_without_a_place_keeps_the_vehicles():
    (step,) = steps_of((item(TAKEOFF, up=5.0)._replace(x=0, y=0),), FRAME, HOME)
    assert math.isnan(step.position[0]) and math.isnan(step.position[1]) and step.position[2] == pytest.approx(-5.0)
