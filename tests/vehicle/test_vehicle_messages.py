"""Messages for SDKs and instruments: their fields, and that what is requested is sent."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from test_vehicle_status import SAMPLE, fields
from vehicle_bench import ACCEPTED, DENIED, GROUND, HOLD, REJECTED, STRANGER, Bench, command

from gcs.mavlink import newer_messages, px4
from gcs.mavlink.layout import LAYOUTS
from vehicle_sim.mavlink.telemetry import Telemetry
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import ReportedState

NO_POINTS = np.empty((0, 3))
OWN = px4.AUTOPILOT_COMPONENT
HAVE_DATA = sorted(
    {number for component, number in Bench().vehicle.telemetry.builders if component == OWN}
    - {
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT,
        mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS,
        mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D,
        mavlink.MAVLINK_MSG_ID_MISSION_ITEM_REACHED,
    }
)
"""Messages of which a vehicle on the ground that has just scanned has data."""


def name_of(number: int) -> str:
    return LAYOUTS[number].kind.msgname


@pytest.fixture
def moving() -> Bench:
    bench = Bench()
    bench.run(0.1)
    bench.vehicle.report(ReportedState(SAMPLE, SAMPLE))
    return bench


def nan_free(found: dict[str, object]) -> tuple[dict[str, object], set[str]]:
    """Fields that are numbers, and the names of those that are NaN."""
    unknown = {name for name, value in found.items() if isinstance(value, float) and math.isnan(value)}
    return {name: value for name, value in found.items() if name not in unknown}, unknown


def test_altitude_and_pressure_are_those_of_the_sample(moving: Bench) -> None:
    assert fields(moving, "ALTITUDE") == {
        "time_usec": 2500000, "altitude_monotonic": 495.0, "altitude_amsl": 495.0, "altitude_local": 7.0,
        "altitude_relative": 7.0, "altitude_terrain": 488.0, "bottom_clearance": 7.0,
    }  # fmt: skip
    pressure = fields(moving, "SCALED_PRESSURE")
    # The barometric formula in its exponential form, for the mean temperature of the layer.
    mean = 288.15 - 0.0065 * 495.0 / 2.0
    expected = 1013.25 * math.exp(-0.0289644 * 9.80665 * 495.0 / (8.31446 * mean))
    assert pressure.pop("press_abs") == pytest.approx(expected, abs=0.05)
    assert pressure == {"time_boot_ms": 2500, "temperature": round(100.0 * (15.0 - 0.0065 * 495.0))}
    imu, unknown = nan_free(fields(moving, "HIGHRES_IMU"))
    assert unknown == {"xacc", "yacc", "zacc", "xmag", "ymag", "zmag", "diff_pressure"}
    assert imu == pytest.approx({
        "time_usec": 2500000, "xgyro": 0.1, "ygyro": 0.2, "zgyro": 0.3, "abs_pressure": expected,
        "pressure_alt": 495.0, "temperature": 11.7825, "fields_updated": 0b1101000111000,
    }, abs=0.05)  # fmt: skip


def test_estimator_status_holds_while_samples_come(moving: Bench) -> None:
    status, unknown = nan_free(fields(moving, "ESTIMATOR_STATUS"))
    assert status == {"time_usec": 100000, "flags": 0b1100111111} and len(unknown) == 8
    moving.body.tick += 500 * 10
    status, _ = nan_free(fields(moving, "ESTIMATOR_STATUS"))
    assert "flags" not in status


def test_outputs_are_the_commanded_rotor_speeds(bench: Bench) -> None:
    servos = fields(bench, "SERVO_OUTPUT_RAW")
    assert [servos[f"servo{k}_raw"] for k in range(1, 5)] == [1000] * 4 and "servo5_raw" not in servos
    assert set(fields(bench, "ACTUATOR_OUTPUT_STATUS")) == {"time_usec"}
    bench.fly()
    shares = bench.vehicle.autopilot.arrays.speeds[0] / bench.vehicle.autopilot.state.airframe.rotors.rotor_speed_max
    assert min(shares) > 0.2
    servos, status = fields(bench, "SERVO_OUTPUT_RAW"), fields(bench, "ACTUATOR_OUTPUT_STATUS")
    assert [servos[f"servo{k}_raw"] for k in range(1, 5)] == pytest.approx(1000.0 * (1.0 + shares), abs=0.5)
    assert status["active"] == 0b1111
    assert status["actuator"] == pytest.approx([*shares, *[0.0] * 28])


def test_no_remote_control_is_told_as_such(bench: Bench) -> None:
    found = fields(bench, "RC_CHANNELS")
    assert {found.pop(f"chan{k}_raw") for k in range(1, 19)} == {65535}
    assert found == {"time_boot_ms": 200, "rssi": 255}


def test_time_since_boot_is_told_without_a_time_of_day(bench: Bench) -> None:
    assert fields(bench, "SYSTEM_TIME") == {"time_boot_ms": 200}


def test_position_target_is_the_plan_of_a_stop_and_absent_otherwise(flying: Bench) -> None:
    number = mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED
    assert flying.result(command(512, number)) == REJECTED
    assert "no data" in flying.got("STATUSTEXT")[-1].text
    assert flying.result(HOLD) == ACCEPTED
    flying.run(0.1)
    assert flying.result(command(512, number)) == ACCEPTED
    target = flying.got("POSITION_TARGET_LOCAL_NED")[-1]
    hold = flying.vehicle.autopilot.state.hold
    assert hold is not None
    position, velocity, _ = hold.plan.at(flying.now)
    assert (target.x, target.y, target.z) == pytest.approx(position, abs=1e-5)
    assert (target.vx, target.vy, target.vz) == pytest.approx(velocity, abs=1e-5)
    assert (target.coordinate_frame, target.type_mask) == (mavlink.MAV_FRAME_LOCAL_NED, 0b100000000000)
    assert target.yaw == pytest.approx(hold.plan.yaw, abs=1e-5)
    flying.result(command(512, mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT))
    output = flying.got("NAV_CONTROLLER_OUTPUT")[-1]
    x, y, _ = hold.plan.control_points[-1]
    measured = flying.vehicle.telemetry.own_state
    assert measured is not None
    assert output.wp_dist == int(math.hypot(x - measured.position[0], y - measured.position[1]))


def test_current_mode_is_sent_at_once_with_the_mode_that_was_commanded(flying: Bench) -> None:
    flying.run(0.5)
    last = flying.got("CURRENT_MODE")[-1]
    assert (last.custom_mode, last.intended_custom_mode, last.standard_mode) == (
        px4.MODE_OFFBOARD, px4.MODE_OFFBOARD, mavlink.MAV_STANDARD_MODE_NON_STANDARD,
    )  # fmt: skip
    flying.streaming.clear()
    flying.inbox.clear()
    flying.run(0.6)  # set-points are lost: it holds
    last = flying.got("CURRENT_MODE")[-1]
    assert (last.custom_mode, last.intended_custom_mode) == (px4.MODE_HOLD, px4.MODE_OFFBOARD)


def test_every_mode_that_is_offered_can_be_entered_by_its_number() -> None:
    for number, mode in enumerate(Bench().vehicle.aircraft.modes, start=1):
        bench = Bench()
        bench.run(0.1)
        bench.fly() if mode in (px4.MODE_LAND, px4.MODE_OFFBOARD, px4.MODE_HOLD) else bench.run(0.1)
        answers = bench.request(command(512, newer_messages.AVAILABLE_MODES, number))
        [offered] = [m for m in answers if m.get_type() == "AVAILABLE_MODES"]
        assert offered.custom_mode == mode
        main, sub = px4.decode_custom_mode(mode)
        assert bench.result(command(176, 1, main, sub)) == ACCEPTED
        bench.run(0.02)
        assert bench.vehicle.autopilot.state.mode == mode


@pytest.mark.parametrize("number", HAVE_DATA, ids=name_of)
def test_accepted_message_is_sent_once_or_with_its_interval(bench: Bench, number: int) -> None:
    bench.vehicle.take_scan(RangeSample(bench.now, 10.0, NO_POINTS))
    kind = name_of(number)
    bench.inbox.clear()
    assert bench.result(command(512, number)) == ACCEPTED
    assert bench.got(kind)
    bench.inbox.clear()
    assert bench.result(command(511, number, 20_000)) == ACCEPTED
    for _ in range(10):
        bench.vehicle.take_scan(RangeSample(bench.now, 10.0, NO_POINTS))
        bench.run(0.02)
    assert len(bench.got(kind)) in (10, 11)


def test_scans_are_refused_in_a_world_without_anything_to_range(bench: Bench) -> None:
    for number in (mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D):
        assert bench.result(command(511, number, 100_000)) == DENIED
        assert "nothing to range" in "".join(m.text for m in bench.got("STATUSTEXT")[-2:])
        assert bench.result(command(512, number)) == REJECTED


def test_stamps_never_go_back() -> None:
    bench = Bench(clients={GROUND: True})
    bench.run(0.1)
    bench.fly()
    bench.result(HOLD)
    bench.run(1.0)
    bench.streaming.clear()
    bench.run(2.0)
    stamped: dict[str, list[int]] = {}
    for message in bench.inbox[GROUND]:
        stamp = getattr(message, "time_boot_ms", None) or getattr(message, "time_usec", None)
        if stamp is not None and message.get_srcSystem() == 1:
            stamped.setdefault(message.get_type(), []).append(stamp)
    assert len(stamped) > 15
    assert not [kind for kind, stamps in stamped.items() if np.any(np.diff(stamps) < 0)]


def test_vehicle_on_a_payload_does_not_obey_a_command_to_all_systems(bench: Bench) -> None:
    for message in (command(400, 1, system=0, component=0), command(176, 1, 3, system=0)):
        assert bench.result(message) == DENIED
        assert "each vehicle" in "".join(m.text for m in bench.got("STATUSTEXT")[-3:])
    assert not bench.vehicle.autopilot.armed
    assert bench.result(command(410, system=0)) == ACCEPTED


@pytest.mark.parametrize(
    "message", [command(22), command(192, -1, 1), command(178, 1, 3.0), command(300), command(193, 0), command(193, 1)]
)
def test_what_would_tip_the_payload_is_denied_with_one_text(flying: Bench, message: Any) -> None:
    before = flying.vehicle.autopilot.mode
    answers = flying.request(message)
    assert [m.result for m in answers if m.get_type() == "COMMAND_ACK"] == [DENIED]
    chunks = [m for m in answers if m.get_type() == "STATUSTEXT"]
    assert len({m.id for m in chunks}) == 1 and chunks[0].id > 0
    assert "".join(m.text for m in chunks).endswith("would tip the payload; fly together in OFFBOARD")
    assert flying.vehicle.autopilot.mode == before


def test_termination_stops_the_rotors_in_the_air(flying: Bench) -> None:
    assert flying.result(command(185, 1), STRANGER) == DENIED
    assert flying.result(command(185, 1)) == ACCEPTED and not flying.vehicle.autopilot.armed


@pytest.mark.parametrize(("action", "descends"), [(0, False), (3, True)])
def test_action_of_a_lost_ground_is_the_one_that_was_set(flying: Bench, action: int, descends: bool) -> None:
    wire = px4.parameter_to_wire(action, mavlink.MAV_PARAM_TYPE_INT32)
    flying.send(mavlink.MAVLink_param_set_message(1, 1, b"NAV_DLL_ACT", wire, mavlink.MAV_PARAM_TYPE_INT32))
    wire = px4.parameter_to_wire(5, mavlink.MAV_PARAM_TYPE_INT32)
    flying.send(mavlink.MAVLink_param_set_message(1, 1, b"COM_DL_LOSS_T", wire, mavlink.MAV_PARAM_TYPE_INT32))
    assert flying.result(HOLD) == ACCEPTED
    flying.streaming.clear()
    flying.run(5.5)
    assert (flying.vehicle.autopilot.mode == px4.MODE_LAND) is descends


@pytest.mark.parametrize(
    ("message", "kind"),
    [
        (mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, [0, 0, 0, 4, *[0] * 247]), "FILE_TRANSFER_PROTOCOL"),
        (mavlink.MAVLink_log_request_list_message(1, 1, 0, 0xFFFF), "LOG_ENTRY"),
        (mavlink.MAVLink_param_request_read_message(1, 1, b"NO_SUCH", -1), "PARAM_ERROR"),
        (mavlink.MAVLink_timesync_message(0, 5), "TIMESYNC"),
        (mavlink.MAVLink_ping_message(1, 2, 0, 0), "PING"),
        (mavlink.MAVLink_set_mode_message(1, 0, 4), "STATUSTEXT"),
        (command(510, mavlink.MAVLINK_MSG_ID_ATTITUDE), "MESSAGE_INTERVAL"),
        (command(519, 1), "PROTOCOL_VERSION"),
        (command(410), "HOME_POSITION"),
        (command(401), "STATUSTEXT"),
    ],
)
def test_request_is_answered_at_once(bench: Bench, message: Any, kind: str) -> None:
    assert kind in [m.get_type() for m in bench.request(message)]


def test_inputs_that_are_not_flown_are_answered_with_the_reason(bench: Bench) -> None:
    position = mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, 0xFF8, 1, 2, -3, *[0] * 8)
    place = mavlink.MAVLink_set_position_target_global_int_message(0, 1, 1, 6, 0xFF8, 1, 2, -3, *[0] * 8)
    for message, words in (
        (position, "SET_ATTITUDE_TARGET"),
        (mavlink.MAVLink_manual_control_message(1, 0, 0, 0, 0, 0), "sticks"),
    ):
        assert words in "".join(m.text for m in bench.request(message))
        assert bench.request(message) == []
    assert "on a payload" in "".join(m.text for m in bench.request(place))


def test_offboard_by_position_is_refused_on_a_payload_with_the_reason(bench: Bench) -> None:
    position = mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, 0xFF8, 1, 2, -3, *[0] * 8)
    for _ in range(3):
        bench.send(position)
        bench.run(0.04)
    bench.run(0.1)
    bench.inbox.clear()
    assert bench.result(command(176, 1, px4.MainMode.OFFBOARD)) == REJECTED
    text = "".join(m.text for m in bench.got("STATUSTEXT"))
    assert text.startswith("OFFBOARD denied: SET_POSITION_TARGET_LOCAL_NED refused: ")
    assert "only SET_ATTITUDE_TARGET" in text


def test_old_protocols_of_fence_and_rally_points_are_ignored(bench: Bench) -> None:
    for message in (
        mavlink.MAVLink_fence_fetch_point_message(1, 1, 0),
        mavlink.MAVLink_rally_fetch_point_message(1, 1, 0),
    ):
        assert bench.request(message) == []


def test_request_to_an_absent_component_is_answered(bench: Bench) -> None:
    for component in (100, 154, 25):
        assert bench.result(command(512, 259, component=component)) == mavlink.MAV_RESULT_UNSUPPORTED


def test_streams_that_may_be_absent_are_named(bench: Bench) -> None:
    telemetry: Telemetry = bench.vehicle.telemetry
    assert [key for key in telemetry.builders if telemetry.absence(key)] == [
        (OWN, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D), (OWN, mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE),
    ]  # fmt: skip
