"""Detectors of the flight monitor: alarms raised of the innovations, of the estimator's health and of the links."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from clock_scene import TimedLink, constant, random_latency

from gcs.config import SystemConfig
from gcs.config.flight_settings import DEFAULTS
from gcs.flight import stack
from gcs.flight.alarms import AlarmLog
from gcs.flight.detectors import LinkTiming, MonitorAlarm, detectors
from gcs.flight.monitor_step import MonitorStep
from gcs.mavlink import px4
from gcs.mavlink.clock import RemoteClock
from gcs.mavlink.id_check import SystemIdCheck
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Estimate, InnovationRecord, Position
from idc_controller.model.linear import LinearModel
from idc_controller.safety.filter_protocol import SafetyReport

SYSTEM = SystemConfig()
MODEL = LinearModel(SYSTEM.parameters())
N = SYSTEM.parameters().number_of_uavs
NAMES = (*(f"vehicle {i}" for i in range(1, N + 1)), "payload")
KEYS = (*((uav, Position) for uav in range(N)), (PAYLOAD, Position))


NOTHING_SEEN = SimpleNamespace(
    placement=SimpleNamespace(range_sensors=SimpleNamespace(silent=(), displaced=())),
    take_deleted_tracks=list,
    map_offsets={},
)


class Monitored:
    """Steps at 20 Hz of a flight whose telemetry is complete, with normal innovations of the positions."""

    def __init__(self):
        self.links = tuple(VehicleLink(i, None) for i in range(1, N + 1))
        self.flight = SimpleNamespace(
            mission=SimpleNamespace(system=SYSTEM),
            system=SimpleNamespace(team=SimpleNamespace(links=self.links), obstacle_map=NOTHING_SEEN),
            control=SimpleNamespace(estimator=stack.estimator(SYSTEM, MODEL)),
            landing_place=SimpleNamespace(is_waited_for=False, taken=None),
            ground_legs=None,
        )
        self.log, self.id_check = AlarmLog(), SystemIdCheck(N)
        self.detectors = detectors(self.flight, DEFAULTS.monitor)
        self.random, self.steps = np.random.default_rng(7), 0
        self.safety = SafetyReport()

    def step(
        self,
        rejected=(),
        reset=False,
        force=(0.0, 0.0, 0.0),
        in_air=True,
        clear=True,
        steady=True,
        keys=KEYS,
        payload=True,
    ):
        now = 0.05 * self.steps
        for link in self.links:
            link.attitude_received_at = link.position_received_at = now
            link.payload_received_at = now if payload else 0.0
        normal = self.random.standard_normal(6 * len(keys))
        sizes = np.full(len(keys), 6)
        innovations = InnovationRecord(
            now, float(normal @ normal), len(normal), rejected, reset, keys, sizes, normal, np.zeros((len(keys), 2))
        )
        size = MODEL.layout.size
        estimate = Estimate(
            now, np.zeros(size), np.array(force), np.zeros((N, 3)), 0.0, np.eye(3), lambda: np.eye(size + 2 * N + 4),
            (innovations,),
        )  # fmt: skip
        # On its plan: a level payload at rest below the vehicles.
        decision = SimpleNamespace(safety=self.safety, flat=SimpleNamespace(payload=np.zeros((5, 1, 3))))
        record = SimpleNamespace(estimate=estimate, decision=decision)
        step = MonitorStep(
            now, now, self.flight, self.id_check, self.log, record, in_air, NAMES, clear=clear, steady=steady
        )
        for detector in self.detectors:
            detector(step)
        self.steps += 1

    def raised(self, steps=40, **options):
        for _ in range(steps):
            self.step(**options)
        return [(alarm.source, alarm.code) for alarm in self.log.alarms]


def test_no_alarm_of_normal_innovations():
    assert Monitored().raised() == []


def test_rejected_measurements_raise_an_alarm_of_their_source_clear_of_the_ground_only():
    rejected = ((1, Position),)
    assert Monitored().raised(rejected=rejected) == [("vehicle 2", MonitorAlarm.MEASUREMENTS_REJECTED)]
    assert Monitored().raised(rejected=rejected, clear=False) == []


def test_payload_that_no_vehicle_relays_any_more_raises_an_alarm():
    assert ("payload", MonitorAlarm.TELEMETRY_TIMEOUT) in Monitored().raised(payload=False)


def test_rejected_attitudes_raise_an_alarm_but_not_in_a_hard_manoeuvre():
    attitudes = tuple((uav, Attitude) for uav in range(N))
    options = {"steps": 80, "rejected": attitudes[1:2], "keys": attitudes}
    assert Monitored().raised(**options) == [("vehicle 2", MonitorAlarm.MEASUREMENTS_REJECTED)]
    assert Monitored().raised(**options, steady=False) == []


def test_repeated_covariance_resets_raise_an_alarm_but_not_in_a_hard_manoeuvre():
    count = DEFAULTS.monitor.event_count
    alarm = [("team", MonitorAlarm.COVARIANCE_RESET)]
    assert Monitored().raised(steps=count - 1, reset=True) == []
    assert Monitored().raised(steps=count, reset=True) == alarm
    assert Monitored().raised(steps=count, reset=True, steady=False) == []


@pytest.mark.parametrize(("size", "expected"), [(4.9, []), (5.0, [("payload", MonitorAlarm.DISTURBANCE_FORCE)])])
def test_disturbance_force_beyond_its_covariance_raises_an_alarm(size, expected):
    assert Monitored().raised(steps=1, force=(0.0, size, 0.0)) == expected


def test_failed_range_sensor_raises_an_alarm_in_the_air_only():
    for in_air, expected in ((True, [("vehicle 3", MonitorAlarm.RANGE_SENSOR_FAILED)]), (False, [])):
        monitored = Monitored()
        monitored.links[2].status.obstacle_sensing_valid = False
        assert monitored.raised(steps=2, in_air=in_air, clear=in_air) == expected


@pytest.mark.parametrize(
    ("sensors", "code"),
    [
        ({"silent": {1}, "displaced": set()}, MonitorAlarm.RANGE_SENSOR_SILENT),
        ({"silent": set(), "displaced": {1}}, MonitorAlarm.RANGE_SENSOR_DISPLACED),
    ],
    ids=lambda value: value.code if isinstance(value, MonitorAlarm) else "",
)
def test_silent_and_displaced_range_sensors_raise_alarms(sensors, code):
    monitored, found = Monitored(), SimpleNamespace(range_sensors=SimpleNamespace(**sensors))
    monitored.flight.system.obstacle_map = SimpleNamespace(placement=found, map_offsets={}, take_deleted_tracks=list)
    assert monitored.raised(steps=2) == [("vehicle 2", code)]


EVENTS = {
    MonitorAlarm.MESSAGES_LOST: lambda link: vars(link.statistics).update(lost=link.statistics.lost + 1),
    MonitorAlarm.MESSAGES_CORRUPTED: lambda link: vars(link.statistics).update(damaged=link.statistics.damaged + 1),
    MonitorAlarm.VALUES_NOT_FINITE: lambda link: link.statistics.add_not_finite(px4.AUTOPILOT_COMPONENT),
    MonitorAlarm.SETPOINTS_LOST: lambda link: vars(link.setpoints).update(lost=link.setpoints.lost + 1),
}


@pytest.mark.parametrize("code", EVENTS, ids=lambda code: code.code)
def test_events_on_a_link_raise_an_alarm_when_frequent_within_their_window(code):
    settings = DEFAULTS.monitor
    window = settings.setpoint_window if code is MonitorAlarm.SETPOINTS_LOST else settings.event_window
    for spacing, expected in ((0.8, [("vehicle 1", code)]), (1.2, [])):
        monitored = Monitored()
        between = round(spacing * window / (settings.event_count - 1) / 0.05)
        for _ in range(settings.event_count):
            EVENTS[code](monitored.links[0])
            raised = monitored.raised(steps=between)
        assert raised == expected


def test_payload_measurements_that_are_no_numbers_raise_an_alarm_of_the_payload():
    monitored = Monitored()
    for _ in range(DEFAULTS.monitor.event_count):
        monitored.links[1].statistics.add_not_finite(px4.PAYLOAD_UNIT_COMPONENT)
    assert monitored.raised(steps=1) == [("payload", MonitorAlarm.VALUES_NOT_FINITE)]


PERIOD = 0.05
LATENCY, JITTER = DEFAULTS.monitor.latency_periods * PERIOD, DEFAULTS.monitor.jitter_periods * PERIOD
CLOCK = DEFAULTS.monitor.clock_error


def timing_alarms(out=0.0, back=0.0, step=0.0, in_air=True, until=12.0):
    """Alarms, with the first text of each, of a link of constant latencies (s); the clock steps by ``step`` at 10 s."""
    timed = TimedLink(lambda t: 7.0 + t + (step if t >= 10.0 else 0.0), constant(out), constant(back))
    timed.run(until, in_air_from=0.0 if in_air else math.inf)
    return {alarm.code: alarm.text for alarm in reversed(timed.log.alarms)}


def test_latency_of_a_link_beyond_its_limit_raises_an_alarm():
    expected = {MonitorAlarm.LINK_LATENCY: "link latency is 30 ms (limit 25 ms)"}
    assert timing_alarms(0.03, 0.03) == timing_alarms(0.06, 0.0) == expected
    assert timing_alarms(1.01 * LATENCY, 1.01 * LATENCY).keys() == expected.keys()
    assert timing_alarms(0.99 * LATENCY, 0.99 * LATENCY) == timing_alarms(0.03, 0.03, in_air=False) == {}


@pytest.mark.parametrize("latency", [0.0, 0.06])
@pytest.mark.parametrize("spread", [0.0, 0.06])
@pytest.mark.parametrize("step", [0.0, 0.5])
def test_alarms_of_latency_jitter_and_clock_do_not_hide_each_other(latency, spread, step):
    timed = TimedLink(
        lambda t: 7.0 + t + (step if t >= 10.0 else 0.0),
        random_latency(1, spread, latency), random_latency(2, spread, latency),
    )  # fmt: skip
    raised = {code for code, _ in timed.run(14.0)}
    assert (MonitorAlarm.LINK_LATENCY in raised) == (latency + 0.5 * spread > LATENCY)
    assert (MonitorAlarm.LINK_JITTER in raised) == (spread > 0.0)
    assert (MonitorAlarm.CLOCK_ERROR in raised) == (step > 0.0)


def test_jitter_of_a_link_beyond_its_limit_raises_an_alarm():
    clock, good = RemoteClock(), RemoteClock()
    for k in range(10):
        clock.add_answer(clock.request(0.1 * k), 0.1 * k + (0.041 if k % 2 else 0.001))
        good.add_answer(good.request(0.1 * k), 0.1 * k + (0.025 if k % 2 else 0.001))
    log, detector = AlarmLog(), LinkTiming(DEFAULTS.monitor, PERIOD, 2)
    links = [SimpleNamespace(clock=good), SimpleNamespace(clock=clock)]
    flight = SimpleNamespace(system=SimpleNamespace(team=SimpleNamespace(links=links)))
    detector(MonitorStep(2.0, 2.0, flight, None, log, None, True, NAMES, clear=True, steady=True))
    expected = ("vehicle 2", MonitorAlarm.LINK_JITTER, "link latency varies by 20 ms (limit 12.5 ms)")
    assert [(alarm.source, alarm.code, alarm.text) for alarm in log.alarms] == [expected]


def test_clock_that_moves_beyond_its_limit_raises_an_alarm_in_the_air():
    assert timing_alarms(step=0.02) == {MonitorAlarm.CLOCK_ERROR: "clock moved ahead by 20 ms or more"}
    assert timing_alarms(step=-0.02) == {MonitorAlarm.CLOCK_ERROR: "clock was set back by 20 ms or more"}
    for step in (0.9 * CLOCK, -0.9 * CLOCK):
        assert timing_alarms(step=step) == {}
    assert timing_alarms(step=0.02, in_air=False) == {}


def test_movement_of_a_clock_is_reported_for_its_window():
    timed = TimedLink(lambda t: 7.0 + t + (0.5 if t >= 10.0 else 0.0))
    timed.log = AlarmLog(settings=replace(DEFAULTS.monitor, hold_time=-math.inf))  # every step that raises it counts
    times = [time for _, time in timed.run(20.0)]
    assert times[0] == pytest.approx(10.0, abs=0.06)
    assert times[-1] == pytest.approx(10.0 + DEFAULTS.monitor.clock_window, abs=0.16)


def test_telemetry_of_a_vehicle_that_paused_between_two_steps_raises_an_alarm_in_the_air():
    timeout = DEFAULTS.monitor.missed_samples / SYSTEM.rates.telemetry

    def alarms(pause, in_air=True):
        """Of vehicle 2, whose telemetry pauses (s) and is back by the next step."""
        links = [SimpleNamespace(complete_telemetry_received_at=10.0, payload_received_at=10.0) for _ in range(N)]
        monitored, log = Monitored(), AlarmLog()
        flight = SimpleNamespace(system=SimpleNamespace(team=SimpleNamespace(links=links)))
        for now in (10.0, 10.0 + pause):
            for i, link in enumerate(links):
                link.complete_telemetry_received_at = now if i == 1 else max(now, 10.0 + pause)
                link.payload_received_at = 10.0 + pause
            step = MonitorStep(now, now, flight, None, log, None, in_air, NAMES, clear=in_air, steady=True)
            monitored.detectors[0](step)
        return [(alarm.source, alarm.code, alarm.text) for alarm in log.alarms]

    assert alarms(0.99 * timeout) == []
    assert alarms(2.0) == [("vehicle 2", MonitorAlarm.TELEMETRY_TIMEOUT, "no telemetry for 2.00 s")]
    assert alarms(2.0, in_air=False) == []
