"""Telemetry routing: datagram -> codec -> vehicle link -> system-id check -> estimator and obstacle map."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.flight_settings import DEFAULTS, TimingSettings
from gcs.flight.flight import Flight
from gcs.flight.phase import IN_AIR, Phase
from gcs.flight.team_clock import TeamClock
from gcs.mavlink import px4
from gcs.mavlink.address import Address
from gcs.mavlink.codec import Codec
from gcs.mavlink.id_check import SystemIdCheck
from gcs.mavlink.layout import Sample
from gcs.mavlink.messages import Received
from gcs.mavlink.telemetry import measurements, scan_end, scan_returns, setpoint_flown
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.estimation.measurements import PAYLOAD

_ATTITUDE, _POSITION, _SETPOINT, _RETURNS = Sample.ATTITUDE, Sample.POSITION, Sample.SETPOINT, Sample.RETURNS


class _Routed(NamedTuple):
    """What has come in one exchange for the estimator, in order."""

    samples: list[tuple[Received, int, float]]
    """Measurements: the message, its source, time of validity (s)."""
    senders: list[int]
    """The vehicle (0 .. N-1) as which each of them was sent."""
    setpoints: list[tuple[Received, int, float, float, float, float]]
    """Set-points that vehicles report to fly: the message, the vehicle (0 .. N-1), since and until when (s), jitter and
    largest latency of its link then (s)."""


class TelemetryRouter:
    """Takes datagrams of all vehicles. Times are the ground's (s) unless said otherwise."""

    def __init__(
        self,
        codec: Codec,
        flight: Flight,
        clock: TeamClock,
        id_check: SystemIdCheck,
        settings: TimingSettings = DEFAULTS.timing,
    ) -> None:
        self._codec, self._flight, self._clock, self._id_check = codec, flight, clock, id_check
        self._clock_settled = settings.clock_settled
        self._unread = codec.unread
        self._links = flight.system.team.links
        self._by_address: dict[tuple[Address, int], int] = {}
        self._at: dict[Address, list[VehicleLink]] = {}
        """Vehicles at each address: several behind a router."""
        for i, link in enumerate(self._links):
            if link.address is not None:
                self._enter(i, link.address)
        self.refused = 0
        """Datagrams from addresses that belong to no vehicle of this flight."""

    def receive(self, datagrams: Sequence[tuple[bytes, Address]], now: float) -> list[bytes]:
        """Take datagrams, each with its sender; return those from vehicles of this flight."""
        codec = self._codec
        # All are read before the first is routed, and all measurements added before the first report of a set-point: so
        # many calls of one kind cost far less in a row.
        read = [(codec.read(datagram), codec.unread) for datagram, _ in datagrams]
        known = []
        routed = _Routed([], [], [])
        for (datagram, sender), (messages, unread) in zip(datagrams, read, strict=True):
            if unread > self._unread:
                self._unread = unread
                if (link := next((link for link in self._links if link.address == sender), None)) is not None:
                    link.statistics.damaged += 1
            if self._take(messages, len(datagram), sender, now, routed):
                known.append(datagram)
        self.refused += len(datagrams) - len(known)
        if routed.samples:
            self._add_measurements(routed)
        for report in routed.setpoints:
            self._confirm_setpoint(*report)
        return known

    def _take(self, messages: Sequence[Received], size: int, sender: Address, now: float, routed: _Routed) -> bool:
        """Take the messages of a datagram of ``size`` bytes; return whether it is from a vehicle of this flight."""
        groups: dict[int, list[Received]] = {}
        system = index = None
        for received in messages:
            if index is None or received.system != system:
                system = received.system
                index = self._by_address.get((sender, system))
                if index is None:
                    index = self._new_vehicle(received, sender, now)
                if index is None:
                    continue
                group = groups.setdefault(index, [])
            if received.target_system and not received.is_for(self._codec.system_id):
                continue  # an answer to another system behind this address
            if system == px4.PAYLOAD_UNIT_SYSTEM and received.component != px4.PAYLOAD_UNIT_COMPONENT:
                continue
            group.append(received)
        for index, group in groups.items():
            if group:
                link = self._links[index]
                samples = link.handle(group, now, size)
                if len(sharing := self._at[sender]) > 1:
                    for other in sharing:
                        other.payload_received_at = max(other.payload_received_at, link.payload_received_at)
                if samples and link.clock.known:
                    self._route(samples, index, now, routed)
        return bool(groups)

    def _enter(self, index: int, address: Address) -> None:
        """Take what a vehicle sends from its address, and what it, or the first of several there, forwards."""
        link = self._links[index]
        self._at.setdefault(address, []).append(link)
        self._by_address[address, link.system_id] = index
        self._by_address.setdefault((address, px4.PAYLOAD_UNIT_SYSTEM), index)

    def _new_vehicle(self, received: Received, sender: Address, now: float) -> int | None:
        """Return the index of a vehicle that calls in for the first time with this heartbeat; None: none does.

        A vehicle of this flight that calls in from a second address has an id that it shares with another.
        """
        is_heartbeat = received.message_id == mavlink.MAVLINK_MSG_ID_HEARTBEAT
        if not is_heartbeat or received.component != px4.AUTOPILOT_COMPONENT:
            return None
        system_id = received.system
        for i, link in enumerate(self._links):
            if link.system_id == system_id:
                if link.address is None:
                    link.address = sender
                    self._enter(i, sender)
                    return i
                link.conflict.second_address, link.conflict.second_address_at = sender, now
            if link.address == sender:
                link.conflict.other_system_id = system_id
        return None

    def _route(self, samples: list[Received], index: int, now: float, routed: _Routed) -> None:
        """Route the samples, and runs of them, of one vehicle in one datagram."""
        link, obstacle_map = self._links[index], self._flight.system.obstacle_map
        offset = link.clock.offset
        if index == 0:
            self._clock.follow(offset + link.clock.set_back, now, connecting=self._flight.phase is Phase.CONNECT)
        team_offset, uav = self._clock.offset, self._id_check.vehicle_of(index)
        latest = -math.inf
        stamp, time = -1, math.nan
        for received in samples:
            sample = received.layout.sample
            if received.time_boot_ms != stamp:
                stamp = received.time_boot_ms
                time = whole_ms(link.clock.bounds.unwrapped(stamp * 1e-3) - offset + team_offset)
            if sample is _ATTITUDE or sample is _POSITION:
                routed.samples.append((received, PAYLOAD if received.system == px4.PAYLOAD_UNIT_SYSTEM else uav, time))
                routed.senders.append(index)
            elif sample is _SETPOINT:
                # Its stamp is that of the moment at which it began to act.
                until = min(max(time, latest), self._clock.time(now))
                routed.setpoints.append((received, index, time, until, link.clock.spread, link.setpoints.delay_max))
            # Scans from before a clock jump have the stamp of another pose.
            elif now - link.clock.jumped_at > self._clock_settled:
                if sample is _RETURNS:
                    obstacle_map.placement.add(scan_returns(received), index, time, now)
                else:
                    is_complete = link.statistics.scans.is_complete(stamp)
                    obstacle_map.placement.end(scan_end(received, is_complete), index, time, now)
            if time > latest:
                latest = time

    def _add_measurements(self, routed: _Routed) -> None:
        taken, partial = measurements(routed.samples)
        for k in partial:
            self._links[routed.senders[k]].statistics.add_not_finite(routed.samples[k][0].component)
        used = self._flight.add_measurements(taken)
        for sample in taken:
            if sample.source != PAYLOAD:
                self._id_check.add(sample)
        poses = self._flight.system.obstacle_map.placement.poses
        for sample in used:
            if sample.source != PAYLOAD:
                poses.add_measured(sample)

    def _confirm_setpoint(
        self, received: Received, index: int, since: float, until: float, jitter: float, latency_max: float
    ) -> None:
        link, flight = self._links[index], self._flight
        setpoint = setpoint_flown(received.fields, link.status.parameters.get(px4.PARAM_THRUST_MAX, math.nan))
        if setpoint is None or flight.phase not in IN_AIR:
            return
        confirmation = flight.control.estimator.confirm_setpoint(index, since, until, setpoint, jitter, latency_max)
        if confirmation is not None:
            link.setpoints.confirm(confirmation)


def whole_ms(time: float) -> float:
    """Return ``time`` (s) in whole milliseconds, as stamps are: what is estimated for one of them serves them all.

    Always finite: stamps are integers of 32 bits, and clock offsets and delays come from those and from arrivals.
    """
    return round(time * 1e3) / 1e3
