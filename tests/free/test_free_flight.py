"""What a free vehicle flies by itself: take-off, go-to, return, landing, holding against wind."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import FRAME, NAN, FreeBench, config_of, mode

from gcs.mavlink import px4
from gcs.mavlink.services.aircraft import Reposition
from gcs.mission.model import DEFAULT_HOME, Fault
from vehicle_sim.faults.fault_injector import FaultInjector

ACCEPTED, REJECTED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_TEMPORARILY_REJECTED
ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM


def reposition(bench, north, east, up, yaw=NAN, speed=NAN):
    latitude, longitude, altitude = FRAME.geodetic(north, east, -up)
    return bench.vehicles[0].aircraft.reposition(Reposition(latitude, longitude, altitude, yaw, speed), bench.now)


def test_take_off_mode_climbs_to_the_parameters_height_then_loiters(bench):
    bench.set_parameter("MIS_TAKEOFF_ALT", 4.0)
    assert bench.command(ARM, 1) == ACCEPTED
    bench.run(0.5)
    assert bench.position()[2] == pytest.approx(-0.02, abs=0.01)  # armed in LOITER it stays on the ground
    assert bench.command(*mode(px4.AutoMode.TAKEOFF)) == ACCEPTED
    bench.run(0.1)
    assert bench.mode_of() == "AUTO.TAKEOFF"
    assert bench.run(10.0, lambda: bench.mode_of() == "AUTO.LOITER")
    bench.run(3.0)
    assert bench.position() == pytest.approx((0.0, 0.0, -4.0), abs=0.2)
    path = bench.path()
    assert -path[:, 2].min() < 4.3
    assert -path[:, 9].min() == pytest.approx(1.5, abs=0.3)  # MPC_TKO_SPEED


def test_take_off_commanded_before_arming_begins_when_armed(bench):
    assert bench.vehicles[0].aircraft.take_off(DEFAULT_HOME.altitude + 3.0, bench.now).result == ACCEPTED
    bench.run(0.5)
    assert not bench.armed()
    assert bench.command(ARM, 1) == ACCEPTED
    bench.run(6.0)
    assert bench.position()[2] == pytest.approx(-3.0, abs=0.2)


def test_go_to_ends_at_the_place_with_yaw_at_the_speed(flying):
    began = len(flying.track)
    assert reposition(flying, 12.0, -5.0, 8.0, yaw=math.radians(100.0), speed=3.0).result == ACCEPTED
    flying.run(12.0)
    assert flying.mode_of() == "AUTO.LOITER"
    assert flying.position() == pytest.approx((12.0, -5.0, -8.0), abs=0.3)
    assert math.degrees(flying.heading()) == pytest.approx(100.0, abs=3.0)
    path = flying.path()[began:]
    assert np.hypot(path[:, 7], path[:, 8]).max() == pytest.approx(3.0, abs=0.3)
    # About straight: no more than a metre beside the line.
    line = np.array((12.0, -5.0)) / 13.0
    assert np.abs(path[:, 0] * line[1] - path[:, 1] * line[0]).max() < 0.5
    assert path[:, 0].max() < 12.4


def test_go_to_of_altitude_alone_stays_over_its_place(flying):
    goal = Reposition(NAN, NAN, DEFAULT_HOME.altitude + 9.0, NAN, NAN)
    assert flying.vehicles[0].aircraft.reposition(goal, flying.now).result == ACCEPTED
    flying.run(7.0)
    assert flying.position() == pytest.approx((0.0, 0.0, -9.0), abs=0.3)


def test_go_to_is_rejected_on_the_ground(bench):
    answer = reposition(bench, 5.0, 0.0, 5.0)
    assert answer.result == REJECTED and answer.text == "Reposition denied: not flying"


def test_change_of_speed_is_flown_and_bounded(flying):
    reposition(flying, 60.0, 0.0, 5.0, speed=4.0)
    flying.run(5.0)
    assert flying.swarm.world.states()[0, 7] == pytest.approx(4.0, abs=0.3)
    flying.set_parameter("MPC_XY_VEL_MAX", 8.0)
    assert flying.vehicles[0].aircraft.change_speed(11.0, flying.now).result == ACCEPTED
    flying.run(3.0)
    assert flying.swarm.world.states()[0, 7] == pytest.approx(8.0, abs=0.3)


def test_hold_brakes_and_stays(flying):
    reposition(flying, 50.0, 0.0, 5.0)
    flying.run(4.0)
    before = flying.position()[0]
    assert flying.command(*mode(px4.AutoMode.LOITER)) == ACCEPTED
    flying.run(5.0)
    stopped = flying.position().copy()
    assert 2.0 < stopped[0] - before < 12.0
    flying.run(3.0)
    assert flying.position() == pytest.approx(stopped, abs=0.1)


def test_return_climbs_flies_home_lands_and_disarms():
    with FreeBench(2) as bench:
        bench.set_parameter("RTL_RETURN_ALT", 9.0, vehicle=2)
        bench.set_parameter("RTL_DESCEND_ALT", 4.0, vehicle=2)
        bench.take_off(4.0)
        bench.vehicles[1].autopilot.go_to((15.0, 10.0, -4.0), NAN, 8.0, bench.now)
        bench.run(8.0)
        assert bench.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, vehicle=2) == ACCEPTED
        began = len(bench.track)
        assert bench.run(40.0, lambda: not bench.armed(2))
        path = bench.path(2)[began:]
        assert -path[:, 2].min() == pytest.approx(9.0, abs=0.4)
        far = np.hypot(path[:, 0], path[:, 1] - 2.0) > 5.0
        moving = np.hypot(path[:, 7], path[:, 8]) > 1.0
        assert -path[far & moving, 2].max() > 8.0  # it flies home at that height
        assert bench.position(2) == pytest.approx((0.0, 2.0, -0.02), abs=0.3)  # its own home
        assert bench.mode_of(2) == "AUTO.LOITER" and bench.mode_of(1) == "AUTO.LOITER"
        assert bench.armed(1)


def test_return_near_home_stays_within_the_cone():
    with FreeBench() as bench:
        bench.take_off(3.0)
        reposition(bench, 6.0, 0.0, 3.0)
        bench.run(6.0)
        bench.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH)
        assert bench.run(40.0, lambda: not bench.armed())
        assert -bench.path()[:, 2].min() == pytest.approx(6.0, abs=0.5)


def test_landing_touches_down_gently_where_it_is_and_disarms(flying):
    reposition(flying, 4.0, 3.0, 5.0)
    flying.run(6.0)
    assert flying.command(mavlink.MAV_CMD_NAV_LAND) == ACCEPTED
    flying.run(0.5)
    assert flying.mode_of() == "AUTO.LAND"
    flying.messages.clear()
    assert flying.run(20.0, lambda: not flying.armed())
    path = flying.path()
    low = (path[:, 2] > -1.0) & (path[:, 2] < -0.1)
    assert path[low, 9][-10:] == pytest.approx(0.7, abs=0.15)  # MPC_LAND_SPEED
    assert flying.position() == pytest.approx((4.0, 3.0, -0.02), abs=0.3)
    flying.run(1.0)
    assert "Touch-down: disarmed" in flying.texts()
    assert flying.swarm.at_rest
    assert flying.swarm.world.contacts() == (0, True)


def test_landing_from_a_climb_does_not_disarm_in_the_air(flying):
    reposition(flying, 0.0, 0.0, 40.0)
    flying.run(4.0)
    assert flying.swarm.world.states()[0, 9] < -2.5
    flying.command(mavlink.MAV_CMD_NAV_LAND)
    assert flying.run(40.0, lambda: not flying.armed())
    assert flying.position()[2] == pytest.approx(-0.02, abs=0.02)


def test_vehicle_flies_again_after_a_landing():
    with FreeBench() as bench:
        bench.take_off(2.0)
        bench.command(mavlink.MAV_CMD_NAV_LAND)
        assert bench.run(15.0, lambda: not bench.armed())
        bench.run(1.0)
        bench.take_off(3.0)
        bench.run(3.0)
        assert bench.position()[2] == pytest.approx(-3.0, abs=0.2)


def test_disarming_in_the_air_needs_force(flying):
    assert flying.command(ARM, 0) == mavlink.MAV_RESULT_DENIED
    assert flying.command(ARM, 0, px4.FORCE_ARM_DISARM) == ACCEPTED
    flying.run(0.5)
    assert flying.swarm.world.states()[0, 9] > 1.0  # it falls


def test_holds_its_place_against_wind():
    fault = Fault("wind", 0.0, settings={"velocity": [6.0, -4.0, 0.0], "gust": 1.0})
    with FreeBench(faults=FaultInjector((fault,), 1, config_of(1))) as bench:
        bench.take_off()
        bench.run(10.0)
        x, y = bench.swarm.world.states()[0, 4:6]
        assert math.acos(1.0 - 2.0 * (x * x + y * y)) > math.radians(2.0)  # it leans against it
        bench.run(10.0)
        away = np.linalg.norm(bench.path()[-500:, :3] - (0.0, 0.0, -5.0), axis=1)
        assert away.max() < 0.5


def test_home_position_is_each_vehicles_own():
    with FreeBench(2) as bench:
        bench.take_off(2.0)
        bench.messages.clear()
        bench.run(2.5)
        homes = {i: m for _, i, m in bench.messages if m.get_type() == "HOME_POSITION"}
        assert homes[1].y == pytest.approx(0.0, abs=0.1) and homes[2].y == pytest.approx(2.0, abs=0.1)
        for message in homes.values():
            north, east, _ = FRAME.local(message.latitude * 1e-7, message.longitude * 1e-7, message.altitude * 1e-3)
            assert (north, east) == pytest.approx((message.x, message.y), abs=0.02)
        origins = {m.latitude for _, _, m in bench.messages if m.get_type() == "GPS_GLOBAL_ORIGIN"}
        assert len(origins) <= 1


def test_no_payload_unit_is_forwarded():
    with FreeBench() as bench:
        bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        bench.run(3.0)
        assert bench.messages
        assert {message.get_srcSystem() for _, _, message in bench.messages} == {1}


def test_landed_state_follows_the_flight():
    with FreeBench() as bench:
        seen = []

        def look():
            state = bench.vehicles[0].autopilot.landed_state
            if seen[-1:] != [state]:
                seen.append(state)
            return False

        bench.run(0.5, look)
        bench.command(ARM, 1)
        bench.command(*mode(px4.AutoMode.TAKEOFF))
        bench.run(5.0, look)
        bench.command(mavlink.MAV_CMD_NAV_LAND)
        bench.run(8.0, look)
        assert seen == [
            mavlink.MAV_LANDED_STATE_ON_GROUND,
            mavlink.MAV_LANDED_STATE_TAKEOFF,
            mavlink.MAV_LANDED_STATE_IN_AIR,
            mavlink.MAV_LANDED_STATE_LANDING,
            mavlink.MAV_LANDED_STATE_ON_GROUND,
        ]


def test_take_off_to_less_than_its_height_does_not_sink():
    with FreeBench() as bench:
        bench.take_off(6.0)
        bench.run(3.0)
        assert bench.vehicles[0].aircraft.take_off(DEFAULT_HOME.altitude + 2.0, bench.now).result == ACCEPTED
        bench.run(4.0)
        assert bench.position()[2] == pytest.approx(-6.0, abs=0.2)
        assert bench.command(*mode(px4.AutoMode.TAKEOFF)) == ACCEPTED
        bench.run(3.0)
        assert bench.mode_of() == "AUTO.LOITER"
