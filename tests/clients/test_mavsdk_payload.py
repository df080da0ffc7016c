"""MAVSDK 4 and a vehicle that carries a payload with others: what is flown, and what is refused with the reason."""

import asyncio
import contextlib

import pytest
from mavsdk.plugins.action import ActionError, ActionResult
from mavsdk.plugins.mission_raw import MissionItem, MissionRawError, MissionRawResult
from mavsdk.plugins.offboard import Attitude, OffboardError, OffboardResult, PositionNedYaw
from mavsdk.plugins.param import ParamError, ParamResult
from mavsdk_client import Steps, first, fly, second

pytestmark = pytest.mark.slow

TIPS = "one vehicle alone would tip the payload"


@contextlib.asynccontextmanager
async def text_with(client, words):
    """Within, something makes the vehicle send a text with these words."""
    listening = asyncio.create_task(first(client.telemetry.subscribe_status_text(), lambda found: words in found.text))
    await asyncio.sleep(0)  # the task subscribes
    yield
    await listening


@pytest.mark.parametrize(
    "action, arguments",
    [
        ("takeoff", ()),
        ("return_to_launch", ()),
        ("goto_location", (47.3977, 8.5456, 495.0, 0.0)),
        ("set_current_speed", (2.0,)),
    ],
)
def test_flight_of_one_vehicle_is_refused_with_the_reason(team, action, arguments):
    async def program(client):
        async with text_with(client, TIPS):
            with pytest.raises(ActionError) as refused:
                await getattr(client.action, action)(*arguments)
        return refused.value.result

    assert fly(team.sdk_port(2), program) == ActionResult.COMMAND_DENIED
    assert team.payload_moved() < 0.01


def test_mission_is_refused_at_once_with_the_reason(team):
    item = MissionItem(0, 6, 16, 1, 1, 0.0, 0.0, 0.0, float("nan"), 473977000, 85456000, 5.0, 0)

    async def program(client):
        async with text_with(client, TIPS):
            with pytest.raises(MissionRawError) as refused:
                await client.mission_raw.upload_mission([item])
        return refused.value.result, await client.mission_raw.download_mission()

    assert fly(team.sdk_port(2), program) == (MissionRawResult.DENIED, [])


def test_position_set_points_are_not_flown_which_a_text_says(team):
    async def program(client):
        await client.offboard.set_position_ned(PositionNedYaw(0.0, 0.0, -5.0, 0.0))
        async with text_with(client, "position set-points are not flown on a payload"):
            with pytest.raises(OffboardError) as refused:
                await client.offboard.start()
        return refused.value.result

    assert fly(team.sdk_port(3), program) == OffboardResult.COMMAND_DENIED
    assert team.payload_moved() < 0.01 and team.track(3).thrust.max() == 0.0


def test_attitude_set_points_are_flown_in_offboard(team):
    steps = Steps(team)

    async def program(client):
        await client.param.set_param_float("COM_OF_LOSS_T", 10.0)  # s: a busy machine may stop the program for a while
        await client.offboard.set_attitude(Attitude(0.0, 0.0, 0.0, 0.1))  # 3 N, less than half of its weight
        await client.offboard.start()
        outputs = client.telemetry.subscribe_actuator_output_status()
        await steps("fly", client.action.arm(), second(outputs))
        await steps("disarm", client.action.disarm(), client.disarmed())

    fly(team.sdk_port(1), program)
    assert steps.track("fly").thrust[0] == 0.0
    assert steps.track("fly").thrust[-1] == pytest.approx(3.0, abs=0.1)
    assert steps.track("disarm").thrust[-1] < 1e-6
    assert steps.modes("fly") == ["OFFBOARD"] and steps.armed("fly")[-1]
    assert team.payload_moved() < 0.01


def test_vehicle_is_read_and_its_parameters_set(team):
    async def program(client):
        await client.param.set_param_float("MPC_LAND_SPEED", 0.4)
        with pytest.raises(ParamError) as refused:
            await client.param.set_param_float("CLFT_MASS", 1.0)
        motion = await first(client.telemetry.subscribe_position_velocity_ned())
        return await client.param.get_param_float("MPC_LAND_SPEED"), refused.value.result, motion.position

    speed, result, position = fly(team.sdk_port(3), program)
    assert speed == pytest.approx(0.4) and result == ParamResult.READ_ONLY
    assert (position.north_m, position.east_m, position.down_m) == pytest.approx(team.track(3).position[-1], abs=0.2)


def test_payload_unit_is_another_system_without_an_autopilot(team):
    async def program(client):
        news = client.mavsdk.on_new_system()
        while len(systems := await client.mavsdk.get_systems()) < 2:
            await anext(news)
        return sorted([(await system.get_system_id(), await system.has_autopilot()) for system in systems])

    assert fly(team.sdk_port(1), program) == [(1, True), (100, False)]
