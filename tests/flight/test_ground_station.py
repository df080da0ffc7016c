"""Ground station: which datagrams count, and which are ignored."""

import pymavlink.dialects.v20.common as mavlink
import pytest
from flights import MISSIONS, address_of

from gcs.app.fly import ground_station
from gcs.flight.ground_station import GROUND_COMPONENT, GROUND_SYSTEM
from gcs.mavlink.codec import Codec
from gcs.mavlink.requests import CommandState
from gcs.mission.read import read_mission
from gcs.record.recorder import FlightRecorder

ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM


@pytest.fixture
def station(tmp_path):
    with FlightRecorder(tmp_path, 0.0) as recorder:
        yield ground_station(
            read_mission(MISSIONS / "hover.toml"), [address_of(i) for i in range(1, 5)], recorder, "idc"
        )


def send(station, message, system=1, address=None, now=0.0):
    station.receive(Codec(system, 1).encode(message), address or address_of(system), now)


@pytest.mark.parametrize(
    ("target", "state"),
    [
        ((42, 190), CommandState.PENDING),
        ((GROUND_SYSTEM, GROUND_COMPONENT), CommandState.REFUSED),
        ((0, 0), CommandState.REFUSED),  # as autopilots answer without target ids
    ],
)
def test_acknowledgement_to_another_system_is_ignored(station, target, state):
    command = station.links[0].requests.command(ARM, 1.0)
    send(station, mavlink.MAVLink_command_ack_message(ARM, mavlink.MAV_RESULT_DENIED, 0, 0, *target))
    assert command.state is state


def test_acknowledgement_from_another_sender_is_ignored(station):
    command = station.links[0].requests.command(ARM, 1.0)
    answer = mavlink.MAVLink_command_ack_message(ARM, mavlink.MAV_RESULT_DENIED)
    send(station, answer, system=1, address=address_of(2))
    send(station, answer, system=2, address=address_of(1))
    send(station, answer, system=1, address=("10.0.0.66", 14580))
    assert command.state is CommandState.PENDING
    assert station.router.refused == 3


def test_heartbeat_is_that_of_a_ground_station_once_a_second(station):
    beats = []
    for k in range(30):
        for datagram, address in station.datagrams_to_send(0.1 * k):
            found = [received.message for received in Codec(2, 1).decode(datagram)]
            beats += [m for m in found if m.get_type() == "HEARTBEAT" and address == address_of(3)]
    assert len(beats) == 3
    assert {(m.type, m.autopilot, m.base_mode, m.custom_mode, m.system_status) for m in beats} == {
        (mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE)
    }


def test_timesync_answer_counts_once_and_only_to_an_own_request(station):
    clock = station.links[0].clock
    sent = [m for m, address in station.datagrams_to_send(1.0) if address == address_of(1)]
    messages = [received.message for data in sent for received in Codec(2, 1).decode(data)]
    [request] = [m for m in messages if m.get_type() == "TIMESYNC"]
    for ts1 in (0, 1, 900_000_000, -(2**63)):
        send(station, mavlink.MAVLink_timesync_message(5, ts1), now=1.02)
    assert clock.delay == 0.0
    send(station, mavlink.MAVLink_timesync_message(5, request.ts1), now=1.04)
    assert clock.delay == pytest.approx(0.02)
    for _ in range(50):
        send(station, mavlink.MAVLink_timesync_message(5, request.ts1), now=1.9)
    assert clock.delay == pytest.approx(0.02)


def test_station_that_is_called_at_its_timers_misses_none(station):
    beats, requests, times = [], [], [0.0]
    assert station.next_timer() == 0.0
    while times[-1] < 3.0:
        for datagram, address in station.datagrams_to_send(times[-1]):
            kinds = [received.message.get_type() for received in Codec(2, 1).decode(datagram)]
            if address == address_of(1):
                beats += [times[-1]] * kinds.count("HEARTBEAT")
                requests += [times[-1]] * kinds.count("TIMESYNC")
        times.append(station.next_timer())
        assert times[-1] > times[-2]
    assert beats == pytest.approx([0.0, 1.0, 2.0])
    assert set(requests) <= set(times) and len(requests) >= 3
    period = station.flight.control.period if hasattr(station.flight.control, "period") else 0.05
    for k in range(60):
        assert min(abs(time - k * period) for time in times) < 1e-9
