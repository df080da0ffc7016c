"""Foreign systems and damaged links beside a flight: no crash, no command accepted, and the flight is the same."""

from random import Random

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from flights import GROUND, InProcessFlight, address_of, check_within_limits, short_figure
from hostile_messages import hostile_to_ground, hostile_to_vehicle
from hostile_traffic import HostileTraffic, Traffic, with_random_contents

from gcs.flight.ground_station import GROUND_SYSTEM
from gcs.flight.phase import IN_AIR
from gcs.mavlink import px4

pytestmark = pytest.mark.slow

EXCHANGES = 1000  # in which they come; the flight has some more
VEHICLE = 1  # the team's time is its time
OTHER_HOST = ("10.0.0.66", 40002)
AGAINST_VEHICLE = [
    (OTHER_HOST, GROUND_SYSTEM),
    (OTHER_HOST, 42),
    ((GROUND[0], GROUND[1] + 1), GROUND_SYSTEM),
    (address_of(2), 2),
    (GROUND, 42),
    (GROUND, VEHICLE),
]
AGAINST_GROUND = [
    (OTHER_HOST, VEHICLE),
    (OTHER_HOST, 77),
    (address_of(2), VEHICLE),
    (address_of(VEHICLE), 2),
    (address_of(VEHICLE), 77),
    (address_of(VEHICLE), GROUND_SYSTEM),
]


class Storm:
    """Hostile traffic at every moment in the air, as much to one vehicle as to the ground."""

    def __init__(self, seed, datagrams):
        self.traffic = Traffic(VEHICLE)
        self.left = datagrams  # to the vehicle, and as many to the ground
        self._at_once = -(-datagrams // EXCHANGES)
        self._to_vehicle = HostileTraffic(
            seed, self.traffic.to_it, GROUND, AGAINST_VEHICLE, hostile_to_vehicle(VEHICLE), VEHICLE
        )
        self._to_ground = HostileTraffic(
            seed + 1, self.traffic.from_it, address_of(VEHICLE), AGAINST_GROUND, hostile_to_ground(), GROUND_SYSTEM,
            [(address_of(2), px4.PAYLOAD_UNIT_SYSTEM)],
        )  # fmt: skip
        self._last = -1.0

    def __call__(self, in_process):
        now = in_process.now
        if in_process.flight.phase not in IN_AIR or now <= self._last:
            return
        self._last = now
        vehicle = in_process.swarm.vehicles[VEHICLE - 1]
        before = state(vehicle)
        for _ in range(min(self._at_once, self.left)):
            vehicle.receive(*self._to_vehicle.draw(), now)
            in_process.station.receive(*self._to_ground.draw(), now)
            self.left -= 1
        assert state(vehicle) == before
        assert vehicle.autopilot.armed
        assert vehicle.autopilot.mode == px4.MODE_OFFBOARD


def state(vehicle):
    """State of a vehicle that hostile commands could change."""
    autopilot, table = vehicle.autopilot, vehicle.parameters
    return (
        autopilot.changes, autopilot.armed, autopilot.mode, autopilot.failsafe, autopilot.state.stop_plan,
        [table.by_index(i).value for i in range(len(table))],
    )  # fmt: skip


@pytest.mark.parametrize("datagrams", [20_000, pytest.param(200_000, marks=pytest.mark.long)])
def test_hostile_datagrams_leave_flight_unchanged(datagrams, tmp_path):
    mission = short_figure(tmp_path, duration=3.0, altitude=1.5)
    with InProcessFlight(mission, tmp_path / "calm", seed=3) as calm:
        calm.fly()
        check_within_limits(calm.summary())
    storm = Storm(5, datagrams)
    with InProcessFlight(mission, tmp_path / "storm", seed=3, faults=storm.traffic) as flight:
        flight.fly(storm)
        check_within_limits(flight.summary())
    assert storm.left == 0
    assert flight.swarm.vehicles[VEHICLE - 1].refused_setpoints > 0.01 * datagrams
    assert flight.station.router.refused > 0.9 * datagrams
    for name in ("truth.csv", "estimate.csv"):
        assert (tmp_path / "storm" / name).read_bytes() == (tmp_path / "calm" / name).read_bytes()


def test_ground_tolerates_any_message_of_the_dialect(tmp_path):
    """Every message, well formed, with whatever its fields may hold, with the ids and address of a vehicle."""
    random = Random(4)
    writer = mavlink.MAVLink(None, VEHICLE, 1)
    with InProcessFlight(short_figure(tmp_path), tmp_path / "run") as flight:
        flight.fly(stop=lambda: flight.flight.phase.value == "fly")
        for kind in mavlink.mavlink_map.values():
            for _ in range(5):
                datagram = with_random_contents(kind, random.randbytes(kind.unpacker.size), GROUND_SYSTEM, writer)
                flight.station.receive(datagram, address_of(VEHICLE), flight.now)
        flight.fly(until=flight.now + 1.0)
