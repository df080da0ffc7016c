"""Flights by the drivers of real time, over UDP, on a wall clock of the test's own: vehicles offer themselves."""

import contextlib
import math
import threading
from random import Random

import pytest
from flights import position_rmse, short_figure, truth_of
from virtual_time import VirtualTime

from gcs.app.fly import ground_station
from gcs.drivers.connection import Connection
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.realtime import run_in_real_time
from gcs.flight.failsafe import Failsafe
from gcs.mission.read import read_mission
from gcs.record.recorder import FlightRecorder
from vehicle_sim.app.drivers import RealTimeDriver
from vehicle_sim.app.ending import Ending
from vehicle_sim.app.swarm_sockets import SwarmSockets
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.truth_log import TruthLog

pytestmark = pytest.mark.slow

GROUND, WORLD = "ground", "world"


class GroundSocket(Connection):
    def __init__(self, time):
        super().__init__()
        self._time = time

    def wait(self, timeout):
        self._time.wait(GROUND, [self.socket], timeout)


class WorldsEnd(Ending):
    def __init__(self, time):
        super().__init__()
        self._time = time

    def wait(self, sockets, timeout):
        self._time.wait(WORLD, sockets, timeout)


def fly_in_real_time(mission, folder, stalls=()):
    """Both programs' loops, each in a thread: the flight, when it has ended."""
    folder.mkdir()
    time = VirtualTime([WORLD, GROUND], stalls)
    with contextlib.ExitStack() as opened:
        connection = opened.enter_context(contextlib.closing(GroundSocket(time)))
        ending = opened.enter_context(contextlib.closing(WorldsEnd(time)))
        sockets = opened.enter_context(SwarmSockets("127.0.0.1", 0, mission.system.team.vehicles, with_clock=False))
        swarm = opened.enter_context(
            Swarm(mission.system, seed=mission.seed, ground_address=connection.socket.getsockname())
        )
        swarm.record(TruthLog(folder, mission.system.team.vehicles))
        recorder = opened.enter_context(contextlib.closing(FlightRecorder(folder, 0.0)))
        station = ground_station(mission, [None] * mission.system.team.vehicles, recorder)

        def world():
            time.begin(WORLD)
            try:
                RealTimeDriver(swarm, sockets, ending, wall=time.read).run()
            finally:
                time.leave(WORLD)

        thread = threading.Thread(target=world)
        thread.start()
        time.begin(GROUND)
        try:
            run_in_real_time(station, connection, Interrupt(), mission.system.drivers, clock=time.read)
        finally:
            ending.request()
            time.leave(GROUND)
            thread.join()
    return station.flight


def check_flown(flight, folder, rmse):
    assert flight.completed, flight.reason
    assert position_rmse(folder, folder) <= rmse
    truth = truth_of(folder)
    assert truth["contacts"].max() == 0
    assert truth["payload_z_m"][-1] == pytest.approx(-0.3, abs=0.02)  # on the pad again


@pytest.fixture
def mission(tmp_path):
    return read_mission(short_figure(tmp_path, duration=3.0, altitude=1.5))


@pytest.mark.long
def test_real_time_flight_is_on_time(mission, tmp_path):
    flight = fly_in_real_time(mission, tmp_path / "run")
    check_flown(flight, tmp_path / "run", rmse=0.03)


def test_ground_without_enough_processor_lands_the_vehicles_before_control_is_lost(tmp_path):
    mission = read_mission(short_figure(tmp_path, duration=10.0, altitude=1.5))
    random, stalls, start = Random(1), [], 9.0
    while start < 30.0:
        stalls.append((GROUND, start, random.uniform(0.06, 0.14)))
        start += stalls[-1][2] + random.uniform(0.005, 0.03)
    flight = fly_in_real_time(mission, tmp_path / "run", stalls)
    assert flight.landed and Failsafe.CONTROL_OVERRUN in flight.failsafes.raised, flight.reason
    truth = truth_of(tmp_path / "run")
    assert truth["contacts"].max() == 0 and truth["payload_z_m"][-1] == pytest.approx(-0.3, abs=0.07)
    upright = 1.0 - 2.0 * (truth["payload_qx"] ** 2 + truth["payload_qy"] ** 2)
    assert upright.min() > math.cos(math.radians(5.0))


@pytest.mark.parametrize(("stalled", "duration"), [(GROUND, 0.4), pytest.param(WORLD, 0.4, marks=pytest.mark.long)])
def test_real_time_flight_completes_on_busy_machine(mission, tmp_path, stalled, duration):
    # Without the processor again and again, at moments that fit no other period.
    stalls = [(stalled, 2.0 + 2.37 * i, duration) for i in range(40)]
    flight = fly_in_real_time(mission, tmp_path / "run", stalls)
    check_flown(flight, tmp_path / "run", rmse=0.1)
