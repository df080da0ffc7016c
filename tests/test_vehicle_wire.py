"""A vehicle by its bytes: sans-I/O, so addresses are just names here."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from flying import AIRFRAME, Body
from hostile_traffic import with_random_contents

from gcs.setpoints import stop_plan_message
from gcs.wire import px4
from gcs.wire.codec import DATAGRAM_LIMIT, Codec
from vehicle_sim.peers import REPLIES_MAX
from vehicle_sim.sensors import Measurement
from vehicle_sim.vehicle import Vehicle

GROUND, STRANGER = ("127.0.0.1", 40001), ("10.0.0.66", 40002)
ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
REJECTED, UNSUPPORTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED, mavlink.MAV_RESULT_UNSUPPORTED
HOVER = 0.7 * 9.81 / 30.0


def attitude_target(
    q: Any = (1, 0, 0, 0), thrust: float = HOVER, mask: int = 7, stamp: int = 0, rates: Any = (0, 0, 0), system: int = 1
) -> Any:
    return mavlink.MAVLink_set_attitude_target_message(stamp, system, 1, mask, list(q), *rates, thrust)


def command(number: int, *parameters: float, system: int = 1, component: int = 1) -> Any:
    values = [*parameters, *([0.0] * (7 - len(parameters)))]
    return mavlink.MAVLink_command_long_message(system, component, number, 0, *values)


OFFBOARD = command(176, 1, px4.MainMode.OFFBOARD)
HOLD = command(176, 1, px4.MainMode.AUTO, px4.AutoMode.LOITER)
ARM, DISARM = command(400, 1), command(400, 0)


class Bench:
    """A vehicle, a body that stands or flies, and grounds that keep what they were sent."""

    def __init__(self, **options: Any) -> None:
        self.vehicle = Vehicle(1, AIRFRAME, **options)
        self.body = Body()
        self.tick = 0
        self.codecs: dict[Any, Codec] = {}
        self.inbox: dict[Any, list[Any]] = {}
        self.datagrams: list[tuple[float, bytes, Any]] = []
        self.streaming: dict[Any, Any] = {}
        self.reader = Codec(254, 1)

    @property
    def now(self) -> float:
        return self.body.now

    def send(self, message: Any, sender: Any = GROUND, system: int = 255) -> None:
        codec = self.codecs.setdefault((sender, system), Codec(system, 190))
        self.vehicle.receive(codec.encode(message), sender, self.now)

    def ask(self, message: Any, sender: Any = GROUND, system: int = 255) -> list[Any]:
        """Send, and return what came back to that address at once, apart from what streams anyway."""
        self.collect()
        before = len(self.inbox.setdefault(sender, []))
        self.send(message, sender, system)
        self.collect()
        streamed = ("HEARTBEAT", "EXTENDED_SYS_STATE")
        new = self.inbox[sender][before:]
        return [m for m in new if m.get_type() not in streamed] if len(new) < 30 else new[-1:]

    def result(self, message: Any, sender: Any = GROUND, system: int = 255) -> int:
        [ack] = [m for m in self.ask(message, sender, system) if m.get_type() == "COMMAND_ACK"]
        assert ack.command == message.command and ack.target_system == system
        return ack.result

    def collect(self) -> None:
        for datagram, address in self.vehicle.datagrams_to_send(self.now):
            self.datagrams.append((self.now, datagram, address))
            self.inbox.setdefault(address, []).extend(self.reader.decode(datagram))

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.002)):
            if self.body.tick % 25 == 0:
                for (sender, system), message in self.streaming.items():
                    self.send(message, sender, system)
            if self.body.tick % 2 == 0:
                measured = self.body.measure()
                self.body.command = self.vehicle.step(measured, self.now)
                self.vehicle.relay(Measurement(self.now, (1, 0, 0, 0), (0, 0, 0), (1, 2, -3), (4, 5, 6)))
            self.collect()
            self.body.advance()

    def got(self, kind: str, address: Any = GROUND, component: int = 1) -> list[Any]:
        found = self.inbox.get(address, [])
        return [m for m in found if m.get_type() == kind and m.get_srcComponent() == component]

    def fly(self) -> None:
        self.streaming[GROUND, 255] = attitude_target(thrust=HOVER * 1.2)
        self.run(0.2)
        assert self.result(OFFBOARD) == ACCEPTED
        assert self.result(ARM) == ACCEPTED
        self.run(1.0)
        self.streaming[GROUND, 255] = attitude_target(thrust=HOVER)
        self.run(0.2)
        assert self.vehicle.autopilot.in_air


@pytest.fixture
def bench() -> Bench:
    bench = Bench()
    bench.run(0.1)
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    bench.run(0.1)
    return bench


@pytest.fixture
def flying(bench: Bench) -> Bench:
    bench.fly()
    return bench


# Telemetry


def test_it_says_nothing_to_nobody_and_offers_itself_to_the_ground_address_with_heartbeats() -> None:
    assert Bench().vehicle.next_timer() is None
    bench = Bench(ground_address=GROUND)
    assert bench.vehicle.next_timer() is not None
    bench.run(3.01)
    assert {m.get_type() for m in bench.inbox[GROUND]} == {"HEARTBEAT"}
    assert 4 <= len(bench.inbox[GROUND]) <= 6
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
    bench.run(0.5)
    assert bench.got("ATTITUDE_QUATERNION")


def test_streams_come_at_their_rates_with_the_stamp_of_the_sample(bench: Bench) -> None:
    bench.run(0.01)
    bench.inbox.clear()
    bench.datagrams.clear()
    bench.run(4.0)
    counts = {kind: len(bench.got(kind)) for kind in {m.get_type() for m in bench.inbox[GROUND]}}
    expected = {
        "ATTITUDE_QUATERNION": 200, "LOCAL_POSITION_NED": 200, "ATTITUDE": 40, "ATTITUDE_TARGET": 200,
        "GLOBAL_POSITION_INT": 20, "EXTENDED_SYS_STATE": 20, "VFR_HUD": 8, "HEARTBEAT": 4, "SYS_STATUS": 4,
        "GPS_RAW_INT": 4, "HOME_POSITION": 2, "BATTERY_STATUS": 2,
    }  # fmt: skip
    assert counts == expected
    stamps = [m.time_boot_ms for m in bench.got("ATTITUDE_QUATERNION")]
    assert stamps == [m.time_boot_ms for m in bench.got("LOCAL_POSITION_NED")]
    assert np.all(np.diff(stamps) == 20) and stamps[0] % 20 == 0
    assert len(bench.got("ATTITUDE_QUATERNION", component=25)) == 200
    # Everything due at one instant shares a datagram.
    assert len(bench.datagrams) == 200
    assert max(len(datagram) for _, datagram, _ in bench.datagrams) <= DATAGRAM_LIMIT


def test_the_payload_unit_is_relayed_as_a_component_with_its_own_stamp(bench: Bench) -> None:
    sample = Measurement(123.456, (0.5, 0.5, -0.5, 0.5), (1, 2, 3), (4, 5, -6), (7, 8, 9))
    bench.vehicle.relay(sample)
    bench.body.tick += 10
    bench.collect()
    attitude = bench.got("ATTITUDE_QUATERNION", component=25)[-1]
    position = bench.got("LOCAL_POSITION_NED", component=25)[-1]
    assert attitude.time_boot_ms == position.time_boot_ms == 123456
    assert (attitude.q1, attitude.q3, attitude.yawspeed) == (0.5, -0.5, 3.0)
    assert (position.x, position.z, position.vy) == (4.0, -6.0, 8.0)
    before = len(bench.got("ATTITUDE_QUATERNION", component=25))
    bench.body.tick += 10
    bench.collect()
    assert len(bench.got("ATTITUDE_QUATERNION", component=25)) == before  # the same sample is told once


def test_sequence_numbers_have_no_gaps_on_any_link(bench: Bench) -> None:
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), STRANGER)
    bench.ask(mavlink.MAVLink_param_request_list_message(1, 1), STRANGER)
    bench.run(1.0)
    for address in (GROUND, STRANGER):
        for component in (1, 25):
            numbers = [m.get_seq() for m in bench.inbox[address] if m.get_srcComponent() == component]
            assert len(numbers) > 50 and np.all(np.diff(numbers) % 256 == 1)


def test_positions_on_the_globe_are_those_of_the_local_frame(bench: Bench) -> None:
    bench.body.position = np.array([100.0, 0.0, -10.0])
    bench.run(0.3)
    message = bench.got("GLOBAL_POSITION_INT")[-1]
    home = bench.got("HOME_POSITION")[0]
    assert (message.lat - home.latitude) * 1e-7 * 111_200 == pytest.approx(100.0, abs=0.3)
    assert message.lon == home.longitude
    assert message.alt - home.altitude == pytest.approx(message.relative_alt, abs=2)


def test_next_timer_is_when_there_is_something_to_send(bench: Bench) -> None:
    bench.collect()
    due = bench.vehicle.next_timer()
    assert due is not None and bench.now < due <= bench.now + 0.02
    assert bench.vehicle.datagrams_to_send(due - 0.001) == []
    bench.send(mavlink.MAVLink_param_request_list_message(1, 1))
    assert bench.vehicle.next_timer() < due


def test_silent_peers_are_forgotten_and_their_number_is_bounded(bench: Bench) -> None:
    for port in range(50):
        bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), ("10.0.0.1", port))
    bench.run(1.0)
    assert len(bench.inbox) == 8
    bench.run(10.0)
    bench.datagrams.clear()
    bench.run(1.0)
    assert bench.datagrams == [] and bench.vehicle.next_timer() is None
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), STRANGER)
    bench.run(0.1)
    assert bench.got("HEARTBEAT", STRANGER)


def test_lost_samples_stop_the_telemetry_and_the_health_bits(bench: Bench) -> None:
    for _ in range(200):
        bench.vehicle.step(None, bench.now)
        bench.collect()
        bench.body.tick += 1
    bench.inbox.clear()
    for _ in range(600):
        bench.vehicle.step(None, bench.now)
        bench.collect()
        bench.body.tick += 1
    assert not bench.got("ATTITUDE_QUATERNION") and not bench.got("LOCAL_POSITION_NED")
    health = bench.got("SYS_STATUS")[-1].onboard_control_sensors_health
    assert not health & (mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO | mavlink.MAV_SYS_STATUS_PREARM_CHECK)
    assert bench.result(ARM) == REJECTED


# Commands


def test_arm_and_offboard_sequence(bench: Bench) -> None:
    [ack] = [m for m in bench.ask(OFFBOARD) if m.get_type() == "COMMAND_ACK"]
    assert ack.result == REJECTED
    assert "no set-points" in bench.got("STATUSTEXT")[-1].text
    bench.streaming[GROUND, 255] = attitude_target(thrust=0.0)
    bench.run(0.2)
    assert bench.got("SYS_STATUS")[-1].onboard_control_sensors_health & mavlink.MAV_SYS_STATUS_PREARM_CHECK
    assert bench.result(OFFBOARD) == ACCEPTED
    bench.run(0.01)
    beat = bench.got("HEARTBEAT")[-1]  # told at once, not with the next second
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


def test_setpoint_loss_is_told(flying: Bench) -> None:
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
        (command(300), UNSUPPORTED),
    ],
)
def test_commands_are_answered(bench: Bench, message: Any, result: int) -> None:
    assert bench.result(message) == result


def test_commands_as_command_int_and_mode_as_set_mode(bench: Bench) -> None:
    as_int = mavlink.MAVLink_command_int_message(1, 1, 0, 400, 0, 0, 1, 0, 0, 0, 0, 0, 0)
    assert bench.result(as_int) == ACCEPTED and bench.vehicle.autopilot.armed
    bench.send(DISARM)
    bench.send(mavlink.MAVLink_set_mode_message(1, 1, px4.MODE_POSCTL))
    assert bench.vehicle.autopilot.mode == px4.MODE_POSCTL


@pytest.mark.parametrize("target", [(2, 1), (1, 25), (7, 0)])
def test_commands_to_others_are_not_answered(bench: Bench, target: tuple[int, int]) -> None:
    assert bench.ask(command(400, 1, system=target[0], component=target[1])) == []
    assert not bench.vehicle.autopilot.armed


def test_its_own_words_coming_back_are_ignored(bench: Bench) -> None:
    bench.send(ARM, GROUND, system=1)
    assert not bench.vehicle.autopilot.armed


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


def test_timesync_and_ping_are_answered_to_the_asker(bench: Bench) -> None:
    [answer] = bench.ask(mavlink.MAVLink_timesync_message(0, 123456789))
    assert answer.ts1 == 123456789 and answer.tc1 == round(bench.now * 1e9)
    assert bench.ask(mavlink.MAVLink_timesync_message(5, 6)) == []
    [answer] = bench.ask(mavlink.MAVLink_ping_message(77, 8, 0, 0))
    assert (answer.time_usec, answer.seq, answer.target_system, answer.target_component) == (77, 8, 255, 190)


# Set-points


@pytest.mark.parametrize(
    "message",
    [
        attitude_target(q=(math.nan, 0, 0, 0)),
        attitude_target(q=(0, 0, 0, 0)),
        attitude_target(q=(math.inf, 0, 0, 0)),
        attitude_target(q=(2, 0, 0, 0)),
        attitude_target(q=(3e38, 3e38, 0, 0)),
        attitude_target(thrust=math.nan),
        attitude_target(thrust=-0.1),
        attitude_target(thrust=1.1),
        attitude_target(thrust=math.inf),
        attitude_target(mask=0, rates=(math.nan, 0, 0)),
        attitude_target(mask=0, rates=(0, 50.0, 0)),
        attitude_target(mask=128 | 7),
        attitude_target(mask=8 | 7),
        attitude_target(mask=32 | 7),
    ],
)
def test_insane_setpoints_do_not_count(flying: Bench, message: Any) -> None:
    flying.streaming[GROUND, 255] = message
    flying.run(0.3)
    assert flying.vehicle.refused_setpoints >= 5
    assert flying.vehicle.autopilot.mode == px4.MODE_OFFBOARD
    flying.run(0.3)  # and they do not keep the failsafe away
    assert flying.vehicle.autopilot.failsafe


@pytest.mark.parametrize(
    ("message", "target"),
    [
        (attitude_target(q=(-1, 0, 0, 0), thrust=0.3), ((-1, 0, 0, 0), (0, 0, 0), 0.3)),
        (attitude_target(mask=3, rates=(9, 9, 0.5), thrust=0.3), ((1, 0, 0, 0), (0, 0, 0.5), 0.3)),
        (attitude_target(mask=128, q=(0, 0, 0, 0), rates=(0.1, 0.2, 0.3), thrust=0.3), (None, (0.1, 0.2, 0.3), 0.3)),
        (attitude_target(mask=7 | 64, thrust=math.nan), ((1, 0, 0, 0), (0, 0, 0), HOVER)),
        (attitude_target(mask=7, rates=(math.nan, math.inf, 1e9), thrust=0.3), ((1, 0, 0, 0), (0, 0, 0), 0.3)),
    ],
)
def test_type_masks(flying: Bench, message: Any, target: Any) -> None:
    flying.send(message)
    flying.body.command = flying.vehicle.step(flying.body.measure(), flying.now)
    attitude, rates, thrust = flying.vehicle.autopilot.attitude_target
    assert attitude == (None if target[0] is None else pytest.approx(target[0], abs=1e-6))
    assert rates == pytest.approx(target[1], abs=1e-6) and thrust == pytest.approx(target[2], abs=1e-6)


def test_setpoints_overtaken_on_the_way_are_dropped_but_not_those_of_a_new_clock(flying: Bench) -> None:
    def thrust_after(stamp: int, thrust: float) -> float:
        flying.send(attitude_target(stamp=stamp, thrust=thrust))
        flying.vehicle.step(flying.body.measure(), flying.now)
        return flying.vehicle.autopilot.attitude_target[2]

    assert thrust_after(5000, 0.2) == pytest.approx(0.2)
    assert thrust_after(4950, 0.3) == pytest.approx(0.2)
    assert thrust_after(5000, 0.25) == pytest.approx(0.25)
    assert thrust_after(10, 0.35) == pytest.approx(0.35)


def test_the_stamp_of_the_last_setpoint_is_told_to_the_driver(flying: Bench) -> None:
    flying.send(attitude_target(stamp=4242))
    assert flying.vehicle.setpoint_stamp_ms == 4242
    flying.send(attitude_target(stamp=1), STRANGER)
    assert flying.vehicle.setpoint_stamp_ms == 4242


# Stop plans


def stop_plan(flying: Bench, start: float, x: float = 0.0, duration: float = 4.0, **changes: Any) -> Any:
    here = flying.body.position
    points = [(here[0] + x * k / 4, here[1], here[2]) for k in (0, 1, 4, 4, 4)]
    message = stop_plan_message(start, duration, points)
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def test_without_setpoints_it_follows_the_plan_that_came_with_the_last_one(flying: Bench) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now, x=3.0))
    flying.streaming.clear()
    flying.run(5.0)
    assert flying.vehicle.autopilot.failsafe
    assert flying.body.position[0] - x == pytest.approx(3.0, abs=0.3)


@pytest.mark.parametrize(
    ("late", "changes"),
    [
        (0.0, {"valid_points": 4}),
        (0.0, {"pos_x": [math.nan] * 5}),
        (0.0, {"delta": [0.0] * 5}),
        (0.0, {"delta": [math.inf] * 5}),
        (0.0, {"pos_yaw": [math.nan] * 5}),
        (0.0, {"pos_y": [50.0] * 5}),
        (3.0, {}),
        (-9.0, {}),
    ],
)
def test_a_plan_of_another_time_or_place_or_none_is_not_followed(flying: Bench, late: float, changes: Any) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now - late, x=3.0, **changes))
    flying.streaming.clear()
    flying.run(5.0)
    assert flying.vehicle.autopilot.failsafe
    assert flying.body.position[0] - x == pytest.approx(0.0, abs=0.3)


def test_a_strangers_plan_is_not_followed(flying: Bench) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now, x=3.0), STRANGER)
    flying.streaming.clear()
    flying.run(5.0)
    assert flying.body.position[0] - x == pytest.approx(0.0, abs=0.3)


def test_a_hold_that_is_asked_for_again_goes_on_with_its_plan(flying: Bench) -> None:
    x = flying.body.position[0]
    flying.send(stop_plan(flying, flying.now, x=3.0))
    flying.streaming.clear()
    assert flying.result(HOLD) == ACCEPTED
    for _ in range(5):
        flying.run(1.0)
        assert flying.result(HOLD) == ACCEPTED
    assert flying.body.position[0] - x == pytest.approx(3.0, abs=0.3)


# Strangers


def test_no_stranger_commands_a_controlled_vehicle(flying: Bench) -> None:
    kill, land, mode = command(400, 0, px4.FORCE_ARM_DISARM), command(21), command(176, 1, 4, 6)
    for sender, system in ((STRANGER, 255), (GROUND, 42), (STRANGER, 42)):
        for message in (kill, land, mode, OFFBOARD, command(185, 1)):
            assert flying.result(message, sender, system) == DENIED
        flying.send(mavlink.MAVLink_set_mode_message(1, 1, px4.MODE_LAND), sender, system)
        flying.ask(mavlink.MAVLink_param_set_message(1, 1, b"COM_OF_LOSS_T", 9.0, 9), sender, system)
        refused = flying.vehicle.refused_setpoints
        flying.send(attitude_target(thrust=0.0), sender, system)
        assert flying.vehicle.refused_setpoints == refused + 1
    flying.vehicle.step(flying.body.measure(), flying.now)
    assert flying.vehicle.autopilot.armed and flying.vehicle.autopilot.mode == px4.MODE_OFFBOARD
    assert flying.vehicle.autopilot.attitude_target[2] == pytest.approx(HOVER)
    assert flying.vehicle.parameters["COM_OF_LOSS_T"] == 0.5
    assert flying.result(command(512, mavlink.MAVLINK_MSG_ID_HOME_POSITION), STRANGER) == ACCEPTED


def test_no_stranger_behind_the_grounds_address_stops_its_telemetry(flying: Bench) -> None:
    stop = command(511, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, -1)
    assert flying.result(stop, GROUND, 42) == DENIED
    assert flying.result(stop, STRANGER, 42) == ACCEPTED
    before = len(flying.got("ATTITUDE_QUATERNION"))
    flying.run(0.5)
    assert len(flying.got("ATTITUDE_QUATERNION")) >= before + 24
    assert flying.result(stop) == ACCEPTED


def test_who_asks_for_too_much_at_once_does_not_get_it(flying: Bench) -> None:
    flying.collect()
    flying.inbox.clear()
    for _ in range(1000):
        flying.send(mavlink.MAVLink_param_request_list_message(1, 1), STRANGER)
    flying.collect()
    assert len(flying.got("PARAM_VALUE", STRANGER)) == REPLIES_MAX
    assert flying.result(command(512, mavlink.MAVLINK_MSG_ID_HOME_POSITION), STRANGER) == ACCEPTED


def test_another_ground_may_take_over_once_the_stream_is_silent(flying: Bench) -> None:
    flying.streaming = {(STRANGER, 42): attitude_target(thrust=HOVER)}
    flying.run(0.45)
    assert flying.result(OFFBOARD, STRANGER, 42) == DENIED
    flying.run(0.3)
    assert flying.vehicle.autopilot.failsafe  # its set-points do not fly the vehicle by themselves
    assert flying.result(OFFBOARD, STRANGER, 42) == ACCEPTED
    flying.streaming[GROUND, 255] = attitude_target(thrust=0.0)
    flying.run(0.3)
    assert not flying.vehicle.autopilot.failsafe
    assert flying.vehicle.autopilot.attitude_target[2] == pytest.approx(HOVER)
    assert flying.result(command(21), GROUND, 255) == DENIED


def test_a_strangers_stream_before_control_does_not_fly(bench: Bench) -> None:
    bench.streaming = {(STRANGER, 42): attitude_target(thrust=0.9), (GROUND, 255): attitude_target(thrust=0.1)}
    bench.run(0.3)
    assert bench.result(OFFBOARD) == ACCEPTED and bench.result(ARM) == ACCEPTED
    bench.run(0.3)
    assert bench.vehicle.autopilot.attitude_target[2] == pytest.approx(0.1)


# Parameters


def value_of(messages: list[Any]) -> dict[str, Any]:
    values = [m for m in messages if m.get_type() == "PARAM_VALUE"]
    return {m.param_id: px4.parameter_from_wire(m.param_value, m.param_type) for m in values}


def test_parameter_list_is_complete_and_byte_wise(bench: Bench) -> None:
    bench.send(mavlink.MAVLink_param_request_list_message(1, 1))
    bench.collect()
    values = bench.got("PARAM_VALUE")
    assert [m.param_index for m in values] == list(range(values[0].param_count))
    table = value_of(values)
    assert table["SYS_AUTOSTART"] == 4001 and isinstance(table["SYS_AUTOSTART"], int)
    assert table[px4.PARAM_THRUST_MAX] == 30.0 and table[px4.PARAM_ONBOARD_RATE] == 250


def test_parameters_are_read_by_name_and_by_index(bench: Bench) -> None:
    ask = mavlink.MAVLink_param_request_read_message
    assert value_of(bench.ask(ask(1, 1, b"MIS_TAKEOFF_ALT", -1))) == {"MIS_TAKEOFF_ALT": 2.5}
    [first] = bench.ask(ask(1, 1, b"", 0))
    assert first.param_index == 0
    assert bench.ask(ask(1, 1, b"NO_SUCH", -1)) == [] and bench.ask(ask(1, 1, b"", 999)) == []


@pytest.mark.parametrize(
    ("name", "value", "kind", "stored"),
    [
        ("COM_OF_LOSS_T", 0.3, 9, pytest.approx(0.3)),
        ("COM_OF_LOSS_T", math.nan, 9, 0.5),
        ("COM_OF_LOSS_T", -1.0, 9, 0.5),
        ("COM_DL_LOSS_T", px4.parameter_to_wire(20, 6), 6, 20),
        ("COM_DL_LOSS_T", 20.0, 9, 10),
        ("COM_DL_LOSS_T", 20.0, 6, 10),  # a C cast: read byte-wise it is far out of range
        (px4.PARAM_THRUST_MAX, 99.0, 9, 30.0),
    ],
)
def test_parameters_are_set_or_the_kept_value_is_answered(
    bench: Bench, name: str, value: float, kind: int, stored: Any
) -> None:
    answer = value_of(bench.ask(mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, kind)))
    assert answer == {name: stored}
    assert bench.vehicle.parameters[name] == stored


# Fuzz


def test_mutated_datagrams_neither_raise_nor_command(flying: Bench) -> None:
    """Random flips in what a ground could send: with a wrong checksum nothing may be obeyed."""
    rng = np.random.default_rng(7)
    codec = Codec(255, 190)
    seeds = [
        codec.encode(message)
        for message in (
            command(400, 0, px4.FORCE_ARM_DISARM), command(176, 1, 4, 6), attitude_target(thrust=0.0), command(21),
            mavlink.MAVLink_set_mode_message(1, 1, px4.MODE_LAND),
            mavlink.MAVLink_param_set_message(1, 1, b"COM_OF_LOSS_T", 9.0, 9),
        )
    ]  # fmt: skip
    vehicle, now = flying.vehicle, flying.now
    before = vehicle.autopilot.changes
    for number in range(20_000):
        frame = bytearray(seeds[number % len(seeds)])
        kind = number % 5
        if kind == 4:
            frame = frame[: rng.integers(0, len(frame))] + rng.bytes(rng.integers(0, 30))
        else:
            for index in rng.choice(len(frame), kind % 3 + 1, replace=False):
                frame[index] ^= int(rng.integers(1, 256))
        vehicle.receive(bytes(frame), GROUND, now)
        if number % 100 == 0:
            flying.send(attitude_target(), GROUND)
            vehicle.step(flying.body.measure(), now)
            vehicle.datagrams_to_send(now)
    assert vehicle.autopilot.armed and vehicle.autopilot.mode == px4.MODE_OFFBOARD
    assert vehicle.autopilot.changes == before
    assert vehicle.autopilot.attitude_target[2] == pytest.approx(HOVER)
    assert vehicle.parameters["COM_OF_LOSS_T"] == 0.5


def test_every_message_with_random_contents_from_a_stranger_is_survived_and_changes_nothing(flying: Bench) -> None:
    rng = np.random.default_rng(11)
    writer = mavlink.MAVLink(None, 42, 1)
    vehicle = flying.vehicle
    before = vehicle.autopilot.changes
    for _ in range(10):
        for kind in mavlink.mavlink_map.values():
            frame = with_random_contents(kind, rng.bytes(kind.unpacker.size), 1, writer)
            vehicle.receive(frame, STRANGER, flying.now)
        flying.send(attitude_target())
        vehicle.step(flying.body.measure(), flying.now)
        vehicle.datagrams_to_send(flying.now)
    assert vehicle.autopilot.changes == before
    assert vehicle.autopilot.armed and vehicle.parameters["COM_OF_LOSS_T"] == 0.5
