"""Flights by the drivers of real time, over UDP, on a wall clock of the test's own: vehicles offer themselves."""

import contextlib
import math
from random import Random

import pytest
from flights import position_rmse, short_figure, truth_of
from virtual_time import GROUND, WORLD, VirtualTime, run_ground, swarm_in_real_time

from gcs.app.fly import ground_station
from gcs.drivers.connection import Connection
from gcs.drivers.interrupt import Interrupt
from gcs.flight.failsafe import Failsafe
from gcs.mission.read import read_mission
from gcs.record.recorder import FlightRecorder

pytestmark = pytest.mark.slow


class GroundSocket(Connection):
    def __init__(self, time):
        super().__init__()
        self._time = time

    def wait(self, timeout):
        self._time.wait(GROUND, [self.socket], timeout)


def fly_in_real_time(mission, folder, stalls=()):
    """Both programs' loops, each in a thread: the flight, when it has ended."""
    folder.mkdir()
    time = VirtualTime([WORLD, GROUND], stalls)
    with contextlib.ExitStack() as opened:
        connection = opened.enter_context(contextlib.closing(GroundSocket(time)))
        recorder = opened.enter_context(contextlib.closing(FlightRecorder(folder, 0.0)))
        station = ground_station(mission, [None] * mission.system.team.vehicles, recorder)
        opened.enter_context(swarm_in_real_time(time, mission, folder, connection.socket.getsockname()))
        run_ground(time, station, connection, Interrupt(), mission.system.drivers)
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
