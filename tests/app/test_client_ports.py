"""The ports of SDKs and ground stations, to which a swarm sends in real time: what comes to each, and how often."""

import socket

import pymavlink.dialects.v20.common as mavlink
import pytest
from programs import PATIENCE, process

from gcs.config import read_system
from gcs.mavlink import px4
from gcs.mavlink.codec import Codec
from vehicle_sim.app.arguments import ClientPorts, parse
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.swarm import Swarm

SDK, STATIONS = ("127.0.0.1", 14540), ("127.0.0.1", 14550)
CONFIG = read_system()
HEARTBEAT = Codec(255, 190).encode(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3))
UNIT = px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT


class Listening:
    """Decoded messages of a swarm by the port to which they come, without an answer."""

    def __init__(self, swarm, answers=()):
        self.swarm, self.answers, self.messages = swarm, answers, {}
        self.decoder = Codec(254, 1)

    def run(self, until):
        now = self.swarm.time
        while now <= until:
            self.swarm.advance_to(now)
            for i, datagram, address in self.swarm.datagrams_to_send(now):
                received = [r.message for r in self.decoder.decode(datagram)]
                self.messages.setdefault(address, []).extend((i, message) for message in received)
                if address in self.answers:
                    self.swarm.receive(i, HEARTBEAT, address, now)
            now = max(self.swarm.next_timer(), now + 0.004)

    def sources(self, address):
        return {(m.get_srcSystem(), m.get_srcComponent()) for _, m in self.messages[address]}

    def of_unit(self, address, kind="LOCAL_POSITION_NED"):
        return [
            (i, m.time_boot_ms)
            for i, m in self.messages[address]
            if (m.get_srcSystem(), m.get_srcComponent()) == UNIT and m.get_type() == kind
        ]


@pytest.mark.parametrize("answers", [(), (STATIONS, SDK)], ids=["listening", "answering"])
def test_each_vehicle_sends_to_its_sdk_port_and_all_to_the_ground_stations_port(answers):
    with Swarm(CONFIG, seed=1, ground_address=STATIONS, sdk_address=SDK) as swarm:
        heard = Listening(swarm, answers)
        heard.run(1.0)
    ports = [("127.0.0.1", 14540 + k) for k in range(4)]
    assert set(heard.messages) == {STATIONS, *ports}
    assert heard.sources(STATIONS) == {(1, 1), (2, 1), (3, 1), (4, 1), UNIT}
    for i, port in enumerate(ports, start=1):
        assert heard.sources(port) == {(i, 1), UNIT} and {sender for sender, _ in heard.messages[port]} == {i}
    # The payload unit's messages come once to each port, whoever answers there.
    for port in (STATIONS, *ports):
        stamps = [stamp for _, stamp in heard.of_unit(port)]
        assert len(stamps) >= CONFIG.rates.telemetry and len(set(stamps)) == len(stamps)
        unit = [m for _, m in heard.messages[port] if (m.get_srcSystem(), m.get_srcComponent()) == UNIT]
        numbers = [m.get_seq() for m in unit]
        assert numbers == [k % 256 for k in range(len(numbers))]
        beats = [m for m in unit if m.get_type() == "HEARTBEAT"]
        assert len(beats) == 2
        assert {(m.type, m.autopilot) for m in beats} == {
            (mavlink.MAV_TYPE_ONBOARD_CONTROLLER, mavlink.MAV_AUTOPILOT_INVALID)
        }


def test_every_vehicle_forwards_the_payload_unit_to_a_ground_that_calls_in_beside_the_clients():
    caller = ("127.0.0.1", 50000)
    with Swarm(CONFIG, seed=1, ground_address=STATIONS, sdk_address=SDK) as swarm:
        heard = Listening(swarm, (caller,))
        for i in range(1, 5):
            swarm.receive(i, HEARTBEAT, caller, 0.0)
        heard.run(0.5)
    assert {i for i, _ in heard.of_unit(caller)} == {1, 2, 3, 4}
    assert {i for i, _ in heard.of_unit(STATIONS)} == {1}


def test_link_faults_act_on_who_calls_in_and_take_nothing_from_who_listens():
    class Deaf(FaultInjector):
        def from_vehicle(self, vehicle, leaving, now):
            return []

    caller = ("127.0.0.1", 50000)
    with Swarm(CONFIG, seed=1, ground_address=STATIONS, faults=Deaf()) as swarm:
        heard = Listening(swarm)
        swarm.receive(1, HEARTBEAT, caller, 0.0)
        heard.run(0.5)
    assert set(heard.messages) == {STATIONS}


@pytest.mark.parametrize(
    ("options", "host", "sdk", "ground"),
    [
        ("", "127.0.0.1", SDK, STATIONS),
        ("--base-port 24580", "127.0.0.1", SDK, STATIONS),
        ("--base-port 0 --sdk-port 0", "127.0.0.1", None, STATIONS),
        ("--sdk-port 15540 --ground-port 0", "127.0.0.1", ("127.0.0.1", 15540), None),
        ("--ground-host 192.0.2.7", "0.0.0.0", ("192.0.2.7", 14540), ("192.0.2.7", 14550)),
        ("--ground-host 192.0.2.7 --base-port 14540", "0.0.0.0", ("192.0.2.7", 14540), ("192.0.2.7", 14550)),
        ("--ground-host 192.0.2.7 --host 192.0.2.1", "192.0.2.1", ("192.0.2.7", 14540), ("192.0.2.7", 14550)),
        ("--ground-host localhost --host 0.0.0.0", "0.0.0.0", SDK, STATIONS),
        ("--lockstep", "127.0.0.1", None, None),
        ("--lockstep --ground-port 0 --host 0.0.0.0", "0.0.0.0", None, None),
    ],
)
def test_ports_are_px4s_unless_options_say_otherwise_and_none_in_lockstep(options, host, sdk, ground):
    assert ClientPorts.of(parse(options.split()), 4) == (host, sdk, ground)


@pytest.mark.parametrize("vehicles", [10, 15])
def test_port_of_ground_stations_gets_the_payload_unit_once_where_it_is_an_sdks_too(vehicles):
    with Swarm(CONFIG.with_vehicles(vehicles), seed=1, ground_address=STATIONS, sdk_address=SDK) as swarm:
        heard = Listening(swarm)
        heard.run(0.1)
    assert {i for i, _ in heard.of_unit(STATIONS)} == {1}
    sent = [m.time_boot_ms for i, m in heard.messages[STATIONS] if i == vehicles and m.get_type() == "ATTITUDE"]
    assert sent and len(set(sent)) == len(sent)


@pytest.mark.slow
def test_ground_on_another_address_is_sent_to_and_commands_from_there():
    """Another address of this machine stands for another machine."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ground:
        ground.bind(("127.0.0.2", 0))
        ground.settimeout(PATIENCE)
        host, port = ground.getsockname()
        with process("--base-port", 0, "--sdk-port", 0, "--ground-host", host, "--ground-port", port) as (
            _,
            _,
            vehicles,
        ):
            codec, acknowledged, heard = Codec(255, 190), set(), set()
            while len(acknowledged) < len(vehicles):
                datagram, sender = ground.recvfrom(65535)
                for received in codec.decode(datagram):
                    message = received.message
                    if message.get_type() == "COMMAND_ACK" and message.result == mavlink.MAV_RESULT_ACCEPTED:
                        acknowledged.add(received.system)
                    elif message.get_type() == "HEARTBEAT" and received.system not in (*heard, UNIT[0]):
                        heard.add(received.system)
                        arm = mavlink.MAVLink_command_long_message(received.system, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
                        ground.sendto(codec.encode(arm), sender)
    assert acknowledged == {1, 2, 3, 4}
