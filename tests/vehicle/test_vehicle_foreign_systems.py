"""Control of a vehicle: one system may command it, and the messages of others change nothing."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from hostile_traffic import with_random_contents
from onboard import step_alone
from vehicle_bench import (
    ACCEPTED,
    ARM,
    DENIED,
    GROUND,
    HOVER,
    OFFBOARD,
    STRANGER,
    Bench,
    attitude_target,
    command,
)

from gcs.config.vehicle_settings import VehicleFailsafeSettings, VehicleLinkSettings
from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from vehicle_sim.world.sensors import Measurement

GROUND_HEARTBEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3)


def test_controlled_vehicle_refuses_commands_of_foreign_systems(flying: Bench) -> None:
    kill, land, mode = command(400, 0, px4.FORCE_ARM_DISARM), command(21), command(176, 1, 4, 6)
    for sender, system in ((STRANGER, 255), (GROUND, 42), (STRANGER, 42)):
        for message in (kill, land, mode, OFFBOARD, command(185, 1)):
            assert flying.result(message, sender, system) == DENIED
        flying.send(mavlink.MAVLink_set_mode_message(1, 1, px4.MODE_LAND), sender, system)
        flying.request(mavlink.MAVLink_param_set_message(1, 1, b"COM_OF_LOSS_T", 9.0, 9), sender, system)
        refused = flying.vehicle.refused_setpoints
        flying.send(attitude_target(thrust=0.0), sender, system)
        assert flying.vehicle.refused_setpoints == refused + 1
    step_alone(flying.vehicle.autopilot, flying.body.measure(), flying.now)
    assert flying.vehicle.autopilot.armed and flying.vehicle.autopilot.mode == px4.MODE_OFFBOARD
    assert flying.vehicle.autopilot.state.actuation.target[2] == pytest.approx(HOVER)
    assert flying.vehicle.parameters["COM_OF_LOSS_T"] == pytest.approx(VehicleFailsafeSettings.setpoint_loss)
    assert flying.result(command(512, mavlink.MAVLINK_MSG_ID_HOME_POSITION), STRANGER) == ACCEPTED


def test_silence_of_the_ground_lets_no_other_stop_the_rotors_in_the_air(flying: Bench) -> None:
    flying.streaming = {}
    flying.run(1.5)
    assert flying.vehicle.autopilot.failsafe
    for kill in (command(400, 0, px4.FORCE_ARM_DISARM), command(185, 1)):
        assert flying.result(kill, STRANGER) == DENIED
    assert "another ground flies it" in flying.got("STATUSTEXT", STRANGER)[-1].text
    assert flying.vehicle.autopilot.armed
    assert flying.result(command(400, 0, px4.FORCE_ARM_DISARM)) == ACCEPTED
    assert not flying.vehicle.autopilot.armed


def test_ground_whose_offboard_is_denied_in_the_air_gets_no_control(flying: Bench) -> None:
    flying.streaming = {(STRANGER, 42): attitude_target(thrust=HOVER)}
    flying.body.measure = lambda: Measurement(flying.now, *((math.nan,) * n for n in (4, 3, 3, 3)))
    flying.run(1.5)
    assert flying.result(OFFBOARD, STRANGER, 42) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert "no navigation data" in flying.got("STATUSTEXT", STRANGER)[-1].text
    assert flying.result(command(400, 0, px4.FORCE_ARM_DISARM), STRANGER, 42) == DENIED
    assert flying.vehicle.autopilot.armed


def test_foreign_system_at_ground_address_cannot_stop_telemetry(flying: Bench) -> None:
    stop = command(511, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, -1)
    assert flying.result(stop, GROUND, 42) == DENIED
    assert flying.result(stop, STRANGER, 42) == ACCEPTED
    before = len(flying.got("ATTITUDE_QUATERNION"))
    flying.run(0.5)
    assert len(flying.got("ATTITUDE_QUATERNION")) >= before + 24
    assert flying.result(stop) == ACCEPTED


def test_excessive_requests_are_rate_limited(flying: Bench) -> None:
    flying.collect()
    flying.inbox.clear()
    for _ in range(1000):
        flying.send(mavlink.MAVLink_param_request_read_message(1, 1, b"COM_DL_LOSS_T", -1), STRANGER)
    flying.collect()
    assert len(flying.got("PARAM_VALUE", STRANGER)) == VehicleLinkSettings().replies_max
    assert flying.result(command(512, mavlink.MAVLINK_MSG_ID_HOME_POSITION), STRANGER) == ACCEPTED


def test_lists_of_parameters_requested_at_the_grounds_address_do_not_fill_its_link(flying: Bench) -> None:
    def sent_in_a_second(requests: int) -> int:
        flying.collect()
        flying.datagrams.clear()
        for _ in range(50):
            for _ in range(requests):
                flying.send(mavlink.MAVLink_param_request_list_message(1, 1), GROUND, 42)
            flying.run(0.02)
        return sum(len(datagram) for _, datagram, address in flying.datagrams if address == GROUND)

    usual = sent_in_a_second(0)
    lists = len(flying.vehicle.parameters) + 1
    assert usual < sent_in_a_second(20) < usual + 6 * 37 * lists
    # Who asks again later gets it.
    flying.run(0.3)
    flying.inbox.clear()
    flying.send(mavlink.MAVLink_param_request_list_message(1, 1))
    flying.collect()
    assert len(flying.got("PARAM_VALUE")) == lists


def test_heartbeat_with_a_forged_address_draws_no_more_than_it_sent() -> None:
    """Whatever the vehicle has to say meanwhile: streams, changes, texts, parameters that another has set."""
    bench = Bench(clients_answer=False, clients={GROUND: True})
    bench.run(0.1)
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
    bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), STRANGER)
    for _ in range(3):
        bench.send(mavlink.MAVLink_param_set_message(1, 1, b"COM_OF_LOSS_T", 0.7, mavlink.MAV_PARAM_TYPE_REAL32))
        bench.send(mavlink.MAVLink_param_set_message(1, 1, b"NO_SUCH", 0.7, mavlink.MAV_PARAM_TYPE_REAL32))
        assert bench.result(command(400, 1)) == ACCEPTED
        assert bench.result(command(400, 0)) == ACCEPTED
        bench.run(1.0)
    sent = [datagram for _, datagram, address in bench.datagrams if address == STRANGER]
    heartbeat = 21
    assert len(b"".join(sent)) == heartbeat
    assert len(bench.got("PARAM_VALUE")) >= 3  # the ground was told all of it


def test_second_ground_may_take_control_after_setpoint_timeout(flying: Bench) -> None:
    flying.streaming = {(STRANGER, 42): attitude_target(thrust=HOVER)}
    flying.run(VehicleFailsafeSettings.setpoint_loss - 0.08)
    assert flying.result(OFFBOARD, STRANGER, 42) == DENIED
    flying.run(0.3)
    assert flying.vehicle.autopilot.failsafe  # its set-points do not fly the vehicle by themselves
    assert flying.result(OFFBOARD, STRANGER, 42) == ACCEPTED
    flying.streaming[GROUND, 255] = attitude_target(thrust=0.0)
    flying.run(0.3)
    assert not flying.vehicle.autopilot.failsafe
    assert flying.vehicle.autopilot.state.actuation.target[2] == pytest.approx(HOVER)
    assert flying.result(command(21), GROUND, 255) == DENIED


def test_setpoints_of_foreign_system_are_ignored_before_control(bench: Bench) -> None:
    bench.streaming = {(STRANGER, 42): attitude_target(thrust=0.9), (GROUND, 255): attitude_target(thrust=0.1)}
    bench.run(0.3)
    assert bench.result(OFFBOARD) == ACCEPTED and bench.result(ARM) == ACCEPTED
    bench.run(0.3)
    assert bench.vehicle.autopilot.state.actuation.target[2] == pytest.approx(0.1)


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
            step_alone(vehicle.autopilot, flying.body.measure(), now)
            vehicle.datagrams_to_send(now)
    assert vehicle.autopilot.armed and vehicle.autopilot.mode == px4.MODE_OFFBOARD
    assert vehicle.autopilot.changes == before
    assert vehicle.autopilot.state.actuation.target[2] == pytest.approx(HOVER)
    assert vehicle.parameters["COM_OF_LOSS_T"] == pytest.approx(VehicleFailsafeSettings.setpoint_loss)


def test_random_messages_of_foreign_system_neither_raise_nor_change_state(flying: Bench) -> None:
    rng = np.random.default_rng(11)
    writer = mavlink.MAVLink(None, 42, 1)
    vehicle = flying.vehicle
    before = vehicle.autopilot.changes
    for _ in range(10):
        for kind in mavlink.mavlink_map.values():
            frame = with_random_contents(kind, rng.bytes(kind.unpacker.size), 1, writer)
            vehicle.receive(frame, STRANGER, flying.now)
        flying.send(attitude_target())
        step_alone(vehicle.autopilot, flying.body.measure(), flying.now)
        vehicle.datagrams_to_send(flying.now)
    assert vehicle.autopilot.changes == before
    assert vehicle.autopilot.armed and vehicle.parameters["COM_OF_LOSS_T"] == pytest.approx(
        VehicleFailsafeSettings.setpoint_loss
    )


def test_companion_with_the_vehicles_own_system_id_is_answered_and_is_no_ground(flying: Bench) -> None:
    flying.streaming.clear()
    heard = flying.vehicle.autopilot.state.link_time
    flying.run(0.5)
    flying.send(GROUND_HEARTBEAT, STRANGER, system=1, component=191)
    assert flying.request(command(512, 148), STRANGER, system=1, component=191)
    assert flying.vehicle.autopilot.state.link_time == heard < flying.now


@pytest.mark.parametrize(
    ("message", "sender", "system", "counts"),
    [
        (GROUND_HEARTBEAT, GROUND, 255, True),
        (GROUND_HEARTBEAT, STRANGER, 255, False),
        (GROUND_HEARTBEAT, GROUND, 254, False),
        (mavlink.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3), STRANGER, 3, False),
        (command(512, 148), GROUND, 255, True),
        (command(512, 148), STRANGER, 255, False),
    ],
    ids=["in control", "another address", "another system", "a drone", "its command", "another's command"],
)
def test_data_link_is_kept_up_by_the_ground_in_control_alone(
    flying: Bench, message: Any, sender: Any, system: int, counts: bool
) -> None:
    flying.run(0.1)
    flying.streaming.clear()
    flying.run(1.0)
    flying.send(message, sender, system)
    assert (flying.vehicle.autopilot.state.link_time == flying.now) is counts


def test_before_any_ground_is_in_control_the_heartbeat_of_each_counts() -> None:
    bench = Bench()
    bench.run(0.1)
    bench.send(mavlink.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3), STRANGER, 3)
    assert bench.vehicle.autopilot.state.link_time == -math.inf
    bench.send(GROUND_HEARTBEAT, STRANGER, 254)
    assert bench.vehicle.autopilot.state.link_time == bench.now
