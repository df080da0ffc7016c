"""The ground station on the wire: bytes in, bytes out, and a flight behind them. No socket, no clock.

Data flow: datagram -> telemetry router -> estimator -> controller -> set-point schedule -> datagram.
"""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.flight.alarms import Alarm
from gcs.flight.compute_times import ComputeTimes, Part
from gcs.flight.condition import Trigger
from gcs.flight.control_loop import Setpoints, StepRecord
from gcs.flight.delivery import Delivery
from gcs.flight.failsafe import Failsafe
from gcs.flight.flight import Flight
from gcs.flight.monitor import FlightMonitor
from gcs.flight.phase import Phase
from gcs.flight.setpoint_schedule import SetpointSchedule
from gcs.flight.team_clock import IntervalTimer, StepTimer, TeamClock
from gcs.flight.telemetry_router import TelemetryRouter, whole_ms
from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec, gather
from gcs.mavlink.id_check import SystemIdCheck
from gcs.mavlink.layout import LAYOUTS, Packed, packed
from gcs.mavlink.setpoints import attitude_target
from gcs.mavlink.stop_plan import StopPlanContent, stop_plan_message
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.control.controller import Decision
from idc_controller.estimation.measurements import Attitude, Position
from idc_controller.perception.obstacle_map import ObstacleMap

GROUND_SYSTEM = px4.GROUND_SYSTEM
GROUND_COMPONENT = mavlink.MAV_COMP_ID_MISSIONPLANNER
_HEARTBEAT = packed(
    mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3
    )
)
_TIMESYNC = LAYOUTS[mavlink.MAVLINK_MSG_ID_TIMESYNC]


class Recorder(Protocol):
    """Records of a ground station."""

    def datagrams(self, now: float, datagrams: Sequence[bytes]) -> None:
        """Record datagrams, sent or received."""

    def end_exchange(self) -> None:
        """Write what was recorded of the datagrams of one exchange."""

    def step(self, flight: Flight, time: float, record: StepRecord | None) -> None:
        """Record one control step at team ``time``."""

    def compute_times(self, time: float, decision: Decision, parts: Sequence[float]) -> None:
        """Record the compute times (s) of the control step at team ``time``, as :class:`Part` orders them."""

    def obstacles(self, obstacle_map: ObstacleMap, time: float) -> None:
        """Record the obstacle map at team ``time``, once a control step."""

    def alarm(self, alarm: Alarm) -> None:
        """Record a new alarm."""


_UNKNOWN = (math.nan, math.nan, math.nan)
"""A hover force that is not known."""


class GroundStation:
    """All vehicles of one flight. A driver calls :meth:`receive`, :meth:`datagrams_to_send` and :meth:`next_timer`."""

    def __init__(self, flight: Flight, recorder: Recorder) -> None:
        settings = flight.mission.system.flight
        timing = settings.timing
        self.flight = flight
        self._recorder = recorder
        self._id_check = SystemIdCheck(len(flight.system.team.links), flight.mission.system.mavlink.id_check)
        alarms, others = flight.failsafes.alarms, [Delivery(flight)]
        self._monitor = FlightMonitor(flight, self._id_check, alarms, settings.monitor, others)
        self._codec = Codec(GROUND_SYSTEM, GROUND_COMPONENT)
        self._clock = TeamClock(timing)
        self.router = TelemetryRouter(self._codec, flight, self._clock, self._id_check, timing)
        self._schedule = SetpointSchedule(timing)
        self._control = StepTimer(1.0 / flight.mission.system.rates.control)
        self._heartbeat = IntervalTimer(timing.heartbeat_interval)
        self._timesync = IntervalTimer(timing.timesync_interval)
        self._stepped = False
        self._session = self._plan_number = 0
        """Number of this run of the ground, and of its last stop plan."""

    @property
    def links(self) -> tuple[VehicleLink, ...]:
        """The links of all vehicles."""
        return self.flight.system.team.links

    @property
    def ended(self) -> bool:
        """True if the flight is over."""
        return self.flight.ended

    @property
    def _times(self) -> ComputeTimes:
        return self.flight.control.compute_times

    def raise_failsafe(self, now: float, failsafe: Failsafe, reason: str) -> None:
        """React to an event that ends the flight early."""
        self.flight.raise_failsafe(self._clock.time(now), failsafe, Trigger(reason))

    def receive(self, datagram: bytes, sender: Address, now: float) -> None:
        """Take a datagram from any address. Never raises for anything that a datagram can hold."""
        self.receive_all([(datagram, sender)], now)

    def receive_all(self, datagrams: Sequence[tuple[bytes, Address]], now: float) -> None:
        """Take datagrams, each with its sender, as :meth:`receive` does one by one."""
        self._recorder.datagrams(now, self.router.receive(datagrams, now))

    def datagrams_to_send(self, now: float) -> list[tuple[bytes, Address]]:
        """Return all that is due at ``now`` (s), each with its address."""
        times, links, record = self._times, self.links, None
        times.lap(Part.TELEMETRY)
        messages: list[list[Packed]] = [[] for _ in links]
        if self._heartbeat.is_due(now):
            for queue in messages:
                queue += _HEARTBEAT
        if self._timesync.is_due(now):
            for link, queue in zip(links, messages, strict=True):
                queue.append(_TIMESYNC.pack(0, link.clock.request(now)))
        self._stepped = self._control.is_due(now)
        times.lap(Part.SETPOINTS)
        if self.flight.check_links(self._clock.time(now), now):
            self._schedule.clear()
        if self._stepped and self._control.begin(now, self._clock, connecting=self.flight.phase is Phase.CONNECT):
            record = self._step(now, messages)
        times.lap(Part.MONITORING)
        carries_setpoints = [self._stepped] * len(links)
        for i, due in self._schedule.take(now):
            messages[i].extend(due)
            carries_setpoints[i] = True
        requests = [link.requests.due(now) for link in links]
        if self.flight.phase is Phase.AUTONOMOUS_LANDING and any(requests) and not self._stepped:
            # The stop plan goes out before every command to stop, or a vehicle stops by another one.
            for queue, stop in zip(messages, self._setpoint_messages(now, None), strict=True):
                queue += stop
        for queue, due_now in zip(messages, requests, strict=True):
            queue += packed(*due_now)
        out = self._encoded(now, messages, carries_setpoints)
        self._recorder.end_exchange()
        times.lap(Part.RECORDING)
        if self._stepped:
            parts = times.take()
            if record is not None:
                self._recorder.compute_times(self.flight.time, record.decision, parts)
            times.lap(Part.RECORDING)
        return out

    def resume(self) -> None:
        """End an idle time: a driver that has waited calls this before it reads what has come."""
        self._times.resume()

    def sent(self) -> None:
        """Take the time since :meth:`datagrams_to_send` for that of sending."""
        self._times.lap(Part.SETPOINTS)

    def add_latency(self, duration: float) -> None:
        """Take the compute latency (s) of what was sent last; from now on it is compensated."""
        if self._stepped:
            self._schedule.add_latency(duration)

    def next_timer(self) -> float | None:
        """Return when :meth:`datagrams_to_send` is to be called again (s, ground time); None: never."""
        if self.ended:
            return None
        return max(min(self._control.next, self._heartbeat.next, self._timesync.next, self._schedule.next_due), 0.0)

    def _step(self, now: float, messages: list[list[Packed]]) -> StepRecord | None:
        """Make one control step and add its messages to those of each vehicle; return what was decided, if anything."""
        times = self._times
        time = self._clock.time(now)
        delays = [link.setpoints.delay for link in self.links]
        waits = self._schedule.waits(delays)
        times.lap(Part.SETPOINTS)
        self._update_obstacle_map(time)
        times.lap(Part.PERCEPTION)
        soonest = time + self._schedule.latency
        leaves = np.array([soonest + wait for wait in waits])
        setpoints, record = self.flight.step(time, whole_ms(soonest + max(delays)), leaves, now)
        if record is not None:
            self._compare(record)
        self._monitor.step(time, now, record)
        times.lap(Part.MONITORING)
        self._recorder.step(self.flight, time, record)
        times.lap(Part.RECORDING)
        if setpoints is None:
            self._schedule.clear()
        due = zip(messages, waits, self._setpoint_messages(now, setpoints), strict=True)
        for i, (queue, wait, outgoing) in enumerate(due):
            if wait and setpoints is not None:
                self._schedule.add(now + wait, i, outgoing)
            else:
                queue.extend(outgoing)
        times.lap(Part.SETPOINTS)
        return record

    def _update_obstacle_map(self, time: float) -> None:
        obstacle_map, estimator = self.flight.system.obstacle_map, self.flight.control.estimator
        obstacle_map.placement.range_sensors.set_failed(
            {i for i, link in enumerate(self.links) if not link.status.obstacle_sensing_valid}, time
        )
        noise = math.sqrt(estimator.health.adaptation.measurement_scale)
        unusable = [estimator.health.unusable_poses(kind, estimator.time) for kind in (Position, Attitude)]
        obstacle_map.update(time, noise, *unusable)
        self._recorder.obstacles(obstacle_map, time)

    def _compare(self, record: StepRecord) -> None:
        """Compare estimated vehicle states with what each system id sends; place the detections by them."""
        estimated = self.flight.control.estimator.measurement_model.vehicles(record.estimate.time, record.estimate.x)
        self._id_check.compare(estimated.values[:, :3])
        self.flight.system.obstacle_map.placement.poses.add_estimated(estimated)

    def _encoded(
        self, now: float, messages: Sequence[Sequence[Packed]], carries_setpoints: Sequence[bool]
    ) -> list[tuple[bytes, Address]]:
        """Return the datagrams of the messages to each vehicle, those with set-points as often as its link needs."""
        out: list[tuple[bytes, Address]] = []
        recorded: list[bytes] = []
        for link, queue, repeated in zip(self.links, messages, carries_setpoints, strict=True):
            if link.address is None or not queue:
                continue
            copies = link.setpoints.copies if repeated else 1
            datagrams = gather([self._codec.frame(message) for message in queue])
            for datagram in datagrams:
                out += [(datagram, link.address)] * copies
            recorded += datagrams
        self._times.lap(Part.SETPOINTS)
        self._recorder.datagrams(now, recorded)
        return out

    def _setpoint_messages(self, now: float, setpoints: Setpoints | None) -> list[list[Packed]]:
        """Return stop plan and set-point of each vehicle, as far as there are any."""
        messages: list[list[Packed]] = [[] for _ in self.links]
        # The plan before the set-point: a vehicle that gets one of the two can still stop with the others.
        if (plan := self.flight.control.stop_plan) is not None:
            self._plan_number += 1
            if self._plan_number == 1:
                self._session = round(now * 1e3) & 0xFFFFFFFF
            paths = plan.control_points.tolist()
            forces = [_UNKNOWN] * len(paths) if plan.hover_forces is None else plan.hover_forces.tolist()
            for link, queue, points, force in zip(self.links, messages, paths, forces, strict=True):
                ahead = link.clock.offset - self._clock.offset
                start, descent = plan.start + ahead, plan.descent + ahead
                content = StopPlanContent(
                    self._session, self._plan_number, start, descent, plan.duration, 0.0, points, force
                )
                queue.append(stop_plan_message(link.system_id, content))
        if setpoints is not None:
            rows = zip(setpoints.directions.tolist(), setpoints.thrusts.tolist(), strict=True)
            for link, queue, (direction, thrust) in zip(self.links, messages, rows, strict=True):
                stamp, thrust_max = link.setpoints.stamp(now), link.status.parameters[px4.PARAM_THRUST_MAX]
                queue.append(attitude_target(link.system_id, stamp, direction, thrust, thrust_max))
        return messages
