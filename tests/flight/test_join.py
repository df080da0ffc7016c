"""A ground that joins a swarm which has been up for long: no alarm, and times that begin with the ground."""

import logging

import pytest
from flights import HOP, InProcessFlight, system_file
from rich.console import Console

from gcs.app.flight_log import FlightLog
from gcs.app.progress import FlightProgress
from gcs.drivers.in_process import InProcessLockstep
from gcs.flight.phase import IN_AIR
from gcs.mission.read import read_mission
from vehicle_sim.faults.disturbances import Disturbances

WRAP = 2**32 * 1e-3
CLIMBED = 2.0
"""Seconds of the climb that are flown: the window of the clock's alarm then holds all from the first contact on."""


class LateStation:
    """A ground station whose own time is 0 when the world's is ``waited`` (s)."""

    def __init__(self, station, waited):
        self._station, self._waited = station, waited

    def __getattr__(self, name):
        return getattr(self._station, name)

    def receive_all(self, datagrams, now):
        self._station.receive_all(datagrams, now - self._waited)

    def datagrams_to_send(self, now):
        return self._station.datagrams_to_send(now - self._waited)

    def next_timer(self):
        return self._station.next_timer() + self._waited


class Joining(InProcessFlight):
    """A ground whose own time is 0 when it joins a swarm that has run without one for a while."""

    def fly_to_the_climb(self, waited, on_exchange):
        """Join after ``waited`` (s), and fly for a few seconds of the climb."""
        self.swarm.advance_to(waited)
        self.lockstep = InProcessLockstep(self.world, LateStation(self.station, waited))
        self.fly(on_exchange, until=waited + 20.0, stop=lambda: self.flight.phase in IN_AIR)
        assert self.flight.phase in IN_AIR
        self.fly(on_exchange, until=self.now + CLIMBED)


class Ahead(Disturbances):
    """No fault, but the clocks of all vehicles are ahead of the world's by as many seconds."""

    def __init__(self, seconds):
        super().__init__()
        self.seconds = seconds

    def clock_of(self, vehicle):
        return lambda now: now + self.seconds


@pytest.mark.slow
@pytest.mark.parametrize(("waited", "ahead"), [(14.0, 0.0), (0.3, 3600.0), (0.3, WRAP - 5.0), (0.3, WRAP - 0.4)])
def test_ground_that_joins_a_swarm_raises_no_alarm_and_counts_from_its_own_start(tmp_path, caplog, waited, ahead):
    system_file(tmp_path)
    (tmp_path / "hop.toml").write_text(HOP)
    mission = read_mission(tmp_path / "hop.toml")
    console = Console(record=True, width=120)
    with Joining(mission, tmp_path / "run", faults=Ahead(ahead)) as joining, caplog.at_level(logging.INFO):
        progress, log = FlightProgress(console), FlightLog(joining.station)
        joining.fly_to_the_climb(waited, lambda _: (progress.update(joining.flight), log.update()))
        assert joining.flight.failsafes.alarms.alarms == []
        assert joining.flight.time == pytest.approx(waited + ahead + joining.flight.elapsed, abs=1.0)
    lines = [line.split() for line in console.export_text().splitlines()]
    printed = {phase: float(time) for time, _, phase, *_ in lines}
    assert printed["connect"] == 0.0 and printed["check"] < 1.2 and printed["climb"] < 6.0
    logged = [record.getMessage() for record in caplog.records if "phase climb" in record.getMessage()]
    assert float(logged[0].split()[0]) == pytest.approx(printed["climb"], abs=0.01)
