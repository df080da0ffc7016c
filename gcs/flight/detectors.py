"""Alarms that change nothing by themselves, and their detectors: links, clocks, measurements, model, obstacles.

To add one, add its code to :class:`MonitorAlarm` and a detector to :func:`detectors`.
"""

import math
from dataclasses import replace

import numpy as np

from gcs.config.flight_settings import MonitorSettings
from gcs.flight.alarms import Severity
from gcs.flight.clock_movement import ClockMovement
from gcs.flight.flight import Flight
from gcs.flight.guarantee import Guarantee
from gcs.flight.monitor_step import Detector, MonitorStep, Scope, ScopedAlarm
from gcs.flight.sliding_window import EventCounter
from gcs.mavlink.clock import RemoteClock
from idc_controller.estimation.health.chi_squared import upper_quantile
from idc_controller.estimation.health.innovation_monitor import Finding, InnovationMonitor
from idc_controller.estimation.measurements import PAYLOAD, Position
from idc_controller.estimation.settings import InnovationMonitorSettings


class MonitorAlarm(ScopedAlarm):
    """Alarms of the detectors; in ``meaning``, names in braces are fields of ``MonitorSettings``."""

    # fmt: off
    TELEMETRY_TIMEOUT = (Scope.IN_AIR, Severity.WARNING, "check its MAVLink link",
        "{missed_samples} telemetry periods passed without attitude or position of a vehicle, or without the payload")
    RANGE_SENSOR_FAILED = (Scope.IN_AIR, Severity.WARNING, "check the sensor",
        "a vehicle reports that its range sensor does not work")
    RANGE_SENSOR_SILENT = (Scope.IN_AIR, Severity.WARNING, "check the sensor",
        "no scan of a vehicle's range sensor comes, though its poses do")
    RANGE_SENSOR_DISPLACED = (Scope.IN_AIR, Severity.WARNING, "check the sensor and its mounting",
        "the points of a vehicle's range sensor are displaced from its rays, all in one direction")
    LINK_LATENCY = (Scope.IN_AIR, Severity.WARNING, "check the MAVLink link for congestion",
        "datagrams usually take more than {latency_periods} control periods one way (`TIMESYNC`)")
    LINK_JITTER = (Scope.IN_AIR, Severity.WARNING, "check the MAVLink link for congestion",
        "their latency varies by more than {jitter_periods} control periods")
    LINK_CONGESTION = (Scope.IN_AIR, Severity.WARNING, "reduce its message rates, or use a link of a higher rate",
        "datagrams usually come more than {jitter_periods} control periods after the least latency, and a queue before "
        "a link of limited rate, which they use by {queue_load:.0%} or more, explains how their latency varies by "
        "{queue_explained:.0%}")
    CLOCK_ERROR = (Scope.IN_AIR, Severity.WARNING, "check its clock",
        "a vehicle's clock has moved by more than {clock_error} s within {clock_window:g} s, and no latency explains "
        "it: stamps step back, or datagrams seem to arrive before they are sent, or both bounds of the offset by the "
        "`TIMESYNC` exchanges of {clock_segment:g} s are displaced in one direction")
    MESSAGES_LOST = (Scope.IN_AIR, Severity.WARNING, "check the MAVLink link",
        "sequence numbers are missing, {event_count} times in {event_window:g} s")
    MESSAGES_REORDERED = (Scope.IN_AIR, Severity.WARNING, "check the MAVLink link",
        "messages were overtaken by later ones, {event_count} times in {event_window:g} s")
    MESSAGES_DUPLICATED = (Scope.IN_AIR, Severity.WARNING, "check the routing for a loop",
        "messages came twice, {event_count} times in {event_window:g} s")
    MESSAGES_CORRUPTED = (Scope.IN_AIR, Severity.WARNING, "check the MAVLink link",
        "datagrams could not be decoded, {event_count} in {event_window:g} s")
    VALUES_NOT_FINITE = (Scope.IN_AIR, Severity.WARNING, "check the sensors",
        "measurements are not finite, {event_count} in {event_window:g} s")
    SETPOINTS_LOST = (Scope.IN_AIR, Severity.WARNING, "check the MAVLink link",
        "by what a vehicle reports to fly, set-points were lost, {event_count} times in {setpoint_window:g} s")
    ID_SWAP = (Scope.CLEAR_OF_GROUND, Severity.ERROR, "check the system ids",
        "a vehicle sends the data of another one, for which they are taken from then on")
    STUCK_SENSOR = (Scope.CLEAR_OF_GROUND, Severity.ERROR, "check the sensor",
        "a channel repeats one value")
    CHANNEL_ISOLATED = (Scope.CLEAR_OF_GROUND, Severity.ERROR, "check the sensor",
        "a channel was rejected for half a second, and is isolated until it has been accepted for 1 s; of a position "
        "and a velocity that contradict each other both")
    INCONSISTENT_STATE = (Scope.CLEAR_OF_GROUND, Severity.ERROR, "check navigation",
        "the positions of most vehicles do not follow from their velocities while the payload's do, or the other way "
        "round; or an attitude does not follow from its rates: the inconsistent ones are isolated from then on")
    MEASUREMENTS_REJECTED = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "check the sensor",
        "three samples of a channel in 1 s failed the innovation test (eight of a UAV's attitude)")
    INNOVATION_BIAS = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "check the sensor; check for wind",
        "the mean innovation of a channel over a second is not zero (p = 1e-10)")
    INNOVATION_NOISE = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "check the sensor",
        "the mean square innovation of a channel over a second is too large (p = 1e-10)")
    SENSOR_NOISE = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "correct the system file",
        "the variances of all sensors are more than {noise_factor:g} times those of the system file")
    COVARIANCE_RESET = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "check for gusts or a lost load",
        "most measurements, or the payload's, rejected the prediction, {event_count} times in {event_window:g} s")
    DISTURBANCE_FORCE = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "check for wind or a wrong mass",
        "the force on the payload is not the model's (p = 1e-10)")
    PROCESS_NOISE = (Scope.CLEAR_OF_GROUND, Severity.WARNING, "check for gusts",
        "forces change so quickly that the process noise is at its largest")
    VEHICLE_MAP_OFFSET = (Scope.ALWAYS, Severity.WARNING, "check its position and range sensor",
        "a vehicle detects a standing obstacle of the map more than 0.2 m from where it was for 0.4 s, "
        "and more obstacles out of their places than in them")
    TRACK_LOST = (Scope.ALWAYS, Severity.NOTICE, "none",
        "a tracked obstacle was not detected for 1 s although a vehicle is near")
    # fmt: on


_Events = EventCounter[tuple[str, MonitorAlarm]]
"""Counts by source and alarm code."""


class _TelemetryTimeout:
    """Gaps in the telemetry, also those that ended since the last step."""

    def __init__(self, timeout: float) -> None:
        self._timeout = timeout
        self._last: list[float] = []
        """Of each vehicle and of the payload; empty: not in the air."""

    def __call__(self, step: MonitorStep) -> None:
        if not step.in_air:
            self._last = []
            return
        links, now, timeout = step.links, step.now, self._timeout
        received_at = [link.complete_telemetry_received_at for link in links]
        received_at.append(max([link.payload_received_at for link in links]))
        for i, (last, before) in enumerate(zip(received_at, self._last or received_at, strict=True)):
            gap = max(now - last, last - before)
            if gap > timeout:
                step.raise_alarm(step.names[i], MonitorAlarm.TELEMETRY_TIMEOUT, f"no telemetry for {gap:.2f} s")
        self._last = received_at


class LinkTiming:
    """Latency, jitter and clock of each vehicle's link, each by a test of its own."""

    def __init__(self, settings: MonitorSettings, control_period: float, number_of_uavs: int) -> None:
        self._settings = settings
        self._latency = settings.latency_periods * control_period
        self._jitter = settings.jitter_periods * control_period
        self._movements = [ClockMovement(settings) for _ in range(number_of_uavs)]
        self._set_back = [0.0] * number_of_uavs
        self._queues: list[tuple[float, str]] = [(-math.inf, "")] * number_of_uavs
        """When each link's was looked at last, and what it said."""

    def __call__(self, step: MonitorStep) -> None:
        """Raise the alarms of one control step; call it before take-off as well, so that nothing waits for it."""
        for i, (link, name) in enumerate(zip(step.links, step.names, strict=False)):
            delay, spread = link.clock.delay, link.clock.spread
            if delay > self._latency:
                text = f"link latency is {delay * 1e3:.0f} ms (limit {self._latency * 1e3:.0f} ms)"
                step.raise_alarm(name, MonitorAlarm.LINK_LATENCY, text)
            if spread > self._jitter:
                text = f"link latency varies by {spread * 1e3:.0f} ms (limit {self._jitter * 1e3:.1f} ms)"
                step.raise_alarm(name, MonitorAlarm.LINK_JITTER, text)
            if text := self._congestion(i, link.clock, step.now):
                step.raise_alarm(name, MonitorAlarm.LINK_CONGESTION, text)
            moved = self._moved(i, link.clock, step.now)
            if abs(moved) > self._settings.clock_error:
                text = f"clock {'moved ahead' if moved > 0.0 else 'was set back'} by {abs(moved) * 1e3:.0f} ms or more"
                step.raise_alarm(name, MonitorAlarm.CLOCK_ERROR, text)

    def _congestion(self, i: int, clock: RemoteClock, now: float) -> str:
        """Return how the datagrams of vehicle ``i`` queue; empty: they do not."""
        s, queue, (looked_at, text) = self._settings, clock.queue, self._queues[i]
        # A clock that drifts delays stamps, too, but no round trip.
        if clock.round_trip_excess <= self._jitter or len(queue) < s.queue_datagrams or queue.wait <= self._jitter:
            text = ""
        elif now - looked_at < s.queue_interval:
            return text
        else:
            fit = queue.fit()
            looked_at, text = now, ""
            if fit.explained > s.queue_explained and fit.load > s.queue_load * fit.rate:
                link = f"a link of {fit.rate * 1e-3:.1f} kB/s, of which {min(fit.load / fit.rate, 1.0):.0%} are used"
                text = f"datagrams come {queue.wait * 1e3:.0f} ms late over {link}"
        self._queues[i] = looked_at, text
        return text

    def _moved(self, i: int, clock: RemoteClock, now: float) -> float:
        """Return by how much (s) the clock of vehicle ``i`` has moved for certain, the most that a test says."""
        movement = self._movements[i]
        movement.add(clock.bounds.take())
        # A stamp that is earlier than one sent before.
        set_back, self._set_back[i] = clock.set_back - self._set_back[i], clock.set_back
        certain = [-set_back] if clock.bounds.known else []
        return max([movement.contradiction(now), movement.displacement(now), *certain], key=abs)


class _MessageEvents:
    """Lost, reordered, duplicated, corrupted and not finite messages, and lost set-points."""

    # Every vehicle relays the payload's: counted for each.
    _CODES = (
        MonitorAlarm.MESSAGES_LOST, MonitorAlarm.MESSAGES_REORDERED, MonitorAlarm.MESSAGES_DUPLICATED,
        MonitorAlarm.MESSAGES_CORRUPTED, MonitorAlarm.VALUES_NOT_FINITE, MonitorAlarm.SETPOINTS_LOST,
        MonitorAlarm.VALUES_NOT_FINITE,
    )  # fmt: skip

    def __init__(self, settings: MonitorSettings, number_of_uavs: int) -> None:
        self._count = settings.event_count
        self._events = _Events(settings.event_window)
        self._setpoints = _Events(settings.setpoint_window)
        self._totals = [(0,) * len(self._CODES)] * number_of_uavs

    def __call__(self, step: MonitorStep) -> None:
        # Counted before take-off as well, so that nothing of that is an event in the air.
        for i, link in enumerate(step.links):
            statistics = link.statistics
            statistics.settle(step.now)
            totals = (
                statistics.lost, statistics.reordered, statistics.duplicated, statistics.damaged,
                statistics.not_finite, link.setpoints.lost, statistics.payload_not_finite,
            )  # fmt: skip
            if totals != self._totals[i]:
                self._add(step, i, totals)
        for events in (self._events, self._setpoints):
            _raise_frequent(step, events, self._count)

    def _add(self, step: MonitorStep, i: int, totals: tuple[int, ...]) -> None:
        """Add what is new in the totals of a vehicle's link, the last of which is the payload's."""
        sources = [step.names[i]] * (len(totals) - 1) + [step.names[PAYLOAD]]
        for source, code, total, before in zip(sources, self._CODES, totals, self._totals[i], strict=True):
            if total > before:
                events = self._setpoints if code is MonitorAlarm.SETPOINTS_LOST else self._events
                events.add((source, code), step.time, total - before)
        self._totals[i] = totals


class _Innovations:
    """Innovation tests of all channels, and resets of the covariance."""

    def __init__(
        self, gate_probability: float, settings: MonitorSettings, innovations: InnovationMonitorSettings
    ) -> None:
        self._tests = InnovationMonitor(gate_probability, innovations)
        self._resets = _Events(settings.event_window)
        self._count = settings.event_count

    def __call__(self, step: MonitorStep) -> None:
        if step.clear and step.record is not None:
            for innovation in step.record.estimate.innovations:
                self._tests.learn(
                    innovation.time, innovation.keys, innovation.sizes, innovation.normalised, innovation.rejected
                )
                if innovation.covariance_reset and step.steady:
                    self._resets.add(("team", MonitorAlarm.COVARIANCE_RESET), innovation.time)
            if not step.steady:
                self._tests.forget_attitudes()
            for (source, kind), findings in self._tests.findings(step.time).items():
                for finding in findings:
                    step.raise_alarm(step.names[source], _OF_FINDING[finding], kind.__name__.lower())
        _raise_frequent(step, self._resets, self._count)


_OF_FINDING = {
    Finding.REJECTED: MonitorAlarm.MEASUREMENTS_REJECTED,
    Finding.BIASED: MonitorAlarm.INNOVATION_BIAS,
    Finding.NOISY: MonitorAlarm.INNOVATION_NOISE,
}


def _range_sensors(step: MonitorStep) -> None:
    """Range sensors that vehicles report as failed, and those that are silent or displaced."""
    for i, link in enumerate(step.links):
        if not link.status.obstacle_sensing_valid:
            step.raise_alarm(step.names[i], MonitorAlarm.RANGE_SENSOR_FAILED)
    sensors = step.flight.system.obstacle_map.placement.range_sensors
    for i in sorted(sensors.silent):
        if step.links[i].status.obstacle_sensing_valid:
            step.raise_alarm(step.names[i], MonitorAlarm.RANGE_SENSOR_SILENT)
    for i in sorted(sensors.displaced):
        step.raise_alarm(step.names[i], MonitorAlarm.RANGE_SENSOR_DISPLACED)


def _estimator_health(step: MonitorStep) -> None:
    """Sensors that the estimator does without, and why."""
    if not step.clear:
        return
    health = step.flight.control.estimator.health
    for sender, other in step.id_check.swapped.items():
        step.raise_alarm(step.names[sender], MonitorAlarm.ID_SWAP, f"sends the data of {step.names[other]}")
    for channel in health.stuck_channels:
        step.raise_alarm(step.names[channel.source], MonitorAlarm.STUCK_SENSOR, channel.name)
    isolated = [c for c in health.isolation.isolated if step.steady or c.kind is Position]
    for uav in dict.fromkeys(channel.source for channel in isolated):
        channels = ", ".join(channel.name for channel in isolated if channel.source == uav)
        step.raise_alarm(step.names[uav], MonitorAlarm.CHANNEL_ISOLATED, channels)
    for group, (poses, _) in health.isolated_groups.items():
        names = ("positions", "velocities") if group.kind is Position else ("attitudes", "rates")
        source, owner = ("payload", "the payload") if group.of_payload else ("team", "all vehicles")
        text = f"{names[0 if poses else 1]} of {owner} are isolated"
        step.raise_alarm(source, MonitorAlarm.INCONSISTENT_STATE, text)


class _ModelMismatch:
    """Noise and forces that differ from the model."""

    def __init__(self, settings: MonitorSettings, innovations: InnovationMonitorSettings) -> None:
        self._noise_factor = settings.noise_factor
        # The error of the estimate includes the walk of the force: where there is none, the estimate varies by less.
        self._force_limit = settings.force_share * float(upper_quantile(innovations.false_alarm, 3))

    def __call__(self, step: MonitorStep) -> None:
        if not step.clear or step.record is None:
            return
        adaptation, estimate = step.flight.control.estimator.health.adaptation, step.record.estimate
        if step.steady and adaptation.measurement_scale > self._noise_factor:
            text = f"variances are {adaptation.measurement_scale:.1f} times those of the system file"
            step.raise_alarm("team", MonitorAlarm.SENSOR_NOISE, text)
        if step.steady and adaptation.is_at_limit:
            step.raise_alarm("payload", MonitorAlarm.PROCESS_NOISE)
        covariance = estimate.force_covariance + 1e-12 * np.eye(3)  # settings may leave none
        if estimate.force @ np.linalg.solve(covariance, estimate.force) > self._force_limit:
            text = " ".join(f"{f:.1f}" for f in estimate.force) + " N north east down"
            step.raise_alarm("payload", MonitorAlarm.DISTURBANCE_FORCE, text)


def _obstacles(step: MonitorStep) -> None:
    """Obstacles that are no longer detected, or elsewhere than on the map."""
    obstacle_map = step.flight.system.obstacle_map
    for name in obstacle_map.take_deleted_tracks():
        step.raise_alarm(name, MonitorAlarm.TRACK_LOST, "not detected although a vehicle is near")
    for uav, offset in obstacle_map.map_offsets.items():
        text = f"detects obstacles {float(np.linalg.norm(offset)):.2f} m from the map"
        step.raise_alarm(step.names[uav], MonitorAlarm.VEHICLE_MAP_OFFSET, text)


def detectors(flight: Flight, settings: MonitorSettings) -> tuple[Detector, ...]:
    """Return the detectors of a flight, in the order in which they run."""
    rates, number_of_uavs = flight.mission.system.rates, len(flight.system.team.links)
    innovations = replace(flight.mission.system.estimation.innovation_monitor, rate=rates.telemetry)
    return (
        _TelemetryTimeout(settings.missed_samples / rates.telemetry),
        _range_sensors,
        LinkTiming(settings, 1.0 / rates.control, number_of_uavs),
        _estimator_health,
        _Innovations(flight.control.estimator.settings.gate_probability, settings, innovations),
        _ModelMismatch(settings, innovations),
        _MessageEvents(settings, number_of_uavs),
        _obstacles,
        Guarantee(flight),
    )


def _raise_frequent(step: MonitorStep, events: _Events, count: int) -> None:
    for (source, code), number in events.recent(step.time).items():
        if number >= count:
            step.raise_alarm(source, code, f"{number} times")
