"""Telemetry streams of a vehicle: messages, rates and addressees."""

from __future__ import annotations

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from onboard import step_alone
from vehicle_bench import (
    ACCEPTED,
    ARM,
    GROUND,
    PAYLOAD_UNIT,
    REJECTED,
    STRANGER,
    Bench,
    command,
)

from gcs.mavlink.codec import DATAGRAM_LIMIT
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement

NO_POINTS = np.empty((0, 3))
SLOW = (
    "SYSTEM_TIME", "ALTITUDE", "HIGHRES_IMU", "SCALED_PRESSURE", "ESTIMATOR_STATUS", "RC_CHANNELS",
    "NAV_CONTROLLER_OUTPUT", "ODOMETRY", "SERVO_OUTPUT_RAW", "ACTUATOR_OUTPUT_STATUS",
)  # fmt: skip
"""Streams of one second, most of them to the ports of clients only."""


def test_ports_of_clients_get_all_streams_from_the_start_and_for_ever_without_an_answer() -> None:
    assert Bench().vehicle.next_timer() is None
    bench = Bench(clients={GROUND: True, STRANGER: False})
    assert bench.vehicle.next_timer() is not None
    bench.run(0.1)
    needed = {
        "HEARTBEAT", "SYS_STATUS", "EXTENDED_SYS_STATE", "ATTITUDE", "ATTITUDE_QUATERNION", "LOCAL_POSITION_NED",
        "GLOBAL_POSITION_INT", "GPS_RAW_INT", "HOME_POSITION", "BATTERY_STATUS", "VFR_HUD", "ATTITUDE_TARGET",
        "VIBRATION", *SLOW, "MISSION_CURRENT", "CURRENT_MODE",
    }  # fmt: skip
    for address in (GROUND, STRANGER):
        assert {m.get_type() for m in bench.inbox[address] if m.get_srcSystem() == 1} == needed
    bench.body.tick += 500 * 70
    bench.inbox.clear()
    bench.run(1.0)
    for address in (GROUND, STRANGER):
        assert len(bench.got("ATTITUDE_QUATERNION", address)) == 50 and len(bench.got("HEARTBEAT", address)) >= 1
    assert len(bench.got("LOCAL_POSITION_NED", GROUND, PAYLOAD_UNIT)) == 50
    assert not bench.got("LOCAL_POSITION_NED", STRANGER, PAYLOAD_UNIT)


def test_port_of_a_client_gets_more_streams_than_who_calls_in() -> None:
    bench = Bench(clients={GROUND: True})
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), STRANGER)
    bench.run(2.5)
    for kind in SLOW:
        assert len(bench.got(kind, GROUND)) == 3
        assert len(bench.got(kind, STRANGER)) == (3 if kind == "SYSTEM_TIME" else 0)
    bench.result(command(511, mavlink.MAVLINK_MSG_ID_ODOMETRY, 20_000), STRANGER)
    bench.run(0.2)
    assert len(bench.got("ODOMETRY", STRANGER)) >= 10


def test_client_that_falls_silent_keeps_its_streams_on_its_port_alone() -> None:
    bench = Bench(clients={GROUND: True})
    for address in (GROUND, STRANGER):
        bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), address)
    bench.run(0.1)
    bench.body.tick += 500 * 11
    bench.inbox.clear()
    bench.run(0.5)
    assert len(bench.got("ATTITUDE_QUATERNION")) == 25 and STRANGER not in bench.inbox


def test_no_message_under_the_vehicles_id_is_of_another_component(bench: Bench) -> None:
    bench.run(2.0)
    sources = {(m.get_srcSystem(), m.get_srcComponent()) for m in bench.inbox[GROUND]}
    assert sources == {(1, 1), PAYLOAD_UNIT}
    assert PAYLOAD_UNIT[0] == 100 and PAYLOAD_UNIT[1] != mavlink.MAV_COMP_ID_AUTOPILOT1


def test_streams_have_their_rates_and_stamps_of_samples(bench: Bench) -> None:
    bench.run(0.01)
    bench.inbox.clear()
    bench.datagrams.clear()
    bench.run(4.0)
    counts = {kind: len(bench.got(kind)) for kind in {m.get_type() for m in bench.inbox[GROUND]}}
    expected = {
        "ATTITUDE_QUATERNION": 200, "LOCAL_POSITION_NED": 200, "ATTITUDE": 40, "ATTITUDE_TARGET": 200,
        "GLOBAL_POSITION_INT": 20, "EXTENDED_SYS_STATE": 20, "VFR_HUD": 8, "HEARTBEAT": 4, "SYS_STATUS": 4,
        "GPS_RAW_INT": 4, "HOME_POSITION": 2, "BATTERY_STATUS": 2, "CURRENT_MODE": 2, "SYSTEM_TIME": 4,
        "MISSION_CURRENT": 4,
    }  # fmt: skip
    assert counts == expected
    stamps = [m.time_boot_ms for m in bench.got("ATTITUDE_QUATERNION")]
    assert stamps == [m.time_boot_ms for m in bench.got("LOCAL_POSITION_NED")]
    assert np.all(np.diff(stamps) == 20) and stamps[0] % 20 == 0
    assert len(bench.got("ATTITUDE_QUATERNION", source=PAYLOAD_UNIT)) == 200
    assert {tuple(m.repr_offset_q) for m in bench.got("ATTITUDE_QUATERNION")} == {(0.0,) * 4}  # as it is mounted
    # Everything due at one instant shares a datagram.
    assert len(bench.datagrams) == 200
    assert max(len(datagram) for _, datagram, _ in bench.datagrams) <= DATAGRAM_LIMIT


def test_payload_unit_is_forwarded_as_a_system_with_its_own_stamp(bench: Bench) -> None:
    sample = Measurement(123.456, (0.5, 0.5, -0.5, 0.5), (1, 2, 3), (4, 5, -6), (7, 8, 9))
    bench.vehicle.relay(sample)
    bench.body.tick += 10
    bench.collect()
    attitude = bench.got("ATTITUDE_QUATERNION", source=PAYLOAD_UNIT)[-1]
    position = bench.got("LOCAL_POSITION_NED", source=PAYLOAD_UNIT)[-1]
    assert attitude.time_boot_ms == position.time_boot_ms == 123456
    assert (attitude.q1, attitude.q3, attitude.yawspeed) == (0.5, -0.5, 3.0)
    assert (position.x, position.z, position.vy) == (4.0, -6.0, 8.0)
    before = len(bench.got("ATTITUDE_QUATERNION", source=PAYLOAD_UNIT))
    bench.body.tick += 10
    bench.collect()
    assert len(bench.got("ATTITUDE_QUATERNION", source=PAYLOAD_UNIT)) == before  # the same sample is sent once


def test_sequence_numbers_have_no_gaps_on_any_link(bench: Bench) -> None:
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), STRANGER)
    bench.request(mavlink.MAVLink_param_request_list_message(1, 1), STRANGER)
    bench.run(1.0)
    for address in (GROUND, STRANGER):
        for system in (1, PAYLOAD_UNIT[0]):
            numbers = [m.get_seq() for m in bench.inbox[address] if m.get_srcSystem() == system]
            assert len(numbers) > 50 and np.all(np.diff(numbers) % 256 == 1)


def test_positions_on_the_globe_are_those_of_the_local_frame(bench: Bench) -> None:
    bench.body.position = np.array([100.0, 0.0, -10.0])
    bench.run(0.3)
    message = bench.got("GLOBAL_POSITION_INT")[-1]
    home = bench.got("HOME_POSITION")[0]
    assert (message.lat - home.latitude) * 1e-7 * 111_200 == pytest.approx(100.0, abs=0.3)
    assert message.lon == home.longitude
    assert message.alt - home.altitude == pytest.approx(message.relative_alt, abs=2)


@pytest.mark.parametrize(("yaw", "course"), [(120.0, 126.87), (-60.0, -53.13)])
def test_course_heading_and_speed_are_those_of_the_sample(bench: Bench, yaw: float, course: float) -> None:
    half, track = math.radians(yaw) / 2.0, math.radians(course)
    velocity = np.array([5.0 * math.cos(track), 5.0 * math.sin(track), -1.0])
    measure = bench.body.measure
    bench.body.measure = lambda: measure()._replace(
        attitude=(math.cos(half), 0.0, 0.0, math.sin(half)), velocity=tuple(velocity), rates=(0.1, 0.2, 0.3),
        position=(1.0, 2.0, -7.0),
    )  # fmt: skip
    bench.run(0.01)
    for kind in ("GPS_RAW_INT", "VFR_HUD", "GLOBAL_POSITION_INT", "ODOMETRY"):
        assert bench.result(command(512, getattr(mavlink, f"MAVLINK_MSG_ID_{kind}"))) == ACCEPTED
    gps, hud = bench.got("GPS_RAW_INT")[-1], bench.got("VFR_HUD")[-1]
    place, odometry = bench.got("GLOBAL_POSITION_INT")[-1], bench.got("ODOMETRY")[-1]
    assert (gps.vel, gps.cog) == (500, round(100.0 * (course % 360.0)))
    assert (hud.groundspeed, hud.climb, hud.heading) == (pytest.approx(5.0), pytest.approx(1.0), yaw % 360.0)
    assert (place.vx, place.vy, place.vz) == tuple(np.round(100.0 * velocity))
    assert (place.hdg, place.relative_alt) == (100.0 * (yaw % 360.0), 7000)
    assert hud.alt == pytest.approx(1e-3 * place.alt, abs=0.01)
    assert (odometry.x, odometry.y, odometry.z) == (1.0, 2.0, -7.0)
    turned = math.radians(course - yaw)
    in_body = [5.0 * math.cos(turned), 5.0 * math.sin(turned), -1.0]
    assert [odometry.vx, odometry.vy, odometry.vz] == pytest.approx(in_body, abs=1e-5)
    assert [odometry.rollspeed, odometry.yawspeed] == pytest.approx([0.1, 0.3])


def test_next_timer_is_time_of_next_message(bench: Bench) -> None:
    bench.collect()
    due = bench.vehicle.next_timer()
    assert due is not None and bench.now < due <= bench.now + 0.02
    assert bench.vehicle.datagrams_to_send(due - 0.001) == []
    bench.send(mavlink.MAVLink_param_request_list_message(1, 1))
    assert bench.vehicle.next_timer() < due


def test_peers_time_out_and_their_number_is_bounded(bench: Bench) -> None:
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
        step_alone(bench.vehicle.autopilot, None, bench.now)
        bench.collect()
        bench.body.tick += 1
    bench.inbox.clear()
    for _ in range(600):
        step_alone(bench.vehicle.autopilot, None, bench.now)
        bench.collect()
        bench.body.tick += 1
    assert not bench.got("ATTITUDE_QUATERNION") and not bench.got("LOCAL_POSITION_NED")
    health = bench.got("SYS_STATUS")[-1].onboard_control_sensors_health
    assert not health & (mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO | mavlink.MAV_SYS_STATUS_PREARM_CHECK)
    assert bench.result(ARM) == REJECTED


def test_failed_range_sensor_is_reported_at_once(bench: Bench) -> None:
    def works() -> list[bool]:
        bit = mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY
        statuses = bench.got("SYS_STATUS")
        bench.inbox.clear()
        assert all(message.onboard_control_sensors_present & bit for message in statuses)
        return [bool(message.onboard_control_sensors_health & bit) for message in statuses]

    bench.run(0.1)
    assert not bench.got("SYS_STATUS")[-1].onboard_control_sensors_present & mavlink.MAV_SYS_STATUS_SENSOR_PROXIMITY
    bench.run(1.0)
    bench.inbox.clear()
    bench.vehicle.take_scan(RangeSample(bench.now, 10.0, NO_POINTS))
    bench.run(0.2)
    assert len(found := works()) > 1 and all(found)
    bench.vehicle.take_scan(RangeSample(bench.now, 10.0, NO_POINTS, works=False))
    bench.run(0.2)
    assert len(found := works()) > 1 and not any(found)
    bench.vehicle.take_scan(RangeSample(bench.now, 10.0, NO_POINTS, works=False))
    bench.run(0.2)
    assert len(works()) <= 1
