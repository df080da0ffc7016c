"""MAVSDK 4 flies a vehicle without a payload by its actions; what then happens is in the true motion."""

import math

import numpy as np
import pytest
from client_swarm import FRAME
from mavsdk.plugins.action import OrbitYawBehavior
from mavsdk_client import Steps, first, fly

pytestmark = pytest.mark.slow

TARGET = (4.0, -1.0, 3.0)  # m, north, east, up


@pytest.fixture(scope="module")
def flown(free_swarm):
    """One flight of vehicle 1, step by step."""
    steps = Steps(free_swarm)

    async def program(client):
        action, telemetry = client.action, client.telemetry
        altitude = (await first(telemetry.subscribe_home())).absolute_altitude_m
        latitude, longitude, _ = FRAME.geodetic(*TARGET[:2], 0.0)
        outputs = telemetry.subscribe_actuator_output_status()
        await steps("arm", action.arm(), first(outputs, lambda output: output.active))
        await steps("disarm", action.disarm(), client.disarmed())
        await steps("take off", client.take_off(2.0))
        await steps(
            "go to", action.goto_location(latitude, longitude, altitude + TARGET[2], 90.0),
            client.is_at(TARGET[0], TARGET[1], -TARGET[2]),
            first(telemetry.subscribe_attitude_euler(), lambda attitude: abs(attitude.yaw_deg - 90.0) < 3.0),
        )  # fmt: skip
        await steps(
            "slowly", action.goto_location(latitude, longitude + 5e-5, altitude + TARGET[2], 90.0),
            action.set_current_speed(0.8), client.is_at(TARGET[0], TARGET[1] + 2.5, -TARGET[2]),
        )  # fmt: skip
        await steps("hold", action.hold(), first(telemetry.subscribe_velocity_ned(), lambda v: abs(v.east_m_s) < 0.1))
        await steps(
            "orbit", action.do_orbit(2.0, 1.0, OrbitYawBehavior.HOLD_INITIAL_HEADING, latitude, longitude, math.nan),
            client.is_at(TARGET[0] - 2.0, TARGET[1], -TARGET[2], 0.4), action.hold(),
            first(telemetry.subscribe_velocity_ned(), lambda v: math.hypot(v.north_m_s, v.east_m_s) < 0.1),
        )  # fmt: skip
        await steps("land", client.land())
        await steps("again", client.take_off(2.0))
        await action.set_return_to_launch_altitude(3.0)
        await client.param.set_param_float("RTL_DESCEND_ALT", 3.0)
        await steps("return", action.return_to_launch(), client.disarmed())

    fly(free_swarm.sdk_port(1), program)
    return steps


def test_arming_and_disarming_do_so_and_no_more(flown):
    assert flown.armed("arm") == [True] and flown.armed("disarm") == [False]
    assert flown.track("arm").height.max() < 0.05


def test_takeoff_climbs_to_its_altitude_and_holds(flown):
    assert flown.track("take off").height[-1] == pytest.approx(2.0, abs=0.2)
    assert "AUTO.TAKEOFF" in flown.modes("take off") and "AUTO.TAKEOFF" not in flown.modes("go to")
    assert flown.track("go to").height.max() < TARGET[2] + 0.2


def test_goto_reaches_place_altitude_and_heading(flown):
    track = flown.track("go to")
    assert track.nearest(*TARGET) < 0.3
    assert track.yaw[-1] == pytest.approx(90.0, abs=5.0)


def test_speed_is_that_commanded(flown):
    speeds = np.linalg.norm(flown.track("slowly").velocity[:, :2], axis=1)
    assert 0.7 < speeds.max() < 1.1


def test_hold_stops_on_the_way(flown):
    track = flown.track("hold")
    assert track.velocity[0, 1] > 0.6 and abs(track.velocity[-1, 1]) < 0.4
    assert track.position[-1, 1] < TARGET[1] + 3.4  # the target of the command before was 3.77 m east


def test_orbit_flies_about_its_centre(flown):
    track = flown.track("orbit")
    away = np.linalg.norm(track.position[:, :2] - TARGET[:2], axis=1)
    beyond = np.arctan2(track.position[:, 1] - TARGET[1], track.position[:, 0] - TARGET[0])
    assert away[beyond > math.radians(110.0)] == pytest.approx(2.0, abs=0.5)
    assert "POSCTL.ORBIT" in flown.modes("orbit")


def test_land_comes_down_where_it_is(flown):
    track = flown.track("land")
    assert np.linalg.norm(track.position[-1, :2] - track.position[0, :2]) < 0.3
    assert track.height[-1] < 0.05 and track.thrust[-1] < 1e-6
    assert flown.modes("land") == ["AUTO.LAND", "AUTO.LOITER"]


def test_return_lands_at_home(flown):
    track = flown.track("return")
    assert np.linalg.norm(track.position[-1, :2] - flown.track("again").position[0, :2]) < 0.3
    assert track.height[-1] < 0.05 and track.thrust[-1] < 1e-6
    assert flown.modes("return")[0] == "AUTO.RTL"
