"""Alarms: code, time and source."""

import json
from dataclasses import replace

import pytest
from flights import HOP, InProcessFlight, system_file

from gcs.campaign.faults.judgement import detection, first_start
from gcs.config.flight_settings import DEFAULTS
from gcs.flight.alarms import AlarmLog
from gcs.flight.detectors import MonitorAlarm
from gcs.mavlink.link_statistics import LinkStatistics
from gcs.mavlink.settings import LinkSettings
from gcs.mission.model import Fault
from gcs.mission.read import read_mission
from gcs.record.reader import read_table
from gcs.record.tables import ALARM_COLUMNS
from vehicle_sim.faults.fault_injector import FaultInjector


def test_alarm_log_records_a_lasting_condition_once():
    sink = []
    log = AlarmLog(sink.append)
    for k in range(100):
        log.raise_alarm(0.05 * k, "vehicle 2", MonitorAlarm.TELEMETRY_TIMEOUT, f"{k}")
    assert [(alarm.time, alarm.text) for alarm in log.alarms] == [(0.0, "0")]
    log.raise_alarm(5.0, "vehicle 3", MonitorAlarm.TELEMETRY_TIMEOUT)
    log.raise_alarm(5.0, "vehicle 2", MonitorAlarm.STUCK_SENSOR)
    log.raise_alarm(4.95 + DEFAULTS.monitor.hold_time + 0.05, "vehicle 2", MonitorAlarm.TELEMETRY_TIMEOUT)
    raised = [(alarm.source, alarm.code.code) for alarm in log.alarms[1:]]
    expected = [("vehicle 3", "telemetry_timeout"), ("vehicle 2", "stuck_sensor"), ("vehicle 2", "telemetry_timeout")]
    assert raised == expected
    assert sink == log.alarms


def event_counts(numbers, interval=0.01):
    link = LinkStatistics()
    for k, number in enumerate(numbers):
        link.message(number % 256, interval * k)
    link.settle(interval * len(numbers) + 2.0 * LinkSettings.reordering_time)
    return link.lost, link.reordered, link.duplicated


@pytest.mark.parametrize(
    ("numbers", "counts"),
    [
        ([*range(200, 600)], (0, 0, 0)),
        ([*range(10), *range(11, 300)], (1, 0, 0)),
        ([*range(10), *range(25, 300)], (1, 0, 0)),  # consecutive losses
        ([0, 1, 3, 2, 4, 5], (0, 1, 0)),
        ([0, 1, 4, 5, 2, 3, 6], (0, 2, 0)),
        ([0, 1, 1, 2, 3, 2, 3, 4], (0, 0, 3)),
        ([250, 255, 254, 256, 257], (1, 1, 0)),
    ],
)
def test_lost_and_reordered_messages_follow_from_sequence_numbers(numbers, counts):
    assert event_counts(numbers) == counts


def test_gap_after_a_loss_is_a_loss_at_once_until_a_message_comes_late():
    link, wait = LinkStatistics(), LinkSettings.reordering_time
    lost = []
    for number, now in [
        (0, 0.0),
        (2, 0.0),
        (3, wait),
        (5, 1.01 * wait),
        (8, 1.02 * wait),
        (7, 1.03 * wait),
        (10, 1.04 * wait),
    ]:
        link.message(number, now)
        link.settle(now)
        lost.append(link.lost)
    assert lost == [0, 0, 0, 2, 3, 3, 3] and link.reordered == 1
    link.settle(2.05 * wait)
    assert link.lost == 4


def write_records(folder, rows, starts):
    lines = [",".join(ALARM_COLUMNS), *(f"{time},vehicle 2,measurements_rejected,warning,position" for time in rows)]
    (folder / "alarms.csv").write_text("\n".join(lines) + "\n")
    faults = [{"activations": [] if start is None else [[start, None]]} for start in starts]
    (folder / "faults.json").write_text(json.dumps({"take_off_s": 3.0, "end_s": 20.0, "faults": faults}))


def test_detection_counts_from_the_first_fault_of_the_case(tmp_path):
    write_records(tmp_path, [4.0, 7.5, 9.0], [2.0, None, 5.0, 4.0])
    assert first_start(tmp_path) == 5.0
    assert first_start(tmp_path, 3) == 7.0
    found = detection(tmp_path, first_start(tmp_path, 3))
    assert (found.after, found.alarm, found.false) == (0.5, "measurements_rejected, vehicle 2", 1)


def test_detection_without_faults_or_records(tmp_path):
    assert detection(tmp_path, first_start(tmp_path, 1)).false is None
    write_records(tmp_path, [4.0], [None])
    assert detection(tmp_path, first_start(tmp_path, 1)) == replace(
        detection(tmp_path, first_start(tmp_path, 1)), after=None, alarm="", false=1
    )
    (tmp_path / "faults.json").unlink()
    assert detection(tmp_path, first_start(tmp_path, 0)).false == 1


def hop(folder, *faults):
    system_file(folder)
    path = folder / "hop.toml"
    path.write_text(HOP.replace("hold = 1.0", "hold = 3.0"))
    return replace(read_mission(path), faults=faults)


@pytest.mark.slow
def test_biased_position_raises_an_alarm_of_its_vehicle_at_once(tmp_path):
    fault = Fault("bias", 3.0, vehicles=(3,), settings={"channel": "position", "amount": 0.3, "axes": ["x"]})
    mission = hop(tmp_path, fault)
    injector = FaultInjector(mission.faults, 52, mission.system)
    with InProcessFlight(mission, tmp_path / "run", seed=52, faults=injector) as flight:
        flight.fly()
    begin = injector.take_off + fault.start
    rows = read_table(tmp_path / "run" / "alarms.csv")
    assert (rows["source"][0], rows["code"][0]) == ("vehicle 3", "measurements_rejected")
    assert 0.0 < rows["time_s"][0] - begin < 0.5
    assert set(rows["source"]) == {"vehicle 3"}
    # Each alarm once: the position does not fit, for the gate, for its noise and its mean, and then it is isolated.
    assert len(rows["code"]) == len(set(rows["code"])) and rows["code"][-1] == "channel_isolated"


@pytest.mark.slow
@pytest.mark.parametrize("start", [3.044, *(pytest.param(start, marks=pytest.mark.long) for start in (3.0, 3.04))])
def test_flapping_link_raises_telemetry_timeout_at_any_phase(tmp_path, start):
    """Down for 0.2 s in every 1.2 s, of which steps and samples are whole shares: always at the same moment between."""
    fault = Fault("flapping", start, vehicles=(2,), settings={"down": 0.2, "up": 1.0})
    mission = hop(tmp_path, fault)
    injector = FaultInjector(mission.faults, 53, mission.system)
    with InProcessFlight(mission, tmp_path / "run", seed=53, faults=injector) as flight:
        raised = flight.flight.failsafes.alarms.alarms
        flight.fly(stop=lambda: any(alarm.code is MonitorAlarm.TELEMETRY_TIMEOUT for alarm in raised))
    begin = injector.take_off + start
    rows = read_table(tmp_path / "run" / "alarms.csv")
    found = rows["time_s"][rows["code"] == "telemetry_timeout"]
    assert len(found) and 0.0 < found[0] - begin < 0.4
