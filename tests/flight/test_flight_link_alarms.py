"""Alarms of links and clocks in flight: each named beside the others, and congestion as what it is."""

import pytest
from flights import HOP, InProcessFlight, system_file

from gcs.flight.detectors import MonitorAlarm
from gcs.mission.model import Fault
from gcs.mission.read import read_mission
from vehicle_sim.faults.fault_injector import FaultInjector

pytestmark = pytest.mark.slow

CLOCK, CONGESTION = MonitorAlarm.CLOCK_ERROR, MonitorAlarm.LINK_CONGESTION
ALL = {f"vehicle {i}" for i in range(1, 5)}


def hop(folder, *faults):
    """Alarms of a hop with faults, by code: {source: time of the first (s after take-off)}; and how it ended."""
    system_file(folder)
    (folder / "hop.toml").write_text(HOP)
    mission = read_mission(folder / "hop.toml")
    injector = FaultInjector(faults, mission.seed, mission.system)
    with InProcessFlight(mission, folder / "run", faults=injector) as flight:
        flight.fly()
        took_off = injector.take_off
        found = {}
        for alarm in flight.flight.failsafes.alarms.alarms:
            found.setdefault(alarm.code, {}).setdefault(alarm.source, alarm.time - took_off)
        return found, flight.flight.reason


@pytest.mark.parametrize("rate", [5760.0, pytest.param(11520.0, marks=pytest.mark.long)])
def test_radio_of_a_low_rate_is_named_as_congestion_and_no_clock_is_blamed(tmp_path, rate):
    cap = Fault(kind="bandwidth_cap", start=0.0, settings={"rate": rate, "queue": 2048})
    alarms, reason = hop(tmp_path, cap)
    assert CLOCK not in alarms
    assert alarms[CONGESTION].keys() == ALL
    assert max(alarms[CONGESTION].values()) < 3.0
    assert bool(reason) == (rate < 6000.0)
