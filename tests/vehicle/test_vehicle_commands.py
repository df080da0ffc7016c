"""Commands to a vehicle, and its answers."""

from __future__ import annotations

import math
from typing import Any

import pymavlink.dialects.v20.common as mavlink
import pytest
from vehicle_bench import (
    ACCEPTED,
    ARM,
    DENIED,
    DISARM,
    GROUND,
    OFFBOARD,
    PAYLOAD_UNIT,
    REJECTED,
    STRANGER,
    UNSUPPORTED,
    Bench,
    attitude_target,
    command,
)

from gcs.mavlink import px4


def test_vehicle_arms_and_enters_offboard_in_sequence(bench: Bench) -> None:
    [ack] = [m for m in bench.request(OFFBOARD) if m.get_type() == "COMMAND_ACK"]
    assert ack.result == REJECTED
    assert "no set-points" in bench.got("STATUSTEXT")[-1].text
    bench.streaming[GROUND, 255] = attitude_target(thrust=0.0)
    bench.run(0.2)
    assert bench.got("SYS_STATUS")[-1].onboard_control_sensors_health & mavlink.MAV_SYS_STATUS_PREARM_CHECK
    assert bench.result(OFFBOARD) == ACCEPTED
    bench.run(0.01)
    beat = bench.got("HEARTBEAT")[-1]  # sent at once, not with the next second
    assert beat.custom_mode == px4.MODE_OFFBOARD and not beat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    assert (beat.type, beat.autopilot) == (mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4)
    assert bench.result(ARM) == ACCEPTED
    bench.run(0.01)
    beat = bench.got("HEARTBEAT")[-1]
    assert beat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED and beat.system_status == mavlink.MAV_STATE_ACTIVE
    assert bench.result(DISARM) == ACCEPTED


def test_disarming_in_the_air_is_refused(flying: Bench) -> None:
    assert flying.result(DISARM) == DENIED
    assert flying.result(command(400, 0, px4.FORCE_ARM_DISARM)) == ACCEPTED


def test_setpoint_loss_is_reported(flying: Bench) -> None:
    flying.streaming.clear()
    flying.run(0.55)
    beat = flying.got("HEARTBEAT")[-1]
    assert beat.custom_mode == px4.MODE_HOLD and beat.system_status == mavlink.MAV_STATE_CRITICAL
    assert "Set-points lost" in flying.got("STATUSTEXT")[-1].text


@pytest.mark.parametrize(
    ("message", "result"),
    [
        (command(22, math.nan, 0, 0, math.nan, math.nan, math.nan, math.nan), DENIED),
        (command(20), DENIED),
        (command(21, math.nan, math.nan), REJECTED),  # not flying
        (command(176, 1, 4, 4), DENIED),
        (command(176, 1, 3), ACCEPTED),
        (command(176, 1, 4, 3), ACCEPTED),
        (command(176, 0, 6), DENIED),
        (command(176, math.nan, math.nan, math.nan), DENIED),
        (command(176, 1, 300), DENIED),
        (command(400, math.nan), DENIED),
        (command(400, 2), DENIED),
        (command(400, 0), ACCEPTED),
        (command(520, 1), ACCEPTED),
        (command(512, mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN), ACCEPTED),
        (command(512, 99999), UNSUPPORTED),
        (command(512, math.inf), UNSUPPORTED),
        (command(511, 30, math.nan), DENIED),
        (command(511, 30, 1), DENIED),
        (command(511, 31, -1), ACCEPTED),
        (command(300), DENIED),
        (command(420, 1), UNSUPPORTED),
        (command(34, 5, 1), DENIED),
        (command(187), UNSUPPORTED),
    ],
)
def test_commands_are_acknowledged(bench: Bench, message: Any, result: int) -> None:
    assert bench.result(message) == result


@pytest.mark.parametrize("mode", [256.0, 2.5, -1.0])
def test_mode_that_is_no_byte_is_denied_with_the_reason(bench: Bench, mode: float) -> None:
    assert bench.result(command(176, 1, mode)) == DENIED
    assert "parameters are not whole numbers" in bench.got("STATUSTEXT")[-1].text


def test_commands_as_command_int_and_mode_as_set_mode(bench: Bench) -> None:
    as_int = mavlink.MAVLink_command_int_message(1, 1, 0, 400, 0, 0, 1, 0, 0, 0, 0, 0, 0)
    assert bench.result(as_int) == ACCEPTED and bench.vehicle.autopilot.armed
    bench.send(DISARM)
    bench.send(mavlink.MAVLink_set_mode_message(1, 1, px4.MODE_POSCTL))
    assert bench.vehicle.autopilot.mode == px4.MODE_POSCTL


@pytest.mark.parametrize("target", [(2, 1), (7, 0), (0, 25)])
def test_commands_to_others_are_not_answered(bench: Bench, target: tuple[int, int]) -> None:
    assert bench.request(command(400, 1, system=target[0], component=target[1])) == []
    assert not bench.vehicle.autopilot.armed


@pytest.mark.parametrize("component", [25, 158, 191, 250])
def test_command_to_a_component_that_is_absent_is_refused_by_the_autopilot(bench: Bench, component: int) -> None:
    as_int = mavlink.MAVLink_command_int_message(1, component, 0, 400, 0, 0, 1, 0, 0, 0, 0, 0, 0)
    for message in (command(400, 1, component=component), command(512, 242, component=component), as_int):
        [ack] = bench.request(message)
        assert (ack.get_type(), ack.command, ack.result) == ("COMMAND_ACK", message.command, UNSUPPORTED)
        assert (ack.get_srcSystem(), ack.get_srcComponent()) == (1, 1)
        assert (ack.target_system, ack.target_component) == (255, 190)
    assert not bench.vehicle.autopilot.armed
    # An answer is none to an answer.
    assert bench.request(mavlink.MAVLink_command_ack_message(400, 0, 0, 0, 1, component)) == []


def test_payload_unit_sends_its_messages_on_request_and_refuses_all_else(bench: Bench) -> None:
    position = mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED
    for number, parameters, component, result in (
        (512, (position,), PAYLOAD_UNIT[1], ACCEPTED), (512, (mavlink.MAVLINK_MSG_ID_VFR_HUD,), 0, UNSUPPORTED),
        (400, (1,), PAYLOAD_UNIT[1], UNSUPPORTED), (512, (position,), 1, UNSUPPORTED),
        (511, (position, -1), 0, ACCEPTED),
    ):  # fmt: skip
        bench.run(0.02)
        answers = bench.request(command(number, *parameters, system=PAYLOAD_UNIT[0], component=component))
        [ack] = [m for m in answers if m.get_type() == "COMMAND_ACK"]
        assert (ack.command, ack.result, ack.target_system) == (number, result, 255)
        assert (ack.get_srcSystem(), ack.get_srcComponent()) == PAYLOAD_UNIT
        sent = [m for m in answers if m.get_type() == "LOCAL_POSITION_NED" and m.get_srcSystem() == PAYLOAD_UNIT[0]]
        assert len(sent) == (number == 512 and result == ACCEPTED)
    bench.inbox.clear()
    bench.run(0.5)
    assert bench.got("LOCAL_POSITION_NED") and not bench.got("LOCAL_POSITION_NED", source=PAYLOAD_UNIT)
    assert not bench.vehicle.autopilot.armed


def test_payload_units_streams_start_on_request_where_another_vehicle_sends_them() -> None:
    bench = Bench(clients={GROUND: False})
    bench.run(0.5)
    assert bench.got("ATTITUDE_QUATERNION") and not bench.got("ATTITUDE_QUATERNION", source=PAYLOAD_UNIT)
    bench.send(command(511, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, 0, system=PAYLOAD_UNIT[0], component=0))
    bench.inbox.clear()
    bench.run(1.0)
    assert len(bench.got("ATTITUDE_QUATERNION", source=PAYLOAD_UNIT)) == 50


@pytest.mark.parametrize("own", [(1, 1), PAYLOAD_UNIT])
def test_looped_back_own_messages_are_ignored(own: tuple[int, int]) -> None:
    bench = Bench()
    bench.send(ARM, GROUND, *own)
    bench.run(0.1)
    assert not bench.vehicle.autopilot.armed and bench.inbox == {}


@pytest.mark.parametrize("component", [190, 191, 240])
def test_companion_with_the_vehicles_id_is_heard_and_answered(bench: Bench, component: int) -> None:
    companion = ("127.0.0.1", 40191)
    [answer] = bench.request(mavlink.MAVLink_timesync_message(0, 5), companion, 1, component)[-1:]
    assert bench.got("ATTITUDE_QUATERNION", companion) and answer is not None
    [ack] = bench.request(ARM, companion, 1, component)
    assert (ack.result, ack.target_system, ack.target_component) == (ACCEPTED, 1, component)
    assert bench.vehicle.autopilot.armed
    parameters = bench.request(
        mavlink.MAVLink_param_request_read_message(1, 1, b"MAV_SYS_ID", -1), companion, 1, component
    )
    assert [m.param_id for m in parameters] == ["MAV_SYS_ID"]


def test_message_requests_and_intervals(bench: Bench) -> None:
    bench.send(command(512, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION))
    bench.send(command(512, mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN))
    bench.send(command(511, mavlink.MAVLINK_MSG_ID_ODOMETRY, 20000))
    bench.send(command(511, mavlink.MAVLINK_MSG_ID_ATTITUDE, -1))
    bench.run(0.1)
    assert bench.got("AUTOPILOT_VERSION")[0].uid == 1
    assert bench.got("GPS_GLOBAL_ORIGIN")[0].latitude == bench.got("HOME_POSITION")[0].latitude
    bench.inbox.clear()
    bench.run(1.0)
    assert len(bench.got("ODOMETRY")) == 50 and not bench.got("ATTITUDE")
    bench.send(command(511, mavlink.MAVLINK_MSG_ID_ATTITUDE, 0))
    bench.run(1.0)
    assert len(bench.got("ATTITUDE")) in (10, 11)


def test_timesync_and_ping_are_answered_to_the_sender(bench: Bench) -> None:
    [answer] = bench.request(mavlink.MAVLink_timesync_message(0, 123456789))
    assert answer.ts1 == 123456789 and answer.tc1 == round(bench.now * 1e9)
    assert bench.request(mavlink.MAVLink_timesync_message(5, 6)) == []
    [answer] = bench.request(mavlink.MAVLink_ping_message(77, 8, 0, 0))
    assert (answer.time_usec, answer.seq, answer.target_system, answer.target_component) == (77, 8, 255, 190)


STREAMED = mavlink.MAVLINK_MSG_ID_ATTITUDE


@pytest.mark.parametrize(
    ("microseconds", "result"),
    [(4000, ACCEPTED), (3999, DENIED), (2.0e9, ACCEPTED), (2.1e9, DENIED), (0, ACCEPTED), (-1, ACCEPTED), (-2, DENIED)],
)
def test_interval_of_a_message_is_from_that_of_the_onboard_loop_to_2000_s(
    bench: Bench, microseconds: float, result: int
) -> None:
    assert bench.result(command(511, STREAMED, microseconds)) == result


@pytest.mark.parametrize("number", [-1.0, 30.5, float(1 << 24), 99999.0, math.nan])
@pytest.mark.parametrize("what", [511, 512])
def test_message_that_there_is_not_is_unsupported(bench: Bench, what: int, number: float) -> None:
    assert bench.result(command(what, number, 20000)) == UNSUPPORTED


def test_message_without_data_is_refused_for_now_until_there_are_some() -> None:
    bench = Bench()
    wanted = command(512, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT)
    assert bench.result(wanted) == REJECTED
    bench.run(0.1)
    assert bench.result(wanted) == ACCEPTED and bench.got("GPS_RAW_INT")


def test_interval_is_that_of_the_link_that_asked_for_it_alone(bench: Bench) -> None:
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), STRANGER)
    assert bench.result(command(511, STREAMED, 10000)) == ACCEPTED
    bench.run(0.02)
    bench.inbox.clear()
    bench.run(0.5)
    assert (len(bench.got("ATTITUDE")), len(bench.got("ATTITUDE", STRANGER))) == (50, 5)


@pytest.mark.parametrize(
    ("number", "mode"), [(21, px4.MODE_LAND), (20, None), (22, None)], ids=["land", "return", "take off"]
)
def test_commands_of_manoeuvres_enter_the_mode_or_are_denied(flying: Bench, number: int, mode: int | None) -> None:
    before = flying.vehicle.autopilot.mode
    assert flying.result(command(number)) == (DENIED if mode is None else ACCEPTED)
    assert flying.vehicle.autopilot.mode == (before if mode is None else mode)


@pytest.mark.parametrize(("sub", "mode"), [(px4.AutoMode.LOITER, px4.MODE_HOLD), (px4.AutoMode.LAND, px4.MODE_LAND)])
def test_mode_of_automatic_flight_is_told_by_its_part(flying: Bench, sub: int, mode: int) -> None:
    assert flying.result(command(176, 1, px4.MainMode.AUTO, sub)) == ACCEPTED
    assert flying.vehicle.autopilot.mode == mode
    assert flying.result(command(176, 1, px4.MainMode.AUTO, 2.5)) == DENIED
    assert flying.vehicle.autopilot.mode == mode


@pytest.mark.parametrize("sub", [0, px4.AutoMode.LAND, math.nan])
def test_part_counts_in_automatic_flight_alone(bench: Bench, sub: float) -> None:
    assert bench.result(command(176, 1, px4.MainMode.POSCTL, sub)) == ACCEPTED
    assert bench.vehicle.autopilot.mode == px4.MODE_POSCTL


def test_mode_without_the_flag_of_custom_modes_is_denied_with_the_reason(bench: Bench) -> None:
    before = bench.vehicle.autopilot.mode
    bench.request(mavlink.MAVLink_set_mode_message(1, 0, px4.MODE_POSCTL))
    assert bench.vehicle.autopilot.mode == before
    assert "only custom modes are known" in bench.got("STATUSTEXT")[-1].text
    assert bench.result(command(176, 4, px4.MainMode.POSCTL)) == DENIED
    bench.request(mavlink.MAVLink_set_mode_message(1, 1 | 128, px4.MODE_POSCTL))
    assert bench.vehicle.autopilot.mode == px4.MODE_POSCTL


def test_answer_goes_to_the_system_and_component_that_asked(bench: Bench) -> None:
    [answer] = [m for m in bench.request(command(520), STRANGER, system=77) if m.get_type() == "COMMAND_ACK"]
    assert (answer.target_system, answer.target_component, answer.command) == (77, 190, 520)
    assert (answer.progress, answer.result_param2) == (0, 0)
