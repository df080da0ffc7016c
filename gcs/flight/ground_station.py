"""The ground station on the wire: bytes in, bytes out, and a flight behind them. No socket, no clock.

The way of the data: datagram -> codec -> vehicle link, identities, telemetry -> estimator -> controller ->
set-points -> datagram.
"""

from __future__ import annotations

import math
from collections import deque
from statistics import median
from typing import Protocol

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.flight.alarms import Alarm
from gcs.flight.flight import Flight, Setpoints, StepRecord
from gcs.flight.monitor import Watch
from gcs.flight.phase import IN_THE_AIR, Phase
from gcs.flight.team import Team
from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec, gather
from gcs.mavlink.id_check import Identities
from gcs.mavlink.messages import Message, Received
from gcs.mavlink.setpoints import attitude_target, stop_plan_message
from gcs.mavlink.telemetry import detection, measurement, setpoint_flown
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.estimation.measurements import Attitude, Position
from idc_controller.perception.obstacle_map import ObstacleMap

GROUND_SYSTEM = 255
GROUND_COMPONENT = mavlink.MAV_COMP_ID_MISSIONPLANNER
HEARTBEAT_INTERVAL = 1.0  # s
TIMESYNC_INTERVAL = 0.1  # s
SILENCE_GIVES_UP = 3.0  # s without a word of any vehicle
CLOCK_STEP = 0.5  # s by which the team's time is corrected at most in flight
CLOCK_SETTLED = 0.2  # s after which stamps of one message and of another are of one clock again
LEAD_RATE, LEAD_MAX = 0.02, 0.01  # s/s, and s at once, by which it follows a clock ahead of where that has ever been
LATENCIES = 20  # control steps whose latency is remembered
TOGETHER = 0.004  # s; vehicles that act within it act at once
TOLERANCE = 1e-6  # s, for timers that are sums of periods

_SAMPLES = (
    mavlink.MAVLink_attitude_quaternion_message,
    mavlink.MAVLink_local_position_ned_message,
    mavlink.MAVLink_attitude_target_message,
    mavlink.MAVLink_obstacle_distance_3d_message,
)
"""Messages of one moment, which their stamp names."""


class Recorder(Protocol):
    """Where a ground station's records go."""

    def datagram(self, now: float, datagram: bytes) -> None:
        """One datagram, sent or received."""
        ...

    def step(self, flight: Flight, time: float, record: StepRecord | None) -> None:
        """One control step at team ``time``."""
        ...

    def obstacles(self, obstacle_map: ObstacleMap, time: float) -> None:
        """What is believed of the obstacles at team ``time``, once a control step."""
        ...

    def alarm(self, alarm: Alarm) -> None:
        """Something was noticed."""
        ...


class GroundStation:
    """All vehicles of one flight. A driver calls :meth:`receive`, :meth:`datagrams_to_send` and :meth:`next_timer`."""

    def __init__(
        self,
        team: Team,
        flight: Flight,
        control_period: float,
        recorder: Recorder,
        obstacle_map: ObstacleMap | None = None,
    ) -> None:
        self.team, self.flight = team, flight
        self.links = team.links
        self._recorder = recorder
        self._obstacle_map = obstacle_map
        self._identities = Identities(len(self.links))
        self.watch = Watch(flight, obstacle_map, self._identities)
        self._codec = Codec(GROUND_SYSTEM, GROUND_COMPONENT)
        self._by_address: dict[tuple[Address, int], int] = {
            (link.address, link.system_id): i for i, link in enumerate(self.links) if link.address is not None
        }
        self._period = control_period
        self._next_control = -math.inf
        self._next_heartbeat = -math.inf
        self._next_timesync = -math.inf
        self._began = math.nan
        self._team_offset = self._lead = 0.0
        self._led_at = -math.inf
        self._last_step = -math.inf
        self._stepped = False
        self._held: list[tuple[float, int, list[Message]]] = []
        """Set-points that wait for those on longer ways: when they are due, the vehicle's index, the messages."""
        self._thinking: deque[float] = deque(maxlen=LATENCIES)
        self._latency = 0.0
        self.refused_datagrams = 0
        """Datagrams from addresses that belong to no vehicle of this flight."""

    @property
    def ended(self) -> bool:
        """Whether the flight is over."""
        return self.flight.ended

    def team_time(self, now: float) -> float:
        """The team's time (s): the boot time of the first vehicle; the ground's own until that is known."""
        return now + self._team_offset

    def break_off(self, now: float, reason: str, *, interrupted: bool = False) -> None:
        """End the flight early and safely."""
        self.flight.break_off(self.team_time(now), reason, interrupted=interrupted)

    def receive(self, datagram: bytes, sender: Address, now: float) -> None:
        """Whatever came from an address. Never raises for anything that a datagram can hold."""
        unread = self._codec.unread
        messages = self._codec.decode(datagram)
        if self._codec.unread > unread and (link := self._link_at(sender)) is not None:
            link.statistics.damaged += 1
        known = False
        latest = -math.inf
        for received in messages:
            index = self._by_address.get((sender, received.system))
            if index is None:
                index = self._unexpected(received, sender)
            if index is None:
                continue
            known = True
            if not received.is_for(GROUND_SYSTEM):
                continue  # an answer to another system behind this address
            link = self.links[index]
            link.handle(received, now)
            if link.clock.known:
                latest = max(latest, self._learn(received, index, latest, now))
        if known:
            self._recorder.datagram(now, datagram)
        else:
            self.refused_datagrams += 1

    def datagrams_to_send(self, now: float) -> list[tuple[bytes, Address]]:
        """All that is due at ``now`` (s), each with its address."""
        if math.isnan(self._began):
            self._began = now
        messages: list[list[Message]] = [[] for _ in self.links]
        if now >= self._next_heartbeat - TOLERANCE:
            self._next_heartbeat = now + HEARTBEAT_INTERVAL
            for queue in messages:
                queue.append(_heartbeat())
        if now >= self._next_timesync - TOLERANCE:
            self._next_timesync = now + TIMESYNC_INTERVAL
            for link, queue in zip(self.links, messages, strict=True):
                queue.append(mavlink.MAVLink_timesync_message(0, link.clock.ask(now)))
        self._stepped = now >= self._next_control - TOLERANCE
        if self.flight.watch_team(self.team_time(now), now):
            # The plan that they are to stop by comes before the command to stop, or they stop by another one.
            self._held.clear()
            for i, queue in enumerate(messages):
                queue.extend(self._closing_the_loop(i, now, None))
        if self._stepped:
            self._control(now, messages)
        carries_setpoints = [self._stepped] * len(self.links)
        for due, i, queue in self._held:
            if due <= now + TOLERANCE:
                messages[i].extend(queue)
                carries_setpoints[i] = True
        self._held = [entry for entry in self._held if entry[0] > now + TOLERANCE]
        for link, queue in zip(self.links, messages, strict=True):
            queue.extend(link.requests_to_send(now))
        out = []
        for link, queue, repeated in zip(self.links, messages, carries_setpoints, strict=True):
            if link.address is None:
                continue
            copies = link.copies if repeated else 1
            for datagram in gather(self._codec.encode(message) for message in queue):
                out += [(datagram, link.address)] * copies
                self._recorder.datagram(now, datagram)
        return out

    def thought(self, duration: float) -> None:
        """What was sent last left ``duration`` (s) after the time it was asked for: reckoned with from now on."""
        if self._stepped:
            self._thinking.append(duration)
            self._latency = median(self._thinking)

    def next_timer(self) -> float | None:
        """When :meth:`datagrams_to_send` is to be called again (s, ground time); None: never."""
        if self.ended:
            return None
        held = min((due for due, _, _ in self._held), default=math.inf)
        return max(min(self._next_control, self._next_heartbeat, self._next_timesync, held), 0.0)

    def _link_at(self, address: Address) -> VehicleLink | None:
        return next((link for link in self.links if link.address == address), None)

    def _unexpected(self, received: Received, sender: Address) -> int | None:
        """The index of a vehicle that offers itself for the first time with this message; None: nothing is learnt."""
        is_heartbeat = isinstance(received.message, mavlink.MAVLink_heartbeat_message)
        if not is_heartbeat or received.component != px4.AUTOPILOT_COMPONENT:
            return None
        system_id = received.system
        for i, link in enumerate(self.links):
            if link.address is None and link.system_id == system_id:
                link.address = sender
                self._by_address[sender, system_id] = i
                return i
            if link.address == sender:
                link.found_instead = system_id
        return None

    def _follow_clock(self, offset: float, now: float) -> None:
        """The team's time is the first vehicle's; in flight a jump is a reboot, and time goes on.

        Datagrams that are late, and a simulated world that has stalled, hold that vehicle's clock back against the
        ground's for a while. Only a clock that is wrong gets ahead of where it has been, and is followed slowly.
        """
        if self.flight.phase is Phase.CONNECT:
            self._team_offset = self._lead = offset
        elif abs(offset - self._team_offset) < CLOCK_STEP:
            allowed = self._lead + min(LEAD_MAX, LEAD_RATE * (now - self._led_at))
            self._team_offset = min(offset, allowed)
        if self._team_offset >= self._lead:
            self._lead, self._led_at = self._team_offset, now

    def _learn(self, received: Received, index: int, latest: float, now: float) -> float:
        """From a message that tells of one moment: which. ``latest`` is that of those before it in its datagram."""
        message = received.message
        if not isinstance(message, _SAMPLES):
            return -math.inf
        link, obstacle_map = self.links[index], self._obstacle_map
        if index == 0:
            self._follow_clock(link.clock.offset + link.clock.set_back, now)
        time = _whole_ms(message.time_boot_ms * 1e-3 - link.clock.offset + self._team_offset)
        if isinstance(message, mavlink.MAVLink_attitude_target_message):
            told = setpoint_flown(message, link.parameters.get(px4.PARAM_THRUST_MAX, math.nan))
            if told is not None:
                # Its stamp is that of the moment at which it began to act.
                until = min(max(time, latest), self.team_time(now))
                confirmation = self.flight.flown(index, time, until, told, link.clock.spread, link.longest_way)
                if confirmation is not None:
                    link.confirmed(confirmation)
            return time
        if isinstance(message, mavlink.MAVLink_obstacle_distance_3d_message):
            # What was seen before its clock was set has the stamp of another pose.
            if obstacle_map is not None and now - link.clock.jumped > CLOCK_SETTLED:
                obstacle_map.detected(detection(message), index, time)
            return time
        sample = measurement(received, self._identities.whose(index), time)
        if sample is None or not (sample.has_pose and sample.has_motion):
            link.statistics.unusable(received.component)
        if sample is not None:
            self._identities.told(sample)
            believed = self.flight.measured(sample)
            if obstacle_map is not None and believed is not None:
                obstacle_map.measured(believed)
        return time

    def _control(self, now: float, messages: list[list[Message]]) -> None:
        time = self.team_time(now)
        # Steps fall on whole periods of the team's time.
        self._next_control = (math.floor(time / self._period + 0.5) + 1) * self._period - self._team_offset
        if self.flight.phase is not Phase.CONNECT and time <= self._last_step:
            return  # a better guess of the vehicle's clock has set the time back a little
        self._last_step = time
        silent = self.team.silent(now, SILENCE_GIVES_UP) and now - self._began > SILENCE_GIVES_UP
        # Who is not heard may hear: the descent is to be ordered first.
        if silent and not self.flight.owes_descent:
            heard = any(math.isfinite(link.heard) for link in self.links)
            if heard:
                self.flight.give_up(f"nothing was heard of any vehicle for {SILENCE_GIVES_UP:g} s")
        # All are to act at once: what has a shorter way waits.
        delays = np.array([link.setpoint_delay for link in self.links])
        waits = delays.max() - delays
        waits[waits < TOGETHER] = 0.0
        leaves = time + self._latency + waits
        if self._obstacle_map is not None:
            unusable = self.flight.estimator.unusable_poses
            self._obstacle_map.broken({i for i, link in enumerate(self.links) if not link.sees}, time)
            self._obstacle_map.update(time, self.flight.pose_noise, unusable(Position), unusable(Attitude))
            if self.flight.phase in IN_THE_AIR and not self.flight.reason:
                if self._obstacle_map.is_blind:
                    self.break_off(now, "no vehicle sees obstacles, or what all tell of them can not be")
                elif self._obstacle_map.is_astray:
                    self.break_off(now, "no vehicle sees obstacles where they are on the map any more")
            self._recorder.obstacles(self._obstacle_map, time)
        effective = _whole_ms(time + self._latency + delays.max())
        setpoints, record = self.flight.step(time, effective, leaves, now)
        if record is not None:
            estimated = self.flight.estimator.vehicles(record.estimate)
            self._identities.compare(estimated)
            if self._obstacle_map is not None:
                for sample in estimated:
                    self._obstacle_map.estimated(sample)
        for alarm in self.watch.step(time, now, record):
            self._recorder.alarm(alarm)
        self._recorder.step(self.flight, time, record)
        if setpoints is None:
            self._held.clear()
        for i, (queue, wait) in enumerate(zip(messages, waits.tolist(), strict=True)):
            closing = self._closing_the_loop(i, now, setpoints)
            if wait and setpoints is not None:
                self._held.append((now + wait, i, closing))
            else:
                queue.extend(closing)

    def _closing_the_loop(self, i: int, now: float, setpoints: Setpoints | None) -> list[Message]:
        """Stop plan and set-point of one vehicle, as far as there are any."""
        link = self.links[i]
        messages: list[Message] = []
        # The plan before the set-point: a vehicle that gets one of the two can still stop with the others.
        if (plan := self.flight.stop_plan) is not None:
            start = plan.start - self._team_offset + link.clock.offset
            messages.append(stop_plan_message(start, plan.duration, plan.control_points[i].tolist()))
        if setpoints is not None:
            direction, thrust = setpoints.directions[i], float(setpoints.thrusts[i])
            thrust_max = link.parameters[px4.PARAM_THRUST_MAX]
            messages.append(attitude_target(link.system_id, link.stamp(now), direction, thrust, thrust_max))
        return messages


def _whole_ms(time: float) -> float:
    """No stamp tells more, and what the estimator computes for one interval serves for all of its length."""
    return round(time, 3)


def _heartbeat() -> Message:
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, mavlink.MAV_STATE_ACTIVE, 3
    )
