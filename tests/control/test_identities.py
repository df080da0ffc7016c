"""System ids and addresses at the ground: ids that two vehicles share, routers, vehicles that are missing."""

import contextlib

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from flights import GROUND, MISSIONS, address_of

from gcs.app.fly import ground_station
from gcs.app.fly_options import FlyOptions
from gcs.config.flight_settings import DEFAULTS
from gcs.flight.phase import Phase
from gcs.mavlink import px4
from gcs.mavlink.address import parse_url
from gcs.mavlink.codec import Codec
from gcs.mission.read import read_mission
from gcs.record.recorder import FlightRecorder
from vehicle_sim.swarm import Swarm

MISSION = read_mission(MISSIONS / "hop.toml")
TEAM = MISSION.system.team.vehicles
PAYLOAD_UNIT = px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT
ROUTER, SECOND = ("10.0.0.1", 14550), ("10.0.0.66", 14580)
WINDOW = DEFAULTS.failsafe.duplicate_id_window


@contextlib.contextmanager
def station(folder, addresses):
    with contextlib.closing(FlightRecorder(folder, 0.0)) as recorder:
        yield ground_station(MISSION, addresses, recorder)


def run(ground, until, arrivals=()):
    """Step the ground to ``until`` (s); ``arrivals``: (time, message, sender's id or pair, address)."""
    now, pending = 0.0, sorted(arrivals, key=lambda each: each[0])
    while now <= until and not ground.ended:
        while pending and pending[0][0] <= now:
            _, message, sender, address = pending.pop(0)
            pair = sender if isinstance(sender, tuple) else (sender, 1)
            ground.receive(Codec(*pair).encode(message), address, now)
        ground.datagrams_to_send(now)
        now += 0.02
    return ground.flight.reason


def beats(system_id, address, times):
    message = mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 3, 3)
    return [(time, message, system_id, address) for time in times]


@pytest.mark.parametrize("known", [True, False], ids=["named", "calling in"])
def test_one_system_id_from_two_addresses_is_refused_at_once_with_both_named(tmp_path, known):
    addresses = [address_of(i) if known else None for i in range(1, TEAM + 1)]
    with station(tmp_path, addresses) as ground:
        arrivals = beats(2, address_of(2), (0.0, 1.0)) + beats(2, SECOND, (0.5,))
        reason = run(ground, 1.2, arrivals)
        assert ground.ended
        [alarm] = ground.flight.failsafes.alarms.alarms
    assert reason == (
        "system id 2 is heard from 127.0.0.1:14581 and from 10.0.0.66:14580: every vehicle needs one of its own"
    )
    assert (alarm.source, alarm.code.code) == ("vehicle 2", "duplicate_system_id")


@pytest.mark.parametrize(
    ("other", "time"),
    [
        ((2, 1), 1.0 + WINDOW + 0.1),
        ((77, 1), 1.1),
        ((2, mavlink.MAV_COMP_ID_ONBOARD_COMPUTER), 1.1),
        (PAYLOAD_UNIT, 1.1),
    ],
    ids=["later", "another id", "a companion", "the payload unit"],
)
def test_another_sender_is_no_second_vehicle(tmp_path, other, time):
    arrivals = beats(2, address_of(2), (0.0, 1.0)) + beats(other, SECOND, (time,))
    with station(tmp_path, [address_of(i) for i in range(1, TEAM + 1)]) as ground:
        assert run(ground, time + 0.2, arrivals) == ""


def fly_until_armed(ground, swarm, sender):
    """Exchange datagrams, the vehicles' by way of the address ``sender(vehicle)``; the ground's go to all there."""
    now = 0.0
    while ground.flight.phase in (Phase.CONNECT, Phase.CHECK) and not ground.ended:
        swarm.advance_to(now)
        for i, datagram, address in swarm.datagrams_to_send(now):
            if address == GROUND:
                ground.receive(datagram, sender(i), now)
        for datagram, address in ground.datagrams_to_send(now):
            for i in range(1, TEAM + 1):
                if sender(i) == address:
                    swarm.receive(i, datagram, GROUND, now)
        due = [timer for timer in (swarm.next_timer(), ground.next_timer()) if timer is not None]
        now = max(min(due), now)
        assert now < 20.0
    return ground.flight.phase, ground.flight.reason


def test_several_system_ids_from_one_address_are_a_routers_and_are_taken(tmp_path):
    addresses = FlyOptions(MISSIONS / "hop.toml", connect=(parse_url("udp://10.0.0.1:14550"),)).addresses(TEAM)
    assert addresses == [ROUTER] * TEAM
    for named in (addresses, [None] * TEAM):
        folder = tmp_path / str(named[0])
        folder.mkdir()
        with Swarm(MISSION.system, seed=1, ground_address=GROUND) as swarm, station(folder, named) as ground:
            assert fly_until_armed(ground, swarm, lambda i: ROUTER) == (Phase.ARM, "")
            assert {link.address for link in ground.links} == {ROUTER}


def test_ground_that_listens_where_ground_stations_do_gets_the_payload_unit_from_every_vehicle(tmp_path):
    with Swarm(MISSION.system, seed=1, ground_address=GROUND) as swarm, station(tmp_path, [None] * TEAM) as ground:
        assert fly_until_armed(ground, swarm, address_of) == (Phase.ARM, "")
        assert len({link.payload_received_at for link in ground.links}) == 1


def test_team_of_which_one_vehicle_is_missing_is_refused_with_their_numbers(tmp_path):
    addresses = [address_of(i) for i in range(1, TEAM + 1)]
    with Swarm(MISSION.system.with_vehicles(3), seed=1) as swarm, station(tmp_path, addresses) as ground:
        phase, reason = fly_until_armed(ground, ThreeOfFour(swarm), address_of)
    assert phase is Phase.ENDED
    assert reason == "3 of 4 vehicles connected: vehicle 4 does not answer at 127.0.0.1:14583"


class ThreeOfFour:
    """A swarm of three, to which what is for a fourth does not come."""

    def __init__(self, swarm):
        self._swarm = swarm
        self.advance_to, self.datagrams_to_send, self.next_timer = (
            swarm.advance_to, swarm.datagrams_to_send, swarm.next_timer,
        )  # fmt: skip

    def receive(self, vehicle, datagram, sender, now):
        if vehicle < 4:
            self._swarm.receive(vehicle, datagram, sender, now)


@pytest.mark.parametrize(
    ("connect", "vehicles", "addresses"),
    [
        ((), 3, [("127.0.0.1", 14580), ("127.0.0.1", 14581), ("127.0.0.1", 14582)]),
        (("udp://10.0.0.7:14580", "udpout://10.0.0.8:9"), 2, [("10.0.0.7", 14580), ("10.0.0.8", 9)]),
        (("udpin://0.0.0.0:14550",), 2, [None, None]),
        (("udpin://0.0.0.0:14540",), 2, [None, None]),
    ],
)
def test_addresses_are_those_named_or_the_ports_where_vehicles_listen(connect, vehicles, addresses):
    options = FlyOptions(MISSIONS / "hop.toml", connect=tuple(map(parse_url, connect)))
    assert options.addresses(vehicles) == addresses


def test_clock_of_a_swarm_in_lockstep_is_at_the_port_before_its_vehicles():
    assert FlyOptions(MISSIONS / "hop.toml", connect=()).clock_address() == ("127.0.0.1", 14579)
    urls = tuple(parse_url(f"udp://10.0.0.7:{port}") for port in (703, 702, 704))
    assert FlyOptions(MISSIONS / "hop.toml", connect=urls).clock_address() == ("10.0.0.7", 701)
