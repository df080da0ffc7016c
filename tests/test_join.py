"""A ground that joins a swarm which has been up for long: no alarm, and times that begin with the ground."""

import logging

import pytest
from flight_in_process import GROUND, HOP, InProcessFlight, address_of, system_file
from rich.console import Console

from gcs.app.flight_log import FlightLog
from gcs.app.progress import FlightProgress
from gcs.flight.phase import IN_AIR
from gcs.mission.read import read_mission
from vehicle_sim.faults.disturbances import Disturbances

WRAP = 2**32 * 1e-3
CLIMBED = 2.0
"""Seconds of the climb that are flown: the window of the clock's alarm then holds all from the first contact on."""


class Joining(InProcessFlight):
    """A ground whose own time is 0 when it joins a swarm that has run without one for ``waited`` seconds."""

    waited = 0.0

    def fly_to_the_climb(self, on_exchange=lambda in_process: None):
        """Fly for a few seconds of the climb, as :meth:`InProcessFlight.fly` does."""
        swarm, station, airborne = self.swarm, self.station, None
        self.now = self.waited
        while airborne is None or self.now < airborne + CLIMBED:
            swarm.advance_to(self.now)
            ground = self.now - self.waited
            telemetry = list(swarm.datagrams_to_send(self.now))
            received = [(datagram, address_of(i)) for i, datagram, address in telemetry if address == GROUND]
            station.receive_all(received, ground)
            for datagram, address in station.datagrams_to_send(ground):
                swarm.receive(address[1] - 14579, datagram, GROUND, self.now)
            on_exchange(self)
            if airborne is None and self.flight.phase in IN_AIR:
                airborne = self.now
            due = [t for t in (swarm.next_timer(), station.next_timer() + self.waited) if t is not None]
            self.now = max(min(due), self.now)
            assert self.now < self.waited + 20.0
        return self


class Ahead(Disturbances):
    """No fault, but the clocks of all vehicles are ahead of the world's by as many seconds."""

    def __init__(self, seconds):
        self.seconds = seconds

    def clock_of(self, vehicle):
        return lambda now: now + self.seconds


@pytest.mark.slow
@pytest.mark.parametrize(
    ("waited", "ahead"), [(14.0, 0.0), (0.3, 60.0), (0.3, 3600.0), (0.3, WRAP - 5.0), (0.3, WRAP - 0.4)]
)
def test_ground_that_joins_a_swarm_raises_no_alarm_and_counts_from_its_own_start(tmp_path, caplog, waited, ahead):
    system_file(tmp_path)
    (tmp_path / "hop.toml").write_text(HOP)
    mission = read_mission(tmp_path / "hop.toml")
    console = Console(record=True, width=120)
    with Joining(mission, tmp_path / "run", faults=Ahead(ahead)) as joining, caplog.at_level(logging.INFO):
        joining.waited = waited
        progress, log = FlightProgress(console), FlightLog(joining.station)
        joining.fly_to_the_climb(lambda _: (progress.update(joining.flight), log.update()))
        assert joining.flight.failsafes.alarms.alarms == []
        assert joining.flight.time == pytest.approx(waited + ahead + joining.flight.elapsed, abs=1.0)
    lines = [line.split() for line in console.export_text().splitlines()]
    printed = {phase: float(time) for time, _, phase, *_ in lines}
    assert printed["connect"] == 0.0 and printed["check"] < 1.2 and printed["climb"] < 6.0
    logged = [record.getMessage() for record in caplog.records if "phase climb" in record.getMessage()]
    assert float(logged[0].split()[0]) == pytest.approx(printed["climb"], abs=0.01)
