"""MAVSDK 4 flies a vehicle without a payload in OFFBOARD by each of its kinds of set-points."""

import numpy as np
import pytest
from client_swarm import FRAME
from mavsdk.plugins.offboard import (
    AccelerationNed,
    Attitude,
    AttitudeRate,
    OffboardError,
    OffboardResult,
    PositionGlobalYaw,
    PositionNedYaw,
    VelocityBodyYawspeed,
    VelocityNedYaw,
)
from mavsdk_client import Steps, first, fly, second

pytestmark = pytest.mark.slow

HOVER = 0.7 * 9.81 / 30.0  # thrust


@pytest.fixture(scope="module")
def flown(free_swarm):
    """One flight of vehicle 1 in OFFBOARD, step by step."""
    steps = Steps(free_swarm)

    async def program(client):
        offboard, telemetry, motion = (
            client.offboard,
            client.telemetry,
            client.telemetry.subscribe_position_velocity_ned,
        )

        async def level():
            await offboard.set_velocity_ned(VelocityNedYaw(0.0, 0.0, 0.0, 0.0))
            await first(motion(), lambda m: max(abs(m.velocity.north_m_s), abs(m.velocity.east_m_s)) < 0.15)

        with pytest.raises(OffboardError) as refused:
            await offboard.start()
        steps.results["without"] = refused.value.result
        await client.param.set_param_float("COM_OF_LOSS_T", 10.0)  # s: a busy machine may stop the program for a while
        await offboard.set_position_ned(PositionNedYaw(0.0, 0.0, -2.0, 0.0))
        await steps("position from the ground", offboard.start(), client.action.arm(), client.is_at(0.0, 0.0, -2.0))
        await steps(
            "position", offboard.set_position_ned(PositionNedYaw(2.0, -1.0, -3.0, 90.0)),
            client.is_at(2.0, -1.0, -3.0),
            first(telemetry.subscribe_attitude_euler(), lambda attitude: abs(attitude.yaw_deg - 90.0) < 3.0),
        )  # fmt: skip
        await steps(
            "velocity of the body", offboard.set_velocity_body(VelocityBodyYawspeed(1.0, 0.0, 0.0, 0.0)),
            first(motion(), lambda m: m.position.east_m > 0.5),
        )  # fmt: skip
        latitude, longitude, _ = FRAME.geodetic(1.0, -1.0, 0.0)
        place = PositionGlobalYaw(latitude, longitude, 2.0, 0.0, PositionGlobalYaw.AltitudeType.REL_HOME)
        await steps("global position", offboard.set_position_global(place), client.is_at(1.0, -1.0, -2.0))
        await steps(
            "velocity", offboard.set_velocity_ned(VelocityNedYaw(-0.8, 0.0, -0.4, 0.0)),
            first(motion(), lambda m: m.position.north_m < -0.8),
        )  # fmt: skip
        goal, still = PositionNedYaw(0.0, 0.0, -2.5, 0.0), VelocityNedYaw(0.0, 0.0, 0.0, 0.0)
        await steps(
            "position and velocity", offboard.set_position_velocity_ned(goal, still), client.is_at(0.0, 0.0, -2.5)
        )
        goal = PositionNedYaw(1.0, 0.0, -3.0, 0.0)
        await steps(
            "position, velocity and acceleration",
            offboard.set_position_velocity_acceleration_ned(goal, still, AccelerationNed(0.0, 0.0, 0.0)),
            client.is_at(1.0, 0.0, -3.0), level(),
        )  # fmt: skip
        await steps(
            "acceleration", offboard.set_acceleration_ned(AccelerationNed(0.0, 0.6, 0.0)),
            first(motion(), lambda m: m.velocity.east_m_s > 0.8),
        )  # fmt: skip
        await level()
        await steps(
            "attitude", offboard.set_attitude(Attitude(-8.0, 0.0, 20.0, HOVER)),
            first(telemetry.subscribe_attitude_euler(), lambda a: abs(a.roll_deg + 8.0) < 1.0),
            first(telemetry.subscribe_attitude_euler(), lambda a: abs(a.yaw_deg - 20.0) < 2.0),
        )  # fmt: skip
        await level()
        await steps(
            "rates", offboard.set_attitude_rate(AttitudeRate(0.0, 0.0, 60.0, HOVER)),
            first(telemetry.subscribe_attitude_euler(), lambda a: a.yaw_deg > 60.0),
        )  # fmt: skip
        await level()
        steps.results["active"] = await offboard.is_active()
        await steps("stop and land", offboard.stop(), second(telemetry.subscribe_attitude_euler()), client.land())

    fly(free_swarm.sdk_port(1), program)
    return steps


def test_offboard_is_not_started_without_a_set_point(flown):
    assert flown.results["without"] == OffboardResult.NO_SETPOINT_SET
    assert flown.modes("position from the ground") == ["OFFBOARD"]


@pytest.mark.parametrize(
    "step, place, yaw",
    [
        ("position from the ground", (0.0, 0.0, 2.0), 0.0),
        ("position", (2.0, -1.0, 3.0), 90.0),
        ("global position", (1.0, -1.0, 2.0), None),
        ("position and velocity", (0.0, 0.0, 2.5), 0.0),
        ("position, velocity and acceleration", (1.0, 0.0, 3.0), 0.0),
    ],
)
def test_position_is_reached(flown, step, place, yaw):
    track = flown.track(step)
    assert track.nearest(*place) < 0.3
    assert yaw is None or track.yaw[-1] == pytest.approx(yaw, abs=5.0)


@pytest.mark.parametrize(
    "step, velocity",
    [("velocity", (-0.8, 0.0, -0.4)), ("velocity of the body", (0.0, 1.0, 0.0))],  # its heading is east there
)
def test_velocity_is_flown(flown, step, velocity):
    assert flown.track(step).velocity[-10:].mean(axis=0) == pytest.approx(velocity, abs=0.25)


def test_acceleration_is_flown(flown):
    track = flown.track("acceleration")
    late = track.time > track.time[-1] - 0.6
    gained = np.polyfit(track.time[10:][late[10:]], track.velocity[late[10:], 1], 1)[0]
    assert gained == pytest.approx(0.6, abs=0.25)


def test_attitude_is_flown(flown):
    track = flown.track("attitude")
    assert track.roll.min() == pytest.approx(-8.0, abs=1.5)
    assert track.yaw[-1] == pytest.approx(20.0, abs=5.0)
    assert abs(track.pitch[-1]) < 3.0


def test_rates_are_flown(flown):
    track = flown.track("rates")
    late = track.time > track.time[-1] - 0.4
    assert np.polyfit(track.time[late], track.yaw[late], 1)[0] == pytest.approx(60.0, abs=10.0)


def test_stopping_it_holds(flown):
    assert flown.results["active"] is True
    assert flown.modes("stop and land") == ["AUTO.LOITER", "AUTO.LAND", "AUTO.LOITER"]
