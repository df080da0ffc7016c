"""What MAVSDK 4 reads of a vehicle and sets on it, on the ground."""

import asyncio
import contextlib
import json

import pytest
from mavsdk.asyncio.plugins.info import InfoAsync
from mavsdk.asyncio.plugins.mavlink_direct import MavlinkDirectAsync
from mavsdk.plugins.action import ActionError, ActionResult
from mavsdk.plugins.param import ParamError, ParamResult
from mavsdk.plugins.telemetry import FixType, LandedState
from mavsdk_client import first, fly

from gcs.mission.model import DEFAULT_HOME

pytestmark = pytest.mark.slow

STREAMS = [
    "position", "home", "in_air", "landed_state", "armed", "attitude_quaternion", "attitude_euler",
    "attitude_angular_velocity_body", "velocity_ned", "gps_info", "raw_gps", "battery", "flight_mode", "health",
    "rc_status", "actuator_output_status", "odometry", "position_velocity_ned", "fixedwing_metrics", "imu",
    "health_all_ok", "unix_epoch_time", "scaled_pressure", "heading", "altitude",
]  # fmt: skip
RATES = [
    "position", "home", "in_air", "gps_info", "battery", "rc_status", "actuator_output_status", "odometry",
    "imu", "altitude",
]  # fmt: skip
"""Streams that come five times a second at most when none is asked for."""


@pytest.fixture(scope="module")
def heard(free_swarm):
    """The first message of each stream of telemetry."""

    async def program(client):
        found = [first(getattr(client.telemetry, f"subscribe_{stream}")()) for stream in STREAMS]
        heard = dict(zip(STREAMS, await asyncio.gather(*found), strict=True))
        heard["health"] = await first(client.telemetry.subscribe_health(), lambda health: health.is_armable)
        heard["health_all_ok"] = await first(client.telemetry.subscribe_health_all_ok(), lambda ok: ok)
        return heard

    return fly(free_swarm.sdk_port(1), program)


def test_every_stream_comes_unasked(heard):
    assert heard.keys() == {*STREAMS} and None not in heard.values()


def test_streams_say_where_the_vehicle_truly_is(heard, free_swarm):
    north, east, down = free_swarm.track(1).position[0]
    place, local = heard["position"], heard["position_velocity_ned"].position
    assert (local.north_m, local.east_m, local.down_m) == pytest.approx((north, east, down), abs=0.2)
    assert (place.latitude_deg, place.longitude_deg) == pytest.approx(
        (DEFAULT_HOME.latitude, DEFAULT_HOME.longitude), abs=2e-6
    )
    assert place.absolute_altitude_m == pytest.approx(DEFAULT_HOME.altitude, abs=0.3)
    assert heard["heading"].heading_deg % 360.0 == pytest.approx(0.0, abs=1.0) or heard["heading"].heading_deg > 359.0
    assert heard["landed_state"] == LandedState.ON_GROUND and not heard["in_air"] and not heard["armed"]


def test_streams_say_that_the_vehicle_is_ready(heard):
    assert heard["health_all_ok"] and heard["health"].is_global_position_ok
    assert heard["battery"].remaining_percent == pytest.approx(100.0)
    assert heard["gps_info"].fix_type >= FixType.FIX_3D
    assert not heard["rc_status"].is_available  # there are no sticks


@pytest.fixture(scope="module")
def durations(free_swarm):
    """In which time (s) a hundred messages of each stream come, of which 50 a second are asked for."""

    async def program(client):
        async def lasting(stream):
            await getattr(client.telemetry, f"set_rate_{stream}")(50.0)
            messages = getattr(client.telemetry, f"subscribe_{stream}")()
            began = free_swarm.now()
            async with contextlib.aclosing(messages):
                for _ in range(100):
                    await anext(messages)
            return free_swarm.now() - began

        return dict(zip(RATES, await asyncio.gather(*map(lasting, RATES)), strict=True))

    return fly(free_swarm.sdk_port(2), program)


@pytest.mark.parametrize("stream", RATES)
def test_stream_comes_faster_when_asked_to(durations, stream):
    assert durations[stream] < 10.0  # else at least 20 s


def test_parameters_are_read_set_and_kept(free_swarm):
    async def program(client):
        param = client.param
        await param.set_param_float("MPC_XY_CRUISE", 3.5)
        await param.set_param_int("NAV_DLL_ACT", 3)
        every = await param.get_all_params()
        assert await param.get_param_float("MPC_XY_CRUISE") == 3.5 and await param.get_param_int("NAV_DLL_ACT") == 3
        return {parameter.name: parameter.value for parameter in [*every.float_params, *every.int_params]}

    parameters = fly(free_swarm.sdk_port(2), program)
    assert parameters["MPC_XY_CRUISE"] == 3.5 and parameters["NAV_DLL_ACT"] == 3
    assert parameters["MAV_SYS_ID"] == 2
    assert len(parameters) > 30


@pytest.mark.parametrize(
    "name, value, result, text",
    [
        ("NO_SUCH", 1.0, ParamResult.DOES_NOT_EXIST, "NO_SUCH: no such parameter"),
        ("CLFT_MASS", 1.0, ParamResult.READ_ONLY, "CLFT_MASS: read-only"),
        ("MPC_XY_CRUISE", 300.0, ParamResult.VALUE_OUT_OF_RANGE, "MPC_XY_CRUISE: 300 is outside 0.1 .. 20"),
    ],
)
def test_parameter_that_cannot_be_set_is_refused_with_the_reason(free_swarm, name, value, result, text):
    async def program(client):
        texts = first(client.telemetry.subscribe_status_text(), lambda found: found.text == text)
        listening = asyncio.create_task(texts)
        while True:  # until the subscription has begun, which nothing tells
            with pytest.raises(ParamError) as refused:
                await client.param.set_param_float(name, value)
            if listening.done():
                return refused.value.result

    assert fly(free_swarm.sdk_port(2), program) == result


@pytest.mark.parametrize(
    "action, arguments, result",
    [
        ("reboot", (), ActionResult.COMMAND_DENIED),
        ("land", (), ActionResult.COMMAND_DENIED),  # on the ground
        ("return_to_launch", (), ActionResult.COMMAND_DENIED),
        ("set_actuator", (1, 0.5), ActionResult.UNSUPPORTED),
    ],
)
def test_action_that_it_cannot_do_is_refused_at_once(free_swarm, action, arguments, result):
    async def program(client):
        with pytest.raises(ActionError) as refused:
            await getattr(client.action, action)(*arguments)
        return refused.value.result

    assert fly(free_swarm.sdk_port(2), program) == result


def test_vehicle_says_what_it_is(free_swarm):
    async def program(client):
        info = InfoAsync(client.system)
        return await info.get_identification(), await info.get_version(), await client.telemetry.get_gps_global_origin()

    identification, version, origin = fly(free_swarm.sdk_port(2), program)
    assert int(identification.hardware_uid[-2:], 16) == 2 == identification.legacy_uid
    assert (version.flight_sw_major, version.flight_sw_minor) == (0, 2)
    assert (origin.latitude_deg, origin.longitude_deg) == pytest.approx(
        (DEFAULT_HOME.latitude, DEFAULT_HOME.longitude), abs=1e-7
    )


def test_message_is_read_by_its_name(free_swarm):
    async def program(client):
        return await first(MavlinkDirectAsync(client.system).subscribe_message("LOCAL_POSITION_NED"))

    message = fly(free_swarm.sdk_port(2), program)
    assert (message.system_id, message.component_id) == (2, 1)
    assert json.loads(message.fields_json)["z"] == pytest.approx(free_swarm.track(2).position[-1, 2], abs=0.2)
